//! What happens to a simulated motion from outside: commands of a person, and a host that sends nothing for a while.

use std::fmt;
use std::str::FromStr;

use serde::Serialize;
use shared::motion::{CommandError, MotionCommand};

/// Something that happens to a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// What a person asks of the controller.
    Command(MotionCommand),
    /// For so many seconds the host sends no pieces.
    Starve(f64),
}

/// An action with its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// When, in s from the start: it acts in the first tick that begins then or later.
    pub time: f64,
    /// What.
    pub action: Action,
}

/// All that happens to a run from outside. Nothing does by default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Script {
    /// The actions, in any order; those of the same time in this order.
    pub entries: Vec<Entry>,
    /// How many pieces the controller's queue holds; all of them by default.
    pub queue: Option<usize>,
}

/// An action as it was carried out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Carried {
    /// The tick that it acted in, from 1.
    pub tick: u64,
    /// The action as it is written.
    pub action: String,
    /// Why the controller refused it, if it did.
    pub refused: Option<String>,
}

impl Carried {
    pub(super) fn new(tick: u64, action: Action, outcome: Result<(), CommandError>) -> Self {
        Self { tick, action: action.to_string(), refused: outcome.err().map(|error| error.to_string()) }
    }
}

impl fmt::Display for Action {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Command(MotionCommand::Hold) => write!(f, "hold"),
            Self::Command(MotionCommand::Resume) => write!(f, "resume"),
            Self::Command(MotionCommand::Cancel) => write!(f, "cancel"),
            Self::Command(MotionCommand::Override { percent }) => write!(f, "override:{percent}"),
            Self::Command(MotionCommand::SingleBlock(on)) => write!(f, "block:{}", if *on { "on" } else { "off" }),
            Self::Starve(seconds) => write!(f, "starve:{seconds}"),
        }
    }
}

impl FromStr for Action {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, value) = text.split_once(':').unwrap_or((text, ""));
        let command = match (name, value) {
            ("hold", "") => MotionCommand::Hold,
            ("resume", "") => MotionCommand::Resume,
            ("cancel", "") => MotionCommand::Cancel,
            ("block", "on") => MotionCommand::SingleBlock(true),
            ("block", "off") => MotionCommand::SingleBlock(false),
            ("override", percent) => MotionCommand::Override { percent: percent_from(percent)? },
            ("starve", seconds) => {
                let seconds = number(seconds)?;
                return Ok(Self::Starve(seconds));
            }
            _ => {
                return Err(format!(
                    "`{text}` is nothing that happens; give hold, resume, cancel, override:PERCENT, block:on, block:off or \
                     starve:SECONDS"
                ));
            }
        };
        Ok(Self::Command(command))
    }
}

impl FromStr for Entry {
    type Err = String;

    /// As `2.5=hold`.
    fn from_str(text: &str) -> Result<Self, String> {
        let (time, action) =
            text.split_once('=').ok_or_else(|| "it needs a time and what happens, as 2.5=hold".to_string())?;
        Ok(Self { time: number(time)?, action: action.parse()? })
    }
}

/// An override in per cent. Errors: outside 1..=200.
pub fn percent_from(text: &str) -> Result<u8, String> {
    let percent = text.parse().ok().filter(|percent| (1..=200).contains(percent));
    percent.ok_or_else(|| format!("`{text}` is no override; give whole per cents within 1 and 200"))
}

fn number(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds: &f64| *seconds >= 0.0 && seconds.is_finite());
    seconds.ok_or_else(|| format!("`{text}` is no time; give seconds from 0 on"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_what_is_read() {
        for text in ["hold", "resume", "cancel", "override:150", "block:on", "block:off", "starve:0.25"] {
            assert_eq!(text.parse::<Action>().map(|action| action.to_string()), Ok(text.to_string()));
        }
        let entry = "2.5=override:7".parse();
        let action = Action::Command(MotionCommand::Override { percent: 7 });
        assert_eq!(entry, Ok(Entry { time: 2.5, action }));
        for wrong in [
            "hold",
            "x=hold",
            "-1=hold",
            "nan=hold",
            "1=stop",
            "1=override:0",
            "1=override:201",
            "1=override:",
            "1=starve:x",
        ] {
            let error = wrong.parse::<Entry>().unwrap_err();
            assert!(error.contains("give") || error.contains("needs"), "{wrong}: {error}");
        }
    }
}

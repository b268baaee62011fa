//! Actions as they are written after `--act`, and what a person is told of them.

use std::str::FromStr;

use host_sim::session::Session;
use host_sim::stream::StreamError;
use shared::link::{Action, Refusal};
use shared::motion::MotionCommand;

/// One action by its name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Act(pub Action);

impl FromStr for Act {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let percent = |text: &str| match text.parse() {
            Ok(percent @ 1..=200) => Ok(percent),
            _ => Err(format!("an override is 1 to 200 %, and not {text}")),
        };
        Ok(Self(match text {
            "hold" => Action::Motion(MotionCommand::Hold),
            "resume" => Action::Motion(MotionCommand::Resume),
            "cancel" => Action::Motion(MotionCommand::Cancel),
            "single-block=on" => Action::Motion(MotionCommand::SingleBlock(true)),
            "single-block=off" => Action::Motion(MotionCommand::SingleBlock(false)),
            "home" => Action::Home,
            "acknowledge" => Action::Acknowledge,
            _ => match text.strip_prefix("override=") {
                Some(text) => Action::Motion(MotionCommand::Override { percent: percent(text)? }),
                None => {
                    return Err(
                        "it must be hold, resume, cancel, override=PERCENT, single-block=on, single-block=off, \
                                home or acknowledge"
                            .to_string(),
                    );
                }
            },
        }))
    }
}

/// The action by its name.
pub fn name(action: &Action) -> String {
    match action {
        Action::Motion(MotionCommand::Hold) => "hold".into(),
        Action::Motion(MotionCommand::Resume) => "resume".into(),
        Action::Motion(MotionCommand::Cancel) => "cancel".into(),
        Action::Motion(MotionCommand::Override { percent }) => format!("override={percent}"),
        Action::Motion(MotionCommand::SingleBlock(on)) => format!("single-block={}", if *on { "on" } else { "off" }),
        Action::Home => "home".into(),
        Action::Acknowledge => "acknowledge".into(),
        Action::WriteImage { .. } | Action::CommitImage { .. } => "write".into(),
        Action::ReadImage { .. } => "read".into(),
    }
}

/// A refusal in one sentence that begins with what was asked for.
pub fn refused(action: &Action, reason: &Refusal) -> String {
    format!("{} was refused: {reason}", name(action))
}

/// Carries out one action after another and says each that is done. Home is done when the search for it is over. Errors: the first
/// that is refused or fails.
pub fn carry_out(session: &mut Session<'_>, actions: &[Act], mut done: impl FnMut(&str)) -> Result<(), String> {
    let gone = |error: StreamError| error.to_string();
    for Act(action) in actions {
        session.ask(*action).map_err(gone)?.map_err(|reason| refused(action, &reason))?;
        if *action == Action::Home {
            let telemetry = session.until_homed().map_err(gone)?;
            if let Some(fault) = telemetry.fault {
                return Err(format!("home was not found: {fault}"));
            }
        }
        done(&name(action));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_an_action_of_that_name() {
        let names =
            ["hold", "resume", "cancel", "override=120", "single-block=on", "single-block=off", "home", "acknowledge"];
        for text in names {
            assert_eq!(name(&Act::from_str(text).unwrap().0), text);
        }
        for text in ["override=0", "override=201", "override=", "single-block", "HOLD", ""] {
            assert!(Act::from_str(text).is_err(), "{text}");
        }
    }
}

//! What a program does beside moving, in words that both languages have.

use std::io::Write;

use super::blocks::{decimals, significant};
use super::{Dialect, WriteError, Writer};
use crate::program::Action;
use crate::program::item::{Coolant, PathMode, Speed, Spindle, Turning};

impl<W: Write> Writer<W> {
    /// Writes an event; whether the language has it. Tool lengths, cutter compensation and speeds of the cut (G96) are not written.
    ///
    /// Errors: the file cannot be written.
    pub fn event(&mut self, action: &Action<'_>) -> Result<bool, WriteError> {
        let block = match *action {
            Action::Dwell(seconds) => format!("G4 {}{}", self.either("P", "F"), significant(seconds)),
            Action::ToolSelect(number) => format!("T{number}"),
            Action::ToolChange(number) => format!("T{number} M6"),
            Action::Spindle(Spindle { turning: Turning::Off, .. }) => "M5".to_string(),
            Action::Spindle(Spindle { turning, speed: Speed::Turns(turns) }) => {
                let word = if turning == Turning::Clockwise { "M3" } else { "M4" };
                format!("{word} S{}", significant(turns * 60.0))
            }
            Action::Coolant(Coolant { mist, flood }) => {
                // One goes on beside the other, and M9 ends both.
                self.block("M9")?;
                for (is_on, word) in [(mist, "M7"), (flood, "M8")] {
                    if is_on {
                        self.block(word)?;
                    }
                }
                return Ok(true);
            }
            Action::Stop { optional } => if optional { "M1" } else { "M0" }.to_string(),
            Action::PathMode(PathMode::Stop) => self.either("G61.1", "G60").to_string(),
            Action::PathMode(PathMode::Exact) if self.dialect == Dialect::Rs274 => "G61".to_string(),
            Action::PathMode(PathMode::Blend { tolerance, thinning }) if self.dialect == Dialect::Rs274 => {
                let word =
                    |letter: &str, value: Option<f64>| value.map(|value| format!(" {letter}{}", decimals(value)));
                let (tolerance, thinning) = (word("P", tolerance), word("Q", thinning));
                format!("G64{}{}", tolerance.unwrap_or_default(), thinning.unwrap_or_default())
            }
            Action::PathMode(PathMode::Blend { .. }) => "G64".to_string(),
            _ => return Ok(false),
        };
        self.block(&block)?;
        Ok(true)
    }

    fn either(&self, rs274: &'static str, sinumerik: &'static str) -> &'static str {
        match self.dialect {
            Dialect::Rs274 => rs274,
            Dialect::Sinumerik => sinumerik,
        }
    }

    fn block(&mut self, text: &str) -> Result<(), WriteError> {
        self.blocks.word(text);
        self.blocks.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::write::Settings;
    use crate::program::{Feed, Motion, rs274, sinumerik};

    const EVENTS: [Action<'static>; 9] = [
        Action::ToolChange(3),
        Action::Spindle(Spindle { turning: Turning::Clockwise, speed: Speed::Turns(200.0) }),
        Action::Coolant(Coolant { mist: false, flood: true }),
        Action::Dwell(0.25),
        Action::Stop { optional: true },
        Action::PathMode(PathMode::Stop),
        Action::Spindle(Spindle { turning: Turning::Anticlockwise, speed: Speed::Turns(50.5) }),
        Action::Coolant(Coolant { mist: false, flood: false }),
        Action::Spindle(Spindle { turning: Turning::Off, speed: Speed::Turns(50.5) }),
    ];

    /// Events between motions are read back in their order: each is found behind the one before.
    #[test]
    fn events_are_read_back() {
        for dialect in [Dialect::Rs274, Dialect::Sinumerik] {
            let mut writer = Writer::new(Vec::new(), dialect, Settings::default()).unwrap();
            let mut at = [0.0; 3];
            for event in &EVENTS {
                assert!(writer.event(event).unwrap(), "{event:?}");
                let to = [at[0] + 1.0, 2.0, 0.0];
                writer.motion(at, Feed::Rate(10.0), &Motion::Line { to }).unwrap();
                at = to;
            }
            assert!(!writer.event(&Action::ToolLength([0.0; 3])).unwrap());
            let text = writer.finish().unwrap();
            let mut left = EVENTS.iter().peekable();
            let mut sink = |item: &crate::program::Item<'_>| {
                let same = |event: &&Action<'_>| match (**event, item.action) {
                    // A spindle that stands has no speed.
                    (Action::Spindle(one), Action::Spindle(other)) if one.turning == Turning::Off => {
                        other.turning == Turning::Off
                    }
                    (Action::Spindle(one), Action::Spindle(other)) => {
                        let (Speed::Turns(one_turns), Speed::Turns(other_turns)) = (one.speed, other.speed) else {
                            return false;
                        };
                        one.turning == other.turning && (one_turns - other_turns).abs() < 1e-9
                    }
                    (one, other) => one == other,
                };
                left.next_if(same);
                Ok(())
            };
            match dialect {
                Dialect::Rs274 => rs274::read("e.ngc", &text[..], &rs274::Settings::default(), &mut sink),
                Dialect::Sinumerik => sinumerik::read("e.mpf", &text[..], &sinumerik::Settings::default(), &mut sink),
            }
            .unwrap_or_else(|error| panic!("{dialect:?}: {error}\n{}", String::from_utf8_lossy(&text)));
            assert_eq!(left.next(), None, "{dialect:?}\n{}", String::from_utf8_lossy(&text));
        }
    }
}

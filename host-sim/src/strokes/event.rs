//! What a program does beside moving.

use std::fmt;

use crate::program::Action;
use crate::program::item::{Coolant, Speed, Spindle, Turning};

/// Something that a program does at a place of its path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// It is done before the stroke of this number; behind the last one where there is none of it.
    pub before: usize,
    /// The line of the program, from 1.
    pub line: usize,
    /// What it is.
    pub what: What,
}

/// What is done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum What {
    /// Everything rests for so many seconds.
    Dwell(f64),
    /// The tool of this number is put in; 0 is none.
    ToolChange(u32),
    /// The spindle turns in another way.
    Spindle(Spindle),
    /// The coolant runs in another way.
    Coolant(Coolant),
    /// The program waits for a person.
    Stop {
        /// Only where the person asked for it.
        optional: bool,
    },
}

impl What {
    /// What an action of a program is; none where it is a motion, or says how motions are to be.
    pub fn of(action: &Action<'_>) -> Option<Self> {
        match *action {
            Action::Dwell(seconds) => Some(Self::Dwell(seconds)),
            Action::ToolChange(number) => Some(Self::ToolChange(number)),
            Action::Spindle(spindle) => Some(Self::Spindle(spindle)),
            Action::Coolant(coolant) => Some(Self::Coolant(coolant)),
            Action::Stop { optional } => Some(Self::Stop { optional }),
            _ => None,
        }
    }

    /// Whether the machine rests for it: coolant is switched on the way.
    pub fn rests(&self) -> bool {
        !matches!(self, Self::Coolant(_))
    }
}

impl fmt::Display for What {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Dwell(seconds) => write!(f, "dwell for {seconds} s"),
            Self::ToolChange(0) => f.write_str("take the tool out"),
            Self::ToolChange(number) => write!(f, "put in tool {number}"),
            Self::Spindle(Spindle { turning: Turning::Off, .. }) => f.write_str("stop the spindle"),
            Self::Spindle(Spindle { turning, speed }) => {
                let way = if turning == Turning::Clockwise { "clockwise" } else { "anticlockwise" };
                match speed {
                    Speed::Turns(turns) => write!(f, "turn the spindle {way} at {:.0}/min", turns * 60.0),
                    Speed::Surface { speed, .. } => write!(f, "turn the spindle {way} at {:.1} m/min", speed * 0.06),
                }
            }
            Self::Coolant(Coolant { mist, flood }) => f.write_str(match (mist, flood) {
                (false, false) => "coolant off",
                (true, false) => "mist on",
                (false, true) => "coolant on",
                (true, true) => "coolant and mist on",
            }),
            Self::Stop { optional: false } => f.write_str("wait for a person"),
            Self::Stop { optional: true } => f.write_str("wait for a person, if asked to"),
        }
    }
}

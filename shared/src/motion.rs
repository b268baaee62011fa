//! What a motion is about, what may be asked of it, and the one table of what follows from what.
//!
//! | state | hold | resume | cancel | at rest | short | ample | dry | fed | block | end |
//! | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |
//! | idle | - | - | - | | | | | | | |
//! | run | holding | run | cancelling | | braking | run | starved | | held | finished |
//! | braking | holding | braking | cancelling | | braking | run | starved | | held | finished |
//! | starved | held | starved | cancelling | | | | starved | run | | |
//! | holding | holding | run | cancelling | held | holding | holding | held | | held | finished |
//! | held | held | run | cancelling | | | | | | | |
//! | cancelling | cancelling | - | cancelling | cancelled | cancelling | cancelling | cancelled | | cancelled | finished |
//! | cancelled | - | - | - | | | | | | | |
//! | finished | - | - | - | | | | | | | |
//!
//! A minus is a command that is refused, an empty place an event that cannot be. To begin a path leads to run and to give it up
//! to idle, from everywhere. The test `the_table_is_this_one` reads the table above.

use core::fmt;

use serde::{Deserialize, Serialize};

/// What the executor is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum State {
    /// No path; the setpoint rests.
    Idle,
    /// On a path, at the pace of the override or on the way to it.
    Run,
    /// On a path and at rest, at the end of all pieces that have come; goes on with the next one.
    Starved,
    /// The path's last point was reached in this tick or before.
    Finished,
    /// On a path, slower than the override asks for: what is queued, the path or the block ends soon.
    Braking,
    /// On a path, coming to rest for a hold.
    Holding,
    /// On a path and at rest, until it is resumed.
    Held,
    /// On a path, coming to rest in order to leave it.
    Cancelling,
    /// At rest where a path was left.
    Cancelled,
}

/// What happens to a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// Asked to come to rest and wait.
    Hold,
    /// Asked to go on.
    Resume,
    /// Asked to come to rest and leave the path.
    Cancel,
    /// The pace has come to 0 as it should.
    AtRest,
    /// The way that is left slows the pace down.
    Short,
    /// There is way enough.
    Ample,
    /// The end of all pieces that have come is reached.
    Dry,
    /// A piece has come after all.
    Fed,
    /// The end of a block is reached, and blocks are run one by one.
    Block,
    /// The last point of the path is reached.
    End,
}

impl State {
    /// What follows from `event`; none where it is refused or cannot be.
    pub const fn after(self, event: Event) -> Option<Self> {
        use Event::*;
        use State::*;
        Some(match (self, event) {
            (Run | Braking | Holding, Hold) => Holding,
            (Starved | Held, Hold) => Held,
            (Run | Holding | Held, Resume) => Run,
            (Braking, Resume) => Braking,
            (Starved, Resume | Dry) => Starved,
            (Run | Braking | Starved | Holding | Held | Cancelling, Cancel) | (Cancelling, Hold | Short | Ample) => {
                Cancelling
            }
            (Run | Braking, Short) => Braking,
            (Run | Braking, Ample) | (Starved, Fed) => Run,
            (Run | Braking, Dry) => Starved,
            (Holding, Short | Ample) => Holding,
            (Run | Braking, Block) | (Holding, AtRest | Dry | Block) => Held,
            (Cancelling, AtRest | Dry | Block) => Cancelled,
            (Run | Braking | Holding | Cancelling, End) => Finished,
            _ => return None,
        })
    }

    /// The state of a number, as `as u8` gives it.
    pub const fn from_number(number: u8) -> Option<Self> {
        Some(match number {
            0 => Self::Idle,
            1 => Self::Run,
            2 => Self::Starved,
            3 => Self::Finished,
            4 => Self::Braking,
            5 => Self::Holding,
            6 => Self::Held,
            7 => Self::Cancelling,
            8 => Self::Cancelled,
            _ => return None,
        })
    }

    /// Its name, as in the table.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::Run => "run",
            Self::Starved => "starved",
            Self::Finished => "finished",
            Self::Braking => "braking",
            Self::Holding => "holding",
            Self::Held => "held",
            Self::Cancelling => "cancelling",
            Self::Cancelled => "cancelled",
        }
    }

    /// Whether a tick may move the setpoint.
    #[inline(always)]
    pub const fn is_moving(self) -> bool {
        matches!(self, Self::Run | Self::Braking | Self::Starved | Self::Holding | Self::Cancelling)
    }

    /// Whether the pace shall come to 0.
    #[inline(always)]
    pub const fn is_stopping(self) -> bool {
        matches!(self, Self::Holding | Self::Cancelling)
    }
}

/// What may be asked of a motion, at any tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MotionCommand {
    /// Come to rest on the path and wait.
    Hold,
    /// Go on after a hold or a block.
    Resume,
    /// Come to rest on the path, then leave it: what is queued of it is dropped.
    Cancel,
    /// Run at so many per cent of the path's feed, 1..=200. Holds for later paths too.
    Override {
        /// 100 is the path's own feed.
        percent: u8,
    },
    /// Whether to come to rest and wait at the end of every piece. Holds for later paths too.
    SingleBlock(bool),
}

/// Why a command was refused; nothing has changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum CommandError {
    /// There is no motion that could do so.
    Refused {
        /// What the executor is about instead.
        state: State,
    },
    /// An override outside 1..=200 %.
    Override {
        /// What was given.
        percent: u8,
    },
    /// The path was begun at a fixed pace.
    FixedPace,
}

impl fmt::Display for CommandError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Refused { state: State::Cancelling } => {
                write!(f, "the path is being cancelled; begin it anew")
            }
            Self::Refused { .. } => write!(f, "nothing is in motion; begin a path first"),
            Self::Override { percent } => write!(f, "the override is {percent} %; it must be within 1 and 200 %"),
            Self::FixedPace => write!(f, "the path was begun at a fixed pace; begin it with limits of its pace"),
        }
    }
}

impl core::error::Error for CommandError {}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::string::{String, ToString};
    use std::vec::Vec;

    use super::*;

    const STATES: [State; 9] = [
        State::Idle,
        State::Run,
        State::Braking,
        State::Starved,
        State::Holding,
        State::Held,
        State::Cancelling,
        State::Cancelled,
        State::Finished,
    ];

    const EVENTS: [Event; 10] = [
        Event::Hold,
        Event::Resume,
        Event::Cancel,
        Event::AtRest,
        Event::Short,
        Event::Ample,
        Event::Dry,
        Event::Fed,
        Event::Block,
        Event::End,
    ];

    /// The table of this module's text is what the code does, cell by cell.
    #[test]
    fn the_table_is_this_one() {
        let rows: Vec<Vec<String>> = include_str!("motion.rs")
            .lines()
            .filter_map(|line| line.strip_prefix("//! |"))
            .map(|row| row.trim_end_matches('|').split('|').map(|cell| cell.trim().to_string()).collect())
            .collect();
        let (head, rows) = (&rows[0], &rows[2..]);
        assert_eq!(head.len(), EVENTS.len() + 1);
        assert_eq!(rows.len(), STATES.len());
        for (row, state) in rows.iter().zip(STATES) {
            assert_eq!(row[0], state.name());
            for ((cell, event), column) in row[1..].iter().zip(EVENTS).zip(&head[1..]) {
                let found = state.after(event).map_or("", State::name);
                assert_eq!(cell.trim_start_matches('-'), found, "{state:?}, {event:?} ({column})");
                let asked = matches!(event, Event::Hold | Event::Resume | Event::Cancel);
                assert_eq!(cell == "-", asked && found.is_empty(), "a minus is a refused command");
            }
        }
    }

    /// From every state of a path a hold and a cancel lead to rest, whatever else happens first; and a path that was left is
    /// never entered again.
    #[test]
    fn every_path_can_be_left() {
        for state in STATES {
            let on_path = state.is_moving() || state == State::Held;
            assert_eq!(state.after(Event::Cancel).is_some(), on_path, "{state:?}");
            assert_eq!(state.after(Event::Hold).is_some(), on_path);
            for event in EVENTS {
                if let Some(next) = state.after(event) {
                    assert!(on_path, "{state:?} is left by {event:?}");
                    if state == State::Cancelling {
                        assert!(matches!(next, State::Cancelling | State::Cancelled | State::Finished));
                    }
                }
            }
        }
        for (stopping, rest) in [(State::Holding, State::Held), (State::Cancelling, State::Cancelled)] {
            for event in [Event::AtRest, Event::Dry, Event::Block] {
                assert_eq!(stopping.after(event), Some(rest));
            }
        }
    }
}

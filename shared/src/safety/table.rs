//! What the machine is about, what may happen to it, and the one table of what follows from what.
//!
//! | state | e-stop | trip | acknowledge | home | axis homed | homed | start | hold | resume | cancel | at rest | end |
//! | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |
//! | idle | e-stop | fault | - | homing | | | run | - | - | - | | |
//! | homing | e-stop | fault | - | - | homing | idle | - | - | - | braking | | |
//! | run | e-stop | fault | - | - | | | - | hold | run | braking | run | idle |
//! | hold | e-stop | fault | - | - | | | - | hold | run | braking | hold | idle |
//! | braking | e-stop | fault | - | - | | | - | braking | - | braking | idle | idle |
//! | fault | e-stop | fault | idle | - | | | - | - | - | - | | |
//! | e-stop | e-stop | e-stop | idle | - | | | - | - | - | - | | |
//!
//! A minus is a command that is refused; an empty place is an event that changes nothing there. A run that is at rest waits for its
//! host: starvation is no fault.
//!
//! | state | drives | setpoints | jobs |
//! | --- | --- | --- | --- |
//! | idle | on | rest | taken |
//! | homing | on | advance | - |
//! | run | on | advance | - |
//! | hold | on | advance | - |
//! | braking | on | advance | - |
//! | fault | off | rest | - |
//! | e-stop | off | rest | - |
//!
//! In a hold the setpoints advance until they rest, on the path. The tests of this module read both tables.

use serde::{Deserialize, Serialize};

/// What the machine is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum State {
    /// At rest under power, without a job.
    Idle,
    /// Looking for its home switches.
    Homing,
    /// On a path, or starved on it.
    Run,
    /// On a path, coming to rest for a hold or held.
    Hold,
    /// Coming to rest in order to leave the path or the homing.
    Braking,
    /// Without power until a fault is acknowledged.
    Fault,
    /// Without power until the emergency stop is released and acknowledged.
    EStop,
}

/// The kinds of what happens to a machine: the columns of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The emergency stop is pressed.
    EStop,
    /// Something is wrong.
    Trip,
    /// A person has seen what was wrong.
    Acknowledge,
    /// Asked to look for home.
    Home,
    /// Some axes have found home; others still look for it.
    AxisHomed,
    /// All axes that were asked to are at home.
    Homed,
    /// Asked to run a job.
    Start,
    /// Asked to come to rest on the path and wait, by a person or because the host has vanished.
    Hold,
    /// Asked to go on.
    Resume,
    /// Asked to come to rest and leave the path, by a person.
    Cancel,
    /// The setpoints have come to rest.
    AtRest,
    /// The last point of the path is reached.
    End,
}

/// What follows from an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// This state, which may be the same.
    To(State),
    /// Nothing: a command that is refused.
    Refused,
    /// Nothing: it does not matter there.
    Nothing,
}

/// How many states there are.
const STATES: usize = 7;
/// How many kinds of events there are.
const KINDS: usize = 12;

/// The table above, in the order of [`State`] and [`Kind`].
const TABLE: [[Next; KINDS]; STATES] = {
    use Next::{Nothing as __, Refused as NO, To};
    const IDLE: Next = To(State::Idle);
    const HOME: Next = To(State::Homing);
    const RUN: Next = To(State::Run);
    const HOLD: Next = To(State::Hold);
    const STOP: Next = To(State::Braking);
    const FAULT: Next = To(State::Fault);
    const OFF: Next = To(State::EStop);
    [
        [OFF, FAULT, NO, HOME, __, __, RUN, NO, NO, NO, __, __],
        [OFF, FAULT, NO, NO, HOME, IDLE, NO, NO, NO, STOP, __, __],
        [OFF, FAULT, NO, NO, __, __, NO, HOLD, RUN, STOP, RUN, IDLE],
        [OFF, FAULT, NO, NO, __, __, NO, HOLD, RUN, STOP, HOLD, IDLE],
        [OFF, FAULT, NO, NO, __, __, NO, STOP, NO, STOP, IDLE, IDLE],
        [OFF, FAULT, IDLE, NO, __, __, NO, NO, NO, NO, __, __],
        [OFF, OFF, IDLE, NO, __, __, NO, NO, NO, NO, __, __],
    ]
};

impl State {
    /// What follows from an event of this kind.
    #[inline]
    pub fn after(self, kind: Kind) -> Next {
        TABLE.get(self as usize).and_then(|row| row.get(kind as usize)).copied().unwrap_or(Next::Nothing)
    }

    /// The state of a number, as `as u8` gives it.
    pub const fn from_number(number: u8) -> Option<Self> {
        Some(match number {
            0 => Self::Idle,
            1 => Self::Homing,
            2 => Self::Run,
            3 => Self::Hold,
            4 => Self::Braking,
            5 => Self::Fault,
            6 => Self::EStop,
            _ => return None,
        })
    }

    /// Whether the drives may have power.
    #[inline(always)]
    pub const fn has_drives(self) -> bool {
        !matches!(self, Self::Fault | Self::EStop)
    }

    /// Whether setpoints may advance.
    #[inline(always)]
    pub const fn advances(self) -> bool {
        matches!(self, Self::Homing | Self::Run | Self::Hold | Self::Braking)
    }

    /// Whether a job may be started, as far as the state goes.
    #[inline(always)]
    pub const fn takes_jobs(self) -> bool {
        matches!(self, Self::Idle)
    }

    /// Its name, as in the table.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::Homing => "homing",
            Self::Run => "run",
            Self::Hold => "hold",
            Self::Braking => "braking",
            Self::Fault => "fault",
            Self::EStop => "e-stop",
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::*;

    const STATES: [State; super::STATES] =
        [State::Idle, State::Homing, State::Run, State::Hold, State::Braking, State::Fault, State::EStop];

    const KINDS: [(Kind, &str); super::KINDS] = [
        (Kind::EStop, "e-stop"),
        (Kind::Trip, "trip"),
        (Kind::Acknowledge, "acknowledge"),
        (Kind::Home, "home"),
        (Kind::AxisHomed, "axis homed"),
        (Kind::Homed, "homed"),
        (Kind::Start, "start"),
        (Kind::Hold, "hold"),
        (Kind::Resume, "resume"),
        (Kind::Cancel, "cancel"),
        (Kind::AtRest, "at rest"),
        (Kind::End, "end"),
    ];

    /// The rows of the tables of this module's text.
    fn rows() -> Vec<Vec<&'static str>> {
        include_str!("table.rs")
            .lines()
            .filter_map(|line| line.strip_prefix("//! |"))
            .map(|row| row.trim_end_matches('|').split('|').map(str::trim).collect())
            .collect()
    }

    #[test]
    fn the_table_is_what_the_text_says() {
        let rows = rows();
        assert_eq!(rows[0][1..], KINDS.map(|(_, name)| name));
        for (row, state) in rows[2..].iter().zip(STATES) {
            assert_eq!(row[0], state.name());
            assert_eq!(row.len(), KINDS.len() + 1);
            for (cell, (kind, name)) in row[1..].iter().zip(KINDS) {
                let found = match state.after(kind) {
                    Next::To(next) => next.name(),
                    Next::Refused => "-",
                    Next::Nothing => "",
                };
                assert_eq!(*cell, found, "{state:?}, {name}");
            }
        }
    }

    #[test]
    fn what_a_state_allows_is_what_the_text_says() {
        for (row, state) in rows()[super::STATES + 4..].iter().zip(STATES) {
            let say = |yes: bool, word, other| if yes { word } else { other };
            assert_eq!(row[0], state.name());
            assert_eq!(row[1], say(state.has_drives(), "on", "off"));
            assert_eq!(row[2], say(state.advances(), "advance", "rest"));
            assert_eq!(row[3], say(state.takes_jobs(), "taken", "-"));
        }
    }

    /// The emergency stop wins over everything, a fault over everything else, and both are left by an acknowledgement alone.
    #[test]
    fn stops_win_and_are_left_by_an_acknowledgement_alone() {
        for state in STATES {
            assert_eq!(state.after(Kind::EStop), Next::To(State::EStop));
            let tripped = if state == State::EStop { State::EStop } else { State::Fault };
            assert_eq!(state.after(Kind::Trip), Next::To(tripped));
            for (kind, name) in KINDS {
                if let Next::To(next) = state.after(kind)
                    && next.has_drives()
                    && !state.has_drives()
                {
                    assert_eq!((kind, next), (Kind::Acknowledge, State::Idle), "{state:?}, {name}");
                }
            }
        }
    }

    /// From every state idle is reached, and every motion can be asked to come to rest.
    #[test]
    fn every_state_can_be_left() {
        for state in STATES {
            let mut reached = std::vec![state];
            let mut next = 0;
            while let Some(&from) = reached.get(next) {
                for (kind, _) in KINDS {
                    if let Next::To(to) = from.after(kind)
                        && !reached.contains(&to)
                    {
                        reached.push(to);
                    }
                }
                next += 1;
            }
            assert_eq!(reached.len(), STATES.len(), "{state:?}");
            if state.advances() {
                assert_eq!(state.after(Kind::Cancel), Next::To(State::Braking));
            }
        }
        assert_eq!(State::Braking.after(Kind::AtRest), Next::To(State::Idle));
    }
}

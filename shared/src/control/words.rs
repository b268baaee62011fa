//! What came of a directive in one word: how a tick leaves it for other tasks, which read words only.
//!
//! Bits 0..4 are the kind, from 1; 4..12 the axis, the state or the percentage.

use super::directive::DirectiveError;
use crate::motion::{self, CommandError};
use crate::safety::{self, Refused};

/// The word of an answer, above 0.
#[inline]
pub fn answer_word(answer: &Result<(), DirectiveError>) -> u32 {
    let pack = |kind: u32, detail: u8| kind | u32::from(detail) << 4;
    match *answer {
        Ok(()) => 1,
        Err(DirectiveError::Machine(refused)) => match refused {
            Refused::State { state } => pack(2, state as u8),
            Refused::PositionUnknown { axis } => pack(3, axis),
            Refused::OnLimit { axis } => pack(4, axis),
            Refused::Away { axis } => pack(5, axis),
            Refused::EStopPressed => 6,
            Refused::DriveFault { axis } => pack(7, axis),
            Refused::NoHome => 8,
            Refused::NoMachine => 9,
        },
        Err(DirectiveError::Motion(error)) => match error {
            CommandError::Refused { state } => pack(10, state as u8),
            CommandError::Override { percent } => pack(11, percent),
            CommandError::FixedPace => 12,
        },
    }
}

/// The answer of a word; none of 0, and of one that is no answer's.
pub fn answer_of(word: u32) -> Option<Result<(), DirectiveError>> {
    let detail = (word >> 4) as u8;
    let machine = |refused| Some(Err(DirectiveError::Machine(refused)));
    let motion = |error| Some(Err(DirectiveError::Motion(error)));
    match word & 0xf {
        1 => Some(Ok(())),
        2 => machine(Refused::State { state: safety::State::from_number(detail)? }),
        3 => machine(Refused::PositionUnknown { axis: detail }),
        4 => machine(Refused::OnLimit { axis: detail }),
        5 => machine(Refused::Away { axis: detail }),
        6 => machine(Refused::EStopPressed),
        7 => machine(Refused::DriveFault { axis: detail }),
        8 => machine(Refused::NoHome),
        9 => machine(Refused::NoMachine),
        10 => motion(CommandError::Refused { state: motion::State::from_number(detail)? }),
        11 => motion(CommandError::Override { percent: detail }),
        12 => motion(CommandError::FixedPace),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_is_its_answer_and_no_other() {
        let machine = [
            Refused::State { state: safety::State::EStop },
            Refused::State { state: safety::State::Homing },
            Refused::PositionUnknown { axis: 2 },
            Refused::OnLimit { axis: 1 },
            Refused::Away { axis: 0 },
            Refused::EStopPressed,
            Refused::DriveFault { axis: 5 },
            Refused::NoHome,
            Refused::NoMachine,
        ]
        .map(DirectiveError::Machine);
        let motion = [
            CommandError::Refused { state: motion::State::Cancelled },
            CommandError::Refused { state: motion::State::Idle },
            CommandError::Override { percent: 201 },
            CommandError::FixedPace,
        ]
        .map(DirectiveError::Motion);
        let errors = machine.into_iter().chain(motion).map(Err);
        for answer in errors.chain([Ok(())]) {
            let word = answer_word(&answer);
            assert!(word > 0);
            assert_eq!(answer_of(word), Some(answer));
        }
        assert_eq!(answer_of(0), None);
    }
}

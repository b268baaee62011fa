//! A fault in one word: how a tick leaves it for other tasks, which read words only.
//!
//! Bits 0..4 are the kind, from 1; 4..8 the axis; 8..16 the end, the cause or how a search failed.

use super::fault::{End, Fault, HomingFault, ResetCause};

impl Fault {
    /// The word, above 0 and below 2^24.
    #[inline]
    pub const fn word(self) -> u32 {
        match self {
            Self::Limit { axis, end } => pack(1, axis, end as u8),
            Self::Drive { axis } => pack(2, axis, 0),
            Self::FollowingError { axis } => pack(3, axis, 0),
            Self::Steps { axis } => pack(4, axis, 0),
            Self::SoftLimit { axis } => pack(5, axis, 0),
            Self::Homing { axis, fault } => pack(6, axis, fault as u8),
            Self::LateTick => pack(7, 0, 0),
            Self::Reset { cause } => pack(8, 0, cause as u8),
        }
    }

    /// The fault of a word; none of one that is no fault's.
    pub const fn from_word(word: u32) -> Option<Self> {
        let axis = (word >> 4 & 0xf) as u8;
        Some(match (word & 0xf, word >> 8) {
            (1, 0) => Self::Limit { axis, end: End::Low },
            (1, 1) => Self::Limit { axis, end: End::High },
            (2, _) => Self::Drive { axis },
            (3, _) => Self::FollowingError { axis },
            (4, _) => Self::Steps { axis },
            (5, _) => Self::SoftLimit { axis },
            (6, 0) => Self::Homing { axis, fault: HomingFault::NotFound },
            (6, 1) => Self::Homing { axis, fault: HomingFault::Stuck },
            (7, _) => Self::LateTick,
            (8, 0) => Self::Reset { cause: ResetCause::Ordinary },
            (8, 1) => Self::Reset { cause: ResetCause::Watchdog },
            (8, 2) => Self::Reset { cause: ResetCause::BrownOut },
            (8, 3) => Self::Reset { cause: ResetCause::HardFault },
            _ => return None,
        })
    }
}

const fn pack(kind: u32, axis: u8, detail: u8) -> u32 {
    kind | (axis as u32 & 0xf) << 4 | (detail as u32) << 8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_is_its_fault_and_no_other() {
        let faults = [
            Fault::Limit { axis: 5, end: End::Low },
            Fault::Limit { axis: 0, end: End::High },
            Fault::Drive { axis: 1 },
            Fault::FollowingError { axis: 2 },
            Fault::Steps { axis: 3 },
            Fault::SoftLimit { axis: 4 },
            Fault::Homing { axis: 1, fault: HomingFault::NotFound },
            Fault::Homing { axis: 1, fault: HomingFault::Stuck },
            Fault::LateTick,
            Fault::Reset { cause: ResetCause::Ordinary },
            Fault::Reset { cause: ResetCause::Watchdog },
            Fault::Reset { cause: ResetCause::BrownOut },
            Fault::Reset { cause: ResetCause::HardFault },
        ];
        for (number, fault) in faults.iter().enumerate() {
            assert_eq!(Fault::from_word(fault.word()), Some(*fault));
            assert!(fault.word() > 0 && fault.word() < 1 << 24);
            assert!(faults[..number].iter().all(|other| other.word() != fault.word()));
        }
        assert_eq!(Fault::from_word(0), None);
    }
}

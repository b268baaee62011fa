//! What a tick leaves for others to read.

use crate::fixed::Position;
use crate::safety::Fault;
use crate::{motion, safety};

/// How the machine stands after a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Status<const AXES: usize> {
    /// What the machine is about.
    pub machine: safety::State,
    /// What the motion along a path is about.
    pub motion: motion::State,
    /// What became of the last path.
    pub path: PathEnd,
    /// What is wrong, until it is acknowledged.
    pub fault: Option<Fault>,
    /// The axes whose position is known; bit k is axis k.
    pub known: u8,
    /// The override in per cent.
    pub percent: u8,
    /// Ticks of this path.
    pub ticks: u32,
    /// Pieces of this path that were entered.
    pub pieces: u32,
    /// Where the axes shall be at the next tick, in the path's coordinates.
    pub setpoint: Position,
    /// The same in machine coordinates.
    pub position: Position,
    /// Where they were when this tick began, in machine coordinates: by the encoders, and of step axes as they were told.
    pub actual: Position,
    /// The hash of all setpoints of this path, in its own coordinates.
    pub hash: u64,
    /// Time left in the tick that reached the end of the path, in s.
    pub residual: f32,
    /// What each axis was told: a drive's command as the bits of an f32, or a position in steps.
    pub told: [u32; AXES],
}

/// What became of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PathEnd {
    /// There was none since the start or since it was cleared.
    #[default]
    None,
    /// It has not ended.
    Running,
    /// It was run to its last point.
    Finished,
    /// It was cancelled, and the machine rests on it.
    Cancelled,
    /// The emergency stop took the drives' power.
    Stopped,
    /// A fault took the drives' power.
    Faulted(Fault),
}

impl PathEnd {
    /// In one word: the kind in bits 0..8, a fault above.
    pub const fn word(self) -> u32 {
        match self {
            Self::None => 0,
            Self::Running => 1,
            Self::Finished => 2,
            Self::Cancelled => 3,
            Self::Stopped => 4,
            Self::Faulted(fault) => 5 | fault.word() << 8,
        }
    }

    /// What a word says; nothing of one that is none.
    pub const fn from_word(word: u32) -> Self {
        match (word & 0xff, Fault::from_word(word >> 8)) {
            (1, _) => Self::Running,
            (2, _) => Self::Finished,
            (3, _) => Self::Cancelled,
            (4, _) => Self::Stopped,
            (5, Some(fault)) => Self::Faulted(fault),
            _ => Self::None,
        }
    }
}

//! What a host learns of its conversation.

use core::fmt;

use super::action::{Action, Answer};
use super::message::{Ending, Identity, Refusal, Telemetry};
use super::sender::TRIES;

/// What the controller said, as far as a caller is concerned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// The conversation has begun; this is the controller.
    Hello(Identity),
    /// How it goes.
    Telemetry(Telemetry),
    /// The job is done.
    Finished {
        /// Ticks of the job.
        ticks: u32,
        /// Time left in the last tick, in s.
        residual: f32,
        /// The hash of all setpoints.
        hash: u64,
    },
    /// The job has ended before its last point.
    Ended(Ending),
    /// An action was carried out, or refused.
    Done(Action, Result<Answer, Refusal>),
    /// The job was refused; [`Sender::error`](super::Sender::error) says why.
    Failed(SenderError),
}

/// Why a job cannot be sent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SenderError {
    /// The controller refused it.
    Refused {
        /// The piece that it refused, counted from 0; none if it was not a piece.
        piece: Option<u32>,
        /// Why.
        reason: Refusal,
    },
    /// No frame came through in [`TRIES`] tries.
    Lost {
        /// What the controller said of the frames, if it said anything.
        reason: Option<Refusal>,
    },
}

impl fmt::Display for SenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused { piece: Some(piece), reason } => write!(f, "the controller refused piece {piece}: {reason}"),
            Self::Refused { piece: None, reason } => reason.fmt(f),
            Self::Lost { reason: Some(reason) } => write!(f, "no frame came through in {TRIES} tries: {reason}"),
            Self::Lost { reason: None } => write!(f, "the controller does not answer; check the port and its power"),
        }
    }
}

impl core::error::Error for SenderError {}

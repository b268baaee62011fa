//! What is said over the link.

use core::fmt;

use serde::{Deserialize, Serialize};

use super::frame::FrameError;
use crate::error::PathError;
use crate::fixed::Position;
use crate::piece::{Header, Piece};

/// The version of everything in this module. A controller speaks to hosts of the same version only.
pub const VERSION: u16 = 2;

/// From the host to the controller.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Command {
    /// Starts a conversation. Its sequence number is where the sequence starts; a job that was loading is forgotten.
    Hello {
        /// The host's [`VERSION`].
        version: u16,
    },
    /// Starts a job: what holds for all of its pieces.
    Begin(Header<f32>),
    /// The next piece of the job.
    Piece(Piece<f32>),
    /// Starts the motion. More pieces may follow while it runs.
    Run,
    /// Stops the motion where it is and forgets the job. Taken out of sequence.
    Abort,
    /// Asks for a [`Telemetry`], and for the [`Report::Finished`] of a job that is. Taken out of sequence.
    Status,
}

impl Command {
    /// Whether this command waits for its turn in the sequence.
    pub fn is_sequenced(&self) -> bool {
        !matches!(self, Self::Hello { .. } | Self::Abort | Self::Status)
    }
}

/// From the controller to the host.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Report {
    /// Answers [`Command::Hello`].
    Hello {
        /// The controller's [`VERSION`].
        version: u16,
        /// Pieces that its queue holds.
        capacity: u16,
    },
    /// Everything before `next` has been taken.
    Ack {
        /// The next expected sequence number.
        next: u16,
        /// Pieces that may follow before the queue is full.
        room: u16,
    },
    /// Something was not taken.
    Refused {
        /// Of a [`Refusal::Link`]: the next expected sequence number. Of any other: the command's own.
        sequence: u16,
        /// Why.
        reason: Refusal,
    },
    /// How it goes.
    Telemetry(Telemetry),
    /// The job has been executed to its last point.
    Finished {
        /// Ticks from the first that moved to the one that reached the end.
        ticks: u32,
        /// Time that the last tick had left when it reached the end, in s; below one tick.
        residual: f32,
        /// The hash of all setpoints; the simulator's for the same job.
        hash: u64,
    },
}

/// Why a command was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refusal {
    /// The frame did not arrive whole, or not in its turn; sending it again helps.
    Link(LinkError),
    /// The job is faulty; sending it again does not help.
    Path(PathError),
    /// The controller speaks another version of the protocol.
    Version {
        /// The controller's [`VERSION`].
        version: u16,
    },
    /// A piece or a start without a job: none was begun, or it was refused or stopped.
    NoJob,
    /// A job is running; it has to end or to be stopped first.
    Busy,
    /// The queue of pieces is full: the sender did not keep to the room it was told.
    Full,
    /// The emergency stop is pressed.
    Stopped,
}

/// Why a frame was not even read as a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LinkError {
    /// The bytes were no frame.
    Frame(FrameError),
    /// A command before this one is missing.
    Gap {
        /// The sequence number that came.
        found: u16,
    },
}

/// What the controller is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MotionState {
    /// No job; at rest.
    #[default]
    Idle,
    /// A job is loading; at rest.
    Loading,
    /// In motion.
    Running,
    /// In the middle of a path with no piece left: the host is too slow.
    Starved,
    /// At the end of a path.
    Finished,
    /// Stopped by the emergency stop or by [`Command::Abort`], or the job was refused.
    Stopped,
}

/// How it goes, at one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Telemetry {
    /// What the controller is doing.
    pub state: MotionState,
    /// Ticks of this job so far.
    pub tick: u32,
    /// Pieces of this job that the tick has taken from the queue.
    pub pieces: u32,
    /// The commanded position.
    pub setpoint: Position,
    /// The magnitude of the commanded velocity in mm/s, good to 6 %: for people, not for geometry.
    pub speed: f32,
    /// Pieces in the queue.
    pub queued: u16,
    /// The longest tick since the controller started, in cycles of the core.
    pub worst_cycles: u32,
    /// The most stack in use since the controller started, in bytes.
    pub stack: u32,
    /// Frames that did not arrive whole since the controller started.
    pub broken_frames: u32,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Link(error) => error.fmt(f),
            Self::Path(error) => error.fmt(f),
            Self::Version { version } => {
                write!(
                    f,
                    "the controller speaks version {version} of the link, this host version {VERSION}; flash or update one"
                )
            }
            Self::NoJob => write!(f, "the controller has no job: none was begun, or it was refused or stopped"),
            Self::Busy => write!(f, "the controller is running a job; wait for its end or stop it first"),
            Self::Full => write!(f, "the controller's queue is full; send no more pieces than it has room for"),
            Self::Stopped => write!(f, "the emergency stop is pressed; release it first"),
        }
    }
}

impl fmt::Display for LinkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Frame(error) => error.fmt(f),
            Self::Gap { found } => write!(f, "frame {found} came before its turn; one before it was lost"),
        }
    }
}

impl core::error::Error for Refusal {}

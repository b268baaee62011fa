//! What is said over the link.

use core::fmt;

use serde::{Deserialize, Serialize};

use super::action::{Action, Answer};
use super::frame::FrameError;
use crate::error::PathError;
use crate::fixed::Position;
use crate::motion::{CommandError, State};
use crate::piece::{Header, Piece};
use crate::safety::{self, Coordinates, Fault, Refused};

/// The version of everything that is said. A controller speaks to hosts of the same version only.
///
/// `Hello`, its answer and [`Refusal::Version`] keep their form in every version from 3 on, so that two versions can say so.
pub const VERSION: u16 = 6;

/// From the host to the controller.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Command {
    /// Starts a session, in which the sequence begins at 1: one session is one conversation with one job at most. A job that was
    /// loading is forgotten. The same session again is answered again and changes nothing. Said in no session.
    Hello {
        /// The host's [`VERSION`].
        version: u16,
        /// A number that the host has not used lately; not 0.
        session: u32,
    },
    /// Starts a job: what holds for all of its pieces, and what their coordinates mean.
    Begin(Header<f32>, Coordinates),
    /// The next piece of the job.
    Piece(Piece<f32>),
    /// Starts the motion. More pieces may follow while it runs.
    Run,
    /// Gives up the job: a motion comes to rest on its path. Taken out of sequence.
    Abort,
    /// Asks for a [`Telemetry`], and for the end of a job that has ended or the refusal of one that was refused. Taken out of sequence, and in no session too: then it is
    /// answered in none, and the session of somebody else does not notice. A host that has nothing to say says this, to be heard.
    Status,
    /// Asks for something beside the job. Numbered apart from the rest, from 0.
    Act(Action),
}

/// From the controller to the host.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Report {
    /// Answers [`Command::Hello`], in no session.
    Hello {
        /// The controller's [`VERSION`].
        version: u16,
        /// The session that is now open.
        session: u32,
        /// What the controller is.
        identity: Identity,
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
    /// The job has ended before its last point.
    Ended(Ending),
    /// Answers [`Command::Act`].
    Done {
        /// The action's number.
        number: u16,
        /// What came of it.
        outcome: Result<Answer, Refusal>,
    },
}

/// What a controller is, as far as a host must know.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Identity {
    /// The version of its firmware: major, minor, patch.
    pub firmware: [u8; 3],
    /// How many axes it moves.
    pub axes: u8,
    /// Pieces that its queue holds.
    pub capacity: u16,
}

/// How a job ended that did not reach its last point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Ending {
    /// It was cancelled, and rests on the path.
    Cancelled,
    /// By the emergency stop, or by [`Command::Abort`].
    Stopped,
    /// By this fault of the machine.
    Fault(Fault),
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
    /// The machine has this fault; it has to be acknowledged first.
    Fault(Fault),
    /// The motion does not allow it.
    Motion(CommandError),
    /// A number is outside its range.
    Range,
    /// This controller cannot do it.
    Unsupported,
    /// The configuration image is not whole, or not one.
    Image,
    /// The machine does not allow it as it is.
    Machine(Refused),
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
    /// On a path, slower than the override asks for: what is queued ends soon.
    Braking,
    /// On a path, coming to rest for a hold.
    Holding,
    /// On a path and at rest, until it is resumed.
    Held,
    /// On a path, coming to rest in order to leave it.
    Cancelling,
    /// At rest where a path was left.
    Cancelled,
    /// Looking for the reference switches.
    Homing,
    /// At rest with a fault.
    Fault,
}

impl MotionState {
    /// In one word, for people.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::Loading => "loading",
            Self::Running => "running",
            Self::Starved => "starved",
            Self::Finished => "finished",
            Self::Stopped => "stopped",
            Self::Braking => "braking",
            Self::Holding => "holding",
            Self::Held => "held",
            Self::Cancelling => "cancelling",
            Self::Cancelled => "cancelled",
            Self::Homing => "homing",
            Self::Fault => "fault",
        }
    }
}

impl From<State> for MotionState {
    fn from(state: State) -> Self {
        match state {
            State::Idle => Self::Idle,
            State::Run => Self::Running,
            State::Starved => Self::Starved,
            State::Finished => Self::Finished,
            State::Braking => Self::Braking,
            State::Holding => Self::Holding,
            State::Held => Self::Held,
            State::Cancelling => Self::Cancelling,
            State::Cancelled => Self::Cancelled,
        }
    }
}

/// How it goes, at one tick. Bit k of a set of axes is axis k.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Telemetry {
    /// What the controller is doing.
    pub state: MotionState,
    /// In which state the machine is.
    pub machine: safety::State,
    /// What is wrong, until it is acknowledged.
    pub fault: Option<Fault>,
    /// The axes that there are.
    pub axes: u8,
    /// Those whose position is known.
    pub known: u8,
    /// Ticks of this job so far.
    pub tick: u32,
    /// Pieces of this job that the tick has taken from the queue.
    pub pieces: u32,
    /// The commanded position.
    pub setpoint: Position,
    /// The position that the encoders show; that of an axis without one is its setpoint.
    pub actual: Position,
    /// The magnitude of the commanded velocity in mm/s, good to 6 %: for people, not for geometry.
    pub speed: f32,
    /// The override in per cent.
    pub percent: u8,
    /// Pieces in the queue.
    pub queued: u16,
    /// The next expected sequence number, as an acknowledgement says it: a lost one is made good within two hundredths of a second.
    pub next: u16,
    /// Pieces that may follow before the queue is full.
    pub room: u16,
    /// The last tick, in cycles of the core.
    pub cycles: u32,
    /// The longest tick since the controller started, in cycles of the core.
    pub worst_cycles: u32,
    /// The most stack in use since the controller started, in bytes.
    pub stack: u32,
    /// Frames that did not arrive whole since the controller started.
    pub broken_frames: u32,
}

impl Telemetry {
    /// The axes that there are and whose position is not known, from 0.
    pub fn unknown_axes(&self) -> impl Iterator<Item = u8> {
        let unknown = self.axes & !self.known;
        (0..8).filter(move |axis| unknown & (1 << axis) != 0)
    }
}

/// At rest at zero, with nothing wrong and no axis.
impl Default for Telemetry {
    fn default() -> Self {
        Self {
            state: MotionState::Idle,
            machine: safety::State::Idle,
            fault: None,
            axes: 0,
            known: 0,
            tick: 0,
            pieces: 0,
            setpoint: Position::default(),
            actual: Position::default(),
            speed: 0.0,
            percent: 0,
            queued: 0,
            next: 0,
            room: 0,
            cycles: 0,
            worst_cycles: 0,
            stack: 0,
            broken_frames: 0,
        }
    }
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
            Self::Fault(fault) => write!(f, "{fault}; mend its cause and acknowledge it"),
            Self::Motion(error) => error.fmt(f),
            Self::Range => write!(f, "a number is outside its range; an override is 1 to 200 %"),
            Self::Unsupported => write!(f, "this controller cannot do that"),
            Self::Image => write!(f, "the configuration did not arrive whole; write it again"),
            Self::Machine(refused) => refused.fmt(f),
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

impl fmt::Display for Ending {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cancelled => write!(f, "the job was cancelled; the machine rests on its path"),
            Self::Stopped => write!(f, "the job was stopped; the machine rests where it was"),
            Self::Fault(fault) => write!(f, "the job ended where it was, because {fault}"),
        }
    }
}

impl core::error::Error for Refusal {}

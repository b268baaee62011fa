//! The link between a host and a controller: what is said, how it is framed, and who may say it when.
//!
//! A frame is COBS( postcard( sequence, message ) + CRC-32 ), ended by a zero byte. A zero occurs nowhere else, so a receiver that
//! has lost its place finds the next frame at the next zero. Each layer is usable alone:
//!
//! | module | what |
//! | --- | --- |
//! | [`message`] | [`Command`] from the host, [`Report`] from the controller, and why something was refused |
//! | [`action`] | what may be asked beside a job: hold, override, home, the configuration image |
//! | [`frame`] | [`encode`] into a fixed buffer, and the streaming [`Decoder`] |
//! | [`receiver`] | the controller's half of the sequence: the next expected command and no other is taken |
//! | [`endpoint`] | the controller's end: obeys commands through a [`Machine`], reports, and sees a host vanish |
//! | [`sender`] | the host's end: a window of commands in flight, going back where one was lost |
//! | [`event`] | what a host learns of its conversation |
//!
//! The rules.
//! - `Hello` opens a session, whose number is in the CRC of every frame: nothing that was said in another one is ever taken, and a late
//!   copy of the `Hello` itself changes nothing. A session has one job at most.
//! - While a host is heard whose job is in motion, no other session is opened. Once it has vanished, the motion is left to the next host,
//!   which may resume, cancel or abort it, and begins no job of its own before.
//! - A job says in which coordinates it is. One in those of the machine is refused while the position of an axis is unknown.
//! - The commands of a job carry a sequence number. The controller takes the next expected one only; a repeated one is acknowledged
//!   and not executed; after a gap or a broken frame it says which one it expects, and the sender goes back to it. An
//!   acknowledgement carries the room in the queue of pieces, and the sender never has more pieces in flight than that.
//! - Actions are numbered apart from the job, one under way at a time: a hold does not wait behind pieces, and is carried out once.
//! - `Abort` and `Status` are taken whenever they come.
//! - Telemetry comes 51 times a second while there is a session. It repeats the acknowledgement, so that a lost one stops nothing.
//! - Each end is heard at least four times a second. A host that is not is told to the machine, which finishes or brakes as
//!   configured; a controller that is not is an error of the sender.

pub mod action;
pub mod endpoint;
pub mod event;
pub mod frame;
pub mod message;
pub mod receiver;
pub mod sender;
mod view;

pub use action::{Action, Answer, Chunk};
pub use endpoint::{End, Endpoint, Machine};
pub use event::{Event, SenderError};
pub use frame::{Decoder, FRAME_SIZE, Frame, FrameError, NO_SESSION, Received, encode};
pub use message::{Command, Ending, Identity, LinkError, MotionState, Refusal, Report, Telemetry, VERSION};
pub use receiver::{Receiver, Turn};
pub use sender::Sender;

//! The link between a host and a controller: what is said, how it is framed, and who may say it when.
//!
//! A frame is COBS( postcard( sequence, message ) + CRC-32 ), ended by a zero byte. A zero occurs nowhere else, so a receiver that
//! has lost its place finds the next frame at the next zero. Three layers, each usable alone:
//!
//! | module | what |
//! | --- | --- |
//! | [`message`] | [`Command`] from the host, [`Report`] from the controller, and why something was refused |
//! | [`frame`] | [`encode`] into a fixed buffer, and the streaming [`Decoder`] |
//! | [`receiver`] | the controller's half of the sequence: the next expected command and no other is taken |
//! | [`sender`] | the host's half: a window of commands in flight, going back where one was lost |
//!
//! The rules. Commands carry a sequence number. The controller takes the next expected one only; a repeated one is acknowledged
//! and not executed; after a gap or a broken frame it says which one it expects, and the sender goes back to it. Three commands
//! stand outside the sequence: `Hello` starts it, `Abort` and `Status` are taken whenever they come. An acknowledgement
//! carries the room in the queue of pieces, and the sender never has more pieces in flight than that.

pub mod frame;
pub mod message;
pub mod receiver;
pub mod sender;

pub use frame::{Decoder, FRAME_SIZE, Frame, FrameError, encode};
pub use message::{Command, LinkError, MotionState, Refusal, Report, Telemetry, VERSION};
pub use receiver::{Receiver, Turn};
pub use sender::{Event, Sender, SenderError};

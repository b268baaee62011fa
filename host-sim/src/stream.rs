//! Sends a job over a transport.
//!
//! The protocol is [`Sender`]'s, which knows no port and no clock; here it meets both.

use std::fmt;
use std::hash::{BuildHasher, Hasher, RandomState};
use std::io;
use std::time::Instant;

use serde::Serialize;
use shared::link::{Action, Answer, Ending, Event, Identity, Refusal, Sender, SenderError, Telemetry};
use shared::piece::{Header, Piece};
use shared::safety::Coordinates;

use crate::transport::Transport;

/// How a transfer went.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Transfer {
    /// Commands of the job that were sent.
    pub sent: u32,
    /// Commands that the controller has taken.
    pub acknowledged: u32,
    /// Commands that were sent again.
    pub resent: u32,
    /// Pieces of the job.
    pub pieces: u32,
    /// Ticks that the motion took.
    pub ticks: Option<u32>,
    /// The hash of all setpoints; the simulator's for the same job.
    #[serde(serialize_with = "as_hex")]
    pub setpoint_hash: Option<u64>,
    /// The time of the motion in s.
    pub time_s: Option<f64>,
}

fn as_hex<S: serde::Serializer>(hash: &Option<u64>, serializer: S) -> Result<S::Ok, S::Error> {
    hash.map(|hash| format!("{hash:016x}")).serialize(serializer)
}

/// What happens during a transfer, for whoever shows or logs it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Happening {
    /// The controller has answered.
    Hello(Identity),
    /// How it goes: pieces that it has taken, and its telemetry.
    Progress(u32, Telemetry),
    /// An action was carried out or refused.
    Done(Action, Result<Answer, Refusal>),
}

/// What somebody who looks on asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wish {
    /// An action.
    Act(Action),
    /// Stop the motion at once.
    Abort,
}

/// Why a conversation failed.
#[derive(Debug)]
pub enum StreamError {
    /// The line is gone.
    Line(io::Error),
    /// The controller refused the job, or does not answer.
    Sender(SenderError),
    /// The job ended before its last point.
    Ended(Ending),
    /// The search for home does not end.
    Homing,
}

impl StreamError {
    /// Nobody answers.
    pub const fn silent() -> Self {
        Self::Sender(SenderError::Lost { reason: None })
    }

    /// Whether what was asked for cannot be had from this controller, before anything was begun.
    pub fn is_input(&self) -> bool {
        matches!(self, Self::Sender(SenderError::Refused { reason: Refusal::Version { .. } | Refusal::Path(_), .. }))
    }
}

impl fmt::Display for StreamError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(error) => write!(f, "the line to the controller is gone: {error}"),
            Self::Sender(error) => error.fmt(f),
            Self::Ended(ending) => ending.fmt(f),
            Self::Homing => write!(f, "the machine still looks for home; look at it before you ask for more"),
        }
    }
}

impl From<io::Error> for StreamError {
    fn from(error: io::Error) -> Self {
        Self::Line(error)
    }
}

/// A number that no session had lately.
pub fn new_session() -> u32 {
    (RandomState::new().build_hasher().finish() as u32).max(1)
}

/// Sends a job in these coordinates and waits for its end. `look` sees what happens; `wish` is asked again and again for what a person wants.
///
/// The transfer is told as far as it went, failed or not.
pub fn stream(
    line: &mut dyn Transport,
    header: &Header<f32>,
    pieces: &[Piece<f32>],
    coordinates: Coordinates,
    mut look: impl FnMut(Happening),
    mut wish: impl FnMut() -> Option<Wish>,
) -> (Transfer, Result<(), StreamError>) {
    let sender = Sender::new(new_session(), header, pieces).in_coordinates(coordinates);
    let mut sender = match line.baud() {
        Some(baud) => sender.at_baud(baud),
        None => sender,
    };
    let mut transfer = Transfer { pieces: pieces.len() as u32, ..Transfer::default() };
    let outcome = converse(line, &mut sender, &mut transfer, &mut look, &mut wish);
    transfer.sent = sender.sent();
    transfer.acknowledged = sender.acknowledged();
    transfer.resent = sender.resent();
    (transfer, outcome)
}

fn converse(
    line: &mut dyn Transport,
    sender: &mut Sender<'_>,
    transfer: &mut Transfer,
    look: &mut dyn FnMut(Happening),
    wish: &mut dyn FnMut() -> Option<Wish>,
) -> Result<(), StreamError> {
    let start = Instant::now();
    let mut buffer = [0; 1024];
    // Ends whatever noise came before.
    line.send(&[0])?;
    loop {
        match wish() {
            Some(Wish::Act(action)) => {
                // Too many keys at a time: the last ones are none.
                sender.act(action);
            }
            Some(Wish::Abort) => {
                if let Some(frame) = sender.abort() {
                    line.send(&frame)?;
                }
            }
            None => {}
        }
        let now_us = start.elapsed().as_micros() as u64;
        while let Some(frame) = sender.poll(now_us) {
            line.send(&frame)?;
        }
        if let Some(error) = sender.error() {
            return Err(StreamError::Sender(error));
        }
        let count = line.receive(&mut buffer)?;
        let now_us = start.elapsed().as_micros() as u64;
        for &byte in buffer.iter().take(count) {
            match sender.receive(now_us, byte) {
                None => {}
                Some(Event::Hello(identity)) => look(Happening::Hello(identity)),
                Some(Event::Telemetry(telemetry)) => look(Happening::Progress(sender.acknowledged_pieces(), telemetry)),
                Some(Event::Done(action, outcome)) => look(Happening::Done(action, outcome)),
                Some(Event::Failed(error)) => return Err(StreamError::Sender(error)),
                Some(Event::Ended(ending)) => return Err(StreamError::Ended(ending)),
                Some(Event::Finished { ticks, residual, hash }) => {
                    transfer.ticks = Some(ticks);
                    transfer.setpoint_hash = Some(hash);
                    transfer.time_s = Some(f64::from(ticks) * f64::from(shared::TICK) - f64::from(residual));
                    return Ok(());
                }
            }
        }
    }
}

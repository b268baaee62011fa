//! The far end of the serial line: a conversation partner in virtual time.

use std::collections::VecDeque;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rigless::chip::Timeline;
use rigless::chip::uart::Peer;
use rigless::snapshot::Store;
use rigless::time::VirtualNanos;
use shared::link::{
    Action, Answer, Decoder, Ending, Event, Identity, Received, Refusal, Report, Sender, SenderError, Telemetry,
};
use shared::piece::{Header, Piece};
use shared::safety::Coordinates;

/// The controller has its receiver on by then, with a machine that was written into its empty flash before; what comes before is lost, as
/// on a bench.
pub(crate) const POWER_UP_US: u64 = 15_000;

/// The session of a conversation. The board starts anew each time, so that it may be the same.
pub const SESSION: u32 = 0x0b0a_4d01;

/// Whoever speaks to the controller.
pub trait Talker: Send {
    /// A byte from the controller.
    fn receive(&mut self, now_us: u64, byte: u8);
    /// Bytes for the controller, if there are any now.
    fn poll(&mut self, now_us: u64) -> Option<Vec<u8>>;
    /// Whether there is nothing more to say or to wait for.
    fn is_done(&self) -> bool;
}

/// A talker that a test and the board can both reach.
pub type Shared<T> = Arc<Mutex<T>>;

/// `talker`, to be shared with the board.
pub fn share<T>(talker: T) -> Shared<T> {
    Arc::new(Mutex::new(talker))
}

/// Looks at a shared talker.
pub fn lock<T: ?Sized>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The peer at the port's pins.
pub(crate) struct Line {
    talker: Shared<dyn Talker>,
    outgoing: VecDeque<u8>,
}

impl Line {
    pub(crate) fn new(talker: Shared<dyn Talker>) -> Self {
        Self { talker, outgoing: VecDeque::new() }
    }
}

impl fmt::Debug for Line {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Line").finish_non_exhaustive()
    }
}

impl Store for Line {}

impl Peer for Line {
    fn receive(&mut self, word: u16, context: &mut Timeline<'_, '_>) {
        lock(&*self.talker).receive(context.now().0 / 1_000, word as u8);
    }

    fn transmit(&mut self, now: VirtualNanos) -> Option<u16> {
        let now_us = now.0 / 1_000;
        if self.outgoing.is_empty() && now_us >= POWER_UP_US {
            while let Some(bytes) = lock(&*self.talker).poll(now_us) {
                self.outgoing.extend(bytes);
            }
        }
        self.outgoing.pop_front().map(u16::from)
    }
}

/// Sends one job, and waits for its end.
pub struct JobTalker {
    sender: Sender<'static>,
    /// What the controller reported at the end: ticks, residual time in s, hash of the setpoints.
    pub finished: Option<(u32, f32, u64)>,
    /// How it ended otherwise.
    pub ended: Option<Ending>,
    /// The last telemetry.
    pub telemetry: Option<Telemetry>,
}

impl JobTalker {
    /// A talker with this job. The job is kept for the life of the process: the sender borrows it, and there are few.
    pub fn new(header: Header<f32>, pieces: Vec<Piece<f32>>) -> Self {
        let sender = Sender::new(SESSION, Box::leak(Box::new(header)), pieces.leak());
        // No axis is homed: the job begins where the machine stands.
        let sender = sender.in_coordinates(Coordinates::Relative);
        Self { sender, finished: None, ended: None, telemetry: None }
    }

    /// Why the job was not taken, if it was not.
    pub fn error(&self) -> Option<SenderError> {
        self.sender.error()
    }

    /// Commands that had to be sent again.
    pub fn resent(&self) -> u32 {
        self.sender.resent()
    }
}

impl Talker for JobTalker {
    fn receive(&mut self, now_us: u64, byte: u8) {
        match self.sender.receive(now_us, byte) {
            Some(Event::Finished { ticks, residual, hash }) => self.finished = Some((ticks, residual, hash)),
            Some(Event::Telemetry(telemetry)) => self.telemetry = Some(telemetry),
            Some(Event::Ended(ending)) => self.ended = Some(ending),
            Some(Event::Hello(_) | Event::Failed(_) | Event::Done(..)) | None => {}
        }
    }

    fn poll(&mut self, now_us: u64) -> Option<Vec<u8>> {
        self.sender.poll(now_us).map(|frame| frame.to_vec())
    }

    fn is_done(&self) -> bool {
        self.sender.is_finished() || self.ended.is_some() || self.sender.error().is_some()
    }
}

/// Says given bytes one after another, however faulty, and keeps every report that comes back.
#[derive(Default)]
pub struct Script {
    /// What to say: when, in microseconds, and what.
    lines: VecDeque<(u64, Vec<u8>)>,
    until_us: u64,
    now_us: u64,
    decoder: Decoder,
    /// What came back.
    pub reports: Vec<Report>,
}

impl Script {
    /// Says each of `lines` in turn, `gap_us` apart, and listens for `gap_us` more.
    pub fn new(lines: impl IntoIterator<Item = Vec<u8>>, gap_us: u64) -> Self {
        let lines: VecDeque<_> =
            lines.into_iter().enumerate().map(|(k, line)| (POWER_UP_US + k as u64 * gap_us, line)).collect();
        let until_us = POWER_UP_US + lines.len() as u64 * gap_us;
        let mut decoder = Decoder::new();
        decoder.enter(SESSION);
        Self { lines, until_us, decoder, ..Self::default() }
    }
}

impl Talker for Script {
    fn receive(&mut self, now_us: u64, byte: u8) {
        self.now_us = now_us;
        if let Some(Ok(Received { message, .. })) = self.decoder.push(byte) {
            self.reports.push(message);
        }
    }

    fn poll(&mut self, now_us: u64) -> Option<Vec<u8>> {
        self.now_us = now_us;
        let (at, _) = self.lines.front()?;
        if *at > now_us {
            return None;
        }
        self.lines.pop_front().map(|(_, line)| line)
    }

    fn is_done(&self) -> bool {
        self.lines.is_empty() && self.now_us >= self.until_us
    }
}

/// What came of an action.
pub type Outcome = (Action, Result<Answer, Refusal>);

/// Hosts that come one after another, each in a session of its own, and ask for actions one by one.
pub struct Visitors {
    /// Who is still to come: when, in microseconds, and what for.
    waiting: VecDeque<(u64, Vec<Action>)>,
    /// The session of the one who is there, and what is still to be asked for.
    here: Option<(Sender<'static>, VecDeque<Action>)>,
    until_us: u64,
    now_us: u64,
    /// What the controller said it is, and what came of each action, visit by visit.
    pub visits: Vec<(Option<Identity>, Vec<Outcome>)>,
    /// The last telemetry.
    pub telemetry: Option<Telemetry>,
}

impl Visitors {
    /// Visits at these instants, in microseconds, until the last of them.
    pub fn new(visits: impl IntoIterator<Item = (u64, Vec<Action>)>, until_us: u64) -> Self {
        let waiting = visits.into_iter().collect();
        Self { waiting, here: None, until_us, now_us: 0, visits: Vec::new(), telemetry: None }
    }
}

impl Talker for Visitors {
    fn receive(&mut self, now_us: u64, byte: u8) {
        self.now_us = now_us;
        let event = self.here.as_mut().and_then(|(sender, _)| sender.receive(now_us, byte));
        let Some((identity, outcomes)) = self.visits.last_mut() else { return };
        match event {
            Some(Event::Hello(found)) => *identity = Some(found),
            Some(Event::Done(action, outcome)) => outcomes.push((action, outcome)),
            Some(Event::Telemetry(telemetry)) => self.telemetry = Some(telemetry),
            _ => {}
        }
    }

    fn poll(&mut self, now_us: u64) -> Option<Vec<u8>> {
        self.now_us = now_us;
        if let Some((_, actions)) = self.waiting.pop_front_if(|(at, _)| *at <= now_us) {
            let session = SESSION + self.visits.len() as u32;
            self.here = Some((Sender::without_job(session), actions.into()));
            self.visits.push((None, Vec::new()));
        }
        let (sender, actions) = self.here.as_mut()?;
        while let Some(action) = actions.front()
            && sender.act(*action)
        {
            actions.pop_front();
        }
        sender.poll(now_us).map(|frame| frame.to_vec())
    }

    fn is_done(&self) -> bool {
        self.now_us >= self.until_us
    }
}

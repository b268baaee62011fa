//! A session without a job: asks a controller for one thing after another, and waits for each answer.

use std::time::{Duration, Instant};

use shared::link::{Action, Answer, Event, Identity, MotionState, Refusal, Sender, Telemetry};

use crate::stream::{StreamError, new_session};
use crate::transport::Transport;

/// How long a search for home may take.
const HOMING_PATIENCE: Duration = Duration::from_secs(600);

/// Reports that may still show the machine before the search for home that was asked for.
const REPORTS_BEFORE: u32 = 2;

/// See the module. A controller has one session at a time: it opens one while a host that it hears runs a job for nobody else.
pub struct Session<'a> {
    line: &'a mut dyn Transport,
    sender: Sender<'static>,
    start: Instant,
    identity: Identity,
}

impl<'a> Session<'a> {
    /// Opens a session. Errors: the controller refuses it, or does not answer.
    pub fn open(line: &'a mut dyn Transport) -> Result<Self, StreamError> {
        // Ends whatever noise came before.
        line.send(&[0])?;
        let sender = Sender::without_job(new_session());
        let mut session = Self { line, sender, start: Instant::now(), identity: Identity::default() };
        session.identity = session.wait(|event| match event {
            Event::Hello(identity) => Some(identity),
            _ => None,
        })?;
        Ok(session)
    }

    /// What the controller is.
    pub fn identity(&self) -> Identity {
        self.identity
    }

    /// Asks for an action; returns what came of it, which may be a refusal. Errors: the line or the session is gone.
    pub fn ask(&mut self, action: Action) -> Result<Result<Answer, Refusal>, StreamError> {
        // One at a time: there is room.
        self.sender.act(action);
        self.wait(|event| match event {
            Event::Done(_, outcome) => Some(outcome),
            _ => None,
        })
    }

    /// How the machine is now.
    pub fn look(&mut self) -> Result<Telemetry, StreamError> {
        self.wait(|event| match event {
            Event::Telemetry(telemetry) => Some(telemetry),
            _ => None,
        })
    }

    /// Waits until the machine does not look for home any more, and returns how it is then. Errors: it takes ten minutes.
    pub fn until_homed(&mut self) -> Result<Telemetry, StreamError> {
        let start = Instant::now();
        let mut reports = 0;
        let done = self.wait(|event| match event {
            Event::Telemetry(telemetry) => {
                reports += 1;
                let over = telemetry.state != MotionState::Homing && reports > REPORTS_BEFORE;
                (over || start.elapsed() > HOMING_PATIENCE).then_some(telemetry)
            }
            _ => None,
        })?;
        if done.state == MotionState::Homing { Err(StreamError::Homing) } else { Ok(done) }
    }

    /// Speaks and listens until `wanted` has found what it wants.
    fn wait<T>(&mut self, mut wanted: impl FnMut(Event) -> Option<T>) -> Result<T, StreamError> {
        let mut buffer = [0; 1024];
        let mut found = None;
        loop {
            let now_us = self.start.elapsed().as_micros() as u64;
            while let Some(frame) = self.sender.poll(now_us) {
                self.line.send(&frame)?;
            }
            if let Some(error) = self.sender.error() {
                return Err(StreamError::Sender(error));
            }
            let count = self.line.receive(&mut buffer)?;
            let now_us = self.start.elapsed().as_micros() as u64;
            // What comes behind is heard too: it keeps the decoder in step.
            for &byte in buffer.iter().take(count) {
                if let Some(event) = self.sender.receive(now_us, byte) {
                    found = found.or_else(|| wanted(event));
                }
            }
            if let Some(found) = found {
                return Ok(found);
            }
        }
    }
}

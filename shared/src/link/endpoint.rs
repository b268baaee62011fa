//! The controller's end of the link: frames in, validated pieces to the tick, reports out.
//!
//! It owns no queue, no port and no clock: a [`Machine`] has them, the firmware's or a simulated one, and both therefore speak the same
//! protocol to the last byte. Times are ticks.

use super::action::{Action, Answer};
use super::frame::{Decoder, Frame, NO_SESSION, encode};
use super::message::{Command, Ending, Identity, Refusal, Report, Telemetry, VERSION};
use super::receiver::{Receiver, Turn};
use crate::active::ActivePiece;
use crate::control::Start;
use crate::error::PathError;
use crate::loader::{Bounds, Loader};
use crate::motion::MotionCommand;
use crate::piece::{Header, Piece};
use crate::safety::Coordinates;

/// Telemetry comes every so many ticks: 51 times a second.
pub const TELEMETRY_TICKS: u32 = 20;

/// A host that has said nothing for so many ticks has vanished: 1.5 s, six of its signs of life.
pub const SILENCE_TICKS: u32 = 1_536;

/// What the endpoint needs of the controller.
pub trait Machine {
    /// What the controller is.
    fn identity(&self) -> Identity;
    /// How many pieces the queue has room for.
    fn room(&self) -> u16;
    /// Whether a job may begin now. Errors: why not.
    fn ready(&self) -> Result<(), Refusal>;
    /// Forgets the path before, with nothing moving: the next piece is the first of a new one.
    fn clear(&mut self);
    /// Puts a piece into the queue; false where it is full.
    fn push(&mut self, piece: ActivePiece<f32>) -> bool;
    /// How far a path in these coordinates may go; none where nobody knows.
    fn bounds(&self, coordinates: Coordinates) -> Option<Bounds>;
    /// Begins the path whose first pieces stand in the queue. Errors: why not; nothing moves then.
    fn start(&mut self, start: &Start) -> Result<(), Refusal>;
    /// Gives up the path: one that runs comes to rest on itself and has been cancelled then; of one that waits nothing moves.
    fn stop(&mut self);
    /// Carries out an action, whose numbers are in range.
    fn act(&mut self, action: Action) -> Result<Answer, Refusal>;
    /// How the path that was started has ended, once it has.
    fn end(&self) -> Option<End>;
    /// How it goes. The link's own numbers are filled in by the endpoint; `loading` is what only it knows.
    fn telemetry(&mut self, loading: bool) -> Telemetry;
    /// The host of a running job has vanished: finish what is queued, or brake, as configured. Called once.
    fn host_vanished(&mut self);
    /// Sends a frame whole, or not at all where the line has no room for it.
    fn send(&mut self, frame: &Frame);
}

/// How a path ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// At its last point.
    Finished {
        /// Ticks of the job.
        ticks: u32,
        /// Time left in the last tick, in s.
        residual: f32,
        /// The hash of all setpoints.
        hash: u64,
    },
    /// Before it.
    Early(Ending),
}

impl From<End> for Report {
    fn from(end: End) -> Self {
        match end {
            End::Finished { ticks, residual, hash } => Self::Finished { ticks, residual, hash },
            End::Early(ending) => Self::Ended(ending),
        }
    }
}

/// The session's job.
#[derive(Clone, Debug)]
enum Job {
    /// None was begun, or it was refused.
    None,
    /// At rest, with pieces in the queue.
    Loading(Loader<f32>),
    /// Started. More pieces may come.
    Running(Loader<f32>),
    /// Started, and coming to rest because a piece of it was refused.
    Leaving,
    /// Started by a host that has vanished, and left to another one: no more pieces come, and its end is nobody's. Actions go on.
    Orphan,
    /// Over; said again to whoever asks.
    Ended(End),
}

/// See the module.
#[derive(Clone, Debug)]
pub struct Endpoint {
    decoder: Decoder,
    receiver: Receiver,
    job: Job,
    /// Those of the job.
    coordinates: Coordinates,
    /// The first command of the session that was refused, and why; said again to whoever asks.
    refused: Option<(u16, Refusal)>,
    /// What came of the last action.
    outcome: Result<Answer, Refusal>,
    /// Reports are numbered too, so that a trace shows what was missed.
    report_number: u16,
    reported_at: u32,
    heard_at: u32,
    vanished: bool,
    told_room: u16,
    broken_frames: u32,
}

impl Default for Endpoint {
    fn default() -> Self {
        Self::new()
    }
}

impl Endpoint {
    /// In no session.
    pub const fn new() -> Self {
        Self {
            decoder: Decoder::new(),
            receiver: Receiver::new(),
            job: Job::None,
            coordinates: Coordinates::Machine,
            refused: None,
            outcome: Ok(Answer::Done),
            report_number: 0,
            reported_at: 0,
            heard_at: 0,
            vanished: false,
            told_room: 0,
            broken_frames: 0,
        }
    }

    /// Takes one received byte, and answers where it ends a frame.
    pub fn receive(&mut self, machine: &mut impl Machine, now: u32, byte: u8) {
        let Some(found) = self.decoder.push::<Command>(byte) else { return };
        let outside = matches!(&found, Ok(found) if found.session == NO_SESSION);
        if found.is_ok() && !outside {
            self.heard_at = now;
            self.vanished = false;
        }
        match self.receiver.turn(found) {
            Turn::Take(_, Command::Hello { version, session }) => self.hello(machine, now, version, session),
            Turn::Take(_, Command::Status) => self.status(machine, now, outside),
            Turn::Take(number, Command::Act(action)) => {
                self.outcome = if action.is_in_range() { machine.act(action) } else { Err(Refusal::Range) };
                self.send(machine, &Report::Done { number, outcome: self.outcome });
            }
            Turn::Take(sequence, command) => match self.obey(machine, command) {
                Ok(()) => self.acknowledge(machine),
                Err(reason) => {
                    self.refused = self.refused.or(Some((sequence, reason)));
                    self.send(machine, &Report::Refused { sequence, reason });
                }
            },
            Turn::Repeated => self.acknowledge(machine),
            Turn::RepeatedAction(number) => self.send(machine, &Report::Done { number, outcome: self.outcome }),
            Turn::Refuse(error) => {
                self.broken_frames = self.broken_frames.wrapping_add(1);
                self.send(machine, &Report::Refused { sequence: self.receiver.next(), reason: Refusal::Link(error) });
            }
            Turn::Ignore => {}
        }
    }

    /// Reports what is due: the end of the job, telemetry while there is a session, new room in the queue. Call once a tick or so.
    pub fn poll(&mut self, machine: &mut impl Machine, now: u32) {
        if matches!(self.job, Job::Running(_) | Job::Leaving)
            && let Some(end) = machine.end()
        {
            self.job = Job::Ended(end);
            self.telemetry(machine, now, self.receiver.session());
            self.send(machine, &end.into());
        }
        if matches!(self.job, Job::Orphan) && machine.end().is_some() {
            self.job = Job::None;
        }
        if let Job::Running(loader) = &self.job {
            // One acknowledgement for several pieces of new room: each is a frame that the line has to carry.
            let worth_telling = (machine.identity().capacity / 4).max(1);
            if !loader.is_finished() && machine.room() >= self.told_room.saturating_add(worth_telling) {
                self.acknowledge(machine);
            }
        }
        let silent = now.wrapping_sub(self.heard_at) >= SILENCE_TICKS;
        if silent && !self.vanished {
            self.vanished = true;
            match self.job {
                Job::Running(_) | Job::Orphan => machine.host_vanished(),
                // What was loaded and never started belongs to nobody.
                Job::Loading(_) => self.drop_job(machine),
                Job::None | Job::Leaving | Job::Ended(_) => {}
            }
        }
        let due = now.wrapping_sub(self.reported_at) >= TELEMETRY_TICKS;
        if due && !self.vanished && self.receiver.session() != NO_SESSION {
            self.telemetry(machine, now, self.receiver.session());
        }
    }

    /// Whether a host has opened a session and was heard lately.
    pub fn has_host(&self) -> bool {
        self.receiver.session() != NO_SESSION && !self.vanished
    }

    fn hello(&mut self, machine: &mut impl Machine, now: u32, version: u16, session: u32) {
        let outcome = match &self.job {
            _ if version != VERSION => Err(Refusal::Version { version: VERSION }),
            _ if session == self.receiver.session() => Ok(()),
            Job::Running(_) | Job::Leaving | Job::Orphan if !self.vanished => Err(Refusal::Busy),
            job => {
                // A motion whose host has vanished is left to the next one, to be resumed or cancelled.
                if matches!(job, Job::Running(_) | Job::Leaving | Job::Orphan) {
                    self.job = Job::Orphan;
                } else {
                    self.drop_job(machine);
                }
                self.receiver.open(session);
                self.decoder.enter(session);
                (self.refused, self.outcome) = (None, Ok(Answer::Done));
                Ok(())
            }
        };
        let report = match outcome {
            Ok(()) => {
                (self.heard_at, self.vanished) = (now, false);
                self.told_room = machine.room();
                Report::Hello { version: VERSION, session, identity: machine.identity() }
            }
            Err(reason) => Report::Refused { sequence: 0, reason },
        };
        self.send_in(machine, NO_SESSION, &report);
    }

    fn status(&mut self, machine: &mut impl Machine, now: u32, outside: bool) {
        if outside {
            self.telemetry(machine, now, NO_SESSION);
            return;
        }
        self.telemetry(machine, now, self.receiver.session());
        if let Job::Ended(end) = self.job {
            self.send(machine, &end.into());
        }
        if let Some((sequence, reason)) = self.refused {
            self.send(machine, &Report::Refused { sequence, reason });
        }
    }

    fn obey(&mut self, machine: &mut impl Machine, command: Command) -> Result<(), Refusal> {
        match command {
            Command::Begin(header, coordinates) => self.begin(machine, &header, coordinates),
            Command::Piece(piece) => self.load(machine, &piece),
            Command::Run => self.run(machine),
            Command::Abort => {
                self.job = match core::mem::replace(&mut self.job, Job::None) {
                    Job::Running(_) | Job::Leaving => {
                        machine.stop();
                        Job::Leaving
                    }
                    Job::Orphan => {
                        machine.stop();
                        Job::Orphan
                    }
                    Job::Loading(_) => {
                        machine.stop();
                        Job::Ended(End::Early(Ending::Stopped))
                    }
                    job @ (Job::None | Job::Ended(_)) => job,
                };
                Ok(())
            }
            // These are answered where they come in.
            Command::Hello { .. } | Command::Status | Command::Act(_) => Ok(()),
        }
    }

    fn begin(
        &mut self,
        machine: &mut impl Machine,
        header: &Header<f32>,
        coordinates: Coordinates,
    ) -> Result<(), Refusal> {
        if !matches!(self.job, Job::None) {
            return Err(Refusal::Busy);
        }
        machine.ready()?;
        let mut loader = Loader::new(header, crate::TICK).map_err(Refusal::Path)?;
        if let Some(bounds) = machine.bounds(coordinates) {
            loader = loader.within(bounds);
        }
        machine.clear();
        self.coordinates = coordinates;
        self.job = Job::Loading(loader);
        Ok(())
    }

    /// A faulty piece ends the job. What was loaded and not started is forgotten, and nothing has moved; a motion comes to rest on
    /// its path.
    fn load(&mut self, machine: &mut impl Machine, piece: &Piece<f32>) -> Result<(), Refusal> {
        let loader = match &mut self.job {
            Job::None => return Err(Refusal::NoJob),
            Job::Orphan => return Err(Refusal::Busy),
            // It ended while the piece was on its way, and that has been told.
            Job::Leaving | Job::Ended(_) => return Ok(()),
            Job::Loading(loader) | Job::Running(loader) => loader,
        };
        let outcome = match loader.load(piece) {
            Ok(_) if machine.room() == 0 => Err(Refusal::Full),
            Ok(active) => machine.push(active).then_some(()).ok_or(Refusal::Full),
            Err(error) => Err(Refusal::Path(error)),
        };
        if outcome.is_err() {
            self.drop_job(machine);
        }
        outcome
    }

    fn run(&mut self, machine: &mut impl Machine) -> Result<(), Refusal> {
        machine.ready()?;
        match core::mem::replace(&mut self.job, Job::None) {
            Job::None => Err(Refusal::NoJob),
            job @ (Job::Leaving | Job::Ended(_)) => {
                self.job = job;
                Ok(())
            }
            job @ (Job::Running(_) | Job::Orphan) => {
                self.job = job;
                Err(Refusal::Busy)
            }
            Job::Loading(loader) => {
                let Some(at) = loader.start() else { return Err(Refusal::Path(PathError::Empty)) };
                let (motion, coordinates, further) = (loader.motion(), self.coordinates, loader.further_start());
                machine.start(&Start { motion, coordinates, at, further })?;
                self.job = Job::Running(loader);
                Ok(())
            }
        }
    }

    fn drop_job(&mut self, machine: &mut impl Machine) {
        let mut leaves = || machine.act(Action::Motion(MotionCommand::Cancel)).is_ok();
        self.job = match &self.job {
            Job::Running(_) if leaves() => Job::Leaving,
            Job::Loading(_) | Job::Running(_) | Job::Leaving | Job::Orphan => {
                machine.stop();
                Job::None
            }
            Job::None | Job::Ended(_) => Job::None,
        };
    }

    fn acknowledge(&mut self, machine: &mut impl Machine) {
        let room = machine.room();
        self.told_room = room;
        self.send(machine, &Report::Ack { next: self.receiver.next(), room });
    }

    fn telemetry(&mut self, machine: &mut impl Machine, now: u32, session: u32) {
        self.reported_at = now;
        let room = machine.room();
        self.told_room = room;
        let telemetry = Telemetry {
            queued: machine.identity().capacity.saturating_sub(room),
            next: self.receiver.next(),
            room,
            broken_frames: self.broken_frames,
            ..machine.telemetry(matches!(self.job, Job::Loading(_)))
        };
        self.send_in(machine, session, &Report::Telemetry(telemetry));
    }

    fn send(&mut self, machine: &mut impl Machine, report: &Report) {
        self.send_in(machine, self.receiver.session(), report);
    }

    fn send_in(&mut self, machine: &mut impl Machine, session: u32, report: &Report) {
        let Some(frame) = encode(session, self.report_number, report) else { return };
        self.report_number = self.report_number.wrapping_add(1);
        machine.send(&frame);
    }
}

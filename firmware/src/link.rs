//! The controller's end of the link: frames in, validated pieces to the tick, reports out.

use heapless::spsc::{Consumer, Producer};
use shared::active::ActivePiece;
use shared::error::PathError;
use shared::executor::State;
use shared::link::{Command, Decoder, Receiver, Refusal, Report, Turn, VERSION, encode};
use shared::loader::Loader;
use shared::piece::{Header, Order, Piece};

use crate::control::Directive;
use crate::hardware::Lamp;
use crate::mailbox::{MAILBOX, Snapshot};
use crate::telemetry::{Reporter, motion_state};

/// Received bytes that may wait for the link: more than the sender's window.
pub const RX_BYTES: usize = 2048;

/// Bytes that may wait for the line.
pub const TX_BYTES: usize = 1024;

/// Telemetry comes every so many ticks while a job is there, ten times a second.
const TELEMETRY_TICKS: u32 = 102;

/// The job as the link knows it.
enum Job {
    /// None was begun, or it was refused, stopped or finished.
    None,
    /// At rest, with pieces in the queue.
    Loading(Loader<f32>, Order),
    /// Started. More pieces may come.
    Running(Loader<f32>),
}

/// See the module.
pub struct Link {
    received: Consumer<'static, u8>,
    to_send: Producer<'static, u8>,
    pieces: Producer<'static, ActivePiece<f32>>,
    directives: Producer<'static, Directive>,
    lamp: Lamp,
    decoder: Decoder,
    receiver: Receiver,
    reporter: Reporter,
    job: Job,
    /// Reports are numbered too, so that a host sees what it missed.
    report_number: u16,
    reported_at: u32,
    told_room: u16,
    broken_frames: u32,
}

impl Link {
    /// A link between these queues.
    pub fn new(
        received: Consumer<'static, u8>,
        to_send: Producer<'static, u8>,
        pieces: Producer<'static, ActivePiece<f32>>,
        directives: Producer<'static, Directive>,
        lamp: Lamp,
    ) -> Self {
        Self {
            received,
            to_send,
            pieces,
            directives,
            lamp,
            decoder: Decoder::new(),
            receiver: Receiver::new(),
            reporter: Reporter::default(),
            job: Job::None,
            report_number: 0,
            reported_at: 0,
            told_room: 0,
            broken_frames: 0,
        }
    }

    /// Answers everything that was received, and reports what is due.
    pub fn serve(&mut self) {
        while let Some(byte) = self.received.dequeue() {
            if let Some(found) = self.decoder.push::<Command>(byte) {
                let turn = self.receiver.turn(found);
                self.answer(turn);
            }
        }
        self.report();
    }

    fn answer(&mut self, turn: Turn) {
        let outcome = match turn {
            Turn::Take(sequence, command) => self.obey(command).map_err(|reason| (sequence, reason)),
            Turn::Repeated => Ok(()),
            Turn::Refuse(error) => {
                self.broken_frames = self.broken_frames.wrapping_add(1);
                Err((self.receiver.next(), Refusal::Link(error)))
            }
        };
        match outcome {
            Ok(()) => {
                if !matches!(turn, Turn::Take(_, Command::Hello { .. } | Command::Status)) {
                    self.acknowledge();
                }
            }
            Err((sequence, reason)) => {
                defmt::warn!("refused {}: {}", sequence, reason);
                self.send(&Report::Refused { sequence, reason });
            }
        }
    }

    fn obey(&mut self, command: Command) -> Result<(), Refusal> {
        match command {
            Command::Hello { version } => self.hello(version),
            Command::Begin(header) => self.begin(&header),
            Command::Piece(piece) => self.load(&piece),
            Command::Run => self.run(),
            Command::Abort => {
                self.job = Job::None;
                self.stop();
                Ok(())
            }
            Command::Status => {
                let snapshot = MAILBOX.read();
                self.telemetry(&snapshot);
                if snapshot.state == State::Finished as u32 {
                    self.finished(&snapshot);
                }
                Ok(())
            }
        }
    }

    fn hello(&mut self, version: u16) -> Result<(), Refusal> {
        if version != VERSION {
            return Err(Refusal::Version { version: VERSION });
        }
        self.rest()?;
        MAILBOX.release();
        let capacity = self.pieces.capacity() as u16;
        self.told_room = capacity;
        self.send(&Report::Hello { version: VERSION, capacity });
        Ok(())
    }

    fn begin(&mut self, header: &Header<f32>) -> Result<(), Refusal> {
        self.rest()?;
        if MAILBOX.is_stopped() {
            return Err(Refusal::Stopped);
        }
        let loader = Loader::new(header, shared::TICK).map_err(Refusal::Path)?;
        self.job = Job::Loading(loader, header.order);
        Ok(())
    }

    /// A faulty piece ends the job: what was loaded of it is forgotten, and nothing has moved.
    fn load(&mut self, piece: &Piece<f32>) -> Result<(), Refusal> {
        let loader = match &mut self.job {
            Job::None => return Err(Refusal::NoJob),
            Job::Loading(loader, _) | Job::Running(loader) => loader,
        };
        let outcome = match loader.load(piece) {
            Ok(active) => self.pieces.enqueue(active).map_err(|_| Refusal::Full),
            Err(error) => Err(Refusal::Path(error)),
        };
        if outcome.is_err() {
            self.job = Job::None;
            self.stop();
        }
        outcome
    }

    fn run(&mut self) -> Result<(), Refusal> {
        match core::mem::replace(&mut self.job, Job::None) {
            Job::None => Err(Refusal::NoJob),
            Job::Running(_) => Err(Refusal::Busy),
            Job::Loading(..) if MAILBOX.is_stopped() => Err(Refusal::Stopped),
            Job::Loading(loader, order) => {
                let Some(start) = loader.start() else { return Err(Refusal::Path(PathError::Empty)) };
                defmt::info!("run");
                self.direct(Directive::Start(order, start));
                self.job = Job::Running(loader);
                Ok(())
            }
        }
    }

    /// Makes sure that nothing moves and nothing is loaded; refuses while a job runs.
    fn rest(&mut self) -> Result<(), Refusal> {
        if matches!(self.job, Job::Running(_)) {
            return Err(Refusal::Busy);
        }
        self.job = Job::None;
        if !self.pieces.is_empty() {
            self.stop();
        }
        Ok(())
    }

    fn stop(&mut self) {
        self.direct(Directive::Stop);
    }

    /// Hands a directive to the tick, and waits for the tick that takes it: a period at most, since nothing here can hold it up.
    /// So whatever is loaded next belongs to what comes after the directive.
    fn direct(&mut self, directive: Directive) {
        let mut waiting = self.directives.enqueue(directive).is_ok();
        while waiting {
            cortex_m::asm::wfi();
            waiting = !self.directives.is_empty();
        }
    }

    fn room(&self) -> u16 {
        self.pieces.capacity().saturating_sub(self.pieces.len()) as u16
    }

    fn acknowledge(&mut self) {
        let room = self.room();
        self.told_room = room;
        self.send(&Report::Ack { next: self.receiver.next(), room });
    }

    /// What a host hears without asking: the end of its job, telemetry while there is one, and new room in the queue.
    fn report(&mut self) {
        let snapshot = MAILBOX.read();
        if let Job::Running(loader) = &self.job {
            // An abandoned motion ends the job as its last point does.
            if snapshot.state == State::Finished as u32 || MAILBOX.is_stopped() {
                self.job = Job::None;
                self.telemetry(&snapshot);
                if snapshot.state == State::Finished as u32 {
                    defmt::info!("finished in {} ticks", snapshot.ticks);
                    self.finished(&snapshot);
                }
                return;
            }
            // One acknowledgement for several pieces of new room: each is a frame that the line has to carry.
            let worth_telling = (self.pieces.capacity() / 4) as u16;
            if !loader.is_finished() && self.room() >= self.told_room.saturating_add(worth_telling) {
                self.acknowledge();
            }
        }
        let due = MAILBOX.uptime().wrapping_sub(self.reported_at) >= TELEMETRY_TICKS;
        if due && !matches!(self.job, Job::None) {
            self.telemetry(&snapshot);
        }
    }

    fn telemetry(&mut self, snapshot: &Snapshot) {
        self.reported_at = MAILBOX.uptime();
        let loading = matches!(self.job, Job::Loading(..));
        self.lamp.show(motion_state(snapshot, loading));
        let telemetry = self.reporter.report(snapshot, loading, self.pieces.len() as u16, self.broken_frames);
        self.send(&Report::Telemetry(telemetry));
    }

    fn finished(&mut self, snapshot: &Snapshot) {
        self.send(&Report::Finished { ticks: snapshot.ticks, residual: snapshot.residual, hash: snapshot.hash });
    }

    /// Queues a report for the line, whole or not at all: half a frame would only spoil the next one.
    fn send(&mut self, report: &Report) {
        let Some(frame) = encode(self.report_number, report) else { return };
        self.report_number = self.report_number.wrapping_add(1);
        if self.to_send.capacity() - self.to_send.len() < frame.len() {
            return;
        }
        for byte in frame {
            // There is room, and nobody else writes here.
            let _ = self.to_send.enqueue(byte);
        }
    }
}

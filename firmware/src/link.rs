//! The controller's end of the link: the queues that `shared`'s endpoint speaks through.

use heapless::spsc::{Consumer, Producer};
use shared::active::ActivePiece;
use shared::control::{Directive, PathEnd, Start};
use shared::link::frame::checksum;
use shared::link::{Action, Answer, Chunk, End, Endpoint, Frame, Identity, Machine as Peer, Refusal, Telemetry};
use shared::loader::Bounds;
use shared::machine::image::{IMAGE_SIZE, Image};
use shared::machine::{HostLost, Machine};
use shared::motion::MotionCommand;
use shared::safety::{Coordinates, State};
use shared::supply::Sink;

use crate::hardware::Lamp;
use crate::mailbox::MAILBOX;
use crate::telemetry::Reporter;
use crate::{kept, restart};

/// Received bytes that may wait for the link: what a sender counts on.
pub const RX_BYTES: usize = shared::link::sender::RECEIVE_SIZE;

/// Bytes that may wait for the line.
pub const TX_BYTES: usize = 1024;

/// How long the answer to a new machine has to leave before the restart, in ticks.
const PARTING_TICKS: u32 = 50;

/// The cycles of the tick's stages are logged every so many ticks, while a host listens.
const LOG_TICKS: u32 = 1024;

/// See the module.
pub struct Link {
    received: Consumer<'static, u8>,
    endpoint: Endpoint,
    queues: Queues,
}

/// What leads to the line and to the tick, and back.
pub struct Lines {
    /// Bytes for the line.
    pub to_send: Producer<'static, u8>,
    /// Pieces for the tick.
    pub pieces: Sink<'static, f32>,
    /// What is asked of it.
    pub directives: Producer<'static, Directive>,
}

/// What the endpoint speaks through.
struct Queues {
    lines: Lines,
    capacity: u16,
    machine: Machine,
    /// The image of the machine; empty where there is none.
    image: &'static Image,
    /// A machine that is being sent.
    draft: [u8; IMAGE_SIZE],
    /// A machine that was sent whole: its length, and when to restart with it.
    leaving: Option<(usize, u32)>,
    lamp: Lamp,
    reporter: Reporter,
    /// When the cycles of the tick's stages were logged last, in ticks.
    logged: u32,
}

impl Link {
    /// A link between these queues, on a controller of this machine and its image.
    pub fn new(
        received: Consumer<'static, u8>,
        lines: Lines,
        machine: Machine,
        image: &'static Image,
        lamp: Lamp,
    ) -> Self {
        let capacity = lines.pieces.room() as u16;
        let draft = [0; IMAGE_SIZE];
        let reporter = Reporter::default();
        let queues = Queues { lines, capacity, machine, image, draft, leaving: None, lamp, reporter, logged: 0 };
        Self { received, endpoint: Endpoint::new(), queues }
    }

    /// Answers everything that was received, and reports what is due.
    pub fn serve(&mut self) {
        while let Some(byte) = self.received.dequeue() {
            self.endpoint.receive(&mut self.queues, MAILBOX.uptime(), byte);
        }
        self.endpoint.poll(&mut self.queues, MAILBOX.uptime());
        self.queues.leave();
    }
}

impl Queues {
    /// Hands a directive to the tick, and waits for its answer: some periods at most, since nothing here can hold the tick up.
    fn direct(&mut self, directive: Directive) -> Result<(), Refusal> {
        if self.lines.directives.enqueue(directive).is_err() {
            return Err(Refusal::Busy);
        }
        loop {
            if let Some(answer) = MAILBOX.take_answer() {
                return answer.map_err(Refusal::from);
            }
            cortex_m::asm::wfi();
        }
    }

    /// Once a second, for whoever has a debug probe: `probe-rs attach` shows it.
    fn log_stages(&mut self) {
        let now = MAILBOX.uptime();
        if now.wrapping_sub(self.logged) >= LOG_TICKS {
            self.logged = now;
            let [inputs, moving, outputs] = MAILBOX.stages();
            defmt::info!("cycles at most: inputs {}, moving {}, outputs {}", inputs, moving, outputs);
        }
    }

    fn put_aside(&mut self, offset: u16, chunk: &Chunk) -> Result<Answer, Refusal> {
        if !chunk.put_into(&mut self.draft, offset) {
            return Err(Refusal::Range);
        }
        Ok(Answer::Done)
    }

    fn commit(&mut self, length: u16, crc: u32) -> Result<Answer, Refusal> {
        let length = usize::from(length);
        let draft = self.draft.get(..length).ok_or(Refusal::Image)?;
        if checksum(draft) != crc || kept::machine_of(draft).is_none() {
            return Err(Refusal::Image);
        }
        if !matches!(MAILBOX.read().machine, State::Idle | State::Fault | State::EStop) {
            return Err(Refusal::Busy);
        }
        self.leaving = Some((length, MAILBOX.uptime().wrapping_add(PARTING_TICKS)));
        Ok(Answer::Done)
    }

    /// A part of the image that is kept, or about to be: a host that has written one reads it back at once.
    fn image_part(&self, offset: u16) -> Answer {
        let image = match self.leaving {
            Some((length, _)) => self.draft.get(..length).unwrap_or_default(),
            None => self.image.as_slice(),
        };
        Answer::part_of(image, offset)
    }

    /// Restarts with a machine that was sent, once its answer has left. Not while anything moves: a job may have begun meanwhile.
    fn leave(&mut self) {
        let Some((length, at)) = self.leaving else { return };
        let is_due = MAILBOX.uptime().wrapping_sub(at) as i32 >= 0;
        if is_due && matches!(MAILBOX.read().machine, State::Idle | State::Fault | State::EStop) {
            restart::with_image(self.draft.get(..length).unwrap_or_default());
        }
    }
}

impl Peer for Queues {
    fn identity(&self) -> Identity {
        Identity { firmware: [0, 1, 0], axes: self.machine.axes.len() as u8, capacity: self.capacity }
    }

    fn room(&self) -> u16 {
        self.lines.pieces.room() as u16
    }

    fn ready(&self) -> Result<(), Refusal> {
        MAILBOX.read().ready()
    }

    fn clear(&mut self) {
        // A path that runs is the endpoint's own, which does not ask for this then.
        let _ = self.direct(Directive::Clear);
        self.lines.pieces.restart();
    }

    fn push(&mut self, piece: ActivePiece<f32>) -> bool {
        self.lines.pieces.push(piece).is_ok()
    }

    fn bounds(&self, coordinates: Coordinates) -> Option<Bounds> {
        MAILBOX.read().bounds(&self.machine, coordinates)
    }

    fn start(&mut self, start: &Start) -> Result<(), Refusal> {
        self.direct(Directive::Start(*start))
    }

    fn stop(&mut self) {
        // Neither can be refused in the state that it is asked for in; a path that has just ended needs no cancelling.
        let _ = match MAILBOX.read().path {
            PathEnd::Running => self.direct(Directive::Motion(MotionCommand::Cancel)),
            _ => self.direct(Directive::Clear),
        };
    }

    fn act(&mut self, action: Action) -> Result<Answer, Refusal> {
        if let Some(directive) = action.directive() {
            return self.direct(directive).map(|()| Answer::Done);
        }
        match action {
            Action::WriteImage { offset, chunk } => self.put_aside(offset, &chunk),
            Action::CommitImage { length, crc } => self.commit(length, crc),
            Action::ReadImage { offset } => Ok(self.image_part(offset)),
            Action::Motion(_) | Action::Home | Action::Acknowledge => Err(Refusal::Unsupported),
        }
    }

    fn end(&self) -> Option<End> {
        MAILBOX.read().end()
    }

    fn telemetry(&mut self, loading: bool) -> Telemetry {
        self.log_stages();
        let status = MAILBOX.read();
        self.lamp.show(status.motion.is_moving() || status.machine == State::Homing);
        self.reporter.report(&status, self.machine.safety.axes, loading)
    }

    fn host_vanished(&mut self) {
        defmt::warn!("the host has vanished");
        if self.machine.host_lost == HostLost::Brake {
            // A motion that has just ended needs no hold. The next host may resume it.
            let _ = self.direct(Directive::Motion(MotionCommand::Hold));
        }
    }

    /// Half a frame would only spoil the next one.
    fn send(&mut self, frame: &Frame) {
        let to_send = &mut self.lines.to_send;
        if to_send.capacity() - to_send.len() < frame.len() {
            return;
        }
        for &byte in frame {
            // There is room, and nobody else writes here.
            let _ = to_send.enqueue(byte);
        }
    }
}

//! A controller without hardware: the endpoint and the tick of `shared` behind a line of bytes, on the machine of [`crate::rig`].
//!
//! It takes bytes and ticks, and gives bytes and setpoints; who lets its time pass, and how fast, is the caller's.

use shared::active::ActivePiece;
use shared::control::{Directive, PathEnd, Start};
use shared::executor::State;
use shared::fixed::{Fixed, Position};
use shared::link::action::IMAGE_SIZE;
use shared::link::{Action, Answer, Chunk, End, Endpoint, Frame, Identity, Machine, Refusal, Telemetry};
use shared::loader::Bounds;
use shared::machine::image::{decode, encode};
use shared::machine::{HostLost, MachineSettings};
use shared::motion::MotionCommand;
use shared::safety::{self, Coordinates};

use crate::rig::{Queue, Rig, RigError};

/// What a controller is set up with.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Pieces that the queue holds; the firmware's holds 63.
    pub capacity: u16,
    /// The machine that it keeps.
    pub machine: Option<MachineSettings>,
}

impl Settings {
    /// A controller like the firmware's.
    pub fn new(machine: Option<MachineSettings>) -> Self {
        Self { capacity: 63, machine }
    }
}

/// See the module.
pub struct Controller {
    endpoint: Endpoint,
    machine: Virtual,
    uptime: u32,
}

/// What the endpoint works on.
struct Virtual {
    capacity: u16,
    rig: Rig,
    /// Ticks that have been taken to answer a directive, and that the caller has still to let pass.
    ahead: u32,
    /// Where the machine was a tick before.
    before: Position,
    loaded: u64,
    image: Vec<u8>,
    draft: Vec<u8>,
    to_send: Vec<u8>,
}

impl Controller {
    /// A controller that was switched on, in no session. Errors: a machine that it cannot drive.
    pub fn new(settings: Settings) -> Result<Self, RigError> {
        let image = settings.machine.as_ref().and_then(|machine| encode(machine).ok());
        let mut machine = Virtual {
            capacity: settings.capacity,
            rig: Rig::new(settings.machine.as_ref())?,
            ahead: 0,
            before: [Fixed(0); 3],
            loaded: 0,
            image: image.map_or_else(Vec::new, |image| image.to_vec()),
            draft: Vec::new(),
            to_send: Vec::new(),
        };
        machine.rig.tick();
        Ok(Self { endpoint: Endpoint::new(), machine, uptime: 0 })
    }

    /// Takes bytes from the line.
    pub fn receive(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.endpoint.receive(&mut self.machine, self.uptime, byte);
        }
    }

    /// One tick: moves, and reports what is due. Returns the setpoint, in the path's coordinates.
    pub fn tick(&mut self) -> Position {
        self.uptime = self.uptime.wrapping_add(1);
        match self.machine.ahead.checked_sub(1) {
            Some(ahead) => self.machine.ahead = ahead,
            None => self.machine.walk(),
        }
        self.endpoint.poll(&mut self.machine, self.uptime);
        self.setpoint()
    }

    /// The bytes for the line since the last call.
    pub fn take_output(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.machine.to_send)
    }

    /// What the motion is about.
    pub fn state(&self) -> State {
        self.machine.rig.status.motion
    }

    /// The setpoint of the last tick, in the path's coordinates.
    pub fn setpoint(&self) -> Position {
        self.machine.rig.status.setpoint
    }

    /// How many pieces were accepted since it was made.
    pub fn loaded(&self) -> u64 {
        self.machine.loaded
    }

    /// Pieces that wait in the queue.
    pub fn queued(&self) -> usize {
        self.machine.rig.queue.len()
    }

    /// The machine at its pins, to press its switches.
    pub fn rig(&mut self) -> &mut Rig {
        &mut self.machine.rig
    }
}

impl Virtual {
    fn walk(&mut self) {
        self.before = self.rig.status.position;
        self.rig.tick();
    }

    /// Hands a directive to the tick, and lets time pass until there is an answer.
    fn direct(&mut self, directive: Directive) -> Result<(), Refusal> {
        /// News go before a directive; there are three in a row at most.
        const PATIENCE: usize = 8;
        (self.rig.asked, self.rig.answer) = (Some(directive), None);
        for _ in 0..PATIENCE {
            self.walk();
            self.ahead += 1;
            if let Some(answer) = self.rig.answer.take() {
                return answer.map_err(Refusal::from);
            }
        }
        Err(Refusal::Busy)
    }

    fn put_aside(&mut self, offset: u16, chunk: &Chunk) -> Result<Answer, Refusal> {
        self.draft.resize(usize::from(IMAGE_SIZE), 0);
        if !chunk.put_into(&mut self.draft, offset) {
            return Err(Refusal::Range);
        }
        Ok(Answer::Done)
    }

    /// Keeps a machine and starts anew with it, as a board does.
    fn commit(&mut self, length: u16, crc: u32) -> Result<Answer, Refusal> {
        let draft = self.draft.get(..usize::from(length)).ok_or(Refusal::Image)?;
        if checksum(draft) != crc {
            return Err(Refusal::Image);
        }
        let settings = decode(draft).map_err(|_| Refusal::Image)?;
        let rig = Rig::new(Some(&settings)).map_err(|_| Refusal::Image)?;
        if !matches!(self.rig.status.machine, safety::State::Idle | safety::State::Fault | safety::State::EStop) {
            return Err(Refusal::Busy);
        }
        self.image = draft.to_vec();
        self.rig = rig;
        self.rig.tick();
        Ok(Answer::Done)
    }
}

/// The CRC-32 of a configuration image.
pub fn checksum(bytes: &[u8]) -> u32 {
    shared::link::frame::checksum(bytes)
}

impl Machine for Virtual {
    fn identity(&self) -> Identity {
        let version = |part: &str| part.parse().unwrap_or(0);
        let firmware = [
            version(env!("CARGO_PKG_VERSION_MAJOR")),
            version(env!("CARGO_PKG_VERSION_MINOR")),
            version(env!("CARGO_PKG_VERSION_PATCH")),
        ];
        Identity { firmware, axes: self.rig.machine.axes.len() as u8, capacity: self.capacity }
    }

    fn room(&self) -> u16 {
        self.capacity.saturating_sub(self.rig.queue.len() as u16)
    }

    fn ready(&self) -> Result<(), Refusal> {
        self.rig.status.ready()
    }

    fn clear(&mut self) {
        // A path that runs is the endpoint's own, which does not ask for this then.
        let _ = self.direct(Directive::Clear);
        self.rig.queue = Queue::default();
    }

    fn push(&mut self, piece: ActivePiece<f32>) -> bool {
        self.rig.queue.push(piece);
        self.loaded += 1;
        true
    }

    fn bounds(&self, coordinates: Coordinates) -> Option<Bounds> {
        self.rig.status.bounds(&self.rig.machine, coordinates)
    }

    fn start(&mut self, start: &Start) -> Result<(), Refusal> {
        self.direct(Directive::Start(*start))
    }

    fn stop(&mut self) {
        // A path that has just ended needs no cancelling.
        let _ = match self.rig.status.path {
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
            Action::ReadImage { offset } => Ok(Answer::part_of(&self.image, offset)),
            Action::Motion(_) | Action::Home | Action::Acknowledge => Err(Refusal::Unsupported),
        }
    }

    fn end(&self) -> Option<End> {
        self.rig.status.end()
    }

    fn telemetry(&mut self, loading: bool) -> Telemetry {
        let way = |(now, before): (Fixed, Fixed)| now.minus::<f32>(before).powi(2);
        let square: f32 = self.rig.status.position.into_iter().zip(self.before).map(way).sum();
        let axes = self.rig.machine.safety.axes;
        Telemetry { speed: square.sqrt() / shared::TICK, ..self.rig.status.telemetry(axes, loading) }
    }

    fn host_vanished(&mut self) {
        if self.rig.machine.host_lost == HostLost::Brake {
            // A motion that has just ended needs no hold. The next host may resume it.
            let _ = self.direct(Directive::Motion(MotionCommand::Hold));
        }
    }

    fn send(&mut self, frame: &Frame) {
        self.to_send.extend_from_slice(frame);
    }
}

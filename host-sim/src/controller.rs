//! A controller without hardware: the endpoint, loader and executor of `shared` behind a line of bytes.
//!
//! It takes bytes and ticks, and gives bytes and setpoints; who lets its time pass, and how fast, is the caller's. Its axes are where
//! their setpoints are.

use std::collections::VecDeque;

use shared::active::ActivePiece;
use shared::executor::{Executor, Pieces, State};
use shared::fixed::{Fixed, Position};
use shared::hash::SetpointHash;
use shared::link::action::IMAGE_SIZE;
use shared::link::{Action, Answer, Chunk, End, Ending, Endpoint, Frame, Identity, Machine, Refusal, Telemetry};
use shared::loader::Motion;
use shared::motion::MotionCommand;
use shared::safety::{self, Coordinates, Fault};
use shared::supply::PathTime;

/// What a host that vanishes leaves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Alone {
    /// A machine that finishes what is queued and rests.
    #[default]
    Finish,
    /// A machine that comes to rest on the path.
    Brake,
}

/// What a controller is set up with.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Pieces that the queue holds; the firmware's holds 63.
    pub capacity: u16,
    /// What a host that vanishes leaves.
    pub alone: Alone,
    /// Whether it can keep a configuration image.
    pub keeps_image: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self { capacity: 63, alone: Alone::default(), keeps_image: true }
    }
}

/// x, y and z; their positions are always known.
const AXES: u8 = 0b111;

/// See the module.
#[derive(Debug)]
pub struct Controller {
    endpoint: Endpoint,
    machine: Virtual,
    uptime: u32,
}

/// What the endpoint works on.
#[derive(Debug)]
struct Virtual {
    settings: Settings,
    queue: Queue,
    executor: Executor<f32>,
    hash: SetpointHash,
    ticks: u32,
    started: bool,
    aborted: bool,
    fault: Option<Fault>,
    before: Position,
    loaded: u64,
    image: Vec<u8>,
    draft: Vec<u8>,
    to_send: Vec<u8>,
}

#[derive(Debug, Default)]
struct Queue {
    pieces: VecDeque<ActivePiece<f32>>,
    reach: PathTime,
}

impl Pieces<f32> for Queue {
    fn next_piece(&mut self, place: &mut Option<ActivePiece<f32>>) -> bool {
        let next = self.pieces.pop_front();
        *place = next.or(*place);
        next.is_some()
    }

    fn horizon(&self) -> Option<PathTime> {
        Some(self.reach)
    }

    fn discard(&mut self) {
        self.pieces.clear();
    }
}

impl Controller {
    /// At rest at the origin, in no session.
    pub fn new(settings: Settings) -> Self {
        let machine = Virtual {
            settings,
            queue: Queue::default(),
            executor: Executor::new(shared::TICK, [Fixed(0); 3]),
            hash: SetpointHash::new(),
            ticks: 0,
            started: false,
            aborted: false,
            fault: None,
            before: [Fixed(0); 3],
            loaded: 0,
            image: Vec::new(),
            draft: Vec::new(),
            to_send: Vec::new(),
        };
        Self { endpoint: Endpoint::new(), machine, uptime: 0 }
    }

    /// Takes bytes from the line.
    pub fn receive(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.endpoint.receive(&mut self.machine, self.uptime, byte);
        }
    }

    /// One tick: moves, and reports what is due. Returns the setpoint.
    pub fn tick(&mut self) -> Position {
        self.uptime = self.uptime.wrapping_add(1);
        self.machine.walk();
        self.endpoint.poll(&mut self.machine, self.uptime);
        self.machine.executor.setpoint()
    }

    /// The bytes for the line since the last call.
    pub fn take_output(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.machine.to_send)
    }

    /// What the motion is about.
    pub fn state(&self) -> State {
        self.machine.executor.state()
    }

    /// The setpoint of the last tick.
    pub fn setpoint(&self) -> Position {
        self.machine.executor.setpoint()
    }

    /// How many pieces were accepted since it was made.
    pub fn loaded(&self) -> u64 {
        self.machine.loaded
    }

    /// Pieces that wait in the queue.
    pub fn queued(&self) -> usize {
        self.machine.queue.pieces.len()
    }

    /// Sets a fault as a machine would, or takes it away. With one the motion stops at once.
    pub fn set_fault(&mut self, fault: Option<Fault>) {
        self.machine.fault = fault;
        if fault.is_some() {
            self.machine.executor.abort();
            self.machine.queue.discard();
        }
    }
}

impl Virtual {
    fn walk(&mut self) {
        let state = self.executor.state();
        self.before = self.executor.setpoint();
        if state.is_moving() || state == State::Held {
            self.hash.add(self.executor.tick(&mut self.queue));
            self.ticks = self.ticks.wrapping_add(1);
        }
    }

    fn image_part(&self, offset: u16) -> Answer {
        let rest = self.image.get(usize::from(offset)..).unwrap_or_default();
        let part = rest.get(..shared::link::action::CHUNK_SIZE).unwrap_or(rest);
        Answer::Image {
            // An image is committed up to `IMAGE_SIZE` only.
            length: self.image.len() as u16,
            crc: checksum(&self.image),
            offset,
            chunk: Chunk::new(part).unwrap_or_default(),
        }
    }

    fn put_aside(&mut self, offset: u16, chunk: &Chunk) -> Result<Answer, Refusal> {
        let bytes = chunk.bytes().ok_or(Refusal::Range)?;
        self.draft.resize(usize::from(IMAGE_SIZE), 0);
        let from = usize::from(offset);
        let place = self.draft.get_mut(from..from + bytes.len()).ok_or(Refusal::Range)?;
        place.copy_from_slice(bytes);
        Ok(Answer::Done)
    }

    fn commit(&mut self, length: u16, crc: u32) -> Result<Answer, Refusal> {
        let draft = self.draft.get(..usize::from(length)).ok_or(Refusal::Image)?;
        if checksum(draft) != crc {
            return Err(Refusal::Image);
        }
        self.image = draft.to_vec();
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
        Identity { firmware, axes: 3, capacity: self.settings.capacity }
    }

    fn room(&self) -> u16 {
        self.settings.capacity.saturating_sub(self.queue.pieces.len() as u16)
    }

    fn ready(&self) -> Result<(), Refusal> {
        self.fault.map_or(Ok(()), |fault| Err(Refusal::Fault(fault)))
    }

    fn clear(&mut self) {
        self.executor.abort();
        self.queue = Queue::default();
        (self.started, self.aborted) = (false, false);
    }

    fn push(&mut self, piece: ActivePiece<f32>) -> bool {
        self.queue.reach = piece.reach();
        self.queue.pieces.push_back(piece);
        self.loaded += 1;
        true
    }

    /// It stands where any job begins, in whatever coordinates.
    fn start(&mut self, motion: &Motion<f32>, _: Coordinates, [x, y]: [Fixed; 2]) -> Result<(), Refusal> {
        self.executor.stand_at([x, y, Fixed(0)]);
        self.executor.begin(motion);
        (self.hash, self.ticks, self.started) = (SetpointHash::new(), 0, true);
        Ok(())
    }

    fn stop(&mut self) {
        self.executor.abort();
        self.queue.discard();
        self.aborted = self.started;
    }

    fn act(&mut self, action: Action) -> Result<Answer, Refusal> {
        match action {
            Action::Motion(command) => self.executor.command(command).map(|()| Answer::Done).map_err(Refusal::Motion),
            Action::Home => Err(Refusal::Unsupported),
            Action::Acknowledge => {
                self.fault = None;
                Ok(Answer::Done)
            }
            Action::WriteImage { .. } | Action::CommitImage { .. } | Action::ReadImage { .. }
                if !self.settings.keeps_image =>
            {
                Err(Refusal::Unsupported)
            }
            Action::WriteImage { offset, chunk } => self.put_aside(offset, &chunk),
            Action::CommitImage { length, crc } => self.commit(length, crc),
            Action::ReadImage { offset } => Ok(self.image_part(offset)),
        }
    }

    fn end(&self) -> Option<End> {
        if let Some(fault) = self.fault {
            return Some(End::Early(Ending::Fault(fault)));
        }
        match self.executor.state() {
            _ if self.aborted => Some(End::Early(Ending::Stopped)),
            State::Finished => {
                Some(End::Finished { ticks: self.ticks, residual: self.executor.spare_time(), hash: self.hash.value() })
            }
            State::Cancelled => Some(End::Early(Ending::Cancelled)),
            _ => None,
        }
    }

    fn telemetry(&mut self, loading: bool) -> Telemetry {
        use shared::link::MotionState;
        let setpoint = self.executor.setpoint();
        let way = |(now, before): (Fixed, Fixed)| now.minus::<f32>(before).powi(2);
        let square: f32 = setpoint.into_iter().zip(self.before).map(way).sum();
        let state = match self.executor.state() {
            _ if self.fault.is_some() => MotionState::Fault,
            State::Idle | State::Finished | State::Cancelled if loading => MotionState::Loading,
            _ if self.aborted => MotionState::Stopped,
            state => state.into(),
        };
        let machine = match self.executor.state() {
            _ if self.fault.is_some() => safety::State::Fault,
            State::Holding | State::Held => safety::State::Hold,
            State::Cancelling => safety::State::Braking,
            State::Run | State::Braking | State::Starved => safety::State::Run,
            State::Idle | State::Finished | State::Cancelled => safety::State::Idle,
        };
        Telemetry {
            state,
            machine,
            fault: self.fault,
            axes: AXES,
            known: AXES,
            tick: self.ticks,
            pieces: self.executor.place().map_or(0, |place| place.piece + 1),
            setpoint,
            actual: setpoint,
            speed: square.sqrt() / shared::TICK,
            percent: self.executor.percent(),
            ..Telemetry::default()
        }
    }

    fn host_vanished(&mut self) {
        if self.settings.alone == Alone::Brake {
            // A motion that cannot be held has no other end than its own.
            let _ = self.executor.command(MotionCommand::Hold);
        }
    }

    fn send(&mut self, frame: &Frame) {
        self.to_send.extend_from_slice(frame);
    }
}

//! A machine that trusts nobody: it executes what the endpoint hands it, and panics where a number is out of range, where a piece comes
//! without room, or where something is asked that its state does not allow. What the fuzz targets and the properties run behind the link.

use host_sim::rig::Queue;
use shared::active::ActivePiece;
use shared::control::Start;
use shared::executor::{Executor, Pieces, State};
use shared::fixed::{Fixed, Position};
use shared::link::action::{CHUNK_SIZE, IMAGE_SIZE};
use shared::link::{Action, Answer, Chunk, End, Ending, Frame, Identity, Machine, Refusal, Telemetry};
use shared::loader::Bounds;
use shared::motion::MotionCommand;
use shared::safety::{Coordinates, Refused};

/// Pieces that its queue holds: few, so that it is full often.
const CAPACITY: u16 = 4;

/// See the module.
#[derive(Debug)]
pub struct StrictMachine {
    executor: Executor<f32>,
    queue: Queue,
    aborted: bool,
    /// Whether its position is known: otherwise it refuses a job in its coordinates.
    pub known: bool,
    /// Pieces that were taken since it was made.
    pub taken: u32,
    /// Motions that were started since it was made.
    pub started: u32,
    /// Actions that were carried out since it was made.
    pub acted: u32,
    /// What it said since this was emptied.
    pub said: Vec<u8>,
}

impl Default for StrictMachine {
    fn default() -> Self {
        Self {
            executor: Executor::new(shared::TICK, [Fixed(0); 3]),
            queue: Queue::default(),
            aborted: false,
            known: true,
            taken: 0,
            started: 0,
            acted: 0,
            said: Vec::new(),
        }
    }
}

impl StrictMachine {
    /// One tick.
    pub fn tick(&mut self) {
        if self.is_on_path() {
            check_position(self.executor.tick(&mut self.queue));
        }
    }

    /// What the motion is about.
    pub fn state(&self) -> State {
        self.executor.state()
    }

    fn is_on_path(&self) -> bool {
        self.executor.state().is_moving() || self.executor.state() == State::Held
    }
}

/// A setpoint may lie between the points of a piece that are checked when it is loaded; these are within 4 m of zero, and nothing of a
/// setpoint may come near the 8.19 m where coordinates wrap.
fn check_position(position: Position) {
    assert!(position.iter().all(|coordinate| coordinate.to_mm().abs() < 8_000.0), "{position:?}");
}

/// Finite and in range at every parameter that is asked for here: more of them than the loader looks at, and others.
fn check_piece(piece: &ActivePiece<f32>) {
    const PARTS: i32 = 100;
    let origin = piece.origin().map(Fixed::to_mm);
    for part in 0..=PARTS {
        let tau = part as f32 / PARTS as f32 - 0.5;
        let (point, rate) = piece.point_and_rate(tau);
        assert!(rate.is_finite() && rate >= 0.0, "a rate of {rate} at {tau} of {piece:?}");
        for (origin, way) in origin.into_iter().zip([point.re, point.im]) {
            let place = origin + f64::from(way);
            assert!(place.abs() < 8_000.0, "{place} mm at {tau} of {piece:?}");
        }
        if let Some(further) = piece.further(tau) {
            assert!(further.iter().all(|coordinate| coordinate.is_in_reach()), "{further:?} of {piece:?}");
        }
    }
}

impl Machine for StrictMachine {
    fn identity(&self) -> Identity {
        Identity { firmware: [0; 3], axes: 3, capacity: CAPACITY }
    }

    fn room(&self) -> u16 {
        CAPACITY - self.queue.len() as u16
    }

    fn ready(&self) -> Result<(), Refusal> {
        Ok(())
    }

    fn clear(&mut self) {
        assert!(!self.is_on_path(), "the path is cleared in {:?}", self.executor.state());
        self.executor.abort();
        self.queue = Queue::default();
        self.aborted = false;
    }

    fn push(&mut self, piece: ActivePiece<f32>) -> bool {
        assert!(self.room() > 0);
        check_piece(&piece);
        self.queue.push(piece);
        self.taken += 1;
        true
    }

    fn bounds(&self, _: Coordinates) -> Option<Bounds> {
        None
    }

    fn start(&mut self, start: &Start) -> Result<(), Refusal> {
        let [x, y] = start.at;
        if start.coordinates == Coordinates::Machine && !self.known {
            return Err(Refusal::Machine(Refused::PositionUnknown { axis: 0 }));
        }
        assert!(!self.is_on_path() && !self.queue.is_empty());
        check_position([x, y, Fixed(0)]);
        self.executor.stand_at([x, y, Fixed(0)]);
        self.executor.begin(&start.motion);
        self.started += 1;
        Ok(())
    }

    fn stop(&mut self) {
        self.executor.abort();
        self.queue.discard();
        self.aborted = true;
    }

    fn act(&mut self, action: Action) -> Result<Answer, Refusal> {
        self.acted += 1;
        match action {
            Action::Motion(command) => {
                if let MotionCommand::Override { percent } = command {
                    assert!((1..=200).contains(&percent), "an override of {percent} %");
                }
                self.executor.command(command).map(|()| Answer::Done).map_err(Refusal::Motion)
            }
            Action::WriteImage { offset, chunk } => {
                let bytes = chunk.bytes().map(<[u8]>::len);
                let end = bytes.map(|length| usize::from(offset) + length);
                assert!(bytes.is_some_and(|length| length <= CHUNK_SIZE), "a chunk of {chunk:?}");
                assert!(end.is_some_and(|end| end <= usize::from(IMAGE_SIZE)), "a chunk to {end:?}");
                Ok(Answer::Done)
            }
            Action::CommitImage { length, .. } => {
                assert!(length <= IMAGE_SIZE);
                Err(Refusal::Image)
            }
            Action::ReadImage { offset } => {
                assert!(offset <= IMAGE_SIZE);
                Ok(Answer::Image { length: 0, crc: 0, offset, chunk: Chunk::default() })
            }
            Action::Home | Action::Acknowledge => Ok(Answer::Done),
        }
    }

    fn end(&self) -> Option<End> {
        match self.executor.state() {
            _ if self.aborted => Some(End::Early(Ending::Stopped)),
            State::Finished => Some(End::Finished { ticks: 0, residual: self.executor.spare_time(), hash: 0 }),
            State::Cancelled => Some(End::Early(Ending::Cancelled)),
            _ => None,
        }
    }

    fn telemetry(&mut self, _loading: bool) -> Telemetry {
        Telemetry { setpoint: self.executor.setpoint(), ..Telemetry::default() }
    }

    fn host_vanished(&mut self) {
        // A motion that cannot be held has no other end than its own.
        let _ = self.executor.command(MotionCommand::Hold);
    }

    fn send(&mut self, frame: &Frame) {
        self.said.extend_from_slice(frame);
    }
}

//! Runs the tick over a path, in the controller's own precision, and measures what comes out.

mod outcome;

pub use outcome::{Outcome, SETTLING_TICKS, Sample};

use shared::active::ActivePiece;
use shared::executor::{Executor, Pieces, State};
use shared::fixed::Position;
use shared::hash::SetpointHash;
use shared::loader::Loader;
use shared::piece::{Header, Piece};
use shared::real::Real;

use crate::job::Units;
use crate::path::Path;
use crate::plant::Measured;
use outcome::Gauge;

/// Pieces from an iterator, each checked by the loader as it is taken.
pub struct Feeder<T, I> {
    loader: Loader<T>,
    pieces: I,
}

impl<T: Real, I: Iterator<Item = Piece<T>>> Feeder<T, I> {
    /// A feeder of pieces that have been checked before, so that the loader only prepares them.
    pub fn new(header: &Header<T>, pieces: I) -> Option<Self> {
        Some(Self { loader: Loader::new(header, T::lit(f64::from(shared::TICK))).ok()?, pieces })
    }
}

impl<T: Real, I: Iterator<Item = Piece<T>>> Pieces<T> for Feeder<T, I> {
    fn next_piece(&mut self, place: &mut Option<ActivePiece<T>>) -> bool {
        let next = self.pieces.next().and_then(|piece| self.loader.load(&piece).ok());
        let found = next.is_some();
        *place = next.or(*place);
        found
    }
}

/// What a run tells of itself, whoever looks on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Ticks until the last point, counting the one that reached it.
    pub ticks: u64,
    /// The time at which the last point was reached, in s: the ticks less what the last one did not need.
    pub time: f64,
    /// Of all setpoints.
    pub hash: SetpointHash,
}

/// Runs the f32 tick over `path` and shows `look` the executor after every tick. Returns none where it never ends.
pub fn run(path: &Path, mut look: impl FnMut(u64, &Executor<f32>)) -> Option<Run> {
    let mut feeder = Feeder::new(&path.header, path.wire())?;
    let mut executor = Executor::new(shared::TICK, path.start());
    executor.start(path.header.order);
    let mut hash = SetpointHash::new();
    let mut ticks = 0;
    while executor.state() == State::Run {
        hash.add(executor.tick(&mut feeder));
        ticks += 1;
        look(ticks, &executor);
    }
    let time = (ticks as f64) * f64::from(shared::TICK) - f64::from(executor.spare_time());
    (executor.state() == State::Finished).then_some(Run { ticks, time, hash })
}

/// Simulates `path`: runs the tick, moves the axes by `drive`, and shows every sample to `look`.
///
/// `drive` gets each setpoint and returns what is to be seen at the end of its tick: [`Plant::advance`](crate::plant::Plant::advance),
/// or [`Measured::ideal`] for a machine that is always where its setpoint is. The first `settling` ticks are left
/// out of the maxima. Returns none where the path never ends.
pub fn simulate(
    path: &Path,
    units: Units,
    settling: u64,
    mut drive: impl FnMut(Position) -> Measured,
    mut look: impl FnMut(&Sample),
) -> Option<Outcome> {
    let mut gauge = Gauge::new(path, settling);
    let run = run(path, |tick, executor| {
        let measured = drive(executor.setpoint());
        look(&gauge.measure(tick, executor, &measured));
    })?;
    Some(gauge.outcome(&run, units))
}

/// All setpoints of a path, as the controller puts them out.
pub fn setpoints(path: &Path) -> Option<Vec<Position>> {
    let mut all = Vec::new();
    run(path, |_, executor| all.push(executor.setpoint()))?;
    Some(all)
}

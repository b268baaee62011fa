//! Sends pieces through loader and executor, tick by tick.

use shared::active::ActivePiece;
use shared::complex::Complex;
use shared::error::PathError;
use shared::executor::{Executor, Pieces, Place, State};
use shared::fixed::{Fixed, Position};
use shared::loader::Loader;
use shared::pace::PaceLimits;
use shared::piece::{Header, Order, Piece};
use shared::real::Real;

use crate::draft::{Draft, pieces};

/// The period of the machine in s.
pub const TICK: f64 = shared::TICK as f64;

/// All orders of the interpolator.
pub const ORDERS: [Order; 4] = [Order::First, Order::Second, Order::Third, Order::Exact];

/// Both scalars of the kernel.
pub trait Scalar: Real + Into<f64> {}

impl Scalar for f32 {}
impl Scalar for f64 {}

/// A header with a tolerance of 1 um, wide enough for the rounding of both ends of a piece.
pub fn header<T: Real>(weight: f64, order: Order) -> Header<T> {
    Header {
        weight: T::lit(weight),
        order,
        closed: false,
        tolerance: T::lit(1e-3),
        rest: false,
        pace: PaceLimits::USUAL.exact(),
    }
}

/// All pieces through the loader.
pub fn load<T: Real>(header: &Header<T>, pieces: &[Piece<T>], tick: f64) -> Result<Vec<ActivePiece<T>>, PathError> {
    let mut loader = Loader::new(header, T::lit(tick))?;
    pieces.iter().map(|piece| loader.load(piece)).collect()
}

/// Pieces from an iterator, counted.
pub struct Feeder<I> {
    /// What is still to come.
    pub rest: I,
    /// How many were taken.
    pub taken: usize,
}

impl<T, I: Iterator<Item = ActivePiece<T>>> Pieces<T> for Feeder<I> {
    fn next_piece(&mut self, place: &mut Option<ActivePiece<T>>) -> bool {
        let Some(next) = self.rest.next() else { return false };
        *place = Some(next);
        self.taken += 1;
        true
    }
}

/// What a path did.
#[derive(Clone, Debug)]
pub struct Run<T> {
    /// The setpoint of each tick, the last one at the path's end.
    pub setpoints: Vec<Position>,
    /// Where each tick ended.
    pub places: Vec<Place<T>>,
    /// How many ticks it took.
    pub ticks: u64,
    /// The time of the path in s: the ticks without the part of the last one that was not needed.
    pub time: f64,
    /// Whether it came to its end within the ticks allowed.
    pub finished: bool,
    /// The most pieces that one tick took.
    pub most_taken: usize,
}

/// Runs pieces that are loaded, for `limit` ticks at most; `visit` sees the executor after every tick. Keeps no setpoints.
pub fn walk<T: Scalar>(
    active: impl Iterator<Item = ActivePiece<T>>,
    order: Order,
    tick: f64,
    limit: u64,
    mut visit: impl FnMut(&Executor<T>),
) -> Run<T> {
    let mut executor = Executor::new(T::lit(tick), [Fixed(0); 3]);
    executor.start(order);
    let mut feeder = Feeder { rest: active, taken: 0 };
    let mut run = Run { setpoints: vec![], places: vec![], ticks: 0, time: 0.0, finished: false, most_taken: 0 };
    while run.ticks < limit && !run.finished {
        let before = feeder.taken;
        executor.tick(&mut feeder);
        run.ticks += 1;
        run.most_taken = run.most_taken.max(feeder.taken - before);
        run.finished = executor.state() == State::Finished;
        visit(&executor);
    }
    run.time = run.ticks as f64 * tick - executor.spare_time().into();
    run
}

/// Loads and runs a path at the machine's tick, and keeps everything.
pub fn run<T: Scalar>(path: &[Draft], weight: f64, order: Order) -> Result<Run<T>, PathError> {
    run_at(path, weight, order, TICK)
}

/// The same at another tick.
pub fn run_at<T: Scalar>(path: &[Draft], weight: f64, order: Order, tick: f64) -> Result<Run<T>, PathError> {
    let active = load(&header::<T>(weight, order), &pieces(path), tick)?;
    let time: f64 = path.iter().map(|draft| draft.duration(weight)).sum();
    let (mut setpoints, mut places) = (vec![], vec![]);
    let run = walk(active.into_iter(), order, tick, (2.0 * time / tick) as u64 + 100, |executor| {
        setpoints.push(executor.setpoint());
        places.extend(executor.place());
    });
    Ok(Run { setpoints, places, ..run })
}

/// The setpoint in mm.
pub fn mm(setpoint: Position) -> Complex<f64> {
    let [x, y, _] = setpoint;
    Complex::new(x.to_mm(), y.to_mm())
}

/// The exact-frame position of a place in mm: the local point on the frame before its origin was rounded.
pub fn exact_mm<T: Scalar>(path: &[Draft], place: &Place<T>) -> Option<Complex<f64>> {
    let frame = path.get(place.piece as usize)?.frame();
    Some(frame + Complex::new(place.point.re.into(), place.point.im.into()))
}

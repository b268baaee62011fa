//! Walks a queue of pieces, one tick at a time, at the pace of its [`motion`](crate::motion).
//!
//! A tick moves the path time by q dt and nothing else, so that a start, a stop or an override never leaves the path. The time that
//! is left at the end of a piece is carried into the next one, so that the time of a path does not depend on where its nodes fall.
//! A path ends at its exact last point.
//!
//! A rest is reached in time, not in arc length. The time that is left on a piece is its duration less the path time spent on
//! it; at order 1, whose steps take other times than they are made for, that is the trapezium of (21) over the step. Over the last ticks
//! before the end the way itself says it, and says it the better the nearer it comes: (1/2 - tau) times the mean of 1/rate here and
//! at the end. So the pace comes to 0 at the end of the way, not near it: the last setpoint is put there, from less than five half
//! steps of the pace away.

use crate::accumulator::Accumulator;
use crate::active::ActivePiece;
use crate::complex::Complex;
use crate::fixed::Position;
use crate::further::Setpoint;
use crate::interpolator::advance;
use crate::loader::Motion;
use crate::motion::{CommandError, Event, MotionCommand};
use crate::pace::{Pace, Pacer};
use crate::piece::Order;
use crate::real::Real;

pub use crate::motion::State;
pub use crate::supply::Pieces;

/// How many pieces a tick may enter. Denser pieces than that slow the motion down instead of lengthening the tick.
pub const NODES_PER_TICK: u32 = 16;

/// The last stretch of a piece, in ticks of path time, on which the way says how much time is left.
const LAST_TICKS: f64 = 4.0;

/// One axis-independent view of a tick, for traces and telemetry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place<T> {
    /// How many pieces the path has had before this one.
    pub piece: u32,
    /// The parameter on it, in -1/2..=1/2.
    pub tau: T,
    /// The rate of (21) at that parameter, in 1/s: at the path's own feed.
    pub rate: T,
    /// The point relative to the piece's origin, in mm.
    pub point: Complex<T>,
}

/// The state of the walk, from tick to tick, of a machine with `F` axes beside its plane.
#[derive(Clone, Copy, Debug)]
pub struct Executor<T, const F: usize = 1> {
    tick: T,
    order: Order,
    state: State,
    pacer: Pacer<T>,
    pace: Pace,
    /// The override in per cent, and the level of the pace that it means.
    percent: u8,
    wanted: i32,
    single_block: bool,
    active: Option<ActivePiece<T, F>>,
    /// Whether the next tick begins with the next piece.
    at_node: bool,
    entered: u32,
    tau: Accumulator<T>,
    /// The path time that is left on the piece, in s.
    left: Accumulator<T>,
    rate: T,
    point: Complex<T>,
    setpoint: Setpoint<F>,
    spare: T,
}

/// The part of a tick that was spent on the piece on which it ended.
struct Spent<T> {
    /// The path time in s.
    time: T,
    /// The rate where it began.
    from: T,
}

/// What the table says of `event`, or nothing.
#[inline(never)]
fn follow(state: &mut State, event: Event) {
    *state = state.after(event).unwrap_or(*state);
}

impl<T: Real> Executor<T> {
    /// An executor that rests at `position`; `tick` is the period in s.
    pub const fn new(tick: T, position: Position) -> Self {
        let [x, y, z] = position;
        Self::resting(tick, Setpoint { plane: [x, y], further: [z] })
    }

    /// Takes the machine to stand at `position` from now on: where a path is about to begin.
    pub fn stand_at(&mut self, position: Position) {
        self.rest_at(position.into());
    }

    /// One tick: [`Executor::step`] for a machine with x, y and z.
    #[inline(always)]
    pub fn tick(&mut self, pieces: &mut impl Pieces<T>) -> Position {
        self.step(pieces).into()
    }

    /// The setpoint of the last tick.
    pub fn setpoint(&self) -> Position {
        self.setpoint.into()
    }
}

impl<T: Real, const F: usize> Executor<T, F> {
    /// An executor that rests at `setpoint`; `tick` is the period in s.
    pub const fn resting(tick: T, setpoint: Setpoint<F>) -> Self {
        let pacer = Pacer::fixed(tick);
        Self {
            tick,
            order: Order::First,
            state: State::Idle,
            pacer,
            pace: pacer.unity(),
            percent: 100,
            wanted: 1,
            single_block: false,
            active: None,
            at_node: true,
            entered: 0,
            tau: Accumulator::new(T::ZERO),
            left: Accumulator::new(T::ZERO),
            rate: T::ZERO,
            point: Complex::ZERO,
            setpoint,
            spare: T::ZERO,
        }
    }

    /// Takes the machine to stand at `setpoint` from now on. Override and single block stay as they are.
    pub fn rest_at(&mut self, setpoint: Setpoint<F>) {
        let Self { percent, single_block, .. } = *self;
        *self = Self { percent, single_block, ..Self::resting(self.tick, setpoint) };
    }

    /// Begins a path at its feed and at a fixed pace: it cannot be held, and stops dead where its pieces run dry. The next tick
    /// takes its first piece.
    pub fn start(&mut self, order: Order) {
        self.begin(&Motion { order, rest: false, pacer: Pacer::fixed(self.tick) });
    }

    /// Begins a path, at rest or at its feed as it says: the next tick takes its first piece.
    pub fn begin(&mut self, motion: &Motion<T>) {
        let Motion { order, rest, pacer } = *motion;
        let (percent, single_block) = (self.percent, self.single_block);
        let pace = if rest { Pace::REST } else { pacer.unity() };
        let wanted = pacer.level(percent);
        let fresh = Self::resting(self.tick, self.setpoint);
        *self = Self { order, state: State::Run, pacer, pace, percent, wanted, single_block, ..fresh };
    }

    /// Leaves the path; the setpoint rests where it is, at once.
    pub fn abort(&mut self) {
        self.rest_at(self.setpoint);
    }

    /// Takes a command; it acts from the next tick on. Legal at any time, unless the error says otherwise.
    pub fn command(&mut self, command: MotionCommand) -> Result<(), CommandError> {
        let event = match command {
            MotionCommand::Override { percent } if !(1..=200).contains(&percent) => {
                return Err(CommandError::Override { percent });
            }
            MotionCommand::Override { percent } => {
                self.percent = percent;
                self.wanted = self.pacer.level(percent);
                return Ok(());
            }
            MotionCommand::SingleBlock(on) => {
                self.single_block = on;
                return Ok(());
            }
            MotionCommand::Hold => Event::Hold,
            MotionCommand::Resume => Event::Resume,
            MotionCommand::Cancel => Event::Cancel,
        };
        let next = self.state.after(event).ok_or(CommandError::Refused { state: self.state })?;
        if self.pacer.is_fixed() {
            return Err(CommandError::FixedPace);
        }
        self.state = next;
        Ok(())
    }

    /// One tick: moves along the path by one period and returns the setpoint.
    ///
    /// Bounded by [`NODES_PER_TICK`] pieces; no panic, no lock, no allocation.
    #[inline(always)]
    pub fn step(&mut self, pieces: &mut impl Pieces<T, F>) -> Setpoint<F> {
        if self.state.is_moving() {
            self.walk(pieces);
            if self.state == State::Cancelled {
                pieces.discard();
            }
        }
        self.setpoint
    }

    #[inline(always)]
    fn walk(&mut self, pieces: &mut impl Pieces<T, F>) {
        let mut entered = 0;
        if self.at_node {
            if !self.enter_first(pieces) {
                return;
            }
            entered = 1;
        }
        let Some(piece) = &self.active else { return };
        let way = self.way(piece, pieces);
        let target = if self.state.is_stopping() { 0 } else { self.wanted };
        let stride = self.pacer.step(&mut self.pace, target, way);
        if stride.short != (self.state == State::Braking) {
            follow(&mut self.state, if stride.short { Event::Short } else { Event::Ample });
        }
        if stride.steps == 0 {
            self.stand(target, way);
            return;
        }
        let time = self.pacer.time(stride);
        let spent = match advance(piece, &mut self.tau, self.rate, self.order, time) {
            None => Some(Spent { time, from: self.rate }),
            Some(left) => self.cross_nodes(pieces, left, time, entered),
        };
        if self.state == State::Finished {
            return;
        }
        self.place_setpoint();
        self.count(spent);
        if self.pace.is_rest() && target == 0 {
            self.come_to_rest();
        }
    }

    /// The path time in s for which there is way: to the end of the piece where blocks are run one by one, else of all that is
    /// queued.
    #[inline(always)]
    fn way(&self, piece: &ActivePiece<T, F>, pieces: &impl Pieces<T, F>) -> T {
        let mut here = self.left.value();
        if here < T::lit(LAST_TICKS) * self.tick {
            let slowness = T::ONE / self.rate + piece.end_slowness();
            here = self.tau.left_to(T::HALF) * T::HALF * slowness;
        }
        if self.single_block {
            return here;
        }
        match pieces.horizon() {
            Some(horizon) => here + horizon.since(piece.until()),
            None => here + self.pacer.ample(),
        }
    }

    /// Evaluates the piece where the tick has come to.
    #[inline(always)]
    fn place_setpoint(&mut self) {
        let Some(piece) = &self.active else { return };
        let tau = self.tau.value();
        let (point, rate) = piece.point_and_rate(tau);
        (self.point, self.rate) = (point, rate);
        self.setpoint.plane = piece.place(point);
        if let Some(further) = piece.further(tau) {
            self.setpoint.further = further;
        }
    }

    /// Counts down the time that is left on the piece.
    #[inline(always)]
    fn count(&mut self, spent: Option<Spent<T>>) {
        let Some(Spent { time, from }) = spent else { return };
        let time = match self.order {
            Order::First => time * T::HALF * (T::ONE + from / self.rate),
            Order::Second | Order::Third | Order::Exact => time,
        };
        self.left.add(-time);
    }

    fn happen(&mut self, event: Event) {
        follow(&mut self.state, event);
    }

    /// From a node into the next piece, in the tick after the node was reached. Returns whether there is one to walk on.
    #[inline(never)]
    fn enter_first(&mut self, pieces: &mut impl Pieces<T, F>) -> bool {
        if self.state.is_stopping() && self.pace.is_rest() {
            self.come_to_rest();
            return false;
        }
        let found = self.enter(pieces);
        if !found {
            self.run_dry();
        }
        found
    }

    /// Takes the next piece and stands at its start; returns false where there is none.
    #[inline(always)]
    fn enter(&mut self, pieces: &mut impl Pieces<T, F>) -> bool {
        if !pieces.next_piece(&mut self.active) {
            return false;
        }
        let Some(piece) = &self.active else { return false };
        self.tau = Accumulator::new(-T::HALF);
        self.left = Accumulator::new(piece.duration());
        self.rate = piece.start_rate();
        self.entered = self.entered.wrapping_add(1);
        self.at_node = false;
        if self.state == State::Starved {
            self.happen(Event::Fed);
        }
        true
    }

    /// From the end of a piece into the next ones, with the path time `left` of `time`; `entered` pieces were entered before.
    /// Returns what was spent on the last one, if the tick ends on it.
    #[inline(never)]
    fn cross_nodes(&mut self, pieces: &mut impl Pieces<T, F>, mut left: T, time: T, entered: u32) -> Option<Spent<T>> {
        for _ in entered..NODES_PER_TICK {
            if self.active.as_ref().is_some_and(|piece| piece.last().is_some()) {
                self.finish(left * (self.tick / time));
                return None;
            }
            self.stop_at_node();
            if self.single_block && self.pacer.may_end(&self.pace) {
                self.pace = Pace::REST;
                self.happen(Event::Block);
                return None;
            }
            if !self.enter(pieces) {
                self.run_dry();
                return None;
            }
            let Some(piece) = &self.active else { return None };
            match advance(piece, &mut self.tau, self.rate, self.order, left) {
                None => return Some(Spent { time: left, from: self.rate }),
                Some(rest) => left = rest,
            }
        }
        // More nodes than a tick may cross: the rest of the time is given up, and the next tick begins at this node.
        self.stop_at_node();
        None
    }

    /// The end of the piece, with nothing left of it.
    fn stop_at_node(&mut self) {
        self.tau = Accumulator::new(T::HALF);
        self.left = Accumulator::new(T::ZERO);
        self.at_node = true;
    }

    /// At the end of all pieces that have come. Whoever counted on more of them stops dead; at a fixed pace the path goes on as it
    /// began.
    fn run_dry(&mut self) {
        if !self.pacer.is_fixed() {
            self.pace = Pace::REST;
        }
        self.stop_at_node();
        self.happen(Event::Dry);
    }

    /// At the last point, with `spare` s of the tick left.
    fn finish(&mut self, spare: T) {
        let Some(piece) = &self.active else { return };
        if let Some([x, y, _]) = piece.last() {
            self.setpoint.plane = [x, y];
        }
        // An axis that no piece moves stays where it is to the end.
        if let Some(further) = piece.further_end() {
            self.setpoint.further = further;
        }
        self.spare = spare;
        self.stop_at_node();
        self.rate = T::ZERO;
        self.happen(Event::End);
    }

    /// A tick that does not move: at rest, as it was asked for, or because the way has come to its end.
    #[inline(never)]
    fn stand(&mut self, target: i32, way: T) {
        if target == 0 {
            self.come_to_rest();
        } else if self.pacer.is_nothing(way) {
            if self.active.as_ref().is_some_and(|piece| piece.last().is_some()) {
                self.finish(T::ZERO);
                return;
            }
            self.stop_at_node();
            self.place_setpoint();
            if self.single_block {
                self.happen(Event::Block);
            }
        }
    }

    /// The pace has come to 0 because it should.
    fn come_to_rest(&mut self) {
        self.pace = Pace::REST;
        self.happen(Event::AtRest);
    }

    /// What the executor is about.
    pub fn state(&self) -> State {
        self.state
    }

    /// The pace q at the end of the last tick: 1 at the path's own feed. Not for the tick: it divides.
    pub fn pace(&self) -> T {
        self.pacer.value(&self.pace)
    }

    /// The override in per cent, as it was asked for: the largest pace of the path may keep [`Executor::pace`] below it.
    pub fn percent(&self) -> u8 {
        self.percent
    }

    /// The part of the last tick that was not needed any more when the path ended, in s.
    pub fn spare_time(&self) -> T {
        self.spare
    }

    /// Where on which piece the last tick ended; none before the first piece.
    pub fn place(&self) -> Option<Place<T>> {
        let piece = self.entered.checked_sub(1)?;
        Some(Place { piece, tau: self.tau.value(), rate: self.rate, point: self.point })
    }

    /// The centre feed V_d at which the last tick ended, in mm/s. Not for the tick.
    pub fn centre_feed(&self) -> T {
        self.active.map_or(T::ZERO, |piece| piece.centre_speed(self.tau.value()) * self.rate * self.pace())
    }

    /// The arc-length fraction u on the piece at which the last tick ended.
    pub fn fraction(&self) -> T {
        self.active.map_or(T::ZERO, |piece| piece.fraction(self.tau.value()))
    }

    /// The setpoint of the last tick, of all axes.
    pub fn axes(&self) -> Setpoint<F> {
        self.setpoint
    }
}

//! Walks a queue of pieces, one tick at a time, at the pace of its [`motion`](crate::motion).
//!
//! A tick moves the path time by q dt and nothing else, so that a start, a stop or an override never leaves the path. The time that
//! is left at the end of a piece is carried into the next one, so that the time of a path does not depend on where its nodes fall.
//! A path ends at its exact last point.
//!
//! A rest is reached in time, not in arc length: the time that is left on a piece is integrated in every tick from which on a
//! stop may have to begin, and the better the nearer its end is ([`duration::of_rest`]). So the pace comes to 0 at the end of the way,
//! not near it: the last setpoint is put there, from less than five half steps of the pace away. Elsewhere a bound of that time from
//! below is enough.

use crate::accumulator::Accumulator;
use crate::active::ActivePiece;
use crate::complex::Complex;
use crate::duration;
use crate::fixed::Position;
use crate::further::Setpoint;
use crate::interpolator::advance;
use crate::loader::Motion;
use crate::motion::{CommandError, Event, MotionCommand};
use crate::pace::{Pace, Pacer, Target};
use crate::piece::Order;
use crate::real::Real;

pub use crate::motion::State;
pub use crate::supply::Pieces;

/// How many pieces a tick may enter. Denser pieces than that slow the motion down instead of lengthening the tick.
pub const NODES_PER_TICK: u32 = 16;

/// What a supply without a horizon is taken for, in s.
const ENDLESS: f64 = 1e6;

/// One axis-independent view of a tick, for traces and telemetry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place<T> {
    /// How many pieces the path has had before this one.
    pub piece: u32,
    /// How far the walk has come on it, in -1/2..=1/2.
    pub tau: T,
    /// The parameter on its curve, in -1/2..=1/2: tau, but on a spline.
    pub parameter: T,
    /// The rate of (21) at that parameter, in 1/s: at the path's own feed.
    pub rate: T,
    /// The point relative to the piece's origin, in mm.
    pub point: Complex<T>,
}

/// The state of the walk, from tick to tick, of a machine with `F` axes beside its plane.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Executor<T, const F: usize = 1> {
    tick: T,
    order: Order,
    /// The same on the piece; none along a profile.
    piece_order: Option<Order>,
    state: State,
    pacer: Pacer<T>,
    pace: Pace,
    /// The override in per cent, and the pace that it means.
    percent: u8,
    wanted: Target<T>,
    single_block: bool,
    /// Whether the next tick moves by `time` again, as long as the way is ample; otherwise it has to look at everything.
    steady: bool,
    /// The path time of a tick at a steady pace, in s.
    time: T,
    /// Whether the next tick begins with the next piece.
    at_node: bool,
    entered: u32,
    tau: Accumulator<T>,
    /// The time on a piece with a profile, -1/2..=1/2.
    theta: Accumulator<T>,
    /// The rate of (21) at tau, along a profile that of F = 1.
    rate: T,
    point: Complex<T>,
    setpoint: Setpoint<F>,
    spare: T,
    active: Option<ActivePiece<T, F>>,
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
            piece_order: None,
            state: State::Idle,
            pacer,
            pace: pacer.unity(),
            percent: 100,
            wanted: pacer.unity_as_target(),
            single_block: false,
            active: None,
            steady: false,
            time: T::ZERO,
            at_node: true,
            entered: 0,
            tau: Accumulator::new(T::ZERO),
            theta: Accumulator::new(T::ZERO),
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
        let wanted = pacer.target(percent);
        let steady = !single_block && pacer.is_steady(&pace, &wanted);
        let fresh = Self::resting(self.tick, self.setpoint);
        *self = Self {
            order,
            state: State::Run,
            pacer,
            pace,
            percent,
            wanted,
            single_block,
            steady,
            // A pace that is steady at once is 1.
            time: self.tick,
            ..fresh
        };
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
                self.wanted = self.pacer.target(percent);
                self.steady = false;
                return Ok(());
            }
            MotionCommand::SingleBlock(on) => {
                self.single_block = on;
                self.steady = false;
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
        self.steady = false;
        Ok(())
    }

    /// One tick: moves along the path by one period and returns the setpoint.
    ///
    /// Bounded by [`NODES_PER_TICK`] pieces; no panic, no lock, no allocation.
    #[inline(always)]
    pub fn step(&mut self, pieces: &mut impl Pieces<T, F>) -> Setpoint<F> {
        let (mut time, mut entered) = (self.time, 0);
        if !(self.steady && self.is_ample(pieces)) {
            let Some(changed) = self.change_pace(pieces) else { return self.setpoint };
            (time, entered) = changed;
        }
        let left = match &self.active {
            Some(piece) => advance(piece, &mut self.tau, &mut self.theta, self.rate, self.piece_order, time),
            None => Some(time),
        };
        if let Some(left) = left
            && !self.cross_nodes(pieces, left, time, entered)
        {
            return self.setpoint;
        }
        self.place_setpoint();
        if !self.steady {
            self.settle(pieces);
        }
        self.setpoint
    }

    /// Whether a stop from the wanted pace need not be looked at, where blocks are not run one by one.
    #[inline(always)]
    fn is_ample(&self, pieces: &impl Pieces<T, F>) -> bool {
        let Some(horizon) = pieces.horizon() else { return true };
        let Some(piece) = &self.active else { return false };
        // Along a profile too: F is no more than 1.
        self.tau.left_to(T::HALF) * piece.least_slowness() + horizon.since(piece.until()) >= self.wanted.ample()
    }

    /// A bound from below of the path time that is left on the piece, in s.
    #[inline(always)]
    fn least_time(&self, piece: &ActivePiece<T, F>) -> T {
        match piece.profile() {
            Some(profile) => profile.left(&self.theta),
            None => self.tau.left_to(T::HALF) * piece.least_slowness(),
        }
    }

    /// The path time that is left on the piece, in s.
    #[inline(always)]
    fn time_left(&self, piece: &ActivePiece<T, F>) -> T {
        match piece.profile() {
            Some(profile) => profile.left(&self.theta),
            None => duration::of_rest(piece, &self.tau),
        }
    }

    /// What a tick does before it moves, unless the pace is steady and the way ample. Returns the path time to move by and how many
    /// pieces were entered; none where nothing moves.
    #[inline(never)]
    fn change_pace(&mut self, pieces: &mut impl Pieces<T, F>) -> Option<(T, u32)> {
        if !self.state.is_moving() {
            return None;
        }
        let entered = u32::from(self.at_node);
        if self.at_node && !self.enter_first(pieces) {
            return None;
        }
        let piece = self.active.as_ref()?;
        let least_way = self.least_time(piece) + self.beyond(piece, pieces);
        let target = if self.state.is_stopping() { Target::REST } else { self.wanted };
        let way = || self.time_left(piece) + self.beyond(piece, pieces);
        let mut pace = self.pace;
        let stride = self.pacer.step(&mut pace, &target, least_way, way);
        self.pace = pace;
        if stride.short != (self.state == State::Braking) {
            self.happen(if stride.short { Event::Short } else { Event::Ample });
        }
        if stride.steps == 0 {
            self.stand(pieces);
            return None;
        }
        self.time = self.pacer.time(stride);
        let looked_at = self.single_block || self.state.is_stopping();
        self.steady = !looked_at && self.pacer.is_steady(&self.pace, &target);
        Some((self.time, entered))
    }

    /// The path time in s for which there is way beyond the piece: none where blocks are run one by one, else what is queued.
    #[inline(always)]
    fn beyond(&self, piece: &ActivePiece<T, F>, pieces: &impl Pieces<T, F>) -> T {
        if self.single_block {
            return T::ZERO;
        }
        match pieces.horizon() {
            Some(horizon) => horizon.since(piece.until()),
            None => T::lit(ENDLESS),
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

    /// What the table says of `event`, or nothing.
    fn happen(&mut self, event: Event) {
        self.state = self.state.after(event).unwrap_or(self.state);
    }

    /// From a node into the next piece, in the tick after the node was reached. Returns whether there is one to walk on.
    fn enter_first(&mut self, pieces: &mut impl Pieces<T, F>) -> bool {
        if self.state.is_stopping() && self.pace.is_rest() {
            self.settle(pieces);
            return false;
        }
        let found = pieces.next_piece(&mut self.active);
        if found {
            self.stand_at_start();
        } else {
            self.run_dry();
        }
        found
    }

    /// Stands at the start of a piece that was just taken.
    #[inline(always)]
    fn stand_at_start(&mut self) {
        let Some(piece) = &self.active else { return };
        self.tau = Accumulator::new(-T::HALF);
        self.theta = self.tau;
        self.rate = piece.start_rate();
        self.piece_order = piece.order(self.order);
        self.entered = self.entered.wrapping_add(1);
        self.at_node = false;
        if self.state == State::Starved {
            self.happen(Event::Fed);
        }
    }

    /// From the end of a piece into the next ones, with the path time `left` of `time`; `entered` pieces were entered in this tick
    /// before. Returns whether the setpoint is to be found where the tick has come to: not at the end of the path.
    #[inline(never)]
    fn cross_nodes(&mut self, pieces: &mut impl Pieces<T, F>, mut left: T, time: T, entered: u32) -> bool {
        for _ in entered..NODES_PER_TICK {
            if let Some(piece) = &self.active {
                if piece.last().is_some() {
                    self.finish(left * (self.tick / time));
                    return false;
                }
                if self.single_block && self.pacer.may_end(&self.pace) {
                    self.pace = Pace::REST;
                    self.stop_at_node();
                    self.happen(Event::Block);
                    return true;
                }
                // Where the next piece does not move them, further axes stay as this one ends.
                if let Some(further) = piece.further_end() {
                    self.setpoint.further = further;
                }
            }
            if !pieces.next_piece(&mut self.active) {
                self.run_dry();
                return true;
            }
            self.stand_at_start();
            let Some(piece) = &self.active else { return false };
            match advance(piece, &mut self.tau, &mut self.theta, self.rate, self.piece_order, left) {
                None => return true,
                Some(rest) => left = rest,
            }
        }
        // More nodes than a tick may cross: the rest of the time is given up, and the next tick begins at this node.
        self.stop_at_node();
        true
    }

    /// The end of the piece; the next tick begins with the next one.
    fn stop_at_node(&mut self) {
        if let Some(further) = self.active.as_ref().and_then(ActivePiece::further_end) {
            self.setpoint.further = further;
        }
        self.tau = Accumulator::new(T::HALF);
        self.theta = self.tau;
        self.steady = false;
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
        if let Some(last) = self.active.as_ref().and_then(ActivePiece::last) {
            self.setpoint.plane = last;
        }
        self.spare = spare;
        self.stop_at_node();
        self.rate = T::ZERO;
        self.happen(Event::End);
    }

    /// A tick that does not move: at rest, as it was asked for, or because the way has come to its end.
    fn stand(&mut self, pieces: &mut impl Pieces<T, F>) {
        if self.state.is_stopping() {
            self.settle(pieces);
            return;
        }
        let Some(piece) = &self.active else { return };
        if !self.pacer.is_nothing(self.time_left(piece) + self.beyond(piece, pieces)) {
            return;
        }
        if piece.last().is_some() {
            self.finish(T::ZERO);
            return;
        }
        self.stop_at_node();
        self.place_setpoint();
        if self.single_block {
            self.happen(Event::Block);
        }
    }

    /// At the end of a tick whose pace was not steady: whether it has come to 0 because it should.
    #[inline(never)]
    fn settle(&mut self, pieces: &mut impl Pieces<T, F>) {
        if self.pace.is_rest() && self.state.is_stopping() {
            self.pace = Pace::REST;
            self.happen(Event::AtRest);
        }
        if self.state == State::Cancelled {
            pieces.discard();
        }
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
        let tau = self.tau.value();
        let parameter = self.active.map_or(tau, |piece| piece.parameter(tau));
        Some(Place { piece, tau, parameter, rate: self.rate_of_feed(), point: self.point })
    }

    /// The rate of (21) where the last tick ended, in 1/s. Not for the tick.
    fn rate_of_feed(&self) -> T {
        let profile = self.active.as_ref().and_then(ActivePiece::profile);
        profile.map_or(self.rate, |profile| self.rate * profile.factor(self.theta.value()))
    }

    /// The centre feed V_d at which the last tick ended, in mm/s. Not for the tick.
    pub fn centre_feed(&self) -> T {
        self.active.map_or(T::ZERO, |piece| piece.centre_speed(self.tau.value()) * self.rate_of_feed() * self.pace())
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

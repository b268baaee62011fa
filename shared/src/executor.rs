//! Walks a queue of pieces, one tick at a time.
//!
//! The time that is left at the end of a piece is carried into the next one, so that the time of a path does not depend on
//! where its nodes fall. A path ends at its exact last point; a queue that runs dry stops at the node where it did.

use crate::accumulator::Accumulator;
use crate::active::ActivePiece;
use crate::complex::Complex;
use crate::fixed::Position;
use crate::interpolator::advance;
use crate::piece::Order;
use crate::real::Real;

/// How many pieces a tick may enter. Denser pieces than that slow the motion down instead of lengthening the tick.
pub const NODES_PER_TICK: u32 = 16;

/// Where the tick gets its pieces from: a queue's consumer on the controller, an iterator in the simulator.
pub trait Pieces<T> {
    /// Puts the next piece of the path into `place`, or leaves it alone and returns false where there is none. In place, because
    /// a piece is large beside the rest of a tick.
    fn next_piece(&mut self, place: &mut Option<ActivePiece<T>>) -> bool;
}

impl<T: Copy> Pieces<T> for heapless::spsc::Consumer<'_, ActivePiece<T>> {
    #[inline(always)]
    fn next_piece(&mut self, place: &mut Option<ActivePiece<T>>) -> bool {
        let Some(next) = self.peek() else { return false };
        *place = Some(*next);
        // A copy that nobody takes is none.
        let _ = self.dequeue();
        true
    }
}

/// What the executor is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum State {
    /// No path; the setpoint rests.
    Idle,
    /// On a path.
    Run,
    /// On a path, at the end of all pieces that have come; goes on with the next one.
    Starved,
    /// The path's last point was reached in this tick or before.
    Finished,
}

/// One axis-independent view of a tick, for traces and telemetry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place<T> {
    /// How many pieces the path has had before this one.
    pub piece: u32,
    /// The parameter on it, in -1/2..=1/2.
    pub tau: T,
    /// The rate of (21) at that parameter, in 1/s.
    pub rate: T,
    /// The point relative to the piece's origin, in mm.
    pub point: Complex<T>,
}

/// The state of the walk, from tick to tick.
#[derive(Clone, Copy, Debug)]
pub struct Executor<T> {
    tick: T,
    order: Order,
    state: State,
    active: Option<ActivePiece<T>>,
    entered: u32,
    tau: Accumulator<T>,
    rate: T,
    point: Complex<T>,
    setpoint: Position,
    spare: T,
}

impl<T: Real> Executor<T> {
    /// An executor that rests at `position`; `tick` is the period in s.
    pub const fn new(tick: T, position: Position) -> Self {
        Self {
            tick,
            order: Order::First,
            state: State::Idle,
            active: None,
            entered: 0,
            tau: Accumulator::new(T::ZERO),
            rate: T::ZERO,
            point: Complex::ZERO,
            setpoint: position,
            spare: T::ZERO,
        }
    }

    /// Takes the machine to stand at `position` from now on: where a path is about to begin.
    pub fn stand_at(&mut self, position: Position) {
        *self = Self::new(self.tick, position);
    }

    /// Begins a path: the next tick takes its first piece.
    pub fn start(&mut self, order: Order) {
        *self = Self { order, state: State::Run, ..Self::new(self.tick, self.setpoint) };
    }

    /// Leaves the path; the setpoint rests where it is.
    pub fn abort(&mut self) {
        *self = Self::new(self.tick, self.setpoint);
    }

    /// One tick: moves along the path by one period and returns the setpoint.
    ///
    /// Bounded by [`NODES_PER_TICK`] pieces; no panic, no lock, no allocation.
    #[inline(always)]
    pub fn tick(&mut self, pieces: &mut impl Pieces<T>) -> Position {
        if matches!(self.state, State::Run | State::Starved) {
            self.walk(pieces);
        }
        self.setpoint
    }

    #[inline(always)]
    fn walk(&mut self, pieces: &mut impl Pieces<T>) {
        let mut left = self.tick;
        let mut moved = false;
        if self.state == State::Run
            && let Some(piece) = &self.active
        {
            match advance(piece, &mut self.tau, self.rate, self.order, left) {
                None => moved = true,
                Some(rest) => left = rest,
            }
        }
        if !moved {
            self.cross_nodes(pieces, left);
        }
        let Some(piece) = &self.active else { return };
        if self.state == State::Finished {
            return;
        }
        let (point, rate) = piece.point_and_rate(self.tau.value());
        (self.point, self.rate) = (point, rate);
        let [x, y] = piece.place(point);
        self.setpoint = [x, y, self.setpoint[2]];
    }

    /// From the end of a piece into the next ones, with the time that is left.
    #[inline(never)]
    fn cross_nodes(&mut self, pieces: &mut impl Pieces<T>, mut left: T) {
        for _ in 0..NODES_PER_TICK {
            if let Some([x, y, _]) = self.active.as_ref().and_then(ActivePiece::last) {
                // Pieces are plane: an axis that they do not move stays where it is to the end.
                self.setpoint = [x, y, self.setpoint[2]];
                self.spare = left;
                self.state = State::Finished;
                self.tau = Accumulator::new(T::HALF);
                self.rate = T::ZERO;
                return;
            }
            if !pieces.next_piece(&mut self.active) {
                self.tau = Accumulator::new(T::HALF);
                self.state = State::Starved;
                return;
            }
            let Some(piece) = &self.active else { return };
            self.tau = Accumulator::new(-T::HALF);
            self.entered = self.entered.wrapping_add(1);
            self.state = State::Run;
            match advance(piece, &mut self.tau, piece.start_rate(), self.order, left) {
                None => return,
                Some(rest) => left = rest,
            }
        }
        // More nodes than a tick may cross: the rest of the time is given up, and the next tick begins at this node.
        self.tau = Accumulator::new(T::HALF);
    }

    /// What the executor is about.
    pub fn state(&self) -> State {
        self.state
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
        self.active.map_or(T::ZERO, |piece| piece.centre_speed(self.tau.value()) * self.rate)
    }

    /// The arc-length fraction u on the piece at which the last tick ended.
    pub fn fraction(&self) -> T {
        self.active.map_or(T::ZERO, |piece| piece.fraction(self.tau.value()))
    }

    /// The setpoint of the last tick.
    pub fn setpoint(&self) -> Position {
        self.setpoint
    }
}

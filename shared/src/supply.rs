//! Where the tick gets its pieces from, and how far they reach.
//!
//! A tick must know how much path time is queued, so that it can rest within it. Every piece says at which path time it ends
//! ([`ActivePiece::until`]), a sum that the loader makes; whoever fills a queue leaves how far the last one reaches beside it, in one
//! word ([`Sink`]), and the tick subtracts the end of the piece that it is on ([`Source`]).

use core::sync::atomic::{AtomicU32, Ordering};

use heapless::spsc::{Consumer, Producer};

use crate::active::ActivePiece;
use crate::real::Real;

/// The unit of [`PathTime`] in s: a thousandth of a tick.
const UNIT_S: f64 = 1.0 / UNITS_PER_S;
const UNITS_PER_S: f64 = 1_048_576.0;

/// What a piece counts at most, 8 s: longer than any stop. So a queue of 255 pieces stays below half the range.
const MOST_UNITS: u32 = 1 << 23;

/// The time along a path at its own feed, q = 1, up to some node: in units of 2^-20 s, modulo 2^32.
///
/// Only differences along one path say anything. A piece counts 8 s at most; it is rounded down, by a thousandth of a tick at
/// most, so that no sum says more than there is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PathTime(u32);

impl PathTime {
    /// The start of a path.
    pub const START: Self = Self(0);

    /// After a piece of `duration` s. Load time.
    pub fn after<T: Real>(duration: T) -> Self {
        let units = (duration.least(T::lit(8.0)) * T::lit(UNITS_PER_S) - T::HALF).to_int();
        Self(units.max(0).unsigned_abs().min(MOST_UNITS))
    }

    /// After this and then `other`. Load time.
    pub fn and(self, other: Self) -> Self {
        Self(self.0.wrapping_add(other.0))
    }

    /// After a path that does not come to rest at its end: as if it went on for 8 s.
    pub fn and_on(self) -> Self {
        Self(self.0.wrapping_add(MOST_UNITS))
    }

    /// The path time from `earlier` to this, in s; 0 where that is not earlier.
    #[inline(always)]
    pub fn since<T: Real>(self, earlier: Self) -> T {
        T::from_int((self.0.wrapping_sub(earlier.0) as i32).max(0)) * T::lit(UNIT_S)
    }
}

/// Where the tick gets its pieces from: a queue's consumer on the controller, a list in the simulator.
pub trait Pieces<T, const F: usize = 1> {
    /// Puts the next piece of the path into `place`, or leaves it alone and returns false where there is none. In place, because
    /// a piece is large beside the rest of a tick.
    fn next_piece(&mut self, place: &mut Option<ActivePiece<T, F>>) -> bool;

    /// How far the last piece reaches that has come, whether or not it was taken ([`ActivePiece::reach`]). None where nobody knows: the motion then relies on
    /// more to come, and stops dead where none does. A path that ends at rest needs a horizon.
    #[inline(always)]
    fn horizon(&self) -> Option<PathTime> {
        None
    }

    /// Drops what has come and was not taken, because the path was cancelled.
    fn discard(&mut self) {}
}

/// A function of its own, so that the compiler knows that the two do not overlap: that is 40 instructions less.
#[inline(never)]
fn copy<T: Copy>(place: &mut Option<T>, next: &T) {
    *place = Some(*next);
}

/// Pieces without a horizon.
impl<T: Copy, const F: usize> Pieces<T, F> for Consumer<'_, ActivePiece<T, F>> {
    #[inline(always)]
    fn next_piece(&mut self, place: &mut Option<ActivePiece<T, F>>) -> bool {
        let Some(next) = self.peek() else { return false };
        copy(place, next);
        // A copy that nobody takes is none.
        let _ = self.dequeue();
        true
    }

    fn discard(&mut self) {
        for _ in 0..self.capacity() {
            if self.dequeue().is_none() {
                return;
            }
        }
    }
}

/// The tick's end of a queue of pieces with a horizon.
pub struct Source<'a, T, const F: usize = 1> {
    pieces: Consumer<'a, ActivePiece<T, F>>,
    horizon: &'a AtomicU32,
}

impl<'a, T, const F: usize> Source<'a, T, F> {
    /// The consumer of a queue with the word beside it.
    pub fn new(pieces: Consumer<'a, ActivePiece<T, F>>, horizon: &'a AtomicU32) -> Self {
        Self { pieces, horizon }
    }
}

impl<T: Copy, const F: usize> Pieces<T, F> for Source<'_, T, F> {
    #[inline(always)]
    fn next_piece(&mut self, place: &mut Option<ActivePiece<T, F>>) -> bool {
        self.pieces.next_piece(place)
    }

    #[inline(always)]
    fn horizon(&self) -> Option<PathTime> {
        Some(PathTime(self.horizon.load(Ordering::Acquire)))
    }

    fn discard(&mut self) {
        self.pieces.discard();
    }
}

/// The loader's end of a queue of pieces with a horizon. It holds 255 pieces at most.
pub struct Sink<'a, T, const F: usize = 1> {
    pieces: Producer<'a, ActivePiece<T, F>>,
    horizon: &'a AtomicU32,
}

impl<'a, T: Real, const F: usize> Sink<'a, T, F> {
    /// The producer of a queue with the word beside it.
    pub fn new(pieces: Producer<'a, ActivePiece<T, F>>, horizon: &'a AtomicU32) -> Self {
        Self { pieces, horizon }
    }

    /// Forgets the path before: to be called before the first piece of a new one, with nothing in the queue.
    pub fn restart(&mut self) {
        self.horizon.store(PathTime::START.0, Ordering::Release);
    }

    /// Adds a piece, or gives it back where there is no room. The horizon moves after the piece has come, so that the tick never
    /// counts on one that is not there.
    pub fn push(&mut self, piece: ActivePiece<T, F>) -> Result<(), ActivePiece<T, F>> {
        let reach = piece.reach();
        self.pieces.enqueue(piece)?;
        self.horizon.store(reach.0, Ordering::Release);
        Ok(())
    }

    /// How many pieces there is room for.
    pub fn room(&self) -> usize {
        self.pieces.capacity() - self.pieces.len()
    }
}

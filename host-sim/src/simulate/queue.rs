//! The controller's queue of pieces, and a host that keeps it filled or does not.

use shared::active::ActivePiece;
use shared::executor::Pieces;
use shared::loader::{Loader, Motion};
use shared::piece::{Header, Piece};
use shared::real::Real;
use shared::supply::PathTime;

/// A queue never reaches farther ahead than this, in s of path time: times in it are told from each other up to half an hour.
const FARTHEST: f64 = 60.0;

/// All pieces of a path, of which the queue holds the next ones.
pub struct Queue<T> {
    pieces: Vec<ActivePiece<T>>,
    motion: Motion<T>,
    holds: usize,
    come: usize,
    taken: usize,
}

impl<T: Real> Queue<T> {
    /// A queue for `holds` pieces, empty. None where the loader refuses a piece.
    pub fn new(header: &Header<T>, pieces: impl Iterator<Item = Piece<T>>, holds: usize) -> Option<Self> {
        let mut loader = Loader::new(header, T::lit(f64::from(shared::TICK))).ok()?;
        let pieces = pieces.map(|piece| loader.load(&piece)).collect::<Result<_, _>>().ok()?;
        Some(Self { pieces, motion: loader.motion(), holds, come: 0, taken: 0 })
    }

    /// What begins this path.
    pub fn motion(&self) -> &Motion<T> {
        &self.motion
    }

    /// The host sends as many pieces as there is room for.
    pub fn fill(&mut self) {
        while self.come < self.pieces.len()
            && self.come - self.taken < self.holds
            && self.until(self.come).since::<f64>(self.until(self.taken)) < FARTHEST
        {
            self.come += 1;
        }
    }

    /// Whether everything that will ever come has come.
    pub fn is_complete(&self) -> bool {
        self.come == self.pieces.len()
    }

    /// The path time at the end of the first `count` pieces.
    fn until(&self, count: usize) -> PathTime {
        let last = count.checked_sub(1).and_then(|last| self.pieces.get(last));
        last.map_or(PathTime::START, ActivePiece::until)
    }
}

impl<T: Real> Pieces<T> for Queue<T> {
    fn next_piece(&mut self, place: &mut Option<ActivePiece<T>>) -> bool {
        let found = self.taken < self.come;
        if found {
            *place = self.pieces.get(self.taken).copied();
            self.taken += 1;
        }
        found
    }

    fn horizon(&self) -> Option<PathTime> {
        let last = self.come.checked_sub(1).and_then(|last| self.pieces.get(last));
        Some(last.map_or(PathTime::START, ActivePiece::reach))
    }

    fn discard(&mut self) {
        self.taken = self.come;
    }
}

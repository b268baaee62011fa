//! A queue whose filling a test decides: all pieces of a path, of which so many have come.

use shared::active::ActivePiece;
use shared::error::PathError;
use shared::executor::Pieces;
use shared::loader::{Loader, Motion};
use shared::piece::{Header, Piece};
use shared::real::Real;
use shared::supply::PathTime;

use crate::run::TICK;

/// Pieces that have passed the loader, and how many of them have come and were taken.
#[derive(Clone, Debug)]
pub struct Stock<'a, T, const F: usize = 1> {
    pieces: &'a [ActivePiece<T, F>],
    /// How many have come.
    pub come: usize,
    /// How many were taken.
    pub taken: usize,
    /// How many were dropped by a cancelled path.
    pub dropped: usize,
}

impl<'a, T, const F: usize> Stock<'a, T, F> {
    /// How many there are in all.
    pub fn all(&self) -> usize {
        self.pieces.len()
    }

    /// All of them are there.
    pub fn full(pieces: &'a [ActivePiece<T, F>]) -> Self {
        Self { pieces, come: pieces.len(), taken: 0, dropped: 0 }
    }
}

impl<T: Real, const F: usize> Pieces<T, F> for Stock<'_, T, F> {
    fn next_piece(&mut self, place: &mut Option<ActivePiece<T, F>>) -> bool {
        let next = self.pieces[..self.come].get(self.taken);
        self.taken += usize::from(next.is_some());
        *place = next.copied().or(*place);
        next.is_some()
    }

    fn horizon(&self) -> Option<PathTime> {
        Some(self.pieces[..self.come].last().map_or(PathTime::START, ActivePiece::reach))
    }

    fn discard(&mut self) {
        self.dropped += self.come - self.taken;
        self.taken = self.come;
    }
}

/// All pieces through the loader, and what begins their path.
pub fn prepare<T: Real, const F: usize>(
    header: &Header<T>,
    pieces: &[Piece<T, F>],
) -> Result<(Motion<T>, Vec<ActivePiece<T, F>>), PathError> {
    let mut loader = Loader::new(header, T::lit(TICK))?;
    let active = pieces.iter().map(|piece| loader.load(piece)).collect::<Result<_, _>>()?;
    Ok((loader.motion(), active))
}

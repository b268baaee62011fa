//! From a job to a path: the exact curves that the tool's centre follows, piece by piece, in f64.
//!
//! The exact path is what everything is measured against; [`PathPiece::wire`] makes of it what the controller gets.

mod drivable;
mod even;
mod piece;
mod route;
mod space;

use shared::error::PathError;
use shared::extent::SoftLimits;
use shared::fixed::{Fixed, Position, round_point};
use shared::loader::Loader;
use shared::pace::PaceLimits;
use shared::piece::{Header, Order, Piece};

use crate::input::InputError;
use crate::job::Job;
use crate::pacing;

pub use piece::PathPiece;
use route::Route;
pub use route::Trimmed;
pub use space::Space;

/// A path that the controller accepts: every piece has passed the loader in the controller's own precision.
#[derive(Clone, Debug)]
pub struct Path {
    /// The pieces in order.
    pub pieces: Vec<PathPiece>,
    /// What holds for all of them.
    pub header: Header<f32>,
    /// The weight, unrounded.
    pub weight: f64,
    /// The trimmed offset that the path was taken from; none where the job gives its pieces or has no offset.
    pub trimmed: Option<Trimmed>,
}

impl Path {
    /// Makes the path of a job: of its pieces, or of its contour, which is trimmed at its offset where there is one. Errors: an
    /// offset that leaves nothing or cannot be made, several loops without a choice, and whatever the loader refuses; with the
    /// place in the job's file.
    pub fn new(job: &Job, order: Order) -> Result<Self, InputError> {
        let Route { pieces, closed, trimmed } = Route::new(job)?;
        let header = Header {
            weight: job.feed.weight as f32,
            order,
            closed,
            // The controller sees points that are rounded to f32: a tenth of a micrometre on top.
            tolerance: (job.tolerance + 1e-4) as f32,
            rest: job.rest,
            pace: PaceLimits::USUAL,
        };
        let mut path = Self { pieces, header, weight: job.feed.weight, trimmed };
        path.header.pace = pacing::usual(&path);
        path.check().map_err(|(number, error)| match path.pieces.get(number) {
            Some(piece) => job.piece_error(number, piece.along, error),
            None => InputError::new(job.name(), error),
        })?;
        Ok(path)
    }

    /// Whether the whole path lies within a machine's travel, as the controller will ask. Errors: the first piece that leaves it,
    /// with the place in the job's file.
    pub fn check_travel(&self, job: &Job, limits: &SoftLimits) -> Result<(), InputError> {
        for (number, (piece, wire)) in self.pieces.iter().zip(self.wire()).enumerate() {
            limits.check(&wire).map_err(|error| job.piece_error(number, piece.along, error))?;
        }
        Ok(())
    }

    /// Loads the whole path as the controller will. Errors: the first piece that is refused, and why.
    fn check(&self) -> Result<(), (usize, PathError)> {
        let mut loader = Loader::new(&self.header, shared::TICK).map_err(|error| (0, error))?;
        for (number, piece) in self.wire().enumerate() {
            loader.load(&piece).map_err(|error| (number, error))?;
        }
        if loader.is_finished() { Ok(()) } else { Err((0, PathError::Empty)) }
    }

    /// Whether z moves anywhere.
    pub fn moves_z(&self) -> bool {
        self.pieces.iter().any(PathPiece::moves_z)
    }

    /// Whether its pieces have their feed over time.
    pub fn is_planned(&self) -> bool {
        self.pieces.iter().any(|piece| piece.profile.is_some())
    }

    /// The exact last point; z is 0 where the path does not speak of it.
    pub fn end(&self) -> Position {
        self.pieces.last().map_or([Fixed(0); 3], |piece| rounded(piece, piece.interval[1]))
    }

    /// The exact first point.
    pub fn start(&self) -> Position {
        self.pieces.first().map_or([Fixed(0); 3], |piece| rounded(piece, piece.interval[0]))
    }

    /// The pieces as the controller gets them.
    pub fn wire(&self) -> impl Iterator<Item = Piece<f32>> {
        self.in_order().map(|(piece, last)| piece.wire(last))
    }

    /// The pieces for the f64 twin.
    pub fn exact(&self) -> impl Iterator<Item = Piece<f64>> {
        self.in_order().map(|(piece, last)| piece.exact(last))
    }

    fn in_order(&self) -> impl Iterator<Item = (&PathPiece, Option<Position>)> {
        let count = self.pieces.len();
        self.pieces.iter().enumerate().map(move |(k, piece)| (piece, (k + 1 == count).then(|| self.end())))
    }

    /// The length on C in mm.
    pub fn contact_length(&self) -> f64 {
        self.pieces.iter().map(PathPiece::contact_length).sum()
    }

    /// The length of the centre's way in mm.
    pub fn centre_length(&self) -> f64 {
        self.pieces.iter().map(PathPiece::centre_length).sum()
    }
}

/// The centre at a parameter of a piece.
fn rounded(piece: &PathPiece, xi: f64) -> Position {
    let [x, y] = round_point(piece.point(xi));
    [x, y, Fixed::from_mm(piece.z(xi).unwrap_or(0.0))]
}

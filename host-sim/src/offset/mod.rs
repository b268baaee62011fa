//! The exact trimmed offset of any contour: the path of a tool's centre that touches the part and never cuts into it.

mod assemble;
mod bury;
mod crossing;
mod field;
mod foot;
mod ground;
mod nesting;
mod reach;
mod roots;
mod strand;
mod stretch;
mod trace;
mod undercut;

use std::fmt;

use serde::Serialize;
use shared::complex::Complex;

use ground::Ground;
use reach::Reach;
use trace::trace;

pub use crate::contour::{Along, Contour};

/// The trimmed offset: all points of the untrimmed one that are nowhere nearer to C than |d|.
#[derive(Clone, Debug, PartialEq)]
pub struct Offset {
    /// The signed distance d of equation (2), positive right of travel, in mm.
    pub distance: f64,
    /// In the order in which their first pieces stand along C; at least one.
    pub loops: Vec<Loop>,
}

/// One connected run of the trimmed offset.
#[derive(Clone, Debug, PartialEq)]
pub struct Loop {
    /// Whether it ends where it starts. Offsets of a closed contour always do.
    pub closed: bool,
    /// In order of travel; the first one is the one that stands first along C.
    pub pieces: Vec<Piece>,
    /// Its length, in mm.
    pub length: f64,
    /// The signed area that a closed loop encloses, positive anticlockwise, in mm^2; 0 of an open one.
    pub area: f64,
    /// The loop just around it, if it lies inside another one.
    pub parent: Option<usize>,
    /// How many loops lie around it.
    pub depth: usize,
}

/// A part of a loop along one segment or fill arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// What it runs along.
    pub along: Along,
    /// Its first point, in mm.
    pub start: Complex<f64>,
    /// Its last point, in mm.
    pub end: Complex<f64>,
    /// The turn of the tangent from the piece before into this one, in radians, positive anticlockwise; 0 at the start of an
    /// open loop.
    pub start_turn: f64,
    /// The turn into the next piece; 0 at the end of an open loop.
    pub end_turn: f64,
}

/// A part of C that the tool cannot touch: the part keeps material there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Undercut {
    /// Segment and parameter where it begins.
    pub from: (usize, f64),
    /// Segment and parameter where it ends; behind the end of a closed contour it goes on at its start.
    pub to: (usize, f64),
    /// The thickness of the material that is left, at its thickest, in mm.
    pub depth: f64,
    /// The point of C where that is.
    pub deepest: Complex<f64>,
}

/// Why there is no trimmed offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OffsetError {
    /// The distance is zero or not a number.
    Distance,
    /// The contour crosses itself.
    Crossing {
        /// The segments that cross.
        segments: [usize; 2],
        /// Where, in mm.
        at: Complex<f64>,
    },
    /// A segment stands still and turns back inside itself: its parametric speed vanishes.
    Cusp {
        /// Its number.
        segment: usize,
    },
    /// At a node the contour goes back the way it came.
    Reversal {
        /// The node at the end of the segment of this number.
        node: usize,
    },
    /// Nothing of the offset is left.
    Empty {
        /// The largest |d| on this side that would leave a path, in mm.
        largest: f64,
    },
    /// Pieces were found that do not join to loops, at every one of a few distances within 1e-9 of the given one.
    Degenerate,
}

impl fmt::Display for OffsetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self:?}")
    }
}

impl std::error::Error for OffsetError {}

/// By how much |d| is changed, relatively, to find which pieces there are; one after the other until they join.
///
/// A tool that just fits a slot, a node that falls on a trim point, three walls at one distance: exactly at d such a thing can be
/// decided neither way, a little beside it it can. The first one is a little smaller, so that a tool that just fits does fit.
/// Trim points are made exact at d afterwards, and no clearance falls short of |d| by more than this.
const NUDGES: [f64; 8] = [-1e-11, -3.1e-11, 1.7e-11, -7.3e-11, 5.3e-11, -1.9e-10, 2.3e-10, -6.1e-10];

/// The trimmed offset of `contour` at the signed `distance` in mm.
pub fn trim(contour: &Contour, distance: f64) -> Result<Offset, OffsetError> {
    if !(distance != 0.0 && distance.is_finite()) {
        return Err(OffsetError::Distance);
    }
    let ground = Ground::new(contour, distance)?;
    ground.check_simple()?;
    let exact = ground.to_frame(distance);
    for nudge in NUDGES {
        let Ok(traced) = trace(&ground, exact * (1.0 + nudge)) else { continue };
        let loops = assemble::loops(contour, &ground, &traced, distance);
        if loops.is_empty() {
            return Err(OffsetError::Empty { largest: largest_fitting(contour, distance) });
        }
        return Ok(Offset { distance, loops });
    }
    Err(OffsetError::Degenerate)
}

/// Where the tool of `offset` leaves material on `contour`, in order along C.
pub fn undercuts(contour: &Contour, offset: &Offset) -> Vec<Undercut> {
    Ground::new(contour, offset.distance).map_or_else(|_| Vec::new(), |ground| undercut::undercuts(&ground, offset))
}

/// The radius of the largest tool that reaches every point of `contour` from the side of `side`'s sign (positive: right of
/// travel), in mm; 0 where a sharp concave corner keeps every tool out, infinite where none is too large. Good to 1e-7 of itself.
pub fn largest_reaching(contour: &Contour, side: f64) -> f64 {
    Ground::new(contour, 0.0).map_or(0.0, |ground| ground.to_mm(Reach::new(&ground, side).everywhere()))
}

/// The radius of the largest tool that touches any point of `contour` from that side, in mm; infinite where none is too large.
pub fn largest_fitting(contour: &Contour, side: f64) -> f64 {
    Ground::new(contour, 0.0).map_or(0.0, |ground| ground.to_mm(Reach::new(&ground, side).anywhere()))
}

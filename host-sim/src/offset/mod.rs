//! The exact trimmed offset of any contour: the path of a tool's centre that touches the part and never cuts into it.

mod assemble;
mod bury;
mod close;
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
use crate::units::Units;

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

impl OffsetError {
    /// What was found and what would do, in one sentence, for an offset at `distance` mm; its lengths are in `units`.
    pub fn sentence(&self, distance: f64, units: Units) -> String {
        self.describe(&format!(" at distance {}", units.length(distance)), units)
    }

    /// The sentence with `at_distance` behind what is so at this distance alone.
    fn describe(&self, at_distance: &str, units: Units) -> String {
        let point = |at| units.point(at);
        match *self {
            Self::Distance => "the offset distance is zero or not a number; give the radius of a tool".to_string(),
            Self::Crossing { segments: [one, other], at } if one == other => {
                format!("the contour crosses itself: segment {one} does at {}; {UNCROSSED}", point(at))
            }
            Self::Crossing { segments: [one, other], at } => {
                format!("the contour crosses itself: segments {one} and {other} meet at {}; {UNCROSSED}", point(at))
            }
            Self::Cusp { segment } => format!(
                "segment {segment} stands still inside and turns back there, so it has no normal; make two segments of it"
            ),
            Self::Reversal { node } => format!(
                "at node {node}, where segment {node} ends, the contour goes back the way it came; no tool fits in between, \
                 so leave the way back out or keep it apart"
            ),
            Self::Empty { largest } if largest > 0.0 => {
                format!("no path is left{at_distance}: the largest tool that fits has radius {}", units.length(largest))
            }
            Self::Empty { .. } => format!("no path is left{at_distance}: no tool fits on this side of the contour"),
            Self::Degenerate => format!(
                "the offset{at_distance} is degenerate: its pieces do not join to loops, nor do those within 1e-9 of it; a \
                 slightly different distance will do"
            ),
        }
    }
}

const UNCROSSED: &str = "only a contour that does not cross itself has a tool side and a part side";

/// As [`OffsetError::sentence`] in mm, but without the distance, which an error does not know.
impl fmt::Display for OffsetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.describe("", Units::Mm))
    }
}

impl std::error::Error for OffsetError {}

/// How often another |d| and another turn of the frame are tried where pieces do not join, or where some are missing.
const ATTEMPTS: u32 = 32;

/// By how much |d| is changed, relatively, to find which pieces there are, and by how much the frame is turned, in radians.
///
/// A tool that just fits a slot, a node that falls on a trim point, three walls at one distance: exactly at d such a thing can be
/// decided neither way, a little beside it it can. The first change is to a little less, so that a tool that just fits does fit.
/// Trim points are made exact at d afterwards, and no clearance falls short of |d| by more than 6.4e-10 of it. Turning, by the
/// golden angle, lets rounding fall differently.
fn attempt(number: u32) -> (f64, f64) {
    let side = if number.is_multiple_of(2) { -1.0 } else { 1.0 };
    let number = f64::from(number);
    (side * 1e-11 * (1.0 + 1.97 * number), 2.399_963_229_728_653 * number)
}

/// The trimmed offset of `contour` at the signed `distance` in mm.
pub fn trim(contour: &Contour, distance: f64) -> Result<Offset, OffsetError> {
    if !(distance != 0.0 && distance.is_finite()) {
        return Err(OffsetError::Distance);
    }
    let mut ground = Ground::new(contour, distance, 0.0)?;
    ground.check_simple()?;
    let exact = ground.to_frame(distance);
    let mut best: Option<(usize, Vec<Loop>)> = None;
    for number in 0..ATTEMPTS {
        let (nudge, angle) = attempt(number);
        if number > 0 {
            ground = Ground::new(contour, distance, angle)?;
        }
        let Ok(traced) = trace(&ground, exact * (1.0 + nudge)) else { continue };
        if best.as_ref().is_none_or(|&(lost, _)| traced.lost < lost) {
            best = Some((traced.lost, assemble::loops(contour, &ground, &traced, distance)));
        }
        if traced.lost == 0 {
            break;
        }
    }
    match best {
        Some((_, loops)) if !loops.is_empty() => Ok(Offset { distance, loops }),
        Some(_) => {
            // The discs are good to 1e-7; that this one does not fit is certain.
            let largest = largest_fitting(contour, distance).min(distance.abs() * (1.0 - 1e-9));
            Err(OffsetError::Empty { largest })
        }
        None => Err(OffsetError::Degenerate),
    }
}

/// Where the tool of `offset` leaves material on `contour`, in order along C.
pub fn undercuts(contour: &Contour, offset: &Offset) -> Vec<Undercut> {
    Ground::new(contour, offset.distance, 0.0)
        .map_or_else(|_| Vec::new(), |ground| undercut::undercuts(&ground, offset))
}

/// The radius of the largest tool that reaches every point of `contour` from the side of `side`'s sign (positive: right of
/// travel), in mm; 0 where a sharp concave corner keeps every tool out, infinite where none is too large. Good to 1e-7 of itself.
pub fn largest_reaching(contour: &Contour, side: f64) -> f64 {
    Ground::new(contour, 0.0, 0.0).map_or(0.0, |ground| ground.to_mm(Reach::new(&ground, side).everywhere()))
}

/// The radius of the largest tool that touches any point of `contour` from that side, in mm; infinite where none is too large.
pub fn largest_fitting(contour: &Contour, side: f64) -> f64 {
    Ground::new(contour, 0.0, 0.0).map_or(0.0, |ground| ground.to_mm(Reach::new(&ground, side).anywhere()))
}

//! The exact trimmed offset of any contour: the path of a tool's centre that touches the part and never cuts into it.
//!
//! Nothing is made of small lines. Every piece of the result is a part of a segment of the contour at the distance d, or of the arc
//! about a node; what is computed is where it begins and ends.
//!
//! <div style="max-width: 32rem">
#![doc = include_str!("../../../docs/trimming.svg")]
//! </div>
//!
//! `hodograph offset examples/farouki2018.toml --svg docs/trimming.svg` draws this picture.
//!
//! # How trimming works
//!
//! 1. `ground`: the contour is moved and scaled into a frame in which it has size 1, and cut into *stretches* (`stretch`) along which
//!    the tangent turns one way by at most 45 degrees and the curvature grows or falls all the way. All certainty below comes from
//!    that. They go into a spatial index (`field`). A contour that crosses itself is found here.
//! 2. `strand`: the untrimmed offset in *strands*, the stretches of it that run forwards: 1 + kappa d > 0. Where it runs backwards,
//!    kappa < -1/d, nothing can ever be kept; cutting there takes the trivial root away from every equation that follows. Convex
//!    nodes are filled by arcs about the node, concave ones leave two ends that pass each other (equation (3)).
//! 3. `bury`: a strand whose middle is nearer to C than |d|, by more than the way to its ends, is left out.
//! 4. `crossing`: all crossings of the strands that are left. Two strands are graphs over a common axis, and their slopes at the ends of
//!    a part bound them in between, so crossings are counted with certainty and made exact by Newton's method; the touching of two
//!    strands whose gap is 1e-13 of the contour's size is told from their crossing. What is flatter than that is joined by `flat`.
//! 5. `trace`: at a crossing one strand passes into the reach of the other. So a fragment is kept if it begins where its strand comes
//!    out, ends where it passes in, and is not covered by anything else, which its distance from C tells (`foot`). At each crossing
//!    exactly one kept fragment ends and one begins: they join to loops by themselves. If they do not, or if a clear strand is part
//!    of no loop, something fell within rounding, and d is changed by some 1e-11 of itself, the frame is turned, and it all is done
//!    again.
//! 6. `assemble`: trim points are made exact at d; lengths and areas in closed form, turning angles, nesting (`nesting`).
//!
//! With a tree at every step the cost grows as n log n with the number of segments, and with the number of crossings (measured by
//! `cargo bench -p host-sim --bench offset`).
//!
//! What is lost and what would fit is told by discs that touch C from the tool's side (`reach`) and by the distance of C from the
//! finished path (`undercut`). [`crate::measure::clearance`] measures a result again without any of this code.

mod assemble;
mod bury;
mod crossing;
mod error;
mod field;
mod flat;
mod foot;
mod golden;
mod ground;
mod nesting;
mod reach;
mod roots;
mod strand;
mod stretch;
mod trace;
mod undercut;

use serde::Serialize;
use shared::complex::Complex;

use ground::Ground;
use reach::Reach;
use trace::trace;

pub use crate::contour::{Along, Contour};
pub use error::OffsetError;

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

/// How often another |d| and another turn of the frame are tried where pieces do not join, or where some are missing.
const ATTEMPTS: u32 = 96;

/// By how much |d| is changed, relatively, to find which pieces there are, and by how much the frame is turned, in radians.
///
/// A tool that just fits a slot, a node that falls on a trim point, three walls at one distance: exactly at d such a thing can be
/// decided neither way, a little beside it it can. The first change is to a little less, so that a tool that just fits does fit.
/// Trim points are made exact at d afterwards, and no clearance falls short of |d| by more than 6.3e-10 of it. Turning, by the
/// golden angle, lets rounding fall differently.
fn attempt(number: u32) -> (f64, f64) {
    let side = if number.is_multiple_of(2) { -1.0 } else { 1.0 };
    let number = f64::from(number);
    (side * 1e-11 * (1.0 + 0.65 * number), 2.399_963_229_728_653 * number)
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
        let Ok(traced) = trace(&ground, exact * (1.0 + nudge), number % 4 == 3) else { continue };
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
            let largest = largest_fitting(contour, distance).min(distance.abs() * (1.0 - 1e-11));
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

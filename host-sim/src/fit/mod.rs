//! Curves for the polylines of programs.
//!
//! A program of CAM is thousands of short lines that stand for a curve. Here the curve is found again, under a tolerance that holds both
//! ways: no point of the polyline is farther from the curve, and no point of the curve is farther from the polyline.
//!
//! | module | what |
//! | --- | --- |
//! | [`vector`], [`curve`] | points and polynomial curves in space |
//! | `corners` | where a polyline is smooth, and what of it is straight (SA 3) |
//! | `tangent` | its tangent at a vertex |
//! | `conditions` | both conditions on a curve (SA 1, SA 2), as an upper bound |
//! | `piecewise` | cubics with common tangents, as published |

mod conditions;
mod corners;
pub mod curve;
mod piecewise;
mod tangent;
pub mod vector;

use curve::{Bezier, Cubic};
use vector::Vector;

/// What is laid through a polyline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Cubics with common tangents.
    Bezier,
}

/// One curve of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Curve {
    /// A line.
    Line(Bezier<2>),
    /// A cubic.
    Cubic(Cubic),
}

/// A part of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// The curve.
    pub curve: Curve,
    /// The numbers of the polyline's vertices at its ends.
    pub vertices: [usize; 2],
    /// An upper bound of how far curve and polyline are apart anywhere, in mm.
    pub deviation: f64,
}

/// Fits curves to a polyline, none of whose points is repeated, within a tolerance in mm.
pub fn fit(points: &[Vector], kind: Kind, tolerance: f64) -> Vec<Part> {
    if points.len() < 2 {
        return Vec::new();
    }
    match kind {
        Kind::Bezier => piecewise::fit(points, tolerance),
    }
}

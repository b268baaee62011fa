//! How smoothly the curves of a fit go on from one to the next, from the curves themselves.

use super::curve::{Bezier, Local};
use super::{Curve, Part};
use crate::vector::Vector;

/// The largest breaks where curves should go on smoothly.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Joins {
    /// Of the direction, in radians.
    pub tangent: f64,
    /// Of the curvature as a vector, as a part of the larger one.
    pub curvature: f64,
}

/// A curvature that counts as this much at least, in 1/mm: 1 m of radius is straight.
pub(super) const STRAIGHT: f64 = 1e-3;

/// Measures all joins but those at corners; that of the last part to the first where a loop is closed smoothly.
pub fn joins(parts: &[Part]) -> Joins {
    let mut found = Joins::default();
    let closing = parts.last().into_iter().chain(parts);
    for (before, after) in closing.zip(parts) {
        if !after.is_smooth {
            continue;
        }
        let here = break_between(&before.curve.at(1.0), &after.curve.at(0.0));
        found.tangent = found.tangent.max(here.tangent);
        found.curvature = found.curvature.max(here.curvature);
    }
    found
}

/// The breaks from one curve's end to another's start; none of a direction that a curve does not have.
pub fn break_between(end: &Local, start: &Local) -> Joins {
    let angle = |(a, b): (Vector, Vector)| a.cross(b).norm().atan2(a.dot(b));
    let (a, b) = (end.curvature(), start.curvature());
    let largest = a.norm().max(b.norm()).max(STRAIGHT);
    Joins { tangent: end.tangent().zip(start.tangent()).map_or(0.0, angle), curvature: (a - b).norm() / largest }
}

impl Curve {
    /// Where it is at a parameter of 0..=1.
    pub fn at(&self, t: f64) -> Local {
        match self {
            Self::Line(line) => line.at(t),
            Self::Cubic(cubic) => Bezier::at(cubic, t),
            Self::Ph(ph) => ph.bezier().at(t),
            Self::Arc(arc) => arc.at(t),
        }
    }
}

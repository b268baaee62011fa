//! Where a closed polyline goes on smoothly at its start: the derivatives that both ends of a fit share there.

use super::bspline;
use super::corners::{Vertex, sagittas};
use super::polyline::Polyline;
use crate::vector::Vector;

/// The most vertices on each side that are looked at.
const MOST: usize = 96;

/// The fewest on each side of a loop.
const FEWEST: usize = 4;

/// The part of the tolerance that the spline over the seam may be off.
const SPLINE: f64 = 0.4;

/// The first and the second derivative by the way at the first and last point of a closed polyline, from a spline over it. None where the
/// polyline is open, or has a corner there.
pub(super) fn seam(points: &[Vector], kinds: &[Vertex], tolerance: f64) -> Option<[Vector; 2]> {
    let last = points.len() - 1;
    if last < 2 * FEWEST || points[0] != points[last] {
        return None;
    }
    let bends = sagittas(points[last - 1], points[0], points[1]);
    if bends.iter().any(|sagitta| *sagitta > tolerance) {
        return None;
    }
    // Up to the next vertex on each side that is not within a curve.
    let most = MOST.min(last / 2);
    let after = (1..=most).find(|&k| kinds[k] != Vertex::Smooth).unwrap_or(most);
    let before = (1..=most).find(|&k| kinds[last - k] != Vertex::Smooth).unwrap_or(most);
    if after < FEWEST || before < FEWEST {
        return None;
    }
    let around: Vec<Vector> = points[last - before..].iter().chain(&points[1..=after]).copied().collect();
    let line = Polyline::new(&around);
    let fitted = bspline::fit(&line, SPLINE * tolerance).ok()?;
    let at = fitted.at(line.ways[before]);
    Some([at.first, at.second])
}

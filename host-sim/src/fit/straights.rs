//! Long straight segments of a polyline: they stay lines, and the curves on both sides begin and end on them with their direction and without
//! curvature.
//!
//! A segment whose deflection (SA 3) is above the tolerance is no chord of a curve. The way from straight to bent needs a part of it: at
//! continuous curvature a bend of radius R that is begun over a way w passes its circle at about w^2/(24 R), so the curves begin
//! [`LEAD`] times sqrt(R tolerance) before the segment's end.

use std::ops::Range;

use super::corners::sagittas;
use crate::vector::Vector;

/// Half of the way over which a bend begins, in parts of sqrt(R tolerance); the other half lies on the bend.
const LEAD: f64 = 3.0;

/// The part of a segment that a lead takes at most.
const MOST: f64 = 0.3;

/// A segment that stays straight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Straight {
    /// Its number: that of the vertex where it begins.
    pub segment: usize,
    /// Where the line begins and ends.
    pub ends: [Vector; 2],
    /// Its direction.
    pub direction: Vector,
    /// Whether a curve leads to it and from it: otherwise there is the end of the run.
    pub is_led: [bool; 2],
}

/// The straight segments of the vertices `run` between two corners, in order.
pub(super) fn straights(points: &[Vector], run: Range<usize>, tolerance: f64) -> Vec<Straight> {
    let (first, last) = (run.start, run.end - 1);
    let at = |segment: usize| {
        let [from, to] = [points[segment], points[segment + 1]];
        let is_led = [segment > first, segment + 1 < last];
        let mut leads = [0.0; 2];
        if is_led[0] {
            let deflection = sagittas(points[segment - 1], from, to)[1];
            let bend = segment.checked_sub(2).filter(|&k| k >= first).map(|k| radius(&points[k..=segment]))?;
            leads[0] = (deflection > tolerance).then(|| LEAD * (bend * tolerance).sqrt())?;
        }
        if is_led[1] {
            let deflection = sagittas(from, to, points[segment + 2])[0];
            let bend = (segment + 3 <= last).then(|| radius(&points[segment + 1..=segment + 3]))?;
            leads[1] = (deflection > tolerance).then(|| LEAD * (bend * tolerance).sqrt())?;
        }
        let length = (to - from).norm();
        let is_long = is_led != [false; 2] && leads.iter().all(|&lead| lead < MOST * length);
        let direction = (to - from) * (1.0 / length);
        let ends = [from + direction * leads[0], to - direction * leads[1]];
        is_long.then_some(Straight { segment, ends, direction, is_led })
    };
    (first..last).filter_map(at).collect()
}

/// The radius of the circle through three vertices.
fn radius(points: &[Vector]) -> f64 {
    let [a, b, c] = [points[0], points[1], points[2]];
    let (before, after, whole) = (b - a, c - b, c - a);
    0.5 * before.norm() * after.norm() * whole.norm() / before.cross(after).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line of 10 mm between two bends of 2 mm: it begins and ends where their ways do.
    #[test]
    fn a_side_between_two_bends_stays_straight() {
        let on = |k: i32| (0.1 * f64::from(k)).sin_cos();
        let mut points: Vec<Vector> =
            (0..=8).rev().map(|k| on(-k)).map(|(s, c)| Vector([2.0 * s, 2.0 - 2.0 * c, 1.0])).collect();
        points.extend((0..=8).map(on).map(|(s, c)| Vector([10.0 + 2.0 * s, 2.0 - 2.0 * c, 1.0])));
        let found = straights(&points, 0..points.len(), 0.01);
        let [Straight { segment: 8, ends, direction, is_led: [true, true] }] = found[..] else { panic!("{found:?}") };
        let lead = LEAD * 0.02_f64.sqrt();
        assert!(
            (ends[0] - Vector([lead, 0.0, 1.0])).norm() < 1e-9
                && (ends[1] - Vector([10.0 - lead, 0.0, 1.0])).norm() < 1e-9
        );
        assert!((direction - Vector([1.0, 0.0, 0.0])).norm() < 1e-12);
    }
}

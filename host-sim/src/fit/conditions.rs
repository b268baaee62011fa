//! The two conditions on a curve that stands for a polyline [Bolsunovsky & Vermel, (SA 1) and (SA 2)]: no point of the polyline is farther
//! from the curve than the tolerance, and no point of the curve is farther from the polyline.
//!
//! Each vertex has a foot point on the curve, in order. The vertex is as far from it as the distance says. Between two feet the curve is
//! within the hull of its control points there, whose distance from the polyline's segment bounds its own; and since the curve goes all the
//! way from foot to foot, no point of the segment is farther from it than that. So one walk bounds both directions.

use super::curve::Bezier;
use super::vector::Vector;

/// What a walk along curve and polyline found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Walk {
    /// An upper bound of both deviations in mm.
    pub deviation: f64,
    /// The part of it that is at vertices.
    pub vertices: f64,
}

/// Newton's steps to a foot point.
const STEPS: usize = 3;

/// A step in the parameter that ends them.
const STILL: f64 = 1e-6;

/// How often a piece of a curve is halved where its hull is too far from its segment.
const HALVINGS: u32 = 3;

/// Walks along a curve and the polyline whose ends stand for its ends. `feet` are guesses of the vertices' foot points from 0 to 1, which are
/// improved. None as soon as something is farther off than `most`.
pub(super) fn walk<const N: usize>(
    curve: &Bezier<N>,
    points: &[Vector],
    feet: &mut [f64],
    tolerance: f64,
    most: f64,
) -> Option<Walk> {
    let (mut rest, mut behind) = (*curve, 0.0);
    let last = points.len() - 1;
    let ends = (curve.points[0] - points[0]).norm().max((curve.points[N - 1] - points[last]).norm());
    let mut found = Walk { deviation: ends, vertices: ends };
    for k in 1..last {
        let foot = foot(curve, points[k], feet[k]).clamp(behind, 1.0);
        feet[k] = foot;
        let part = if behind < 1.0 { ((foot - behind) / (1.0 - behind)).clamp(0.0, 1.0) } else { 1.0 };
        let [piece, after] = rest.split(part);
        found.vertices = found.vertices.max((after.points[0] - points[k]).norm());
        found.deviation = found.deviation.max(hull(&piece, points[k - 1], points[k], tolerance, HALVINGS));
        if found.vertices > most || found.deviation > most {
            return None;
        }
        (rest, behind) = (after, foot);
    }
    let [before, end] = [points[last - 1], points[last]];
    found.deviation = found.deviation.max(hull(&rest, before, end, tolerance, HALVINGS)).max(found.vertices);
    (found.deviation <= most).then_some(found)
}

/// The parameter nearest to a point, from a guess.
fn foot<const N: usize>(curve: &Bezier<N>, point: Vector, guess: f64) -> f64 {
    let mut t = guess;
    for _ in 0..STEPS {
        let at = curve.at(t);
        let off = at.point - point;
        let (slope, bend) = (off.dot(at.first), at.first.dot(at.first) + off.dot(at.second));
        if bend <= 0.0 {
            break;
        }
        let next = (t - slope / bend).clamp(0.0, 1.0);
        let step = (next - t).abs();
        t = next;
        if step < STILL {
            break;
        }
    }
    t
}

/// How far a piece is from a segment at the most.
fn hull<const N: usize>(piece: &Bezier<N>, from: Vector, to: Vector, tolerance: f64, halvings: u32) -> f64 {
    let bound = piece.from_segment(from, to);
    if bound <= tolerance || halvings == 0 {
        return bound;
    }
    let halves = piece.split(0.5);
    halves.iter().map(|half| hull(half, from, to, tolerance, halvings - 1)).fold(0.0, f64::max)
}

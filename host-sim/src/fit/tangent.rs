//! The tangent of the curve that a polyline stands for, at one of its vertices.
//!
//! A parabola through the vertex, over the way along the polyline, fitted to as many neighbours as it follows: with three vertices it is the
//! finite difference of the paper. More of them, where they lie on a curve, average out what a program's digits have rounded away.

use super::polyline::Polyline;
use crate::vector::Vector;

/// The most neighbours on one side.
const MOST: usize = 32;

/// The unit tangent at vertex `k` of a run of at least two points. The parabola stays within `tolerance` of the neighbours that it is
/// fitted to, unless there is only one on each side.
pub(super) fn tangent(run: &Polyline<'_>, k: usize, tolerance: f64) -> Option<Vector> {
    let mut best = None;
    let mut half = 1;
    let mut sums = Sums::default();
    let (mut low, mut high) = (k, k);
    let last = run.points.len() - 1;
    while half <= MOST {
        let wider = [k.saturating_sub(half), (k + half).min(last)];
        for j in (wider[0]..low).chain(high + 1..=wider[1]) {
            sums.add(run.ways[j] - run.ways[k], run.points[j] - run.points[k]);
        }
        [low, high] = wider;
        let (slope, bend) = sums.parabola(high - low > 1)?;
        let is_near = |j: usize| {
            let s = run.ways[j] - run.ways[k];
            let off = run.points[j] - run.points[k] - slope * s - bend * (s * s);
            off.dot(off) <= tolerance * tolerance
        };
        if best.is_some() && !(low..=high).all(is_near) {
            break;
        }
        best = Some(slope);
        if (low, high) == (0, last) {
            break;
        }
        half *= 2;
    }
    best?.unit()
}

/// Sums for the least squares of slope s + bend s^2.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    powers: [f64; 3],
    right: [Vector; 2],
}

impl Sums {
    fn add(&mut self, s: f64, off: Vector) {
        let square = s * s;
        let [s2, s3, s4] = self.powers;
        self.powers = [s2 + square, s3 + square * s, s4 + square * square];
        self.right = [self.right[0] + off * s, self.right[1] + off * square];
    }

    /// Slope and bend of the parabola that is nearest to all; a straight line where it may not bend, or data leave the bend open.
    fn parabola(&self, bends: bool) -> Option<(Vector, Vector)> {
        let ([s2, s3, s4], [r1, r2]) = (self.powers, self.right);
        let determinant = s2 * s4 - s3 * s3;
        if bends && determinant > 1e-9 * s2 * s4 {
            let inverse = 1.0 / determinant;
            Some(((r1 * s4 - r2 * s3) * inverse, (r2 * s2 - r1 * s3) * inverse))
        } else {
            (s2 > 0.0).then(|| (r1 * (1.0 / s2), Vector::default()))
        }
    }
}

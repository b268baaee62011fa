//! The tangent of the curve that a polyline stands for, at one of its vertices.
//!
//! A parabola through the vertex, over the way along the polyline, fitted to as many neighbours as it follows: with three vertices it is the
//! finite difference of the paper. More of them, where they lie on a curve, average out what a program's digits have rounded away.

use super::vector::Vector;

/// The most neighbours on one side.
const MOST: usize = 32;

/// The unit tangent at vertex `k` of a run of at least two points. The parabola stays within `tolerance` of the neighbours that it is
/// fitted to, unless there is only one on each side.
pub(super) fn tangent(run: &[Vector], k: usize, tolerance: f64) -> Option<Vector> {
    let mut best = None;
    let mut half = 1;
    while half <= MOST {
        let (low, high) = (k.saturating_sub(half), (k + half).min(run.len() - 1));
        let (slope, worst) = parabola(&run[low..=high], k - low)?;
        if best.is_some() && worst > tolerance {
            break;
        }
        best = Some(slope);
        if (low, high) == (0, run.len() - 1) {
            break;
        }
        half *= 2;
    }
    best?.unit()
}

/// The slope at point `k` of the parabola through it that is nearest to the others, and how far it is from them. With one other point a
/// straight line.
fn parabola(points: &[Vector], k: usize) -> Option<(Vector, f64)> {
    let origin = points[k];
    let (mut ways, mut way) = (Vec::with_capacity(points.len()), 0.0);
    for (j, point) in points.iter().enumerate() {
        way += if j > 0 { (*point - points[j - 1]).norm() } else { 0.0 };
        ways.push(way);
    }
    let zero = ways[k];
    // Least squares of slope s + bend s^2.
    let (mut s2, mut s3, mut s4) = (0.0, 0.0, 0.0);
    let (mut r1, mut r2) = (Vector::default(), Vector::default());
    for (point, way) in points.iter().zip(&ways) {
        let (s, off) = (way - zero, *point - origin);
        let square = s * s;
        (s2, s3, s4) = (s2 + square, s3 + square * s, s4 + square * square);
        (r1, r2) = (r1 + off * s, r2 + off * square);
    }
    let determinant = s2 * s4 - s3 * s3;
    let (slope, bend) = if points.len() > 2 && determinant > 1e-9 * s2 * s4 {
        ((r1 * s4 - r2 * s3) * (1.0 / determinant), (r2 * s2 - r1 * s3) * (1.0 / determinant))
    } else if s2 > 0.0 {
        (r1 * (1.0 / s2), Vector::default())
    } else {
        return None;
    };
    let off = |(point, way): (&Vector, &f64)| {
        let s = way - zero;
        (*point - origin - slope * s - bend * (s * s)).norm()
    };
    let worst = points.iter().zip(&ways).map(off).fold(0.0, f64::max);
    Some((slope, worst))
}

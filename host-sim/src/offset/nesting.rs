//! Which loop lies inside which.

use shared::complex::Complex;
use shared::curve::{Curve as _, Segment};

use super::{Contour, Loop};

/// Fills in [`Loop::parent`] and [`Loop::depth`]: a loop lies inside those that wind around a point of it.
pub fn nest(contour: &Contour, distance: f64, loops: &mut [Loop]) {
    let boxes: Vec<[Complex<f64>; 2]> = loops.iter().map(|l| around(contour, distance, l)).collect();
    let places: Vec<Option<Complex<f64>>> = loops.iter().map(|l| inmost(contour, distance, l)).collect();
    let inside = |inner: usize, outer: usize| {
        let (Some(Some(point)), Some(b)) = (places.get(inner).copied(), loops.get(outer)) else { return false };
        let holds = boxes.get(outer).is_some_and(|[low, high]| {
            point.re >= low.re && point.re <= high.re && point.im >= low.im && point.im <= high.im
        });
        holds && b.closed && winding(contour, distance, b, point) != 0
    };
    let around: Vec<Vec<usize>> = (0..loops.len())
        .map(|inner| (0..loops.len()).filter(|&outer| outer != inner && inside(inner, outer)).collect())
        .collect();
    let areas: Vec<f64> = loops.iter().map(|l| l.area.abs()).collect();
    for (l, around) in loops.iter_mut().zip(&around) {
        l.depth = around.len();
        l.parent = around.iter().copied().min_by(|&a, &b| {
            let area = |k: usize| areas.get(k).copied().unwrap_or(0.0);
            area(a).total_cmp(&area(b))
        });
    }
}

/// The middle of a loop's longest piece: where it is farthest from places at which other loops may touch it.
fn inmost(contour: &Contour, distance: f64, l: &Loop) -> Option<Complex<f64>> {
    let long = |piece: &&super::Piece| (piece.end - piece.start).norm();
    let piece = l.pieces.iter().max_by(|a, b| long(a).total_cmp(&long(b)))?;
    let (curve, [from, to], d) = contour.carrier(piece.along, distance)?;
    Some(curve.offset_point(0.5 * (from + to), d))
}

/// A box around a loop.
fn around(contour: &Contour, distance: f64, l: &Loop) -> [Complex<f64>; 2] {
    let far = f64::INFINITY;
    let mut bounds = [Complex::new(far, far), Complex::new(-far, -far)];
    for piece in &l.pieces {
        let Some((curve, [from, to], d)) = contour.carrier(piece.along, distance) else { continue };
        // No part of a piece is farther from its middle than its length.
        let middle = curve.offset_point(0.5 * (from + to), d);
        let reach = (curve.length_to(to) - curve.length_to(from)) + 7.0 * d.abs();
        let [low, high] = bounds;
        bounds = [
            Complex::new(low.re.min(middle.re - reach), low.im.min(middle.im - reach)),
            Complex::new(high.re.max(middle.re + reach), high.im.max(middle.im + reach)),
        ];
    }
    bounds
}

/// How often a closed loop runs around `point`, anticlockwise.
pub fn winding(contour: &Contour, distance: f64, l: &Loop, point: Complex<f64>) -> i32 {
    let mut angle = 0.0;
    for piece in &l.pieces {
        if let Some((curve, [from, to], d)) = contour.carrier(piece.along, distance) {
            // The whole piece may turn far; eighths of it do not come around unseen.
            const PARTS: u32 = 8;
            for k in 0..PARTS {
                let at = |k: u32| from + (to - from) * f64::from(k) / f64::from(PARTS);
                angle += seen(&curve, d, [at(k), at(k + 1)], point, 0);
            }
        }
    }
    (angle / std::f64::consts::TAU).round() as i32
}

/// The angle under which a part of a curve is seen from `point`.
fn seen(curve: &Segment<f64>, d: f64, [from, to]: [f64; 2], point: Complex<f64>, depth: u32) -> f64 {
    let middle = 0.5 * (from + to);
    let [a, m, b] = [from, middle, to].map(|xi| curve.offset_point(xi, d) - point);
    let spread = (m - a).norm() + (b - m).norm();
    // A part that is shorter than its distance does not pass between the point and its own chord.
    if depth > 40 || spread < 0.5 * m.norm() {
        return (a.conj() * b).arg();
    }
    seen(curve, d, [from, middle], point, depth + 1) + seen(curve, d, [middle, to], point, depth + 1)
}

//! The length of a rational B-spline, by de Boor's algorithm and chords.

use host_sim::program::item::Nurbs;

/// Chords of the coarsest of three sums in each span.
const CHORDS: usize = 64;

/// The point at `u` of the span that begins at the knot of number `span`.
pub fn point(curve: &Nurbs<'_>, span: usize, u: f64) -> [f64; 3] {
    let degree = curve.order - 1;
    let mut points: Vec<[f64; 4]> = (span - degree..=span)
        .map(|k| {
            let ([x, y, z], weight) = (curve.points[k], curve.weights[k]);
            [x * weight, y * weight, z * weight, weight]
        })
        .collect();
    for round in 1..=degree {
        for j in (round..=degree).rev() {
            let [low, high] = [curve.knots[span - degree + j], curve.knots[span + 1 + j - round]];
            let part = (u - low) / (high - low);
            points[j] = std::array::from_fn(|k| points[j - 1][k] * (1.0 - part) + points[j][k] * part);
        }
    }
    let [x, y, z, weight] = points[degree];
    [x / weight, y / weight, z / weight]
}

/// The length in mm. The error of a chord sum falls with the square of the chords; two extrapolations leave the sixth power.
pub fn length(curve: &Nurbs<'_>) -> f64 {
    let spans = (curve.order - 1..curve.points.len()).filter(|&span| curve.knots[span] < curve.knots[span + 1]);
    spans
        .map(|span| {
            let [a, b, c] = [1, 2, 4].map(|times| chords(curve, span, CHORDS * times));
            let [ab, bc] = [(4.0 * b - a) / 3.0, (4.0 * c - b) / 3.0];
            (16.0 * bc - ab) / 15.0
        })
        .sum()
}

fn chords(curve: &Nurbs<'_>, span: usize, count: usize) -> f64 {
    let [from, to] = [curve.knots[span], curve.knots[span + 1]];
    let at = |k: usize| point(curve, span, from + (to - from) * k as f64 / count as f64);
    let pair = |k: usize| (at(k), at(k + 1));
    (0..count).map(pair).map(|(p, q)| (0..3).map(|k| (q[k] - p[k]).powi(2)).sum::<f64>().sqrt()).sum()
}

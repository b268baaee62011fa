//! Splines through points, open or closed.
//!
//! A C2 cubic is the usual one, with no curvature at free ends. A C3 quintic takes its first derivatives from that cubic; its second
//! ones follow from the continuity of the third, which is a system of the same form. By arc length, the spans of the parameter are the
//! lengths of the curve's own segments and the first derivatives have the length 1, so that |r_u| comes near 1 all along: the approximately
//! arc-length parametrised C3 quintic, reference 5 of the feed correction paper, as far as that paper and the name describe it.

use std::fmt;

use serde::Deserialize;
use shared::complex::Complex;
use shared::curve::Spline;
use shared::spline::{CorrectionOrder, PolynomialSegment};

use super::tridiagonal::{Row, solve};

/// Which parameter the points are given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Parametrisation {
    /// The distances of neighbouring points.
    #[default]
    Chord,
    /// The arc lengths of the segments that come out.
    Arc,
}

/// A spline through points in `D` dimensions.
#[derive(Clone, Debug, PartialEq)]
pub struct Interpolant<const D: usize> {
    /// The segments in order, each over v in -1/2..=1/2.
    pub segments: Vec<PolynomialSegment<f64, D>>,
    /// How far the spline's own parameter u goes on each; |r_u| is near 1.
    pub spans: Vec<f64>,
    /// Whether the last segment ends where the first one starts.
    pub closed: bool,
}

/// Why there is no spline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SplineError {
    /// Too few points.
    Few {
        /// How many there are.
        found: usize,
        /// How many it takes.
        needed: usize,
    },
    /// A point stands where the one before it does.
    Repeated {
        /// Its number, from 0.
        point: usize,
    },
    /// A coordinate is infinite or not a number.
    NotFinite {
        /// The number of its point.
        point: usize,
    },
}

impl fmt::Display for SplineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Few { found, needed } => {
                write!(f, "the spline has {found} points, and it takes {needed} at least; add points or draw a line")
            }
            Self::Repeated { point } => {
                write!(f, "point {point} of the spline stands where the one before it does; leave one of them out")
            }
            Self::NotFinite { point } => write!(f, "point {point} of the spline has a coordinate that is not a number"),
        }
    }
}

impl std::error::Error for SplineError {}

/// Rounds in which the spans follow the lengths; they settle by more than a digit in each.
const ROUNDS: usize = 12;

impl<const D: usize> Interpolant<D> {
    /// The C2 cubic. A closed one ends at its first point, which is not given again.
    pub fn cubic(points: &[[f64; D]], closed: bool, by: Parametrisation) -> Result<Self, SplineError> {
        let mut spans = chords(points, closed)?;
        let mut spline = cubic(points, closed, &spans).1;
        if by == Parametrisation::Arc {
            for _ in 0..ROUNDS {
                spans = spline.lengths();
                spline = cubic(points, closed, &spans).1;
            }
        }
        Ok(spline)
    }

    /// The C3 quintic.
    pub fn quintic(points: &[[f64; D]], closed: bool, by: Parametrisation) -> Result<Self, SplineError> {
        let mut spans = chords(points, closed)?;
        let (mut slopes, mut spline) = cubic(points, closed, &spans);
        if by == Parametrisation::Arc {
            for _ in 0..ROUNDS {
                spans = spline.lengths();
                (slopes, spline) = cubic(points, closed, &spans);
            }
            for slope in &mut slopes {
                *slope = scaled(slope, 1.0 / norm(slope));
            }
        }
        let mut spline = quintic(points, closed, &spans, &slopes);
        if by == Parametrisation::Arc {
            for _ in 0..ROUNDS {
                spans = spline.lengths();
                spline = quintic(points, closed, &spans, &slopes);
            }
        }
        Ok(spline)
    }

    /// The arc lengths of the segments, in mm.
    pub fn lengths(&self) -> Vec<f64> {
        self.segments.iter().map(PolynomialSegment::length).collect()
    }
}

impl Interpolant<2> {
    /// The segments as curves of a contour.
    pub fn curves(&self, correction: CorrectionOrder) -> impl Iterator<Item = Spline<f64>> {
        self.segments.iter().map(move |segment| {
            // The ends with two derivatives each say all of a quintic.
            let jet = |v: f64| {
                [segment.point(v), segment.derivative::<1>(v), segment.derivative::<2>(v)]
                    .map(|[x, y]| Complex::new(x, y))
            };
            let ([p, d, a], [q, e, b]) = (jet(-0.5), jet(0.5));
            let points = [p, p + d * 0.2, p + d * 0.4 + a * 0.05, q - e * 0.4 + b * 0.05, q - e * 0.2, q];
            Spline { points, correction }
        })
    }
}

/// The distances of neighbouring points. Errors: all that can be wrong with points.
fn chords<const D: usize>(points: &[[f64; D]], closed: bool) -> Result<Vec<f64>, SplineError> {
    if let Some(point) = points.iter().position(|point| !point.iter().all(|c| c.is_finite())) {
        return Err(SplineError::NotFinite { point });
    }
    // Three points make a ring or a bend; two make a line.
    if points.len() < 3 {
        return Err(SplineError::Few { found: points.len(), needed: 3 });
    }
    let count = if closed { points.len() } else { points.len() - 1 };
    let size = points.iter().flatten().fold(0.0_f64, |most, c| most.max(c.abs()));
    (0..count)
        .map(|k| {
            let next = (k + 1) % points.len();
            let chord = norm(&difference(&points[next], &points[k]));
            // Nearer than rounding is the same point; a machine resolves 4 nm.
            if chord <= 1e-12 * size || chord < 4e-6 { Err(SplineError::Repeated { point: next }) } else { Ok(chord) }
        })
        .collect()
}

/// The first derivatives by u at the points, and the cubic that has them.
fn cubic<const D: usize>(points: &[[f64; D]], closed: bool, spans: &[f64]) -> (Vec<[f64; D]>, Interpolant<D>) {
    let count = points.len();
    let chord = |k: usize| difference(&points[(k + 1) % count], &points[k]);
    // m_{k-1}/h_{k-1} + 2 (1/h_{k-1} + 1/h_k) m_k + m_{k+1}/h_k = 3 (c_{k-1}/h_{k-1}^2 + c_k/h_k^2).
    let rows: Vec<Row<D>> = (0..count)
        .map(|k| {
            let mut row = Row { before: 0.0, diagonal: 0.0, after: 0.0, right: [0.0; D] };
            if closed || k > 0 {
                let j = (k + count - 1) % count;
                let h = spans[j];
                row.before = 1.0 / h;
                row.diagonal += 2.0 / h;
                row.right = sum(&row.right, &scaled(&chord(j), 3.0 / (h * h)));
            }
            if closed || k + 1 < count {
                let h = spans[k];
                row.after = 1.0 / h;
                row.diagonal += 2.0 / h;
                row.right = sum(&row.right, &scaled(&chord(k), 3.0 / (h * h)));
            }
            row
        })
        .collect();
    let slopes = solve(&rows, closed);
    let segments = spans
        .iter()
        .enumerate()
        .map(|(k, &h)| {
            let next = (k + 1) % count;
            let (d0, d1) = (scaled(&slopes[k], h), scaled(&slopes[next], h));
            let chord = chord(k);
            // In powers about the middle: 3/2 c - (d0 + d1)/4 for v, and so on.
            let middle = |axis: usize| 0.5 * (points[k][axis] + points[next][axis]) + 0.125 * (d0[axis] - d1[axis]);
            let axes = |of: &dyn Fn(usize) -> f64| std::array::from_fn(of);
            PolynomialSegment([
                axes(&middle),
                axes(&|axis| 1.5 * chord[axis] - 0.25 * (d0[axis] + d1[axis])),
                axes(&|axis| 0.5 * (d1[axis] - d0[axis])),
                axes(&|axis| d0[axis] + d1[axis] - 2.0 * chord[axis]),
                [0.0; D],
                [0.0; D],
            ])
        })
        .collect();
    (slopes, Interpolant { segments, spans: spans.to_vec(), closed })
}

/// The quintic with these first derivatives by u at the points, and the third one continuous.
fn quintic<const D: usize>(points: &[[f64; D]], closed: bool, spans: &[f64], slopes: &[[f64; D]]) -> Interpolant<D> {
    let count = points.len();
    let chord = |k: usize| difference(&points[(k + 1) % count], &points[k]);
    // r''' h^3 is 60 c - 36 h d0 - 24 h d1 - 9 h^2 a0 + 3 h^2 a1 at the start of a span, and with 24 and 36, 3 and 9 exchanged and
    // the signs of a turned at its end.
    let combined = |k: usize, at_start: f64, at_end: f64| {
        let h = spans[k];
        let of = scaled(&chord(k), 60.0 / (h * h * h));
        let with = sum(&of, &scaled(&slopes[k], -at_start / (h * h)));
        sum(&with, &scaled(&slopes[(k + 1) % count], -at_end / (h * h)))
    };
    let rows: Vec<Row<D>> = (0..count)
        .map(|k| {
            if !closed && (k == 0 || k + 1 == count) {
                // Free ends have no curvature, as those of the cubic.
                return Row { before: 0.0, diagonal: 1.0, after: 0.0, right: [0.0; D] };
            }
            let j = (k + count - 1) % count;
            let (before, after) = (spans[j], spans[k]);
            Row {
                before: -3.0 / before,
                diagonal: 9.0 / before + 9.0 / after,
                after: -3.0 / after,
                right: difference(&combined(k, 36.0, 24.0), &combined(j, 24.0, 36.0)),
            }
        })
        .collect();
    let bends = solve(&rows, closed);
    let segments = spans
        .iter()
        .enumerate()
        .map(|(k, &h)| {
            let next = (k + 1) % count;
            let coefficients: [[f64; 6]; D] = std::array::from_fn(|axis| {
                let (p, q) = (points[k][axis], points[next][axis]);
                let (d, e) = (slopes[k][axis] * h, slopes[next][axis] * h);
                let (a, b) = (bends[k][axis] * h * h, bends[next][axis] * h * h);
                two_point(p, q, d, e, a, b)
            });
            PolynomialSegment(std::array::from_fn(|power| std::array::from_fn(|axis| coefficients[axis][power])))
        })
        .collect();
    Interpolant { segments, spans: spans.to_vec(), closed }
}

/// The quintic in powers of v with these values, first and second derivatives at both ends: a two-point Taylor series in
/// q = 1/4 - v^2, p + c v + q (f_1 + f_1' v) + q^2 (f_2 + f_2' v).
fn two_point(p: f64, q: f64, d: f64, e: f64, a: f64, b: f64) -> [f64; 6] {
    let (mean, chord) = (0.5 * (p + q), q - p);
    // The first derivative is chord -+ f_1 at the ends.
    let (f_0, f_1) = (d - chord, chord - e);
    let (even_1, odd_1) = (0.5 * (f_0 + f_1), f_1 - f_0);
    // The second one is -2 f_1 -+ 2 odd_1 + 2 f_2.
    let (g_0, g_1) = (0.5 * a + f_0 - odd_1, 0.5 * b + f_1 + odd_1);
    let (even_2, odd_2) = (0.5 * (g_0 + g_1), g_1 - g_0);
    [
        mean + 0.25 * even_1 + 0.0625 * even_2,
        chord + 0.25 * odd_1 + 0.0625 * odd_2,
        -even_1 - 0.5 * even_2,
        -odd_1 - 0.5 * odd_2,
        even_2,
        odd_2,
    ]
}

fn difference<const D: usize>(a: &[f64; D], b: &[f64; D]) -> [f64; D] {
    std::array::from_fn(|axis| a[axis] - b[axis])
}

fn sum<const D: usize>(a: &[f64; D], b: &[f64; D]) -> [f64; D] {
    std::array::from_fn(|axis| a[axis] + b[axis])
}

fn scaled<const D: usize>(a: &[f64; D], by: f64) -> [f64; D] {
    a.map(|c| c * by)
}

fn norm<const D: usize>(a: &[f64; D]) -> f64 {
    a.iter().map(|c| c * c).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(count: usize) -> Vec<[f64; 2]> {
        let angle = |k: usize| std::f64::consts::TAU * (k as f64 + 0.2 * (3.0 * k as f64).sin()) / count as f64;
        (0..count).map(|k| [20.0 * angle(k).cos(), 12.0 * angle(k).sin()]).collect()
    }

    fn helix() -> Vec<[f64; 3]> {
        (0..14).map(|k| f64::from(k) * 0.4).map(|t| [9.0 * t.cos(), 9.0 * t.sin(), 2.0 * t + 0.1 * t * t]).collect()
    }

    /// The largest jump of the derivative of order `K` by u at a node, relative to its size.
    fn jump<const D: usize, const K: usize>(spline: &Interpolant<D>) -> f64 {
        let scaled =
            |k: usize, v: f64| scaled(&spline.segments[k].derivative::<K>(v), spline.spans[k].powi(-(K as i32)));
        let size = (0..spline.segments.len()).map(|k| norm(&scaled(k, 0.5))).fold(1e-3, f64::max);
        let nodes = if spline.closed { spline.segments.len() } else { spline.segments.len() - 1 };
        let jumps =
            (0..nodes).map(|k| norm(&difference(&scaled(k, 0.5), &scaled((k + 1) % spline.segments.len(), -0.5))));
        jumps.fold(0.0, f64::max) / size
    }

    fn check<const D: usize>(points: &[[f64; D]], closed: bool) {
        for by in [Parametrisation::Chord, Parametrisation::Arc] {
            let cubic = Interpolant::cubic(points, closed, by).unwrap();
            let quintic = Interpolant::quintic(points, closed, by).unwrap();
            for spline in [&cubic, &quintic] {
                for (k, segment) in spline.segments.iter().enumerate() {
                    for (v, point) in [(-0.5, points[k]), (0.5, points[(k + 1) % points.len()])] {
                        assert!(norm(&difference(&segment.point(v), &point)) < 1e-13);
                    }
                }
                assert!(jump::<D, 1>(spline) < 1e-13 && jump::<D, 2>(spline) < 1e-12);
            }
            assert!(jump::<D, 3>(&quintic) < 1e-11, "{}", jump::<D, 3>(&quintic));
            assert!(jump::<D, 3>(&cubic) > 1e-3, "only the quintic is C3, or this test says nothing");
            if by == Parametrisation::Arc {
                for (length, span) in quintic.lengths().iter().zip(&quintic.spans) {
                    assert!((length / span - 1.0).abs() < 1e-7, "{length} {span}");
                }
            }
        }
    }

    #[test]
    fn splines_meet_their_points_smoothly() {
        check(&ring(17), true);
        check(&ring(17), false);
        check(&helix(), false);
        check(&[[0.0, 0.0], [4.0, 1.0], [1.0, 5.0]], true);
    }

    /// Points on a line give the line, of its own length.
    #[test]
    fn a_line_stays_a_line() {
        let points: Vec<[f64; 2]> = [0.0, 1.0, 3.0, 7.0].map(|t| [3.0 * t, 4.0 * t]).into();
        let spline = Interpolant::quintic(&points, false, Parametrisation::Arc).unwrap();
        for segment in &spline.segments {
            for v in [-0.3, 0.2] {
                let [x, y] = segment.point(v);
                assert!((4.0 * x - 3.0 * y).abs() < 1e-13);
            }
        }
        assert!((spline.lengths().iter().sum::<f64>() - 35.0).abs() < 1e-12);
    }

    /// The curves of a contour are the segments.
    #[test]
    fn curves_are_the_segments() {
        use shared::curve::Curve as _;
        let spline = Interpolant::quintic(&ring(9), true, Parametrisation::Chord).unwrap();
        for (curve, segment) in spline.curves(CorrectionOrder::Seventh).zip(&spline.segments) {
            for k in 0..=10 {
                let xi = f64::from(k) * 0.1;
                let [x, y] = segment.point(xi - 0.5);
                assert!((curve.point(xi) - Complex::new(x, y)).norm() < 1e-13);
            }
        }
    }

    #[test]
    fn faulty_points_are_told() {
        let cubic =
            |points: &[[f64; 2]], closed| Interpolant::cubic(points, closed, Parametrisation::Chord).unwrap_err();
        assert_eq!(cubic(&[[0.0, 0.0], [1.0, 0.0]], false), SplineError::Few { found: 2, needed: 3 });
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [2.0, 2.0]];
        assert_eq!(cubic(&points, false), SplineError::Repeated { point: 2 });
        let ring = [[0.0, 0.0], [1.0, 0.0], [2.0, 2.0], [0.0, 0.0]];
        assert_eq!(cubic(&ring, true), SplineError::Repeated { point: 0 });
        assert_eq!(cubic(&[[0.0, 0.0], [f64::NAN, 0.0], [2.0, 2.0]], false), SplineError::NotFinite { point: 1 });
    }
}

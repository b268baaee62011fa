//! The spans of a cubic B-spline while it is fitted: each keeps what it gives to the normal equations, and how far it was last found to be
//! from the polyline, so that a round of halving touches only what it changes.

use super::band::Band;
use super::conditions::{Polynomial, across};
use super::curve::{Bezier, Cubic};
use super::polyline::Polyline;
use crate::vector::Vector;

/// The places that a span is looked at in at least.
pub(super) const LOOKS: usize = 6;

/// Where a look is on its span.
pub(super) const fn place(look: usize) -> f64 {
    (look as f64 + 0.5) / LOOKS as f64
}

/// The cubic Bernstein polynomials.
const fn weights(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
}

/// The polynomials at all looks ...
const PARTS: [[f64; 4]; LOOKS] = {
    let mut parts = [[0.0; 4]; LOOKS];
    let mut look = 0;
    while look < LOOKS {
        parts[look] = weights(place(look));
        look += 1;
    }
    parts
};

/// ... and the upper half of the matrix of their products.
const EVEN: [[f64; 4]; 4] = {
    let mut matrix = [[0.0; 4]; 4];
    let mut k = 0;
    while k < 16 * LOOKS {
        let (look, row, column) = (k / 16, k / 4 % 4, k % 4);
        if row <= column {
            matrix[row][column] += PARTS[look][row] * PARTS[look][column];
        }
        k += 1;
    }
    matrix
};

/// The way along the polyline between two breaks.
#[derive(Clone, Debug)]
pub(super) struct Span {
    pub ends: [f64; 2],
    /// Of the squares of (a curve's point less a point of the polyline): the matrix over the curve's Bernstein points ...
    matrix: [[f64; 4]; 4],
    /// ... and the right side.
    right: [Vector; 4],
    /// How far it is from the polyline at the most, in mm.
    pub deviation: f64,
    /// The curve that was last measured, and how far it was.
    measured: (Cubic, f64),
}

impl Span {
    pub(super) fn new(line: &Polyline<'_>, ends: [f64; 2]) -> Self {
        let nothing = Bezier { points: [Vector::default(); 4] };
        let mut span = Self {
            ends,
            matrix: [[0.0; 4]; 4],
            right: [Vector::default(); 4],
            deviation: f64::INFINITY,
            measured: (nothing, f64::INFINITY),
        };
        let step = ends[1] - ends[0];
        let vertices = line.between(ends[0], ends[1]);
        if vertices.len() >= LOOKS {
            let inverse = 1.0 / step;
            for j in vertices {
                span.add((line.ways[j] - ends[0]) * inverse, line.points[j]);
            }
        } else {
            span.matrix = EVEN;
            let mut k = line.segment(ends[0]);
            for (look, parts) in PARTS.iter().enumerate() {
                let way = ends[0] + step * place(look);
                while line.ways[k + 1] <= way && k + 2 < line.ways.len() {
                    k += 1;
                }
                let point = line.on(k, way);
                for (right, &part) in span.right.iter_mut().zip(parts) {
                    *right = *right + point * part;
                }
            }
        }
        span
    }

    fn add(&mut self, t: f64, point: Vector) {
        let parts = weights(t);
        for (row, &part) in parts.iter().enumerate() {
            for (column, &other) in parts.iter().enumerate().skip(row) {
                self.matrix[row][column] += part * other;
            }
            self.right[row] = self.right[row] + point * part;
        }
    }

    /// The two halves.
    pub(super) fn halves(&self, line: &Polyline<'_>) -> [Self; 2] {
        let middle = 0.5 * (self.ends[0] + self.ends[1]);
        [[self.ends[0], middle], [middle, self.ends[1]]].map(|ends| Self::new(line, ends))
    }

    /// Adds what the span says of the four control points from `first` on.
    pub(super) fn add_to(&self, band: &mut Band, first: usize, parts: &[[f64; 4]; 4]) {
        // M^T G M, where row i of M has the parts of Bernstein point i; G is given by its upper half.
        let g = |i: usize, j: usize| if i <= j { self.matrix[i][j] } else { self.matrix[j][i] };
        let product: [[f64; 4]; 4] =
            std::array::from_fn(|i| std::array::from_fn(|k| (0..4).map(|j| g(i, j) * parts[j][k]).sum()));
        let columns: [[f64; 4]; 4] = std::array::from_fn(|row| parts.map(|line| line[row]));
        for (row, weights) in columns.into_iter().enumerate() {
            let sum = |column: usize| weights.iter().zip(&product).map(|(weight, line)| weight * line[column]).sum();
            let entries = std::array::from_fn(|step| if row + step < 4 { sum(row + step) } else { 0.0 });
            let terms = self.right.iter().zip(weights);
            let right = terms.fold(Vector::default(), |all, (&right, weight)| all + right * weight);
            band.add_row(first + row, &entries, right);
        }
    }

    /// Takes the curve of a new round and says how far it is from the polyline: infinite where that is above the tolerance.
    ///
    /// A curve whose control points have moved by no more than d since it was measured is no more than d farther from the polyline; that is
    /// only measured again where it could break the tolerance.
    pub(super) fn take(&mut self, line: &Polyline<'_>, curve: Cubic, tolerance: f64, scratch: &mut Vec<f64>) {
        let moved = |(a, b): (&Vector, &Vector)| {
            let off = *a - *b;
            off.dot(off)
        };
        let (before, deviation) = &self.measured;
        self.deviation = f64::INFINITY;
        if deviation.is_finite() {
            let most = curve.points.iter().zip(&before.points).map(moved).fold(0.0, f64::max).sqrt();
            self.deviation = deviation + most;
        }
        if self.deviation.is_nan() || self.deviation > tolerance {
            self.deviation = across(line, &Polynomial::new(&curve), self.ends, tolerance, scratch);
            self.measured = (curve, self.deviation);
        }
    }
}

/// What of the four control points of span `k` is in each of its Bernstein points [Boehm 1981].
pub(super) fn parts(knots: &[f64], k: usize) -> [[f64; 4]; 4] {
    let [t2, t1, from, to, u1, u2] = std::array::from_fn(|j| knots[k + 1 + j]);
    let step = to - from;
    // The inner two lie on the leg between the second and the third control point.
    let leg = 1.0 / (u1 - t1);
    let (low, high) = ((from - t1) * leg, (to - t1) * leg);
    let (first, last) = ((from - t1) / (to - t1), step / (u1 - from));
    let (before, after) = ((from - t2) / (to - t2), step / (u2 - from));
    [
        [(1.0 - first) * (1.0 - before), (1.0 - first) * before + first * (1.0 - low), first * low, 0.0],
        [0.0, 1.0 - low, low, 0.0],
        [0.0, 1.0 - high, high, 0.0],
        [0.0, (1.0 - last) * (1.0 - high), (1.0 - last) * high + last * (1.0 - after), last * after],
    ]
}

/// The Bernstein points of four control points by their [`parts`].
pub(super) fn bernstein(points: &[Vector], parts: &[[f64; 4]; 4]) -> Cubic {
    // As a sum of differences, so that a part that is 1 gives the point itself.
    let [a, b, c, d] = [points[0], points[1], points[2], points[3]];
    let inner = |part: f64| b + (c - b) * part;
    Bezier {
        points: [
            inner(parts[0][2]) + (a - b) * parts[0][0],
            inner(parts[1][2]),
            inner(parts[2][2]),
            inner(1.0 - parts[3][1]) + (d - c) * parts[3][3],
        ],
    }
}

//! Polynomial curves by their Bernstein control points: lines of degree 1, cubics of degree 3, PH quintics of degree 5.

use crate::vector::{Chord, Vector};

/// A curve over 0..=1 with N control points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bezier<const N: usize> {
    /// Its control points in mm; the first and the last are its ends.
    pub points: [Vector; N],
}

/// A cubic.
pub type Cubic = Bezier<4>;

/// Where a curve is at a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Local {
    /// The point.
    pub point: Vector,
    /// The first derivative.
    pub first: Vector,
    /// The second one.
    pub second: Vector,
}

impl Local {
    /// The unit tangent; none where the curve stands still.
    pub fn tangent(&self) -> Option<Vector> {
        self.first.unit()
    }

    /// The curvature in 1/mm as a vector towards the centre.
    pub fn curvature(&self) -> Vector {
        let square = self.first.dot(self.first);
        if square > 0.0 {
            (self.second - self.first * (self.second.dot(self.first) / square)) * (1.0 / square)
        } else {
            Vector::default()
        }
    }
}

impl<const N: usize> Bezier<N> {
    /// The degree.
    pub const DEGREE: usize = N - 1;

    /// By the algorithm of de Casteljau: N (N - 1)/2 means.
    pub fn at(&self, t: f64) -> Local {
        let mut p = self.points;
        let mut left = N;
        while left > 3 {
            for k in 0..left - 1 {
                p[k] = p[k].toward(p[k + 1], t);
            }
            left -= 1;
        }
        let degree = Self::DEGREE as f64;
        if left < 3 {
            let across = p[N - 1] - p[0];
            return Local { point: p[0].toward(p[N - 1], t), first: across * degree, second: Vector::default() };
        }
        let second = (p[2] - p[1] * 2.0 + p[0]) * (degree * (degree - 1.0));
        let (a, b) = (p[0].toward(p[1], t), p[1].toward(p[2], t));
        Local { point: a.toward(b, t), first: (b - a) * degree, second }
    }

    /// The parts before and behind a parameter.
    pub fn split(&self, t: f64) -> [Self; 2] {
        let (mut low, mut high) = (self.points, self.points);
        for (step, low) in low.iter_mut().enumerate().skip(1) {
            for k in 0..N - step {
                high[k] = high[k].toward(high[k + 1], t);
            }
            *low = high[0];
        }
        [Self { points: low }, Self { points: high }]
    }

    /// The largest distance of its control points from the segment between two points: no point of the curve is farther from it, since a
    /// distance from a segment is a convex function.
    pub fn from_segment(&self, from: Vector, to: Vector) -> f64 {
        self.distance_to(&Chord::new(from, to))
    }

    /// As [`Bezier::from_segment`].
    pub(super) fn distance_to(&self, chord: &Chord) -> f64 {
        self.points.iter().map(|&point| chord.square_from(point)).fold(0.0, f64::max).sqrt()
    }

    /// The curve between two parameters.
    pub(super) fn part(&self, from: f64, to: f64) -> Self {
        let [before, _] = self.split(to);
        let [_, part] = before.split(if to > 0.0 { from / to } else { 0.0 });
        part
    }

    /// What the second derivative is nowhere longer than.
    pub(super) fn bend(&self) -> f64 {
        let second = |p: &[Vector]| {
            let bend = p[0] - p[1] * 2.0 + p[2];
            bend.dot(bend)
        };
        let degree = Self::DEGREE as f64;
        self.points.windows(3).map(second).fold(0.0, f64::max).sqrt() * degree * (degree - 1.0)
    }

    /// By powers of the parameter.
    pub(super) fn powers(&self) -> Powers<N> {
        let mut differences = self.points;
        let mut coefficients = [Vector::default(); N];
        let mut binomial = 1.0;
        for (k, coefficient) in coefficients.iter_mut().enumerate().skip(1) {
            for j in 0..N - k {
                differences[j] = differences[j + 1] - differences[j];
            }
            binomial *= (N - k) as f64 / k as f64;
            *coefficient = differences[0] * binomial;
        }
        Powers { origin: self.points[0], coefficients }
    }
}

/// A curve by powers of its parameter, relative to its start: three times faster to evaluate than its control points, and as exact
/// for a curve that is not much longer than its chord.
#[derive(Clone, Copy, Debug)]
pub(super) struct Powers<const N: usize> {
    origin: Vector,
    coefficients: [Vector; N],
}

impl<const N: usize> Powers<N> {
    /// By Horner's rule.
    pub(super) fn at(&self, t: f64) -> Local {
        let [mut point, mut first, mut half] = [self.coefficients[N - 1], Vector::default(), Vector::default()];
        for &coefficient in self.coefficients.iter().rev().skip(1) {
            half = half * t + first;
            first = first * t + point;
            point = point * t + coefficient;
        }
        Local { point: self.origin + point, first, second: half * 2.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CURVE: Cubic = Bezier {
        points: [Vector([0.0, 0.0, 0.0]), Vector([1.0, 2.0, 1.0]), Vector([3.0, 2.0, 0.0]), Vector([4.0, 0.0, 3.0])],
    };

    #[test]
    fn derivatives_are_those_of_the_points() {
        let (t, h) = (0.3, 1e-4);
        let [before, here, after] = [t - h, t, t + h].map(|t| CURVE.at(t));
        let first = (after.point - before.point) * (0.5 / h);
        let second = (after.first - before.first) * (0.5 / h);
        assert!((first - here.first).norm() < 1e-6 && (second - here.second).norm() < 1e-6);
    }

    #[test]
    fn parts_are_the_curve() {
        let [low, high] = CURVE.split(0.4);
        for t in [0.0, 0.2, 0.7, 1.0] {
            assert!((low.at(t).point - CURVE.at(0.4 * t).point).norm() < 1e-14);
            assert!((high.at(t).point - CURVE.at(0.4 + 0.6 * t).point).norm() < 1e-14);
        }
    }

    #[test]
    fn powers_are_the_curve() {
        for t in [0.0, 0.1, 0.5, 1.0] {
            let (a, b) = (CURVE.powers().at(t), CURVE.at(t));
            for (a, b) in [(a.point, b.point), (a.first, b.first), (a.second, b.second)] {
                assert!((a - b).norm() < 1e-13, "{t}: {a:?} {b:?}");
            }
            assert!(b.second.norm() <= CURVE.bend());
        }
    }

    /// A quarter of a circle of 2 mm by a cubic with handles of k r: its curvature at both ends is 2 (1 - k)/(3 k^2 r), towards the centre.
    #[test]
    fn the_curvature_of_a_quarter_circle() {
        let k = 0.552_284_75;
        let [a, b, c, d] = [[1.0, 0.0], [1.0, k], [k, 1.0], [0.0, 1.0]].map(|[x, y]| Vector([2.0 * x, 2.0 * y, 0.0]));
        let exact = 2.0 * (1.0 - k) / (3.0 * k * k * 2.0);
        for t in [0.0, 1.0] {
            let at = Cubic { points: [a, b, c, d] }.at(t);
            let towards_centre = at.curvature().dot(-at.point) / at.point.norm();
            assert!((towards_centre - exact).abs() < 1e-12, "{towards_centre} {exact}");
        }
    }
}

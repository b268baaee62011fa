//! Polynomial curves: quintics, and cubics as such.

use super::{Curve, Cut};
use crate::complex::Complex;
use crate::piece::{Shape, SplineShape};
use crate::real::Real;
use crate::spline::{CorrectionOrder, PolynomialSegment};

/// A quintic in Bezier form, which keeps both ends exact. It has no exact offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spline<T> {
    /// The control points, in mm.
    pub points: [Complex<T>; 6],
    /// Which feed correction polynomial it is driven with.
    pub correction: CorrectionOrder,
}

impl<T: Real> Spline<T> {
    /// The cubic with these control points.
    pub fn cubic([a, b, c, d]: [Complex<T>; 4], correction: CorrectionOrder) -> Self {
        let tenth = T::lit(0.1);
        let mixed =
            |[p, q, r]: [(Complex<T>, f64); 3]| (p.0 * T::lit(p.1) + q.0 * T::lit(q.1) + r.0 * T::lit(r.1)) * tenth;
        let points = [
            a,
            mixed([(a, 4.0), (b, 6.0), (c, 0.0)]),
            mixed([(a, 1.0), (b, 6.0), (c, 3.0)]),
            mixed([(d, 1.0), (c, 6.0), (b, 3.0)]),
            mixed([(d, 4.0), (c, 6.0), (b, 0.0)]),
            d,
        ];
        Self { points, correction }
    }

    /// The derivative of order `K` by the parameter.
    fn derived<const K: usize>(&self, xi: T) -> Complex<T> {
        let mut points = self.points;
        let degree = points.len() - 1;
        let mut factor = T::ONE;
        for k in 0..K {
            factor = factor * T::from_int((degree - k) as i32);
            for j in 0..degree - k {
                points[j] = points[j + 1] - points[j];
            }
        }
        for k in 1..=degree - K {
            for j in 0..=degree - K - k {
                points[j] = points[j] * (T::ONE - xi) + points[j + 1] * xi;
            }
        }
        points[0] * factor
    }

    /// The part over `from..=to`, in powers about its middle; and that middle.
    fn powers(&self, from: T, to: T) -> (Complex<T>, [Complex<T>; 5]) {
        let middle = (from + to) * T::HALF;
        let width = to - from;
        let derivatives = [
            self.derived::<1>(middle),
            self.derived::<2>(middle) * T::HALF,
            self.derived::<3>(middle) * T::lit(1.0 / 6.0),
            self.derived::<4>(middle) * T::lit(1.0 / 24.0),
            self.derived::<5>(middle) * T::lit(1.0 / 120.0),
        ];
        let mut scale = T::ONE;
        let powers = derivatives.map(|derivative| {
            scale = scale * width;
            derivative * scale
        });
        (self.point(middle), powers)
    }

    /// The second derivative by the parameter, in mm.
    pub fn second_derivative(&self, xi: T) -> Complex<T> {
        self.derived::<2>(xi)
    }

    /// The part over `from..=to` as a curve of its own.
    pub fn part(&self, from: T, to: T) -> Self {
        // The blossom at as many copies of `to` as the number of the control point says.
        let blossom = |count: usize| {
            let mut points = self.points;
            for k in 1..points.len() {
                let at = if k <= count { to } else { from };
                for j in 0..points.len() - k {
                    points[j] = points[j] * (T::ONE - at) + points[j + 1] * at;
                }
            }
            points[0]
        };
        Self { points: [0, 1, 2, 3, 4, 5].map(blossom), correction: self.correction }
    }

    /// All of it in powers of v = xi - 1/2.
    pub fn segment(&self) -> PolynomialSegment<T, 2> {
        let (middle, [a, b, c, d, e]) = self.powers(T::ZERO, T::ONE);
        PolynomialSegment([middle, a, b, c, d, e].map(|z| [z.re, z.im]))
    }
}

impl<T: Real> Curve<T> for Spline<T> {
    fn point(&self, xi: T) -> Complex<T> {
        self.derived::<0>(xi)
    }

    fn derivative(&self, xi: T) -> Complex<T> {
        self.derived::<1>(xi)
    }

    fn speed(&self, xi: T) -> T {
        self.derivative(xi).norm()
    }

    fn curvature(&self, xi: T) -> T {
        let slope = self.derivative(xi);
        let speed = slope.norm();
        slope.cross(self.derived::<2>(xi)) / (speed * speed * speed)
    }

    fn length_to(&self, xi: T) -> T {
        self.segment().length_over(-T::HALF, xi)
    }

    /// The offset distance is not asked for: there is no exact offset, and whoever wants one is refused before.
    fn cut(&self, from: T, to: T, _: T) -> Cut<T> {
        let (origin, plane) = self.powers(from, to);
        Cut { origin, shape: Shape::Spline(SplineShape { plane, bow: [T::ZERO; 4], correction: self.correction }) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve() -> Spline<f64> {
        let points = [(0.0, 0.0), (3.0, 4.0), (7.0, -2.0), (9.0, 5.0), (4.0, 8.0), (1.0, 6.0)];
        Spline { points: points.map(|(x, y)| Complex::new(x, y)), correction: CorrectionOrder::Seventh }
    }

    /// A cubic as a quintic is the cubic; a cut is the same curve over its part.
    #[test]
    fn raising_and_cutting_keep_the_curve() {
        let [a, b, c, d] = [(1.0, 2.0), (3.0, -1.0), (6.0, 5.0), (8.0, 0.5)].map(|(x, y)| Complex::new(x, y));
        let raised = Spline::<f64>::cubic([a, b, c, d], CorrectionOrder::Seventh);
        for k in 0..=10 {
            let x = f64::from(k) * 0.1;
            let e = 1.0 - x;
            let cubic = a * (e * e * e) + b * (3.0 * e * e * x) + c * (3.0 * e * x * x) + d * (x * x * x);
            assert!((raised.point(x) - cubic).norm() < 1e-14);
        }
        let part = curve().part(0.2, 0.7);
        for k in 0..=10 {
            let xi = f64::from(k) * 0.1;
            assert!((part.point(xi) - curve().point(0.2 + 0.5 * xi)).norm() < 1e-14);
        }
        let Cut { origin, shape: Shape::Spline(shape) } = curve().cut(0.2, 0.7, 0.0) else { panic!("another shape") };
        for v in [-0.5, -0.1, 0.3, 0.5] {
            let [x, y, _] = shape.segment(0.0).point(v);
            assert!((origin + Complex::new(x, y) - curve().point(0.45 + 0.5 * v)).norm() < 1e-14);
        }
    }

    /// Derivative and curvature against difference quotients.
    #[test]
    fn derivatives_are_limits() {
        for k in 1..10 {
            let (xi, h) = (f64::from(k) * 0.1, 1e-6);
            let quotient = (curve().point(xi + h) - curve().point(xi - h)) * (0.5 / h);
            assert!((quotient - curve().derivative(xi)).norm() < 1e-7);
            let turn = curve().tangent(xi - h).cross(curve().tangent(xi + h));
            let way = curve().length_to(xi + h) - curve().length_to(xi - h);
            assert!((turn / way - curve().curvature(xi)).abs() < 1e-7, "{xi}");
        }
    }
}

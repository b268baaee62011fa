//! Quintic Pythagorean-hodograph curves.
//!
//! A curve is given by its preimage w(xi), a complex quadratic: r' = w^2, so that the speed |w|^2 and the arc length are
//! polynomials [Farouki & Srinathu 2018, section 3]. Bernstein forms on 0..=1, which keep both ends exact.

use super::{Curve, Cut};
use crate::complex::Complex;
use crate::piece::Shape;
use crate::real::Real;

/// A quintic PH curve: start point and Bernstein coefficients of the preimage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhQuintic<T> {
    /// The point at 0, in mm.
    pub start: Complex<T>,
    /// w_0, w_1, w_2 in mm^(1/2).
    pub w: [Complex<T>; 3],
}

/// |w|^2 in Bernstein form, of a preimage in that form.
pub(crate) fn speed_bernstein<T: Real>([w0, w1, w2]: [Complex<T>; 3]) -> [T; 5] {
    [w0.norm_sqr(), w0.dot(w1), (T::TWO * w1.norm_sqr() + w0.dot(w2)) * T::lit(1.0 / 3.0), w1.dot(w2), w2.norm_sqr()]
}

impl<T: Real> PhQuintic<T> {
    /// w(xi).
    pub fn preimage(&self, xi: T) -> Complex<T> {
        let [w0, w1, w2] = self.w;
        let eta = T::ONE - xi;
        w0 * (eta * eta) + w1 * (T::TWO * (xi * eta)) + w2 * (xi * xi)
    }

    /// w'(xi).
    pub fn preimage_derivative(&self, xi: T) -> Complex<T> {
        let [w0, w1, w2] = self.w;
        ((w1 - w0) * (T::ONE - xi) + (w2 - w1) * xi) * T::TWO
    }

    /// The six Bezier control points.
    pub fn control_points(&self) -> [Complex<T>; 6] {
        let [w0, w1, w2] = self.w;
        let fifth = T::lit(0.2);
        let steps = [
            w0.square() * fifth,
            (w0 * w1) * fifth,
            (w1.square() * T::TWO + w0 * w2) * T::lit(1.0 / 15.0),
            (w1 * w2) * fifth,
            w2.square() * fifth,
        ];
        let mut points = [self.start; 6];
        let mut sum = self.start;
        for (point, step) in points.iter_mut().skip(1).zip(steps) {
            sum = sum + step;
            *point = sum;
        }
        points
    }

    /// The point at 1.
    pub fn end(&self) -> Complex<T> {
        let [.., end] = self.control_points();
        end
    }

    /// sigma in Bernstein form.
    pub fn speed_coefficients(&self) -> [T; 5] {
        speed_bernstein(self.w)
    }

    /// The parameters inside (0, 1) where the curvature changes its sign: zeros of Im(conj w w'), a quadratic.
    pub fn inflections(&self) -> heapless::Vec<T, 2> {
        let [w0, w1, w2] = self.w;
        // Bernstein coefficients of Im(conj w w')/2.
        let [a, b, c] = [w0.cross(w1), w0.cross(w2) * T::HALF, w1.cross(w2)];
        // a (1-x)^2 + 2 b x (1-x) + c x^2 = 0; the root formula that never subtracts nearly equal numbers.
        let discriminant = b * b - a * c;
        let mut found = heapless::Vec::new();
        if discriminant <= T::ZERO {
            return found;
        }
        let root = discriminant.sqrt();
        let q = if b < T::ZERO { b - root } else { b + root };
        // With y = x/(1-x): c y^2 + 2 b y + a = 0, so y = -q/c and y = -a/q, and x = y/(1+y).
        for (numerator, denominator) in [(-q, c), (-a, q)] {
            let xi = numerator / (numerator + denominator);
            if xi > T::ZERO && xi < T::ONE {
                // Two at most; a third could not be pushed and is not there.
                let _ = found.push(xi);
            }
        }
        if let [first, second] = found.as_mut_slice()
            && *first > *second
        {
            core::mem::swap(first, second);
        }
        found
    }

    /// The absolute rotation of the tangent in half turns: (1/pi) times the sum of |change of arg w| between inflections.
    pub fn absolute_rotation(&self) -> T {
        /// Parts of a stretch without inflection; over one of them arg w turns by less than a half turn.
        const PARTS: i32 = 8;
        let inflections = self.inflections();
        let mut sum = T::ZERO;
        let mut from = T::ZERO;
        for to in inflections.iter().copied().chain([T::ONE]) {
            let mut before = self.preimage(from);
            let mut turn = T::ZERO;
            for k in 1..=PARTS {
                let xi = from + (to - from) * (T::from_int(k) / T::from_int(PARTS));
                let w = self.preimage(xi);
                turn += (before.conj() * w).arg();
                before = w;
            }
            sum += turn.abs();
            from = to;
        }
        sum * T::lit(core::f64::consts::FRAC_1_PI)
    }
}

impl<T: Real> Curve<T> for PhQuintic<T> {
    fn point(&self, xi: T) -> Complex<T> {
        // de Casteljau: the most accurate scheme there is for a point, and the host has the time.
        let mut points = self.control_points();
        for k in 1..points.len() {
            for j in 0..points.len() - k {
                points[j] = points[j] * (T::ONE - xi) + points[j + 1] * xi;
            }
        }
        points[0]
    }

    fn derivative(&self, xi: T) -> Complex<T> {
        self.preimage(xi).square()
    }

    fn speed(&self, xi: T) -> T {
        self.preimage(xi).norm_sqr()
    }

    fn curvature(&self, xi: T) -> T {
        let w = self.preimage(xi);
        let speed = w.norm_sqr();
        T::TWO * w.cross(self.preimage_derivative(xi)) / (speed * speed)
    }

    fn tangent(&self, xi: T) -> Complex<T> {
        let w = self.preimage(xi);
        w.square() * (T::ONE / w.norm_sqr())
    }

    fn length_to(&self, xi: T) -> T {
        let mut s = [T::ZERO; 6];
        let mut sum = T::ZERO;
        for (slot, sigma) in s.iter_mut().skip(1).zip(self.speed_coefficients()) {
            sum += sigma * T::lit(0.2);
            *slot = sum;
        }
        for k in 1..s.len() {
            for j in 0..s.len() - k {
                s[j] = s[j] * (T::ONE - xi) + s[j + 1] * xi;
            }
        }
        s[0]
    }

    fn cut(&self, from: T, to: T, offset: T) -> Cut<T> {
        let [w0, w1, w2] = self.w;
        let middle = (from + to) * T::HALF;
        let width = to - from;
        let root = width.sqrt();
        let bend = w0 - w1 * T::TWO + w2;
        Cut {
            origin: self.point(middle),
            shape: Shape::Ph {
                preimage: [
                    self.preimage(middle) * root,
                    self.preimage_derivative(middle) * (width * root),
                    bend * (width * width * root),
                ],
                offset,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve() -> PhQuintic<f64> {
        PhQuintic {
            start: Complex::new(3.0, -2.0),
            w: [Complex::new(4.0, 0.5), Complex::new(-1.0, 3.0), Complex::new(4.2, -1.1)],
        }
    }

    /// Speed against a difference quotient of the point, length against a sum of chords.
    #[test]
    fn speed_and_length_measure_the_curve() {
        let curve = curve();
        let (mut chords, mut before) = (0.0, curve.point(0.0));
        for k in 1..=100_000 {
            let xi = f64::from(k) * 1e-5;
            let point = curve.point(xi);
            chords += (point - before).norm();
            before = point;
            if k % 1000 == 0 {
                let middle = xi - 0.5e-5;
                let quotient = (point - curve.point(xi - 1e-5)) * 1e5;
                assert!((quotient - curve.derivative(middle)).norm() < 1e-7 * curve.speed(middle).max(1.0));
                assert!((curve.length_to(xi) / chords - 1.0).abs() < 1e-8, "{xi}");
            }
        }
    }

    /// Curvature against the turn of the tangent per length.
    #[test]
    fn curvature_is_the_turn_of_the_tangent() {
        let curve = curve();
        for k in 1..1000 {
            let xi = f64::from(k) * 1e-3;
            let (a, b) = (curve.tangent(xi - 1e-6), curve.tangent(xi + 1e-6));
            let turn = a.cross(b) / (curve.length_to(xi + 1e-6) - curve.length_to(xi - 1e-6));
            assert!((curve.curvature(xi) - turn).abs() < 1e-6 * turn.abs().max(1.0), "{xi}");
        }
    }

    #[test]
    fn inflections_are_where_the_curvature_changes_sign() {
        let curve = curve();
        let found = curve.inflections();
        let mut changes = 0;
        for k in 1..10_000 {
            let (a, b) = (f64::from(k - 1) * 1e-4, f64::from(k) * 1e-4);
            if curve.curvature(a) * curve.curvature(b) < 0.0 {
                assert!(found.iter().any(|&xi| xi >= a && xi <= b), "missed one in {a}..{b}");
                changes += 1;
            }
        }
        assert_eq!(changes, found.len());
    }
}

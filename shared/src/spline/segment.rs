//! One segment of a polynomial spline, in powers of a parameter v that runs over -1/2..=1/2.
//!
//! A cubic is a quintic whose highest coefficients are zero. Lengths are mm.

use crate::polynomial::{Polynomial, Sign, binomial, sign};
use crate::real::Real;

/// r(v) = c_0 + c_1 v + .. + c_5 v^5 in `D` dimensions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PolynomialSegment<T, const D: usize>(pub [[T; D]; 6]);

/// What is known of u(s) at both ends of a segment: FC(9) and FC(11).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ends<T> {
    /// S, in mm.
    pub length: T,
    /// u at the start and at the end.
    pub parameter: [T; 2],
    /// u_s in 1/mm.
    pub first: [T; 2],
    /// u_ss in 1/mm^2.
    pub second: [T; 2],
    /// u_sss in 1/mm^3; only the ninth order asks for it.
    pub third: [T; 2],
}

/// u_s, u_ss and u_sss at one place, in 1/mm, 1/mm^2 and 1/mm^3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates<T>(pub [T; 3]);

impl<T: Real, const D: usize> PolynomialSegment<T, D> {
    /// The point, in mm.
    pub fn point(&self, v: T) -> [T; D] {
        self.derivative::<0>(v)
    }

    /// The derivative of order `K` by v, in mm.
    pub fn derivative<const K: usize>(&self, v: T) -> [T; D] {
        let mut value = [T::ZERO; D];
        for (j, coefficient) in self.0.iter().enumerate().skip(K).rev() {
            // j (j - 1) .. (j - K + 1)
            let factor = T::from_int((0..K).fold(1, |product, k| product * (j - k) as i32));
            for (value, &c) in value.iter_mut().zip(coefficient) {
                *value = *value * v + c * factor;
            }
        }
        value
    }

    /// |r'|, in mm.
    pub fn speed(&self, v: T) -> T {
        let slope = self.derivative::<1>(v);
        dot(&slope, &slope).sqrt()
    }

    /// u_s = 1/|r'|, u_ss = -(r' r'')/|r'|^4 and u_sss, for u = v; none where the curve stands still.
    ///
    /// With p = |r'|^2: u_s = p^(-1/2), u_ss = -p'/(2 p^2), u_sss = (p'^2/p - p''/2) p^(-5/2).
    pub fn rates(&self, v: T) -> Option<Rates<T>> {
        let (one, two, three) = (self.derivative::<1>(v), self.derivative::<2>(v), self.derivative::<3>(v));
        let p = dot(&one, &one);
        // p'/2 and p''/2.
        let slope = dot(&one, &two);
        let bend = dot(&two, &two) + dot(&one, &three);
        let inverse = T::ONE / p;
        let first = T::ONE / p.sqrt();
        let second = -slope * (inverse * inverse);
        let third = (T::lit(4.0) * (slope * slope * inverse) - bend) * (inverse * inverse * first);
        let rates = [first, second, third];
        rates.iter().all(|rate| rate.is_finite()).then_some(Rates(rates))
    }

    /// Both ends, of a segment of the length `length`. None where the curve stands still at one.
    pub fn ends(&self, length: T) -> Option<Ends<T>> {
        let parameter = [-T::HALF, T::HALF];
        let [Rates([first_0, second_0, third_0]), Rates([first_1, second_1, third_1])] =
            [self.rates(-T::HALF)?, self.rates(T::HALF)?];
        Some(Ends {
            length,
            parameter,
            first: [first_0, first_1],
            second: [second_0, second_1],
            third: [third_0, third_1],
        })
    }

    /// The arc length over `from..=from + width` by one panel of [`Real::GAUSS`], in mm.
    pub fn panel(&self, from: T, width: T) -> T {
        T::GAUSS.iter().fold(T::ZERO, |sum, &(x, weight)| sum + weight * self.speed(from + x * width)) * width
    }

    /// The arc length over `from..=from + width` to rounding, in mm: 1, 2, 4 .. 64 panels until two sums agree. Load time.
    pub fn length_over(&self, from: T, width: T) -> T {
        const MOST_DOUBLINGS: u32 = 6;
        let mut before = self.panel(from, width);
        for doubling in 1..=MOST_DOUBLINGS {
            let panels = 1 << doubling;
            let part = width / T::from_int(panels);
            let now = (0..panels).fold(T::ZERO, |sum, k| sum + self.panel(from + part * T::from_int(k), part));
            if (now - before).abs() <= T::lit(4.0) * T::ROUNDOFF * now {
                return now;
            }
            before = now;
        }
        before
    }

    /// The arc length of all of it to rounding, in mm. Load time.
    pub fn length(&self) -> T {
        self.length_over(-T::HALF, T::ONE)
    }

    /// Whether |r'| is above zero all along, by more than rounding. Load time.
    ///
    /// |r'|^2 is the sum of one square an axis, each in terms of x^k (1 - x)^(8 - k), which are those of Bernstein without their factor.
    pub fn moves(&self) -> bool {
        let mut square = [T::ZERO; 9];
        for axis in 0..D {
            let mut slope = [T::ZERO; 5];
            for (j, (slope, coefficient)) in (1..).zip(slope.iter_mut().zip(self.0.iter().skip(1))) {
                *slope = coefficient.get(axis).copied().unwrap_or(T::ZERO) * T::from_int(j);
            }
            let mut b = Polynomial(slope).bernstein(-T::HALF, T::ONE);
            for (i, slot) in b.iter_mut().enumerate() {
                *slot = *slot * binomial::<T>(4, i);
            }
            for (i, &x) in b.iter().enumerate() {
                // x_i x_j stands twice in the square, but for j = i.
                let mut factor = x;
                for (slot, &y) in square.iter_mut().skip(2 * i).zip(b.iter().skip(i)) {
                    *slot += factor * y;
                    factor = x + x;
                }
            }
        }
        for (k, slot) in square.iter_mut().enumerate() {
            *slot = *slot * (T::ONE / binomial::<T>(8, k));
        }
        sign(square) == Sign::Positive
    }
}

fn dot<T: Real, const D: usize>(a: &[T; D], b: &[T; D]) -> T {
    a.iter().zip(b).fold(T::ZERO, |sum, (&a, &b)| sum + a * b)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A bent quintic in space.
    pub const BENT: PolynomialSegment<f64, 3> = PolynomialSegment([
        [1.0, -2.0, 0.5],
        [10.0, 1.0, -2.0],
        [-1.0, 5.0, 1.0],
        [2.0, -3.0, 2.0],
        [1.0, 2.0, -1.0],
        [-1.5, 0.5, 0.7],
    ]);

    /// Rates against difference quotients of each other and of the arc length.
    #[test]
    fn rates_are_the_derivatives_of_the_inverse_arc_length() {
        for v in [-0.5, -0.2, 0.0, 0.3, 0.5] {
            let h = 1e-5;
            let Rates([first, second, third]) = BENT.rates(v).unwrap();
            assert!((first * BENT.length_over(v - h, 2.0 * h) / (2.0 * h) - 1.0).abs() < 1e-8);
            // By s, not by v.
            let [before, after] = [v - h, v + h].map(|v| BENT.rates(v).unwrap().0);
            let ds = 2.0 * h / first;
            assert!(((after[0] - before[0]) / ds - second).abs() < 1e-8 * first, "{v}");
            assert!(((after[1] - before[1]) / ds - third).abs() < 1e-8 * first, "{v}");
        }
    }

    /// A parabola y = x^2 over 0..=1 is sqrt(5)/2 + asinh(2)/4 long; in space, a straight way is its chord.
    #[test]
    fn lengths_are_the_closed_forms() {
        let parabola = PolynomialSegment([[0.5, 0.25], [1.0, 1.0], [0.0, 1.0], [0.0; 2], [0.0; 2], [0.0; 2]]);
        let exact = libm::sqrt(5.0) / 2.0 + libm::asinh(2.0) / 4.0;
        assert!((parabola.length() / exact - 1.0).abs() < 1e-14);
        let mut straight = [[0.0_f64; 3]; 6];
        straight[1] = [2.0, 3.0, 6.0];
        assert!((PolynomialSegment(straight).length() - 7.0).abs() < 1e-14);
    }

    /// (v^2, v^3) stands still at its cusp, (v, v^3) nowhere.
    #[test]
    fn a_cusp_is_seen() {
        let with =
            |first: [f64; 2], second| PolynomialSegment([[0.0; 2], first, second, [0.0, 1.0], [0.0; 2], [0.0; 2]]);
        assert!(!with([0.0; 2], [1.0, 0.0]).moves());
        assert!(with([1.0, 0.0], [0.0; 2]).moves());
    }

    /// Against the speed at 1 000 places, of cubics whose hodograph is zero at a random v or near it.
    #[test]
    fn whether_a_curve_moves_is_what_its_speed_says() {
        let mut random = 1_u64;
        let mut number = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 40) as f64 / f64::from(1_u32 << 24) - 0.5
        };
        for _ in 0..500 {
            // r' = (v - c) (a + b v) in x and in y, and in z a constant beside.
            let (c, beside) = (number(), number() * 0.1);
            let [x, y] = [(); 2].map(|()| {
                let (a, b) = (number(), number());
                [-c * a, (a - c * b) / 2.0, b / 3.0]
            });
            let with = |z: f64| {
                let row = |k: usize| [x[k], y[k], if k == 0 { z } else { 0.0 }];
                PolynomialSegment([[0.0; 3], row(0), row(1), row(2), [0.0; 3], [0.0; 3]])
            };
            assert!(!with(0.0).moves());
            let least = |curve: PolynomialSegment<f64, 3>| {
                (0..=1_000).map(|k| curve.speed(f64::from(k) / 1_000.0 - 0.5)).fold(f64::INFINITY, f64::min)
            };
            if least(with(beside)) > 1e-3 {
                assert!(with(beside).moves());
            }
        }
    }
}

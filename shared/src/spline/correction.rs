//! u(s) as the tick evaluates it: about the middle of a segment, as a correction of the straight relation between both.
//!
//! With tau = s/S - 1/2 and q = 1/4 - tau^2, which vanishes at both ends,
//!
//! v(tau) = tau + q (a_1 + b_1 tau) + q^2 (a_2 + b_2 tau) + ..
//!
//! Every pair of terms settles one more derivative at both ends and leaves the lower ones alone: a two-point Taylor series. It is
//! the same polynomial as in powers of s, but its terms are small beside tau, and both ends are met exactly in any arithmetic.

use core::array::from_fn;

use serde::{Deserialize, Serialize};

use crate::jet::Number;
use crate::polynomial::{Polynomial, Sign, binomial, sign};
use crate::real::Real;

/// Which feed correction polynomial a spline piece is driven with. The names are those of the contour form; the wire has numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum CorrectionOrder {
    /// None: the parameter grows evenly with the way. "Natural" interpolation.
    Natural,
    /// The fifth order that meets u and u_s at both ends and is fitted between: figure 5(b).
    #[serde(rename = "fifth")]
    FifthFitted,
    /// The fifth order that meets u, u_s and u_ss at both ends, with nothing left to fit: figure 5(c).
    FifthJoined,
    /// The seventh order, FC(3): meets u, u_s and u_ss, and is fitted between.
    #[default]
    Seventh,
    /// The ninth order: meets u_sss too, so that the jerk of the axes is continuous where the spline's third derivative is.
    Ninth,
}

impl CorrectionOrder {
    /// How many pairs of terms the ends settle.
    pub const fn joined(self) -> usize {
        match self {
            Self::Natural => 0,
            Self::FifthFitted => 1,
            Self::FifthJoined | Self::Seventh => 2,
            Self::Ninth => 3,
        }
    }

    /// The power of q of the one more pair that is fitted to samples; none where nothing is fitted.
    pub const fn fitted(self) -> Option<usize> {
        match self {
            Self::Natural | Self::FifthJoined => None,
            Self::FifthFitted | Self::Seventh | Self::Ninth => Some(self.joined() + 1),
        }
    }
}

/// v(tau), up to the ninth order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction<T> {
    /// a_1 .. a_4.
    pub even: Polynomial<T, 4>,
    /// b_1 .. b_4.
    pub odd: Polynomial<T, 4>,
}

impl<T: Real> Correction<T> {
    /// v = tau.
    pub const NATURAL: Self = Self { even: Polynomial([T::ZERO; 4]), odd: Polynomial([T::ZERO; 4]) };

    /// v at tau, both in -1/2..=1/2. 9 multiplications and 9 additions.
    #[inline(always)]
    pub fn at<N: Number<T>>(&self, tau: N) -> N {
        let q = -(tau * tau) + T::lit(0.25);
        let zero = N::constant(T::ZERO);
        tau + q * (self.even.at(q, zero) + tau * self.odd.at(q, zero))
    }

    /// dv/d(tau).
    pub fn derivative(&self, tau: T) -> T {
        let q = T::lit(0.25) - tau * tau;
        let slope = |Polynomial([_, c1, c2, c3]): Polynomial<T, 4>| (T::lit(3.0) * c3 * q + T::TWO * c2) * q + c1;
        let odd = self.odd.at(q, T::ZERO);
        let inner = self.even.at(q, T::ZERO) + tau * odd;
        let inner_slope = (slope(self.even) + tau * slope(self.odd)) * (-T::TWO * tau) + odd;
        T::ONE - T::TWO * tau * inner + q * inner_slope
    }

    /// Whether v grows all along, by more than rounding. Load time: some 120 operations, half of them additions.
    ///
    /// With x = tau + 1/2, q is x (1 - x) and a + b tau is (a - b/2) (1 - x) + (a + b/2) x. So in terms of x^k (1 - x)^(n - k), which are
    /// those of Bernstein without their factor, every pair of coefficients is put in as it stands, each two degrees above the one before.
    pub fn grows(&self) -> bool {
        let mut sum = [T::ZERO; 10];
        [sum[0], sum[1]] = [-T::HALF, T::HALF];
        for (k, (&a, &b)) in self.even.0.iter().zip(&self.odd.0).enumerate() {
            // Times (x + (1 - x))^2.
            raise(&mut sum);
            raise(&mut sum);
            let half = b * T::HALF;
            sum[k + 1] += a - half;
            sum[k + 2] += a + half;
        }
        let bernstein: [T; 10] = from_fn(|k| sum[k] * (T::ONE / binomial::<T>(9, k)));
        let slope: [T; 9] = from_fn(|k| bernstein[k + 1] - bernstein[k]);
        sign(slope) == Sign::Positive
    }
}

/// Times x + (1 - x), in terms of x^k (1 - x)^(n - k): the next higher degree, of a polynomial that has room for it.
fn raise<T: Real, const N: usize>(sum: &mut [T; N]) {
    let mut before = T::ZERO;
    for slot in sum {
        let here = *slot;
        *slot = here + before;
        before = here;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jet::Jet;

    const SOME: Correction<f64> =
        Correction { even: Polynomial([0.1, -0.3, 0.5, 0.7]), odd: Polynomial([-0.2, 0.4, 0.9, -1.1]) };

    /// The derivative against the Taylor coefficient of the jet, and both ends to the bit, in f32 too.
    #[test]
    fn derivative_and_ends() {
        for k in -50..=50 {
            let tau = f64::from(k) * 0.01;
            let Jet([_, slope, _]) = SOME.at(Jet::variable(tau));
            assert!((SOME.derivative(tau) - slope).abs() < 1e-14);
        }
        assert_eq!((SOME.at(-0.5), SOME.at(0.5)), (-0.5, 0.5));
        let single = Correction { even: Polynomial([0.3_f32; 4]), odd: Polynomial([0.7_f32; 4]) };
        assert_eq!((single.at(-0.5), single.at(0.5)), (-0.5, 0.5));
    }

    /// Against the sign of the derivative at 2 000 places: wherever it is clear.
    #[test]
    fn growth_is_what_the_derivative_says() {
        let mut random = 1_u64;
        let mut number = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 40) as f64 / f64::from(1_u32 << 24) - 0.5
        };
        let mut kinds = [0; 2];
        for _ in 0..2_000 {
            let [even, odd] = [(); 2].map(|()| Polynomial([3.0, 10.0, 28.0, 80.0].map(|size| size * number())));
            let correction = Correction { even, odd };
            let least =
                (0..=2_000).map(|k| correction.derivative(f64::from(k) / 2_000.0 - 0.5)).fold(f64::INFINITY, f64::min);
            if least.abs() > 1e-3 {
                assert_eq!(correction.grows(), least > 0.0, "{correction:?}: {least}");
                kinds[usize::from(least > 0.0)] += 1;
            }
        }
        assert!(kinds[0] > 200 && kinds[1] > 200, "both kinds were seen: {kinds:?}");
        assert!(Correction::<f32>::NATURAL.grows());
    }
}

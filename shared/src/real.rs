//! The scalar of everything that moves: `f32` on the target and in the simulator, `f64` as the oracle of the same code.
//!
//! The tick uses `+ - * /` and comparison only; these are rounded the same way by every IEEE 754 machine, so a host and a
//! Cortex-M4F give the same bits. Nothing here fuses a multiplication with an addition, because not every host could repeat it.
//! Functions below that say *load time* call libm and stay out of the tick.

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A real number: `f32` or `f64`.
pub trait Real:
    Copy
    + Debug
    + PartialEq
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + 'static
{
    /// 0.
    const ZERO: Self;
    /// 1/2.
    const HALF: Self;
    /// 1.
    const ONE: Self;
    /// 2.
    const TWO: Self;
    /// The unit roundoff: the distance from 1 to the next larger number, halved.
    const ROUNDOFF: Self;
    /// Half a quadrant and one quadrant in radians, the latter split into a short leading part and its rest (Cody & Waite).
    const QUADRANT: [Self; 2];
    /// 2/pi.
    const QUADRANTS_PER_RADIAN: Self;
    /// Odd Taylor coefficients of the sine from x^3 on, good to rounding on half a quadrant.
    const SINE: &'static [Self];
    /// Even Taylor coefficients of 1 - cos from x^2 on, good to rounding on half a quadrant.
    const VERSINE: &'static [Self];
    /// Nodes in 0..1 and weights of the Gauss-Legendre rule by which order "exact" integrates equation (21).
    const GAUSS: &'static [(Self, Self)];

    /// A constant of the source text, rounded to this type. Folded when the program is built.
    fn lit(value: f64) -> Self;
    /// A small whole number, exactly.
    fn from_int(value: i32) -> Self;
    /// Magnitude; one instruction.
    fn abs(self) -> Self;
    /// Nearest whole number, halves away from zero, saturating at the ends of `i32`; NaN gives 0.
    fn to_int(self) -> i32;
    /// Whether this is neither infinite nor NaN.
    fn is_finite(self) -> bool;
    /// Square root. Load time.
    fn sqrt(self) -> Self;
    /// Angle of the vector (`x`, `self`), in radians. Load time.
    fn atan2(self, x: Self) -> Self;
    /// This number as `f32`, for error values.
    fn to_f32(self) -> f32;

    /// The smaller of two numbers; the other one where one is NaN.
    #[inline(always)]
    fn least(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    /// The larger of two numbers; the other one where one is NaN.
    #[inline(always)]
    fn most(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    /// (sin x, 1 - cos x) for |x| up to 8 rad, within 2 roundoffs of 1 (test `sine_and_versine`).
    ///
    /// Range reduction by quadrants and two Taylor polynomials: no table, no libm, a bounded number of operations. The versine
    /// instead of the cosine, because a point of an arc relative to its middle is R (1 - cos) away from the tangent there, and
    /// a difference of nearly equal numbers would lose what matters.
    #[inline(always)]
    fn sin_versin(self) -> (Self, Self) {
        let quadrant = (self * Self::QUADRANTS_PER_RADIAN).to_int();
        let turns = Self::from_int(quadrant);
        let x = (self - turns * Self::QUADRANT[0]) - turns * Self::QUADRANT[1];
        let square = x * x;
        let (mut sine, mut versine) = (Self::ZERO, Self::ZERO);
        for &c in Self::SINE.iter().rev() {
            sine = sine * square + c;
        }
        for &c in Self::VERSINE.iter().rev() {
            versine = versine * square + c;
        }
        let (s, v) = (x + x * square * sine, square * versine);
        match quadrant & 3 {
            0 => (s, v),
            1 => (Self::ONE - v, Self::ONE + s),
            2 => (-s, Self::TWO - v),
            _ => (v - Self::ONE, Self::ONE - s),
        }
    }
}

impl Real for f32 {
    const ZERO: f32 = 0.0;
    const HALF: f32 = 0.5;
    const ONE: f32 = 1.0;
    const TWO: f32 = 2.0;
    const ROUNDOFF: f32 = f32::EPSILON / 2.0;
    const QUADRANT: [f32; 2] = [1.570_312_5, 4.838_268e-4];
    const QUADRANTS_PER_RADIAN: f32 = core::f32::consts::FRAC_2_PI;
    const SINE: &'static [f32] = &[-1.0 / 6.0, 1.0 / 120.0, -1.0 / 5_040.0, 1.0 / 362_880.0];
    const VERSINE: &'static [f32] = &[0.5, -1.0 / 24.0, 1.0 / 720.0, -1.0 / 40_320.0, 1.0 / 3_628_800.0];
    const GAUSS: &'static [(f32, f32)] = &[
        (0.046_910_077, 0.118_463_44),
        (0.230_765_35, 0.239_314_34),
        (0.5, 0.284_444_45),
        (0.769_234_66, 0.239_314_34),
        (0.953_089_9, 0.118_463_44),
    ];

    #[inline(always)]
    fn lit(value: f64) -> f32 {
        value as f32
    }

    #[inline(always)]
    fn from_int(value: i32) -> f32 {
        value as f32
    }

    #[inline(always)]
    fn abs(self) -> f32 {
        f32::from_bits(self.to_bits() & 0x7fff_ffff)
    }

    #[inline(always)]
    fn to_int(self) -> i32 {
        (if self < 0.0 { self - 0.5 } else { self + 0.5 }) as i32
    }

    #[inline(always)]
    fn is_finite(self) -> bool {
        f32::is_finite(self)
    }

    fn sqrt(self) -> f32 {
        libm::sqrtf(self)
    }

    fn atan2(self, x: f32) -> f32 {
        libm::atan2f(self, x)
    }

    fn to_f32(self) -> f32 {
        self
    }
}

impl Real for f64 {
    const ZERO: f64 = 0.0;
    const HALF: f64 = 0.5;
    const ONE: f64 = 1.0;
    const TWO: f64 = 2.0;
    const ROUNDOFF: f64 = f64::EPSILON / 2.0;
    const QUADRANT: [f64; 2] = [1.570_796_326_734_125_6, 6.077_100_506_506_192e-11];
    const QUADRANTS_PER_RADIAN: f64 = core::f64::consts::FRAC_2_PI;
    const SINE: &'static [f64] = &[
        -1.0 / 6.0,
        1.0 / 120.0,
        -1.0 / 5_040.0,
        1.0 / 362_880.0,
        -1.0 / 39_916_800.0,
        1.0 / 6_227_020_800.0,
        -1.0 / 1_307_674_368_000.0,
        1.0 / 355_687_428_096_000.0,
    ];
    const VERSINE: &'static [f64] = &[
        0.5,
        -1.0 / 24.0,
        1.0 / 720.0,
        -1.0 / 40_320.0,
        1.0 / 3_628_800.0,
        -1.0 / 479_001_600.0,
        1.0 / 87_178_291_200.0,
        -1.0 / 20_922_789_888_000.0,
        1.0 / 6_402_373_705_728_000.0,
    ];
    const GAUSS: &'static [(f64, f64)] = &[
        (0.019_855_071_751_231_884, 0.050_614_268_145_188_13),
        (0.101_666_761_293_186_63, 0.111_190_517_226_687_24),
        (0.237_233_795_041_835_5, 0.156_853_322_938_943_64),
        (0.408_282_678_752_175_1, 0.181_341_891_689_181),
        (0.591_717_321_247_825, 0.181_341_891_689_181),
        (0.762_766_204_958_164_5, 0.156_853_322_938_943_64),
        (0.898_333_238_706_813_4, 0.111_190_517_226_687_24),
        (0.980_144_928_248_768_1, 0.050_614_268_145_188_13),
    ];

    #[inline(always)]
    fn lit(value: f64) -> f64 {
        value
    }

    #[inline(always)]
    fn from_int(value: i32) -> f64 {
        f64::from(value)
    }

    #[inline(always)]
    fn abs(self) -> f64 {
        f64::from_bits(self.to_bits() & 0x7fff_ffff_ffff_ffff)
    }

    #[inline(always)]
    fn to_int(self) -> i32 {
        (if self < 0.0 { self - 0.5 } else { self + 0.5 }) as i32
    }

    #[inline(always)]
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }

    fn sqrt(self) -> f64 {
        libm::sqrt(self)
    }

    fn atan2(self, x: f64) -> f64 {
        libm::atan2(self, x)
    }

    fn to_f32(self) -> f32 {
        self as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the platform's own functions in double precision, over the whole stated range.
    #[test]
    fn sine_and_versine() {
        for k in -80_000..=80_000 {
            let x = f64::from(k) * 1e-4;
            let (s, v) = x.sin_versin();
            assert!((s - libm::sin(x)).abs() < 2.0 * f64::EPSILON, "sin {x}");
            assert!((v - (1.0 - libm::cos(x))).abs() < 2.0 * f64::EPSILON, "versin {x}");
            let x = x as f32;
            let (s, v) = x.sin_versin();
            assert!((f64::from(s) - libm::sin(f64::from(x))).abs() < 2.0 * f64::from(f32::EPSILON), "sin {x}");
            assert!((f64::from(v) - (1.0 - libm::cos(f64::from(x)))).abs() < 2.0 * f64::from(f32::EPSILON));
        }
    }

    /// A small angle keeps its relative accuracy: 1 - cos x is x^2/2 there, which a cosine could not tell.
    #[test]
    fn versine_of_a_small_angle_is_relatively_exact() {
        for x in [1e-3_f32, 1e-6, 3e-9] {
            let exact = 2.0 * libm::pow(libm::sin(f64::from(x) / 2.0), 2.0);
            assert!((f64::from(x.sin_versin().1) / exact - 1.0).abs() < 3e-7, "{x}");
        }
    }

    /// The rules integrate the monomials that a Gauss rule of their size must integrate exactly.
    #[test]
    fn gauss_rules_are_exact_for_their_degree() {
        for power in 0..2 * f64::GAUSS.len() as i32 {
            let sum: f64 = f64::GAUSS.iter().map(|&(x, w)| w * libm::pow(x, f64::from(power))).sum();
            assert!((sum * f64::from(power + 1) - 1.0).abs() < 1e-14, "{power}");
        }
        for power in 0..2 * f32::GAUSS.len() as i32 {
            let sum: f64 =
                f32::GAUSS.iter().map(|&(x, w)| f64::from(w) * libm::pow(f64::from(x), f64::from(power))).sum();
            assert!((sum * f64::from(power + 1) - 1.0).abs() < 3e-7, "{power}");
        }
    }
}

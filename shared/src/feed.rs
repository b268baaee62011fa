//! The feed law of Farouki & Srinathu (2018): ramps at corners, and the weight between contact feed and centre feed.
//!
//! With x the covered fraction of a ramp, the quintics of equations (7)-(8) and (10)-(11) are both
//! F = f + (1 - f) x^3 (10 - 15 x + 6 x^2): F rises from f to 1 with vanishing first and second derivatives at both ends.

use serde::{Deserialize, Serialize};

use crate::error::PathError;
use crate::jet::Number;
use crate::real::Real;

/// A feed ramp at one end of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Ramp<T> {
    /// lambda: the fraction of the piece's contact length that the ramp takes, in 0..=1.
    pub length: T,
    /// f: the fraction of the feed that is left at the corner, above 0 and at most 1. At 0 the corner would never be reached:
    /// the integral of 1/F diverges.
    pub factor: T,
}

/// The least factor of a ramp. Below some 1e-19 the rounding of u alone may turn F around, and no corner is ever reached anyway.
const LEAST: f64 = 1e-12;

/// A ramp that the tick may use: its values are in range, and a ramp of no length never acts.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ActiveRamp<T> {
    length: T,
    per_length: T,
    factor: T,
    rise: T,
}

impl<T: Real> ActiveRamp<T> {
    const NONE: Self = Self { length: T::ZERO, per_length: T::ZERO, factor: T::ONE, rise: T::ZERO };

    fn activate(ramp: Option<Ramp<T>>) -> Result<Self, PathError> {
        let Some(Ramp { length, factor }) = ramp else { return Ok(Self::NONE) };
        if !(length >= T::ZERO && length <= T::ONE) {
            return Err(PathError::RampLength { length: length.to_f32() });
        }
        if !(factor >= T::lit(LEAST) && factor <= T::ONE) {
            return Err(PathError::Reduction { factor: factor.to_f32() });
        }
        // Shorter than that, 1/lambda is no number any more, and no motion could show the ramp.
        if length < T::lit(1e-6) {
            return Ok(Self { factor, ..Self::NONE });
        }
        Ok(Self { length, per_length: T::ONE / length, factor, rise: T::ONE - factor })
    }

    /// F at the covered length `u` of this ramp's end of the piece.
    #[inline(always)]
    fn at<N: Number<T>>(&self, u: N) -> N {
        let x = u * self.per_length;
        let blend = x * x * x * (x * (x * T::lit(6.0) + T::lit(-15.0)) + T::lit(10.0));
        blend * self.rise + self.factor
    }
}

/// The factor F(u) of equation (21) on one piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedLaw<T> {
    start: ActiveRamp<T>,
    end: ActiveRamp<T>,
}

impl<T: Real> FeedLaw<T> {
    /// Checks lambda in 0..=1, f in (0, 1], and that the two lambda sum to at most 1 (section 4.1).
    pub fn activate(start: Option<Ramp<T>>, end: Option<Ramp<T>>) -> Result<Self, PathError> {
        let law = Self { start: ActiveRamp::activate(start)?, end: ActiveRamp::activate(end)? };
        let sum = law.start.length + law.end.length;
        // Two decimals that sum to 1 may sum to a roundoff more in binary.
        if sum > T::ONE + T::lit(4.0) * T::ROUNDOFF {
            return Err(PathError::Ramps { sum: sum.to_f32() });
        }
        Ok(law)
    }

    /// F at the arc-length fraction `u` of equations (6) and (9): within f..=1 for u in 0..=1, to rounding.
    /// At most 8 multiplications and additions.
    #[inline(always)]
    pub fn factor<N: Number<T>>(&self, u: N) -> N {
        if u.value() < self.start.length {
            self.start.at(u)
        } else if u.value() > T::ONE - self.end.length {
            self.end.at(-u + T::ONE)
        } else {
            N::constant(T::ONE)
        }
    }

    /// Where F leaves and where it takes up a ramp, as fractions u: F is one polynomial between neighbouring knots.
    pub fn knots(&self) -> [T; 2] {
        [self.start.length, T::ONE - self.end.length]
    }

    /// The length of the shorter ramp that there is, as a fraction of the piece; 1 without ramps.
    pub fn shortest_ramp(&self) -> T {
        let of = |ramp: &ActiveRamp<T>| if ramp.length > T::ZERO { ramp.length } else { T::ONE };
        of(&self.start).least(of(&self.end))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jet::Jet;

    /// The Bernstein form of equations (7) and (8), term by term.
    fn published(u: f64, lambda: f64, f: f64) -> f64 {
        let coefficients = [1.0, 1.0, 1.0, f, f, f];
        let binomials = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
        (0..6)
            .map(|i| {
                let k = i as i32;
                coefficients[i] * binomials[i] * (1.0 - u).powi_(5 - k) * (u - 1.0 + lambda).powi_(k) / lambda.powi_(5)
            })
            .sum()
    }

    trait Power {
        fn powi_(self, n: i32) -> Self;
    }

    impl Power for f64 {
        fn powi_(self, n: i32) -> f64 {
            (0..n).fold(1.0, |p, _| p * self)
        }
    }

    #[test]
    fn the_ramps_are_the_published_quintics() {
        for (lambda, f) in [(0.25, 0.25), (0.5, 0.01), (0.1, 0.75)] {
            let ramp = Some(Ramp { length: lambda, factor: f });
            let law = FeedLaw::activate(ramp, ramp).unwrap();
            for k in 0..=100 {
                let u = 1.0 - lambda * f64::from(k) / 100.0;
                assert!((law.factor(u) - published(u, lambda, f)).abs() < 1e-12);
                assert!((law.factor(1.0 - u) - published(u, lambda, f)).abs() < 1e-12, "the other end is its mirror");
            }
        }
    }

    #[test]
    fn the_ramps_join_with_two_derivatives() {
        let law = FeedLaw::activate(None, Some(Ramp { length: 0.3_f64, factor: 0.2 })).unwrap();
        for (u, value) in [(0.700_000_000_001, 1.0), (0.999_999_999_999, 0.2)] {
            let Jet([f, first, second]) = law.factor(Jet::variable(u));
            assert!((f - value).abs() < 1e-9 && first.abs() < 1e-9 && second.abs() < 1e-8, "{u}");
        }
    }

    #[test]
    fn what_would_not_move_is_refused() {
        let ramp = |length, factor| Some(Ramp { length, factor });
        assert_eq!(FeedLaw::activate(ramp(0.25_f32, 0.0), None), Err(PathError::Reduction { factor: 0.0 }));
        assert_eq!(FeedLaw::activate(ramp(0.25_f32, 1e-13), None), Err(PathError::Reduction { factor: 1e-13 }));
        assert!(FeedLaw::activate(ramp(0.25_f32, 1e-11), None).is_ok());
        assert_eq!(FeedLaw::activate(ramp(0.25_f32, 1.5), None), Err(PathError::Reduction { factor: 1.5 }));
        assert_eq!(FeedLaw::activate(None, ramp(1.5_f32, 1.0)), Err(PathError::RampLength { length: 1.5 }));
        assert_eq!(FeedLaw::activate(ramp(0.75_f32, 1.0), ramp(0.5, 1.0)), Err(PathError::Ramps { sum: 1.25 }));
        assert!(FeedLaw::activate(ramp(f32::NAN, 1.0), None).is_err());
        assert!(FeedLaw::activate(ramp(0.1_f32, 1.0), ramp(0.9, 1.0)).is_ok());
    }
}

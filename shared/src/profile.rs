//! The feed as a function of time: what a planner gives a piece in the place of the ramps of [`crate::feed`].
//!
//! A plan within limits of velocity, acceleration and jerk is made of stretches on which one of them is constant, and on each of those
//! the feed is a polynomial of degree 2 at most in time. So F of equation (21) is a cubic in the time theta on the piece, by its
//! value and its slope at both ends: neighbours join with continuous acceleration, a constant acceleration or jerk is one piece,
//! exactly, and a rest is an end like any other, with F = 0, which no law in arc length reaches. What the paper leaves open, how
//! lambda and f follow from axis limits, has no good answer in its own terms: its ramps have no slope at either end, so that
//! a chain of pieces could never speed up across a node.
//!
//! Its integral is the fraction u of the piece's contact length, a quartic in theta. The duration D makes it 1 at the end:
//! D V (b_0 + b_1 + b_2 + b_3)/4 = S with the Bernstein coefficients b of F. The step of equation (22) predicts the parameter, and
//! one Newton step on u(tau) = u(theta) corrects it: the motion stays in time whatever the order, and is at the piece's end when the time
//! is (test `a_profile_keeps_its_time`). Along a profile the feed is that of the contact point: w is the planner's affair.

use serde::{Deserialize, Serialize};

use crate::accumulator::Accumulator;
use crate::error::PathError;
use crate::polynomial::Polynomial;
use crate::real::Real;

/// The Bernstein coefficients of F over the time of a piece, in parts of its feed V: each in 0..=1, one of them at least a half.
///
/// The first and the last are F at the ends, zero for a rest; three times a difference of neighbours over the duration is its slope there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Profile<T> {
    /// b_0 to b_3.
    pub factors: [T; 4],
}

/// A profile that the tick may use. The time theta runs over -1/2..=1/2 on the piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActiveProfile<T> {
    /// u - 1/2 in powers of theta.
    fraction: Polynomial<T, 5>,
    duration: T,
    per_duration: T,
    /// S/V in s.
    per_base: T,
}

impl<T: Real> ActiveProfile<T> {
    /// Checks a profile; `base` is V/S of the piece in 1/s. Load time.
    ///
    /// Errors: [`PathError::Profile`] for a coefficient outside 0..=1, or none that is a half or more: V is not what it is a part of then.
    pub fn activate(profile: &Profile<T>, base: T) -> Result<Self, PathError> {
        let b = profile.factors;
        let largest = b.iter().fold(T::ZERO, |largest: T, &b| largest.most(b));
        if !(b.iter().all(|&b| b >= T::ZERO && b <= T::ONE) && largest >= T::HALF) {
            return Err(PathError::Profile { factors: b.map(T::to_f32) });
        }
        let [b0, b1, b2, b3] = b;
        let sum = b0 + b1 + b2 + b3;
        let quarter = T::lit(0.25);
        let eighth = T::lit(0.125);
        // With t = theta + 1/2 the cubic is b0 (1-t)^3 + 3 b1 t (1-t)^2 + 3 b2 t^2 (1-t) + b3 t^3, about its middle.
        let three = T::lit(3.0);
        let factor = [
            (b0 + b3 + three * (b1 + b2)) * eighth,
            (b3 - b0 + (b2 - b1)) * (three * quarter),
            (b0 + b3 - (b1 + b2)) * (three * T::HALF),
            b3 - b0 - three * (b2 - b1),
        ];
        // The integral, so that it is 1/2 at 1/2 and -1/2 at -1/2.
        let scale = T::lit(4.0) / sum;
        let [f0, f1, f2, f3] = factor.map(|c| c * scale);
        let even = f1 * T::HALF * quarter + f3 * quarter * (quarter * quarter);
        let fraction = [-even, f0, f1 * T::HALF, f2 * T::lit(1.0 / 3.0), f3 * quarter];
        let duration = scale / base;
        if !(duration.is_finite() && duration > T::ZERO) {
            return Err(PathError::NotFinite);
        }
        Ok(Self { fraction: Polynomial(fraction), duration, per_duration: base / scale, per_base: T::ONE / base })
    }

    /// u - 1/2 at the time theta: from -1/2 to 1/2. 4 multiplications and additions.
    #[inline(always)]
    pub fn fraction(&self, theta: T) -> T {
        self.fraction.at(theta, T::ZERO)
    }

    /// F at the time theta, to rounding within 0..=1. For reports: the tick asks for u.
    pub fn factor(&self, theta: T) -> T {
        let (_, slope) = self.fraction.value_and_slope(theta);
        (slope * self.per_duration * self.per_base).most(T::ZERO)
    }

    /// The integral of F over the time in which the fraction grows by `step`, in s.
    #[inline(always)]
    pub fn way(&self, step: T) -> T {
        step * self.per_base
    }

    /// The time that the piece takes, in s.
    pub fn duration(&self) -> T {
        self.duration
    }

    /// The time that is left on the piece, in s.
    #[inline(always)]
    pub fn left(&self, theta: &Accumulator<T>) -> T {
        theta.left_to(T::HALF) * self.duration
    }

    /// Moves theta on by `time` s; what is left of that where the piece ends first.
    #[inline(always)]
    pub fn advance(&self, theta: &mut Accumulator<T>, time: T) -> Option<T> {
        let step = time * self.per_duration;
        let room = theta.left_to(T::HALF);
        if step < room {
            theta.add(step);
            return None;
        }
        Some((time - room * self.duration).most(T::ZERO).least(time))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bernstein([b0, b1, b2, b3]: [f64; 4], t: f64) -> f64 {
        let s = 1.0 - t;
        b0 * s * s * s + 3.0 * b1 * t * s * s + 3.0 * b2 * t * t * s + b3 * t * t * t
    }

    /// F is the Bernstein form, u its integral by Simpson's rule (exact for a cubic), and the duration makes u end at 1.
    #[test]
    fn the_fraction_is_the_integral_of_the_factor() {
        for factors in [[0.0, 0.0, 1.0, 1.0], [1.0, 1.0, 1.0, 1.0], [0.2, 0.7, 0.9, 1.0], [1.0, 0.3, 0.1, 0.0]] {
            let base = 2.5;
            let profile = ActiveProfile::activate(&Profile { factors }, base).unwrap();
            for k in 0..=16 {
                let t = f64::from(k) / 16.0;
                assert!((profile.factor(t - 0.5) - bernstein(factors, t)).abs() < 1e-14);
                let simpson =
                    t / 6.0 * (bernstein(factors, 0.0) + 4.0 * bernstein(factors, t / 2.0) + bernstein(factors, t));
                let u = simpson * base * profile.duration();
                assert!((profile.fraction(t - 0.5) + 0.5 - u).abs() < 1e-14, "{factors:?} at {t}");
            }
            assert!((profile.fraction(0.5) - 0.5).abs() < 1e-15);
        }
    }

    #[test]
    fn what_would_not_move_is_refused() {
        for factors in [[0.0; 4], [0.4; 4], [1.0, -0.1, 1.0, 1.0], [1.0, 1.1, 1.0, 1.0], [1.0, f64::NAN, 1.0, 1.0]] {
            assert!(matches!(ActiveProfile::activate(&Profile { factors }, 1.0), Err(PathError::Profile { .. })));
        }
    }
}

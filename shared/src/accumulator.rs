//! The parameter along a piece, in two words.
//!
//! A single f32 loses small steps near 1: at 0.01 mm/s on a 100 mm piece a tick moves the parameter by 1e-7, the spacing of
//! f32 there. The sum of a leading word and the exact rest of it holds twice the bits [Knuth, TAOCP 2, 4.2.2].

use crate::real::Real;

/// An unevaluated sum `high` + `low`, with |low| at most one roundoff of high.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accumulator<T> {
    high: T,
    low: T,
}

impl<T: Real> Accumulator<T> {
    /// Starts at `value`, exactly.
    pub const fn new(value: T) -> Self {
        Self { high: value, low: T::ZERO }
    }

    /// The sum, rounded.
    #[inline(always)]
    pub fn value(&self) -> T {
        self.high
    }

    /// Adds `step`. Ten additions; the error is two roundoffs squared of the sum.
    #[inline(always)]
    pub fn add(&mut self, step: T) {
        let (sum, rest) = two_sum(self.high, step);
        let low = self.low + rest;
        self.high = sum + low;
        self.low = low - (self.high - sum);
    }

    /// The distance from here up to `end`; exact in the leading words where they are within a factor of two.
    #[inline(always)]
    pub fn left_to(&self, end: T) -> T {
        (end - self.high) - self.low
    }
}

/// The rounded sum and what the rounding lost, exactly.
#[inline(always)]
fn two_sum<T: Real>(a: T, b: T) -> (T, T) {
    let sum = a + b;
    let b_seen = sum - a;
    let a_seen = sum - b_seen;
    (sum, (a - a_seen) + (b - b_seen))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten million steps of which a plain f32 would lose a tenth each.
    #[test]
    fn small_steps_are_not_lost() {
        let step = 1e-7_f32;
        let mut sum = Accumulator::new(-0.5_f32);
        let mut plain = -0.5_f32;
        for _ in 0..9_000_000 {
            sum.add(step);
            plain += step;
        }
        let exact = -0.5 + 9e6 * f64::from(step);
        assert!((f64::from(sum.value()) - exact).abs() < 5e-8);
        assert!((f64::from(plain) - exact).abs() > 1e-3, "a single word would do, and this module would not be needed");
    }
}

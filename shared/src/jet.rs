//! Numbers that carry their own Taylor series: one formula serves for values and for the derivatives of orders 2 and 3.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::real::Real;

/// What a formula of the feed law may be evaluated on: a plain number or a [`Jet`].
pub trait Number<T>:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<T, Output = Self>
    + Mul<T, Output = Self>
{
    /// A number that does not depend on the parameter.
    fn constant(value: T) -> Self;
    /// The value, without its series.
    fn value(self) -> T;
}

impl<T: Real> Number<T> for T {
    #[inline(always)]
    fn constant(value: T) -> T {
        value
    }

    #[inline(always)]
    fn value(self) -> T {
        self
    }
}

/// c_0 + c_1 h + c_2 h^2: a value with the first two Taylor coefficients (not derivatives: c_2 is half of one).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet<T>(pub [T; 3]);

impl<T: Real> Jet<T> {
    /// The parameter itself at `value`.
    #[inline(always)]
    pub fn variable(value: T) -> Self {
        Self([value, T::ONE, T::ZERO])
    }
}

impl<T: Real> Number<T> for Jet<T> {
    #[inline(always)]
    fn constant(value: T) -> Self {
        Self([value, T::ZERO, T::ZERO])
    }

    #[inline(always)]
    fn value(self) -> T {
        self.0[0]
    }
}

impl<T: Real> Add for Jet<T> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let (Self([a, b, c]), Self([x, y, z])) = (self, other);
        Self([a + x, b + y, c + z])
    }
}

impl<T: Real> Add<T> for Jet<T> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: T) -> Self {
        let Self([a, b, c]) = self;
        Self([a + other, b, c])
    }
}

impl<T: Real> Sub for Jet<T> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<T: Real> Neg for Jet<T> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.map(|c| -c))
    }
}

impl<T: Real> Mul for Jet<T> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (Self([a, b, c]), Self([x, y, z])) = (self, other);
        Self([a * x, a * y + b * x, a * z + b * y + c * x])
    }
}

impl<T: Real> Mul<T> for Jet<T> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: T) -> Self {
        Self(self.0.map(|c| c * factor))
    }
}

impl<T: Real> Div for Jet<T> {
    type Output = Self;

    /// One division.
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let (Self([a, b, c]), Self([x, y, z])) = (self, other);
        let inverse = T::ONE / x;
        let p = a * inverse;
        let q = (b - p * y) * inverse;
        Self([p, q, (c - p * z - q * y) * inverse])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1/(1 - h) has the series 1 + h + h^2; times (1 + h)^2 it is 1 + 3h + 4h^2.
    #[test]
    fn quotients_and_products_have_their_known_series() {
        let h = Jet::variable(0.0_f64);
        let geometric = Jet::constant(1.0) / (Jet::constant(1.0) - h);
        assert_eq!(geometric, Jet([1.0, 1.0, 1.0]));
        assert_eq!(geometric * (h + 1.0) * (h + 1.0), Jet([1.0, 3.0, 4.0]));
    }
}

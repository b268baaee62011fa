//! Points and vectors of the plane as complex numbers, as in the papers: x + i y.

use core::ops::{Add, Mul, Neg, Sub};

use serde::{Deserialize, Serialize};

use crate::real::Real;

/// A point, a vector or a preimage value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Complex<T> {
    /// Real part; x of a point.
    pub re: T,
    /// Imaginary part; y of a point.
    pub im: T,
}

impl<T: Real> Complex<T> {
    /// 0.
    pub const ZERO: Self = Self { re: T::ZERO, im: T::ZERO };

    /// `re` + i `im`.
    #[inline(always)]
    pub const fn new(re: T, im: T) -> Self {
        Self { re, im }
    }

    /// The complex conjugate.
    #[inline(always)]
    pub fn conj(self) -> Self {
        Self::new(self.re, -self.im)
    }

    /// The square of the magnitude.
    #[inline(always)]
    pub fn norm_sqr(self) -> T {
        self.re * self.re + self.im * self.im
    }

    /// The magnitude. Load time: it takes a root.
    pub fn norm(self) -> T {
        self.norm_sqr().sqrt()
    }

    /// The angle from the real axis in -pi..=pi. Load time.
    pub fn arg(self) -> T {
        self.im.atan2(self.re)
    }

    /// The square.
    #[inline(always)]
    pub fn square(self) -> Self {
        Self::new(self.re * self.re - self.im * self.im, T::TWO * (self.re * self.im))
    }

    /// This vector turned by -90 degrees: right of travel, as the normal of equation (1).
    #[inline(always)]
    pub fn right(self) -> Self {
        Self::new(self.im, -self.re)
    }

    /// This vector turned by +90 degrees: left of travel.
    #[inline(always)]
    pub fn left(self) -> Self {
        Self::new(-self.im, self.re)
    }

    /// The scalar product: Re(conj(self) other).
    #[inline(always)]
    pub fn dot(self, other: Self) -> T {
        self.re * other.re + self.im * other.im
    }

    /// The z component of the vector product: Im(conj(self) other).
    #[inline(always)]
    pub fn cross(self, other: Self) -> T {
        self.re * other.im - self.im * other.re
    }

    /// The principal square root: its real part is not negative. Load time.
    pub fn sqrt(self) -> Self {
        let norm = self.norm();
        if norm == T::ZERO {
            return Self::ZERO;
        }
        // The larger of the two parts first: the other follows by division, without cancellation.
        let larger = ((norm + self.re.abs()) * T::HALF).sqrt();
        let smaller = self.im.abs() / (larger + larger);
        let (re, im) = if self.re >= T::ZERO { (larger, smaller) } else { (smaller, larger) };
        Self::new(re, if self.im < T::ZERO { -im } else { im })
    }

    /// Whether both parts are finite.
    pub fn is_finite(self) -> bool {
        self.re.is_finite() && self.im.is_finite()
    }
}

impl<T: Real> Add for Complex<T> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.re + other.re, self.im + other.im)
    }
}

impl<T: Real> Sub for Complex<T> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.re - other.re, self.im - other.im)
    }
}

impl<T: Real> Neg for Complex<T> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.re, -self.im)
    }
}

impl<T: Real> Mul for Complex<T> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self::new(self.re * other.re - self.im * other.im, self.re * other.im + self.im * other.re)
    }
}

impl<T: Real> Mul<T> for Complex<T> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: T) -> Self {
        Self::new(self.re * factor, self.im * factor)
    }
}

impl From<Complex<f64>> for Complex<f32> {
    fn from(z: Complex<f64>) -> Self {
        Complex { re: z.re as f32, im: z.im as f32 }
    }
}

impl From<Complex<f32>> for Complex<f64> {
    fn from(z: Complex<f32>) -> Self {
        Complex { re: z.re.into(), im: z.im.into() }
    }
}

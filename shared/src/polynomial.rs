//! Polynomials of a fixed degree, in powers of a parameter that stays within -1/2..=1/2.
//!
//! Powers, because Horner's scheme is the cheapest evaluation there is; a centred parameter, because it keeps the powers small:
//! on a whole quintic the coefficients then are no larger than the curve, where powers of 0..=1 can be a hundred times larger.

use core::ops::{Add, Mul};

use crate::real::Real;

/// c_0 + c_1 x + ... of degree N - 1, with real or complex coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polynomial<C, const N: usize>(pub [C; N]);

impl<C: Copy, const N: usize> Polynomial<C, N> {
    /// The value at `x` by Horner's scheme: N - 1 multiplications and additions (twice that for complex coefficients).
    /// Unrolled when the program is built; without coefficients it is `zero`.
    #[inline(always)]
    pub fn at<X: Copy, V: Copy + Add<C, Output = V> + Mul<X, Output = V>>(&self, x: X, zero: V) -> V {
        let mut value = zero;
        for &c in self.0.iter().rev() {
            value = value * x + c;
        }
        value
    }
}

impl<T: Real, const N: usize> Polynomial<T, N> {
    /// The value and the derivative at `x`: 2 N - 3 multiplications and additions.
    #[inline(always)]
    pub fn value_and_slope(&self, x: T) -> (T, T) {
        let (mut value, mut slope) = (T::ZERO, T::ZERO);
        for &c in self.0.iter().rev() {
            slope = slope * x + value;
            value = value * x + c;
        }
        (value, slope)
    }

    /// The Bernstein coefficients over `from..=from + width`. Load time: some 2 N^2 operations.
    pub fn bernstein(&self, from: T, width: T) -> [T; N] {
        // Powers of x in from + width x, by repeated synthetic division.
        let mut powers = self.0;
        for low in 0..N {
            for k in (low + 1..N).rev() {
                powers[k - 1] += powers[k] * from;
            }
        }
        let mut scale = T::ONE;
        for power in &mut powers {
            *power = *power * scale;
            scale = scale * width;
        }
        // b_i is the sum of a_j (i over j)/(n over j).
        let mut bernstein = [T::ZERO; N];
        for (i, slot) in bernstein.iter_mut().enumerate() {
            for (j, &power) in powers.iter().enumerate().take(i + 1) {
                *slot += power * (binomial::<T>(i, j) / binomial::<T>(N - 1, j));
            }
        }
        bernstein
    }
}

/// What is known of a polynomial's sign on an interval.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// Above zero everywhere.
    Positive,
    /// Below zero everywhere.
    Negative,
    /// Zero somewhere, or too close to tell.
    Vanishing,
}

/// The sign over the whole of -1/2..=1/2 of the polynomial with these Bernstein coefficients.
///
/// Coefficients of one sign, by more than their rounding, prove it; otherwise the interval is halved by de Casteljau's scheme,
/// down to 2^-[`HALVINGS`] of it. Load time: at most 2 [`HALVINGS`] subdivisions near one zero, and a polynomial has few.
pub fn sign<T: Real, const N: usize>(bernstein: [T; N]) -> Sign {
    let end = bernstein.first().copied().unwrap_or(T::ZERO);
    let largest = bernstein.iter().fold(T::ZERO, |largest: T, b| largest.most(b.abs()));
    let least = largest * (T::lit(8.0) * T::ROUNDOFF);
    let flip = if end < T::ZERO { -T::ONE } else { T::ONE };
    // Depth first; the halves still to be looked at, at most one a level.
    let mut pending: heapless::Vec<([T; N], u32), { HALVINGS as usize + 1 }> = heapless::Vec::new();
    let mut current = Some((bernstein.map(|b| b * flip), 0));
    while let Some((mut part, depth)) = current {
        if part.iter().all(|&b| b > least) {
            current = pending.pop();
            continue;
        }
        let ends_hold = part.first().is_some_and(|&b| b > least) && part.last().is_some_and(|&b| b > least);
        if depth >= HALVINGS || !ends_hold {
            return Sign::Vanishing;
        }
        // de Casteljau at the middle: `part` becomes the right half, `left` collects the left one.
        let mut left = part;
        for (k, slot) in left.iter_mut().enumerate().skip(1) {
            for j in 0..N - k {
                part[j] = (part[j] + part[j + 1]) * T::HALF;
            }
            *slot = part[0];
        }
        if pending.push((part, depth + 1)).is_err() {
            return Sign::Vanishing;
        }
        current = Some((left, depth + 1));
    }
    if end < T::ZERO { Sign::Negative } else { Sign::Positive }
}

/// How often [`sign`] halves the interval before it gives up.
pub const HALVINGS: u32 = 16;

/// The Bernstein coefficients on -1/2..=1/2 of the product of two polynomials that are given by theirs.
pub fn bernstein_product<T: Real, const A: usize, const B: usize, const N: usize>(a: [T; A], b: [T; B]) -> [T; N] {
    let mut product = [T::ZERO; N];
    for (i, &x) in a.iter().enumerate() {
        for (j, &y) in b.iter().enumerate() {
            if let Some(slot) = product.get_mut(i + j) {
                *slot += x * y * binomial::<T>(A - 1, i) * binomial::<T>(B - 1, j);
            }
        }
    }
    for (k, slot) in product.iter_mut().enumerate() {
        *slot = *slot / binomial::<T>(N - 1, k);
    }
    product
}

/// n over k for the small degrees of this crate.
pub(crate) fn binomial<T: Real>(n: usize, k: usize) -> T {
    (1..=k).fold(T::ONE, |product, j| product * T::from_int((n + 1 - j) as i32) / T::from_int(j as i32))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both ends and a point between them, of a quintic over a part of its interval.
    #[test]
    fn the_bernstein_form_is_the_same_polynomial() {
        let quintic = Polynomial([0.3_f64, -1.2, 4.0, 0.7, -2.5, 1.1]);
        let b = quintic.bernstein(-0.4, 0.7);
        for x in [0.0_f64, 0.25, 1.0] {
            let mut points = b;
            for k in 1..6 {
                for j in 0..6 - k {
                    points[j] = points[j] * (1.0 - x) + points[j + 1] * x;
                }
            }
            assert!((points[0] - quintic.at(-0.4 + 0.7 * x, 0.0)).abs() < 1e-14, "{x}");
        }
    }

    #[test]
    fn a_double_zero_and_a_near_miss_are_told_apart() {
        // (x - 0.2)^2 on -1/2..=1/2, and the same raised by 1e-6.
        let square = bernstein_product::<f64, 2, 2, 3>([-0.7, 0.3], [-0.7, 0.3]);
        assert_eq!(sign(square), Sign::Vanishing);
        assert_eq!(sign(square.map(|b| b + 1e-6)), Sign::Positive);
        assert_eq!(sign(square.map(|b| -b - 1e-6)), Sign::Negative);
        assert_eq!(sign([1.0, -1.0]), Sign::Vanishing);
        assert_eq!(sign([1.0, -0.4, 1.0]), Sign::Positive);
    }
}

//! The fit as it was published: FC(15) to FC(20), in powers of s, from any number of samples in one pass.
//!
//! Every function is one line of the paper's Table 2, so that its operations can be counted beside the published ones; `hodograph
//! reproduce feed-correction` does, with a scalar that counts. The tick does not use this form: [`super::fit`](mod@super::fit) comes to the same polynomial
//! from fewer samples and without powers of s, which lose digits.

use super::segment::Ends;
use crate::real::Real;

/// sigma and its powers up to the seventh.
type Powers<T> = [T; 7];

/// The fit of one segment under way: FC(16) to FC(19).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Published<T> {
    /// 1/S .. 1/S^7.
    inverse: Powers<T>,
    scaled: Scaled<T>,
    /// u at the start, and all of its growth.
    start: T,
    growth: T,
    /// The sums ii, if, ff, iy, fy of FC(19).
    sums: [T; 5],
}

/// What the ends ask for, without dimension: S u_s and S^2 u_ss at both, and S^3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scaled<T> {
    /// S u_s.
    pub first: [T; 2],
    /// S^2 u_ss.
    pub second: [T; 2],
    /// S^3.
    pub cube: T,
}

impl<T: Real> Published<T> {
    /// Begins the fit of a segment whose ends are known.
    pub fn new(ends: &Ends<T>) -> Self {
        let [start, end] = ends.parameter;
        Self {
            inverse: inverse_powers(ends.length),
            scaled: scaled(ends),
            start,
            growth: end - start,
            sums: [T::ZERO; 5],
        }
    }

    /// Takes a sample between both ends: the parameter `u` at the way `s`.
    pub fn sample(&mut self, s: T, u: T) {
        let [per_length, ..] = self.inverse;
        let powers = powers(s * per_length);
        let (phi_i, phi_f) = (bump_start(&powers), bump_end(&powers));
        let y = u - remainder(&powers, self.start, self.growth, &self.scaled);
        accumulate(&mut self.sums, phi_i, phi_f, y);
    }

    /// A, B .. H: u(s) = A s^7 + .. + H.
    pub fn finish(&self) -> [T; 8] {
        let third = solve(&self.sums);
        coefficients(&self.inverse, self.start, self.growth, &self.scaled, third)
    }
}

/// 1/S to 1/S^7, for FC(15).
pub fn inverse_powers<T: Real>(length: T) -> Powers<T> {
    powers(T::ONE / length)
}

/// sigma to sigma^7, for FC(17).
pub fn powers<T: Real>(sigma: T) -> Powers<T> {
    let mut powers = [sigma; 7];
    let mut power = sigma;
    for slot in powers.iter_mut().skip(1) {
        power = power * sigma;
        *slot = power;
    }
    powers
}

/// S u_s, S^2 u_ss and S^3.
pub fn scaled<T: Real>(ends: &Ends<T>) -> Scaled<T> {
    let square = ends.length * ends.length;
    Scaled {
        first: ends.first.map(|first| first * ends.length),
        second: ends.second.map(|second| second * square),
        cube: square * ends.length,
    }
}

/// phi_i = sigma^3 (1 - sigma)^4/6, for S^3 u_sss at the start.
pub fn bump_start<T: Real>(&[_, _, p3, p4, p5, p6, p7]: &Powers<T>) -> T {
    (p3 + p7) * T::lit(1.0 / 6.0) - (p4 + p6) * T::lit(2.0 / 3.0) + p5
}

/// phi_f = -sigma^4 (1 - sigma)^3/6, for S^3 u_sss at the end.
pub fn bump_end<T: Real>(&[_, _, _, p4, p5, p6, p7]: &Powers<T>) -> T {
    (p7 - p4) * T::lit(1.0 / 6.0) + (p5 - p6) * T::HALF
}

/// u~ of FC(17): what is left without both third derivatives.
pub fn remainder<T: Real>(&[p1, p2, _, p4, p5, p6, p7]: &Powers<T>, start: T, growth: T, by: &Scaled<T>) -> T {
    let c = T::lit;
    let ([u, v], [p, q]) = (by.first, by.second);
    start
        + growth * (c(35.0) * p4 - c(84.0) * p5 + c(70.0) * p6 - c(20.0) * p7)
        + u * (p1 - c(20.0) * p4 + c(45.0) * p5 - c(36.0) * p6 + c(10.0) * p7)
        + v * (c(39.0) * p5 - c(15.0) * p4 - c(34.0) * p6 + c(10.0) * p7)
        + p * (c(0.5) * p2 - c(5.0) * p4 + c(10.0) * p5 - c(7.5) * p6 + c(2.0) * p7)
        + q * (c(2.5) * p4 - c(7.0) * p5 + c(6.5) * p6 - c(2.0) * p7)
}

/// FC(19): adds a sample to the five sums.
pub fn accumulate<T: Real>(sums: &mut [T; 5], phi_i: T, phi_f: T, y: T) {
    let [ii, if_, ff, iy, fy] = *sums;
    *sums = [ii + phi_i * phi_i, if_ + phi_i * phi_f, ff + phi_f * phi_f, iy + phi_i * y, fy + phi_f * y];
}

/// FC(20): S^3 u_sss at both ends.
pub fn solve<T: Real>(&[ii, if_, ff, iy, fy]: &[T; 5]) -> [T; 2] {
    let inverse = T::ONE / (ii * ff - if_ * if_);
    [(ff * iy - if_ * fy) * inverse, (ii * fy - if_ * iy) * inverse]
}

/// FC(15): A to H from everything at both ends; `third` is S^3 u_sss.
pub fn coefficients<T: Real>(
    &[r1, r2, r3, r4, r5, r6, r7]: &Powers<T>,
    start: T,
    growth: T,
    by: &Scaled<T>,
    third: [T; 2],
) -> [T; 8] {
    let c = T::lit;
    let ([u, v], [p, q], [a, b]) = (by.first, by.second, third);
    let sixth = T::lit(1.0 / 6.0);
    [
        (c(10.0) * (u + v) - c(20.0) * growth + c(2.0) * (p - q) + sixth * (a + b)) * r7,
        (c(70.0) * growth - c(36.0) * u - c(34.0) * v - c(7.5) * p + c(6.5) * q - c(2.0 / 3.0) * a - c(0.5) * b) * r6,
        (c(45.0) * u - c(84.0) * growth + c(39.0) * v + c(10.0) * p - c(7.0) * q + a + c(0.5) * b) * r5,
        (c(35.0) * growth - c(20.0) * u - c(15.0) * v - c(5.0) * p + c(2.5) * q - c(2.0 / 3.0) * a - sixth * b) * r4,
        sixth * a * r3,
        c(0.5) * p * r2,
        u * r1,
        start,
    ]
}

#[cfg(test)]
mod tests {
    use super::super::CorrectionOrder;
    use super::super::fit::Fit;
    use super::super::segment::tests::BENT;
    use super::*;

    /// The two forms of the closed form are one polynomial, from the same samples; in s from 0 and u from 3, to say that both count.
    #[test]
    fn both_forms_are_one_polynomial() {
        let length = BENT.length();
        let mut ends = BENT.ends(length).unwrap();
        let mut centred = Fit::new(&ends, CorrectionOrder::Seventh);
        ends.parameter = [3.0, 4.0];
        let mut published = Published::new(&ends);
        for k in 1..100 {
            let v = f64::from(k) * 0.01 - 0.5;
            let s = BENT.length_over(-0.5, v + 0.5);
            published.sample(s, v + 3.5);
            centred.sample(s / length - 0.5, v);
        }
        let (published, centred) = (published.finish(), centred.finish());
        for k in 0..=50 {
            let tau = f64::from(k) / 50.0 - 0.5;
            let s = (tau + 0.5) * length;
            let u = published.iter().fold(0.0, |value, c| value * s + c);
            assert!((u - 3.5 - centred.at(tau)).abs() < 1e-12, "{tau}: {u}");
        }
    }
}

//! Fits u(s) in closed form, from as few samples as keep the quality.
//!
//! The terms of [`Correction`] that the ends settle follow one after another; what is left, q^m (a + b tau), is fitted to samples
//! (tau_j, v_j) by least squares: five sums and one division, as in FC(19) and FC(20), and nothing is stored.
//!
//! Least squares over a whole segment weigh the error of a + b tau by q^(2m). A Gauss rule for that weight needs two nodes only, where the
//! fit then passes through the samples: tau = +-1/(2 sqrt(4 m + 3)). Two samples in place of the published 100 and more give the same
//! feed (`hodograph reproduce feed-correction` shows the fluctuation over the number of samples).

use super::correction::{Correction, CorrectionOrder};
use super::segment::{Ends, PolynomialSegment};
use crate::error::PathError;
use crate::polynomial::Polynomial;
use crate::real::Real;

/// A fit under way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit<T> {
    correction: Correction<T>,
    /// m, the power of q that is fitted; none where nothing is.
    power: Option<usize>,
    /// Of q^2m, q^2m tau, q^2m tau^2, q^m y and q^m tau y over all samples.
    sums: [T; 5],
}

impl<T: Real> Fit<T> {
    /// Begins a fit with what the ends of a segment settle.
    pub fn new(ends: &Ends<T>, order: CorrectionOrder) -> Self {
        Self { correction: joined(ends, order), power: order.fitted(), sums: [T::ZERO; 5] }
    }

    /// Takes a sample: v at tau = s/S - 1/2.
    pub fn sample(&mut self, tau: T, v: T) {
        let Some(power) = self.power else { return };
        let y = v - self.correction.at(tau);
        let q = T::lit(0.25) - tau * tau;
        let weight = (1..power).fold(q, |product, _| product * q);
        let (square, error) = (weight * weight, weight * y);
        let [s0, s1, s2, y0, y1] = self.sums;
        let moment = square * tau;
        self.sums = [s0 + square, s1 + moment, s2 + moment * tau, y0 + error, y1 + error * tau];
    }

    /// The polynomial. With fewer than two samples it is what the ends settle.
    pub fn finish(self) -> Correction<T> {
        let mut correction = self.correction;
        let [s0, s1, s2, y0, y1] = self.sums;
        let determinant = s0 * s2 - s1 * s1;
        if let Some(power) = self.power
            && determinant > T::ZERO
            && let (Some(even), Some(odd)) = (correction.even.0.get_mut(power - 1), correction.odd.0.get_mut(power - 1))
        {
            let inverse = T::ONE / determinant;
            *even = (s2 * y0 - s1 * y1) * inverse;
            *odd = (s0 * y1 - s1 * y0) * inverse;
        }
        correction
    }
}

/// The terms that the ends settle; u runs over one unit.
fn joined<T: Real>(ends: &Ends<T>, order: CorrectionOrder) -> Correction<T> {
    let (mut even, mut odd) = ([T::ZERO; 4], [T::ZERO; 4]);
    // f_k at the ends: a_k - b_k/2 and a_k + b_k/2.
    let pair = |[start, end]: [T; 2]| [(start + end) * T::HALF, end - start];
    let s = ends.length;
    // dv/d(tau) = 1 -+ f_1 at the ends.
    let f1 = [ends.first[0] * s - T::ONE, T::ONE - ends.first[1] * s];
    let [a1, b1] = pair(f1);
    if order.joined() >= 1 {
        (even[0], odd[0]) = (a1, b1);
    }
    // The second derivative is -2 f_1 -+ 2 b_1 + 2 f_2.
    let half_square = s * s * T::HALF;
    let f2 = [ends.second[0] * half_square + f1[0] - b1, ends.second[1] * half_square + f1[1] + b1];
    let [a2, b2] = pair(f2);
    if order.joined() >= 2 {
        (even[1], odd[1]) = (a2, b2);
    }
    // The third one is -6 b_1 +- 12 f_2 + 6 b_2 -+ 6 f_3.
    if order.joined() >= 3 {
        let sixth_cube = s * s * s * T::lit(1.0 / 6.0);
        let rest = |third: T| third * sixth_cube + b1 - b2;
        let f3 = [T::TWO * f2[0] + rest(ends.third[0]), T::TWO * f2[1] - rest(ends.third[1])];
        let [a3, b3] = pair(f3);
        (even[2], odd[2]) = (a3, b3);
    }
    Correction { even: Polynomial(even), odd: Polynomial(odd) }
}

/// Length in mm and v(tau) of a segment, from two samples. Load time.
///
/// The arc length is taken in three panels of [`Real::GAUSS`]. Errors: a segment that stands still somewhere or is so uneven that v does
/// not grow all along, or numbers that are none.
///
/// 18 roots and some 2000 instructions beside them. A function of its own in every image, so that they can be counted there: row `fit of a
/// cubic` of `cargo xtask budget`, where `checks` are the two of them that refuse a piece.
#[inline(never)]
pub fn fit<T: Real, const D: usize>(
    segment: &PolynomialSegment<T, D>,
    order: CorrectionOrder,
) -> Result<(T, Correction<T>), PathError> {
    if !segment.0.iter().flatten().all(|c| c.is_finite()) {
        return Err(PathError::NotFinite);
    }
    if !segment.moves() {
        return Err(PathError::Standstill);
    }
    let (length, correction) = from_two_samples(segment, order).ok_or(PathError::Standstill)?;
    if correction.grows() { Ok((length, correction)) } else { Err(PathError::Uneven) }
}

/// The same without checks. None where the curve stands still at an end.
pub fn from_two_samples<T: Real, const D: usize>(
    segment: &PolynomialSegment<T, D>,
    order: CorrectionOrder,
) -> Option<(T, Correction<T>)> {
    let node = node(order.fitted().unwrap_or(1));
    let (before, between, after) = (
        segment.panel(-T::HALF, T::HALF - node),
        segment.panel(-node, T::TWO * node),
        segment.panel(node, T::HALF - node),
    );
    let length = before + between + after;
    let ends = segment.ends(length)?;
    let mut fit = Fit::new(&ends, order);
    let per_length = T::ONE / length;
    // From the nearer end.
    fit.sample(before * per_length - T::HALF, -node);
    fit.sample(T::HALF - after * per_length, node);
    Some((length, fit.finish()))
}

/// The node of the Gauss rule for the weight q^(2m): 1/(2 sqrt(4 m + 3)).
fn node<T: Real>(power: usize) -> T {
    T::HALF / T::from_int(4 * power as i32 + 3).sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::segment::tests::BENT;
    use super::*;
    use crate::jet::Jet;

    /// The derivatives of v(s) at both ends are those of the curve; the third against a difference of the second.
    #[test]
    fn the_ends_are_met() {
        for order in [
            CorrectionOrder::FifthFitted,
            CorrectionOrder::FifthJoined,
            CorrectionOrder::Seventh,
            CorrectionOrder::Ninth,
        ] {
            let (length, correction) = fit(&BENT, order).unwrap();
            let ends = BENT.ends(length).unwrap();
            for (k, tau) in [-0.5, 0.5].into_iter().enumerate() {
                let Jet([v, first, second]) = correction.at(Jet::variable(tau));
                assert!((v - tau).abs() < 1e-16);
                assert!((first / length / ends.first[k] - 1.0).abs() < 1e-13, "{order:?}");
                if order.joined() >= 2 {
                    assert!((2.0 * second / (length * length) - ends.second[k]).abs() < 1e-13, "{order:?}");
                }
                if order.joined() >= 3 {
                    let h = 1e-4;
                    let [Jet([_, _, low]), Jet([_, _, high])] =
                        [tau - h, tau + h].map(|t| correction.at(Jet::variable(t)));
                    let third = (high - low) / h / (length * length * length);
                    assert!((third - ends.third[k]).abs() < 1e-6 * ends.first[k], "{third} {:?}", ends.third);
                }
            }
        }
    }

    /// Two samples do as well as a thousand, to a third of a fluctuation that is small; and every order does better than the one before it.
    #[test]
    fn two_samples_are_enough() {
        let mut before = f64::INFINITY;
        for order in
            [CorrectionOrder::Natural, CorrectionOrder::FifthFitted, CorrectionOrder::Seventh, CorrectionOrder::Ninth]
        {
            let (length, few) = fit(&BENT, order).unwrap();
            let mut many = Fit::new(&BENT.ends(length).unwrap(), order);
            for k in 1..1_000 {
                let v = f64::from(k) / 1_000.0 - 0.5;
                many.sample(BENT.length_over(-0.5, v + 0.5) / length - 0.5, v);
            }
            let fluctuation = |correction: &Correction<f64>| {
                (0..=1_000)
                    .map(|k| f64::from(k) / 1_000.0 - 0.5)
                    .map(|tau| (BENT.speed(correction.at(tau)) * correction.derivative(tau) / length - 1.0).abs())
                    .fold(0.0, f64::max)
            };
            let (few, many) = (fluctuation(&few), fluctuation(&many.finish()));
            assert!(few < 1.33 * many && few < before, "{order:?}: {few} with two, {many} with 999");
            before = few;
        }
    }

    /// A cusp, a number that is none; and a curve so uneven that its correction would run backwards.
    #[test]
    fn what_cannot_be_corrected_is_refused() {
        let mut segment = [[0.0_f32; 2]; 6];
        (segment[2], segment[3]) = ([10.0, 0.0], [0.0, 10.0]);
        let seventh = CorrectionOrder::Seventh;
        assert_eq!(fit(&PolynomialSegment(segment), seventh), Err(PathError::Standstill));
        segment[1] = [0.2, 0.1];
        assert_eq!(fit(&PolynomialSegment(segment), seventh), Err(PathError::Uneven));
        segment[1] = [f32::NAN, 0.0];
        assert_eq!(fit(&PolynomialSegment(segment), seventh), Err(PathError::NotFinite));
    }
}

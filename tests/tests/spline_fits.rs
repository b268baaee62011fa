//! The closed form of the feed correction polynomial against the 14 equations that it replaces, solved in more digits.
#![allow(clippy::unwrap_used, missing_docs, reason = "a failed test says where")]

use std::ops::{Add, Div, Mul, Neg, Sub};

use host_sim::spline::constrained::{self, Field};
use host_sim::spline::methods::ends_by;
use shared::spline::published::Published;
use shared::spline::{CorrectionOrder, Ends, Fit, PolynomialSegment, fit};
use tests::random::Random;
use twofloat::TwoFloat;

/// Some 32 digits.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
struct High(TwoFloat);

impl Add for High {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for High {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl Mul for High {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }
}

impl Div for High {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        Self(self.0 / other.0)
    }
}

impl Neg for High {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Field for High {
    fn of(value: f64) -> Self {
        Self(TwoFloat::from(value))
    }
}

/// A cubic or quintic whose speed varies by less than a factor of about three, and how far its u goes.
fn segment(random: &mut Random) -> (PolynomialSegment<f64, 2>, f64) {
    let degree = random.pick(&[3_usize, 5]);
    let size = random.scale(0.5, 50.0);
    let mut coefficients = [[0.0; 2]; 6];
    for (power, c) in coefficients.iter_mut().enumerate().take(degree + 1) {
        let width = if power == 1 { 0.2 } else { 0.7 / f64::from(1 << power.saturating_sub(1)) };
        *c = [(); 2].map(|()| size * random.within(-width, width));
    }
    coefficients[1][0] += size;
    (PolynomialSegment(coefficients), size * random.within(0.9, 1.1))
}

/// The largest difference of two sets of coefficients over the largest coefficient.
fn apart(found: &[f64; 8], exact: &[High; 8]) -> f64 {
    let size = exact.iter().map(|c| f64::from(c.0).abs()).fold(0.0, f64::max);
    let difference = |(found, exact): (&f64, &High)| f64::from(exact.0 - *found).abs();
    found.iter().zip(exact).map(difference).fold(0.0, f64::max) / size
}

/// A thousand random segments of 100 to 400 samples each. The closed form keeps eleven digits and more; the 14 equations, solved in
/// the same doubles, lose about a hundred times as many.
#[test]
fn the_closed_form_is_the_solution_of_the_14_equations() {
    let mut random = Random::new(14);
    let (mut worst_closed, mut worst_fourteen) = (0.0_f64, 0.0_f64);
    for number in 0..1_000 {
        let (segment, span) = segment(&mut random);
        let divisions = random.whole(100, 400) as u32;
        let part = |j: u32| f64::from(j) / f64::from(divisions);
        let mut samples = vec![(0.0, 0.0)];
        for j in 1..=divisions {
            let s = samples[j as usize - 1].0 + segment.panel(part(j - 1) - 0.5, part(1));
            samples.push((s, part(j) * span));
        }
        let length = samples[divisions as usize].0;
        let ends = ends_by(&segment, length, span).unwrap();
        let high = |pair: [f64; 2]| pair.map(High::of);
        let high_ends = Ends {
            length: High::of(length),
            parameter: high(ends.parameter),
            first: high(ends.first),
            second: high(ends.second),
            third: high(ends.third),
        };
        let exact = constrained::fit(&high_ends, samples.iter().map(|&(s, u)| (High::of(s), High::of(u)))).unwrap();
        let fourteen = constrained::fit(&ends, samples.iter().copied()).unwrap();
        let mut published = Published::new(&ends);
        for &(s, u) in &samples[1..divisions as usize] {
            published.sample(s, u);
        }
        // From powers of s to powers of s/S.
        let mut closed = published.finish();
        for (k, c) in closed.iter_mut().enumerate() {
            *c *= length.powi(7 - k as i32);
        }
        let (closed, fourteen) = (apart(&closed, &exact), apart(&fourteen, &exact));
        assert!(closed < 1e-11, "segment {number}: {closed}");
        worst_closed = worst_closed.max(closed);
        worst_fourteen = worst_fourteen.max(fourteen);
    }
    println!(
        "largest relative error of a coefficient: closed form {worst_closed:.1e}, 14 equations {worst_fourteen:.1e}"
    );
    assert!(worst_fourteen > 10.0 * worst_closed, "14 equations {worst_fourteen}, closed form {worst_closed}");
}

/// The controller's fit in f32 against the same in f64: the parameter differs by so little that a setpoint on 50 mm is off along the
/// path by less than 0.1 um, and the length by less than a millionth.
#[test]
fn the_fit_in_single_precision_is_the_fit() {
    let mut random = Random::new(32);
    for number in 0..1_000 {
        let (segment, _) = segment(&mut random);
        let single = PolynomialSegment(segment.0.map(|c| c.map(|c| c as f32)));
        // The same curve, so that only the arithmetic differs.
        let double = PolynomialSegment(single.0.map(|c| c.map(f64::from)));
        for order in [CorrectionOrder::Seventh, CorrectionOrder::Ninth] {
            let ((length, single), (exact, double)) = match (fit(&single, order), fit(&double, order)) {
                (Ok(single), Ok(double)) => (single, double),
                (single, double) => panic!("segment {number}: {single:?} {double:?}"),
            };
            assert!((f64::from(length) / exact - 1.0).abs() < 1e-6, "segment {number}");
            for k in -20..=20 {
                let tau = f64::from(k) * 0.025;
                let off = f64::from(single.at(tau as f32)) - double.at(f64::from(tau as f32));
                assert!(off.abs() < 2e-6, "segment {number}, {order:?}, tau {tau}: {off}");
            }
        }
    }
}

/// Least squares about the middle and in powers are one polynomial, of random segments too.
#[test]
fn both_forms_of_the_closed_form_agree() {
    let mut random = Random::new(7);
    for number in 0..200 {
        let (segment, _) = segment(&mut random);
        let length = segment.length();
        let mut ends = segment.ends(length).unwrap();
        let mut centred = Fit::new(&ends, CorrectionOrder::Seventh);
        ends.parameter = [0.0, 1.0];
        let mut published = Published::new(&ends);
        for j in 1..100 {
            let v = f64::from(j) * 0.01 - 0.5;
            let s = segment.length_over(-0.5, v + 0.5);
            centred.sample(s / length - 0.5, v);
            published.sample(s, v + 0.5);
        }
        let (centred, published) = (centred.finish(), published.finish());
        for k in 0..=20 {
            let tau = f64::from(k) * 0.05 - 0.5;
            let u = published.iter().fold(0.0, |value, c| value * ((tau + 0.5) * length) + c);
            assert!((u - 0.5 - centred.at(tau)).abs() < 1e-11, "segment {number}: {}", u - 0.5 - centred.at(tau));
        }
    }
}

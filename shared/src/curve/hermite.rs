//! First-order Hermite interpolation by quintic PH curves.
//!
//! Four curves have the given ends and end derivatives; the one of least absolute rotation is the one that a person means, the
//! others have loops [design section 3; Farouki, Moon & Ravani].

use core::fmt;

use super::PhQuintic;
use crate::complex::Complex;
use crate::real::Real;

/// Why there is no curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HermiteError {
    /// A derivative is zero or not finite: it gives no direction.
    Derivative,
    /// Start and end are the same point, or one is not finite.
    Chord,
}

impl fmt::Display for HermiteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Derivative => {
                write!(f, "a derivative of the segment is zero or not a number; it must give a direction")
            }
            Self::Chord => write!(f, "the segment ends where it starts"),
        }
    }
}

impl core::error::Error for HermiteError {}

/// The curve from `start` to `end` with derivatives `d0` and `d1` that turns least. All in mm.
pub fn hermite<T: Real>(
    start: Complex<T>,
    end: Complex<T>,
    d0: Complex<T>,
    d1: Complex<T>,
) -> Result<PhQuintic<T>, HermiteError> {
    let usable = |d: Complex<T>| d.is_finite() && d.norm_sqr() > T::ZERO;
    if !(usable(d0) && usable(d1)) {
        return Err(HermiteError::Derivative);
    }
    if !usable(end - start) {
        return Err(HermiteError::Chord);
    }
    let candidates = hermite_candidates(start, end, d0, d1);
    let [mut best, ..] = candidates;
    for other in candidates {
        if other.absolute_rotation() < best.absolute_rotation() {
            best = other;
        }
    }
    Ok(best)
}

/// All four curves: w_0 and w_2 are roots of the derivatives, w_1 solves a quadratic for the chord; one overall sign is free.
pub fn hermite_candidates<T: Real>(
    start: Complex<T>,
    end: Complex<T>,
    d0: Complex<T>,
    d1: Complex<T>,
) -> [PhQuintic<T>; 4] {
    let chord = end - start;
    let w0 = d0.sqrt();
    let one = T::ONE;
    [(one, one), (one, -one), (-one, one), (-one, -one)].map(|(side, branch)| {
        let w2 = d1.sqrt() * side;
        let under = chord * T::lit(120.0) - (d0 + d1) * T::lit(15.0) + (w0 * w2) * T::lit(10.0);
        let w1 = (w0 + w2) * T::lit(-0.75) + under.sqrt() * (branch * T::lit(0.25));
        PhQuintic { start, w: [w0, w1, w2] }
    })
}

#[cfg(test)]
mod tests {
    use super::super::Curve;
    use super::*;

    /// The golden curve of design section 3, to 1e-6 in control points, length and rotation of both branches.
    #[test]
    fn the_published_curve() {
        let (p0, p1) = (Complex::new(0.8_f64, 1.4), Complex::new(2.4, 0.8));
        let (p4, p5) = (Complex::new(2.6, 4.2), Complex::new(4.2, 3.6));
        let (d0, d1) = ((p1 - p0) * 5.0, (p5 - p4) * 5.0);
        let curve = hermite(p0, p5, d0, d1).unwrap();
        let points = curve.control_points();
        for (k, expected) in
            [(1, p1), (2, Complex::new(2.8377, 2.5140)), (3, Complex::new(2.1623, 2.4860)), (4, p4), (5, p5)]
        {
            // The published inner points have four decimals.
            let tolerance = if k == 2 || k == 3 { 0.5e-4 } else { 1e-12 };
            assert!((points[k].re - expected.re).abs() < tolerance && (points[k].im - expected.im).abs() < tolerance);
        }
        assert!((curve.length() - 4.824_164).abs() < 1e-6);
        let mut rotations = hermite_candidates(p0, p5, d0, d1).map(|c| c.absolute_rotation());
        rotations.sort_by(f64::total_cmp);
        assert!((rotations[0] - 0.547).abs() < 0.5e-3 && (rotations[3] - 1.682).abs() < 0.5e-3, "{rotations:?}");
    }

    /// A straight line in Hermite form stays one.
    #[test]
    fn a_straight_chord_gives_a_line() {
        let chord = Complex::new(30.0_f64, 40.0);
        let curve = hermite(Complex::ZERO, chord, chord, chord).unwrap();
        assert!((curve.length() - 50.0).abs() < 1e-12 && curve.absolute_rotation() < 1e-12);
        assert!(curve.curvature(0.3).abs() < 1e-15);
    }

    #[test]
    fn what_gives_no_direction_is_refused() {
        let (a, b) = (Complex::new(0.0, 0.0), Complex::new(1.0, 0.0));
        assert_eq!(hermite(a, b, a, b), Err(HermiteError::Derivative));
        assert_eq!(hermite(a, a, b, b), Err(HermiteError::Chord));
    }
}

//! What PH quintics and polynomial curves have in common: six control points and two derivatives.

use shared::complex::Complex;
use shared::curve::{Curve, PhQuintic, Spline};

/// A curve of degree five.
pub(super) trait Quintic: Curve<f64> {
    /// The Bezier control points, in mm.
    fn control_points(&self) -> [Complex<f64>; 6];
    /// The first and the second derivative.
    fn two_derivatives(&self, xi: f64) -> [Complex<f64>; 2];
}

impl Quintic for PhQuintic<f64> {
    fn control_points(&self) -> [Complex<f64>; 6] {
        self.control_points()
    }

    fn two_derivatives(&self, xi: f64) -> [Complex<f64>; 2] {
        let w = self.preimage(xi);
        [w.square(), (w * self.preimage_derivative(xi)) * 2.0]
    }
}

impl Quintic for Spline<f64> {
    fn control_points(&self) -> [Complex<f64>; 6] {
        self.points
    }

    fn two_derivatives(&self, xi: f64) -> [Complex<f64>; 2] {
        [self.derivative(xi), self.second_derivative(xi)]
    }
}

//! Circular arcs.

use super::{Curve, Cut};
use crate::complex::Complex;
use crate::piece::Shape;
use crate::real::Real;

/// An arc of at most one turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc<T> {
    /// The circle's centre, in mm.
    pub centre: Complex<T>,
    /// From the centre to the point at 0, in mm; not zero.
    pub radius: Complex<T>,
    /// The signed angle in radians, positive anticlockwise; within -2 pi..=2 pi and not zero.
    pub sweep: T,
}

impl<T: Real> Arc<T> {
    /// From the centre to the point at `xi`.
    fn radius_at(&self, xi: T) -> Complex<T> {
        let (sine, versine) = (self.sweep * xi).sin_versin();
        self.radius + self.radius * Complex::new(-versine, sine)
    }
}

impl<T: Real> Curve<T> for Arc<T> {
    fn point(&self, xi: T) -> Complex<T> {
        self.centre + self.radius_at(xi)
    }

    fn derivative(&self, xi: T) -> Complex<T> {
        self.radius_at(xi).left() * self.sweep
    }

    fn speed(&self, _: T) -> T {
        self.radius.norm() * self.sweep.abs()
    }

    fn curvature(&self, _: T) -> T {
        let magnitude = T::ONE / self.radius.norm();
        if self.sweep < T::ZERO { -magnitude } else { magnitude }
    }

    fn length_to(&self, xi: T) -> T {
        self.speed(xi) * xi
    }

    fn cut(&self, from: T, to: T, offset: T) -> Cut<T> {
        let stretch = T::ONE + self.curvature(from) * offset;
        let radius = self.radius_at((from + to) * T::HALF) * stretch;
        Cut {
            origin: self.centre + radius,
            shape: Shape::Arc { radius, sweep: self.sweep * (to - from), ratio: stretch.abs() },
        }
    }
}

//! Circular arcs.

use super::{Curve, Cut};
use crate::complex::Complex;
use crate::piece::Shape;
use crate::real::Real;

/// An arc of at most one turn.
///
/// It is held by its start, not by its centre: an arc that is nearly straight has a centre so far away that points seen from
/// there would lose their last digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc<T> {
    /// The point at 0, in mm.
    pub start: Complex<T>,
    /// From the circle's centre to the point at 0, in mm; not zero.
    pub radius: Complex<T>,
    /// The signed angle in radians, positive anticlockwise; within -2 pi..=2 pi and not zero.
    pub sweep: T,
}

impl<T: Real> Arc<T> {
    /// The circle's centre, in mm; good to rounding of the radius.
    pub fn centre(&self) -> Complex<T> {
        self.start - self.radius
    }

    /// What the turn to `xi` adds to the vector `radius`: radius (e^(i sweep xi) - 1), good to rounding of itself.
    fn turn(&self, radius: Complex<T>, xi: T) -> Complex<T> {
        let (sine, versine) = (self.sweep * xi).sin_versin();
        radius * Complex::new(-versine, sine)
    }

    /// From the centre to the point at `xi`.
    fn radius_at(&self, xi: T) -> Complex<T> {
        self.radius + self.turn(self.radius, xi)
    }
}

impl<T: Real> Curve<T> for Arc<T> {
    fn point(&self, xi: T) -> Complex<T> {
        self.start + self.turn(self.radius, xi)
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
        let middle = (from + to) * T::HALF;
        let stretch = T::ONE + self.curvature(from) * offset;
        Cut {
            origin: self.offset_point(middle, offset),
            shape: Shape::Arc {
                radius: self.radius_at(middle) * stretch,
                sweep: self.sweep * (to - from),
                ratio: stretch.abs(),
            },
        }
    }
}

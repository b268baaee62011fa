//! Straight lines.

use super::{Curve, Cut};
use crate::complex::Complex;
use crate::piece::Shape;
use crate::real::Real;

/// The line from `start` to `end`; they differ, unless only a further axis moves along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line<T> {
    /// The point at 0, in mm.
    pub start: Complex<T>,
    /// The point at 1, in mm.
    pub end: Complex<T>,
}

impl<T: Real> Curve<T> for Line<T> {
    fn point(&self, xi: T) -> Complex<T> {
        // From the nearer end, so that both ends are met exactly.
        if xi < T::HALF {
            self.start + (self.end - self.start) * xi
        } else {
            self.end - (self.end - self.start) * (T::ONE - xi)
        }
    }

    fn derivative(&self, _: T) -> Complex<T> {
        self.end - self.start
    }

    fn speed(&self, _: T) -> T {
        (self.end - self.start).norm()
    }

    fn curvature(&self, _: T) -> T {
        T::ZERO
    }

    fn length_to(&self, xi: T) -> T {
        self.speed(xi) * xi
    }

    fn cut(&self, from: T, to: T, offset: T) -> Cut<T> {
        Cut {
            origin: self.offset_point((from + to) * T::HALF, offset),
            shape: Shape::Line { chord: (self.end - self.start) * (to - from) },
        }
    }
}

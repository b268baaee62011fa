//! The segments of a contour: what a person draws, exactly, before it is cut into pieces.
//!
//! Parameters run over 0..=1, lengths are mm, curvature is 1/mm and positive to the left. The host uses these in f64.

mod arc;
mod hermite;
mod line;
mod ph_quintic;
mod spline;

pub use arc::Arc;
pub use hermite::{HermiteError, hermite, hermite_candidates};
pub use line::Line;
pub use ph_quintic::PhQuintic;
pub(crate) use ph_quintic::speed_bernstein;
pub use spline::Spline;

use crate::complex::Complex;
use crate::piece::Shape;
use crate::real::Real;

/// What every segment can tell at a parameter.
pub trait Curve<T: Real> {
    /// The point, in mm.
    fn point(&self, xi: T) -> Complex<T>;
    /// The hodograph r' = dr/d(xi), in mm.
    fn derivative(&self, xi: T) -> Complex<T>;
    /// The parametric speed sigma = |r'|, in mm.
    fn speed(&self, xi: T) -> T;
    /// The curvature of equation (1), in 1/mm.
    fn curvature(&self, xi: T) -> T;
    /// The arc length from 0 to `xi`, in mm.
    fn length_to(&self, xi: T) -> T;
    /// The piece of this segment over `from..to` at offset distance `offset`, in its own frame.
    fn cut(&self, from: T, to: T, offset: T) -> Cut<T>;

    /// The unit tangent.
    fn tangent(&self, xi: T) -> Complex<T> {
        self.derivative(xi) * (T::ONE / self.speed(xi))
    }

    /// The point of the untrimmed offset of equation (2), at signed distance `offset` to the right of travel.
    fn offset_point(&self, xi: T, offset: T) -> Complex<T> {
        // A line along which only another axis moves has no tangent.
        if offset == T::ZERO { self.point(xi) } else { self.point(xi) + self.tangent(xi).right() * offset }
    }

    /// The length of the whole segment, in mm.
    fn length(&self) -> T {
        self.length_to(T::ONE)
    }
}

/// A piece's shape, and the exact place of its frame: [`Piece::origin`](crate::piece::Piece::origin) before it is rounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut<T> {
    /// Where the frame stands, in mm.
    pub origin: Complex<T>,
    /// The curve in that frame.
    pub shape: Shape<T>,
}

/// One curve of a contour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Segment<T> {
    /// A quintic Pythagorean-hodograph curve.
    Ph(PhQuintic<T>),
    /// A straight line.
    Line(Line<T>),
    /// A circular arc.
    Arc(Arc<T>),
    /// A polynomial curve.
    Spline(Spline<T>),
}

macro_rules! each_kind {
    ($segment:expr, $curve:ident => $value:expr) => {
        match $segment {
            Segment::Ph($curve) => $value,
            Segment::Line($curve) => $value,
            Segment::Arc($curve) => $value,
            Segment::Spline($curve) => $value,
        }
    };
}

impl<T: Real> Curve<T> for Segment<T> {
    fn point(&self, xi: T) -> Complex<T> {
        each_kind!(self, curve => curve.point(xi))
    }

    fn derivative(&self, xi: T) -> Complex<T> {
        each_kind!(self, curve => curve.derivative(xi))
    }

    fn speed(&self, xi: T) -> T {
        each_kind!(self, curve => curve.speed(xi))
    }

    fn curvature(&self, xi: T) -> T {
        each_kind!(self, curve => curve.curvature(xi))
    }

    fn length_to(&self, xi: T) -> T {
        each_kind!(self, curve => curve.length_to(xi))
    }

    fn cut(&self, from: T, to: T, offset: T) -> Cut<T> {
        each_kind!(self, curve => curve.cut(from, to, offset))
    }
}

//! The polynomial curve of a piece: its feed correction polynomial, fitted when it is loaded, and the curve over that.
//!
//! The walk's parameter tau is the fraction of the arc length, as on a line: the rate of (21) is F V/S, and v(tau) of
//! [`Correction`] says where on the curve that is. z may bend with it; its ends are the travel's, exactly.

use super::check_length;
use crate::complex::Complex;
use crate::error::PathError;
use crate::fixed::Fixed;
use crate::further::Linear;
use crate::piece::SplineShape;
use crate::polynomial::Polynomial;
use crate::real::Real;
use crate::spline::{Correction, fit};

/// The coefficients of a spline piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spline<T> {
    correction: Correction<T>,
    /// r/v.
    x: Polynomial<T, 5>,
    y: Polynomial<T, 5>,
    /// What z departs from its straight way by, over 1/4 - v^2.
    bow: Polynomial<T, 4>,
    /// How far z goes.
    rise: T,
    /// V/S in 1/s.
    pub(super) base: T,
}

impl<T: Real> Spline<T> {
    /// Fits u(s); `further` is how the further axes move, the first of them z. Load time: what [`fit`] takes.
    pub(super) fn activate<const F: usize>(
        shape: &SplineShape<T>,
        further: Option<&Linear<T, F>>,
        feed: T,
    ) -> Result<Self, PathError> {
        let rise = further.and_then(Linear::first_way);
        if rise.is_none() && shape.bow.iter().any(|&c| c != T::ZERO) {
            return Err(PathError::Bow);
        }
        let rise = rise.unwrap_or(T::ZERO);
        let (length, correction) = fit(&shape.segment(rise), shape.correction)?;
        let length = check_length(length)?;
        Ok(Self {
            correction,
            x: Polynomial(shape.plane.map(|z| z.re)),
            y: Polynomial(shape.plane.map(|z| z.im)),
            bow: Polynomial(shape.bow),
            rise,
            base: feed / length,
        })
    }

    /// v at the fraction tau of the length.
    #[inline(always)]
    pub(super) fn parameter(&self, tau: T) -> T {
        self.correction.at(tau)
    }

    /// The point relative to the origin, in mm.
    #[inline(always)]
    pub(super) fn point(&self, tau: T) -> Complex<T> {
        let v = self.parameter(tau);
        Complex::new(self.x.at(v, T::ZERO) * v, self.y.at(v, T::ZERO) * v)
    }

    /// Where the further axes are: the others go evenly with the arc length.
    #[inline(always)]
    pub(super) fn further<const F: usize>(&self, tau: T, linear: &Linear<T, F>) -> [Fixed; F] {
        let mut at = linear.before_end(T::HALF - tau);
        let v = self.parameter(tau);
        if let Some(z) = at.first_mut()
            && let Some(end) = linear.end().first()
        {
            let bow = (T::lit(0.25) - v * v) * self.bow.at(v, T::ZERO);
            *z = end.offset_by(bow - self.rise * (T::HALF - v));
        }
        at
    }

    /// |dr/d(tau)| in mm, z included. Takes a root.
    pub(super) fn speed(&self, tau: T) -> T {
        let shape = SplineShape {
            plane: [0, 1, 2, 3, 4].map(|k: usize| {
                let of = |Polynomial(c): &Polynomial<T, 5>| c.get(k).copied().unwrap_or(T::ZERO);
                Complex::new(of(&self.x), of(&self.y))
            }),
            bow: self.bow.0,
            correction: Default::default(),
        };
        shape.segment(self.rise).speed(self.parameter(tau)) * self.correction.derivative(tau)
    }
}

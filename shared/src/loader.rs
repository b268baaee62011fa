//! From pieces as they arrive to pieces that the tick may execute: every check of a path, in its order.
//!
//! The host runs the same loader over a whole job before it sends anything, the controller over each piece as it comes.

use crate::active::ActivePiece;
use crate::complex::Complex;
use crate::error::PathError;
use crate::extent::SoftLimits;
use crate::fixed::Fixed;
use crate::pace::Pacer;
use crate::piece::{Header, Order, Piece};
use crate::real::Real;
use crate::supply::PathTime;

/// What the executor must know of a path to begin it; made by [`Loader::motion`], so that every value is in range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<T> {
    pub(crate) order: Order,
    pub(crate) rest: bool,
    pub(crate) pacer: Pacer<T>,
}

/// The checks of one path, piece after piece.
#[derive(Clone, Copy, Debug)]
pub struct Loader<T, const F: usize = 1> {
    header: Header<T>,
    tick: T,
    limits: Option<SoftLimits<F>>,
    pacer: Pacer<T>,
    start: Option<[Fixed; 2]>,
    end: [Fixed; 2],
    /// Where the further axes are, once a piece has said so.
    further: Option<[Fixed; F]>,
    until: PathTime,
    finished: bool,
}

impl<T: Real, const F: usize> Loader<T, F> {
    /// Begins a path; `tick` is the period in s. Errors: a weight outside 0..=1, a tolerance that is not above zero, limits of the
    /// pace that are none.
    pub fn new(header: &Header<T>, tick: T) -> Result<Self, PathError> {
        if !(header.weight >= T::ZERO && header.weight <= T::ONE) {
            return Err(PathError::Weight { weight: header.weight.to_f32() });
        }
        if !(header.tolerance > T::ZERO && header.tolerance.is_finite()) {
            return Err(PathError::Tolerance { tolerance: header.tolerance.to_f32() });
        }
        let pacer = Pacer::activate(&header.pace, tick)?;
        Ok(Self {
            header: *header,
            tick,
            limits: None,
            pacer,
            start: None,
            end: [Fixed(0); 2],
            further: None,
            until: PathTime::START,
            finished: false,
        })
    }

    /// This path, refused where a piece of it leaves the machine's travel.
    pub fn within(mut self, limits: SoftLimits<F>) -> Self {
        self.limits = Some(limits);
        self
    }

    /// What the executor begins this path with.
    pub fn motion(&self) -> Motion<T> {
        Motion { order: self.header.order, rest: self.header.rest, pacer: self.pacer }
    }

    /// Checks the next piece of the path and prepares it. On an error nothing is taken over, and the path is at its end.
    pub fn load(&mut self, piece: &Piece<T, F>) -> Result<ActivePiece<T, F>, PathError> {
        if self.finished {
            return Err(PathError::AfterLast);
        }
        let mut active = ActivePiece::activate(piece, self.header.weight, self.tick)?.behind(self.until);
        if let Some(limits) = self.limits {
            limits.check(piece)?;
        }
        let start = active.place(active.point_and_rate(-T::HALF).0);
        let end = active.place(active.point_and_rate(T::HALF).0);
        if self.start.is_some()
            && let Some(width) = self.gap(self.end, start)
        {
            return Err(PathError::Gap { width });
        }
        if let (Some(end), Some(travel)) = (self.further, piece.further) {
            for (end, from) in end.into_iter().zip(travel.from) {
                let width = from.minus::<T>(end).abs();
                if width > self.header.tolerance {
                    return Err(PathError::Gap { width: width.to_f32() });
                }
            }
        }
        let first = *self.start.get_or_insert(start);
        if let Some([x, y, _]) = piece.last {
            if self.header.closed
                && let Some(width) = self.gap(end, first)
            {
                return Err(PathError::Open { width });
            }
            if let Some(width) = self.gap(end, [x, y]) {
                return Err(PathError::LastPoint { width });
            }
            self.finished = true;
            if !self.header.rest {
                active = active.and_on();
            }
        }
        self.end = end;
        self.further = active.further_end().or(self.further);
        self.until = active.until();
        Ok(active)
    }

    /// Where the path starts; none before its first piece.
    pub fn start(&self) -> Option<[Fixed; 2]> {
        self.start
    }

    /// Whether the last piece of the path has been loaded.
    pub fn is_finished(&self) -> bool {
        self.finished
    }

    /// The distance of two points in mm, where it is above the tolerance.
    fn gap(&self, from: [Fixed; 2], to: [Fixed; 2]) -> Option<f32> {
        let [x0, y0] = from;
        let [x1, y1] = to;
        let width = Complex::<T>::new(x1.minus(x0), y1.minus(y0)).norm();
        (width > self.header.tolerance).then(|| width.to_f32())
    }
}

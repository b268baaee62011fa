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

/// The travel of a machine, as a path must keep to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bounds<const F: usize = 1> {
    limits: SoftLimits<F>,
    /// Where the machine stands, of a path that begins there whatever its own coordinates are, and has not begun yet.
    here: Option<([Fixed; 2], [Fixed; F])>,
}

impl<const F: usize> Bounds<F> {
    /// Of a path in machine coordinates.
    pub fn machine(limits: SoftLimits<F>) -> Self {
        Self { limits, here: None }
    }

    /// Of a path that begins where the machine stands.
    pub fn from_here(limits: SoftLimits<F>, plane: [Fixed; 2], further: [Fixed; F]) -> Self {
        Self { limits, here: Some((plane, further)) }
    }

    /// Moves the travel into the coordinates of a path that begins at these points.
    fn begin(&mut self, plane: [Fixed; 2], further: Option<[Fixed; F]>) {
        let Some((here, further_here)) = self.here.take() else { return };
        let moved = |limits: &mut [Fixed; 2], from: Fixed, to: Fixed| {
            for limit in limits {
                // Limits and positions are within 4 m, and 32 bits hold 8 m.
                limit.0 = limit.0.saturating_add(to.0.saturating_sub(from.0));
            }
        };
        for (limits, (from, to)) in self.limits.plane.iter_mut().zip(here.into_iter().zip(plane)) {
            moved(limits, from, to);
        }
        for (limits, (from, to)) in
            self.limits.further.iter_mut().zip(further_here.into_iter().zip(further.unwrap_or(further_here)))
        {
            moved(limits, from, to);
        }
    }
}

/// The checks of one path, piece after piece.
#[derive(Clone, Copy, Debug)]
pub struct Loader<T, const F: usize = 1> {
    header: Header<T>,
    tick: T,
    bounds: Option<Bounds<F>>,
    pacer: Pacer<T>,
    start: Option<[Fixed; 2]>,
    end: [Fixed; 2],
    /// Where the further axes are, once a piece has said so.
    further: Option<[Fixed; F]>,
    further_start: Option<[Fixed; F]>,
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
            bounds: None,
            pacer,
            start: None,
            end: [Fixed(0); 2],
            further: None,
            further_start: None,
            until: PathTime::START,
            finished: false,
        })
    }

    /// This path, refused where a piece of it leaves the machine's travel.
    pub fn within(self, bounds: Bounds<F>) -> Self {
        Self { bounds: Some(bounds), ..self }
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
        let start = active.place(active.point_and_rate(-T::HALF).0);
        if let Some(bounds) = &mut self.bounds {
            bounds.begin(start, piece.further.map(|travel| travel.from));
            bounds.limits.check(piece)?;
        }
        if self.start.is_some() && self.further.is_none() && piece.further.is_some() {
            return Err(PathError::LateFurther);
        }
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
        self.further_start = self.further_start.or(piece.further.map(|travel| travel.from));
        self.further = active.further_end().or(self.further);
        self.until = active.until();
        Ok(active)
    }

    /// Where the path starts; none before its first piece.
    pub fn start(&self) -> Option<[Fixed; 2]> {
        self.start
    }

    /// Where the further axes start; none before the first piece, and where the path does not move them.
    pub fn further_start(&self) -> Option<[Fixed; F]> {
        self.further_start
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

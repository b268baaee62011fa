//! From a job to a path: the exact curves that the tool's centre follows, piece by piece, in f64.
//!
//! The exact path is what everything is measured against; [`PathPiece::wire`] makes of it what the controller gets.

use shared::complex::Complex;
use shared::curve::{Arc, Curve as _, Segment};
use shared::error::PathError;
use shared::feed::Ramp;
use shared::fixed::{Fixed, Position, round_point};
use shared::loader::Loader;
use shared::pace::PaceLimits;
use shared::piece::{Header, Order, Piece, Shape};

use crate::input::InputError;
use crate::job::{Along, Job};
use crate::pacing;

/// One piece of the exact path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPiece {
    /// The curve; for a fill arc the arc itself.
    pub segment: Segment<f64>,
    /// The parameter interval.
    pub interval: [f64; 2],
    /// The offset distance; 0 on a fill arc, which is its own centre path.
    pub offset: f64,
    /// Whether the contact point rests here.
    pub fill: bool,
    /// V in mm/s.
    pub feed: f64,
    /// The ramp at the start.
    pub start: Option<Ramp<f64>>,
    /// The ramp at the end.
    pub end: Option<Ramp<f64>>,
}

impl PathPiece {
    /// The parameter on the segment for the local one in -1/2..=1/2.
    pub fn parameter(&self, tau: f64) -> f64 {
        let [from, to] = self.interval;
        0.5 * (from + to) + tau * (to - from)
    }

    /// The exact point of the tool's centre at a parameter of the segment.
    pub fn point(&self, xi: f64) -> Complex<f64> {
        self.segment.offset_point(xi, self.offset)
    }

    /// |1 + kappa d| of equation (13).
    pub fn stretch(&self, xi: f64) -> f64 {
        (1.0 + self.segment.curvature(xi) * self.offset).abs()
    }

    /// The length on C; none on a fill arc.
    pub fn contact_length(&self) -> f64 {
        if self.fill { 0.0 } else { self.segment_length() }
    }

    /// The length of the segment's part.
    pub fn segment_length(&self) -> f64 {
        let [from, to] = self.interval;
        self.segment.length_to(to) - self.segment.length_to(from)
    }

    /// The length of the centre's way: |length + d times the turn of the tangent|, from integrating equation (13).
    pub fn centre_length(&self) -> f64 {
        (self.segment_length() + self.offset * self.turn()).abs()
    }

    /// The turn of the tangent along the piece, in radians.
    fn turn(&self) -> f64 {
        /// Parts over each of which the tangent turns by less than a half turn.
        const PARTS: u32 = 64;
        let [from, to] = self.interval;
        let mut before = self.segment.tangent(from);
        (1..=PARTS)
            .map(|k| {
                let here = self.segment.tangent(from + (to - from) * f64::from(k) / f64::from(PARTS));
                let turn = (before.conj() * here).arg();
                before = here;
                turn
            })
            .sum()
    }

    /// What the controller gets, in its own precision.
    pub fn wire(&self, last: Option<Position>) -> Piece<f32> {
        let exact = self.exact(last);
        let real = |x: f64| x as f32;
        let ramp = |ramp: Ramp<f64>| Ramp { length: real(ramp.length), factor: real(ramp.factor) };
        let shape = match exact.shape {
            Shape::Ph { preimage, offset } => Shape::Ph { preimage: preimage.map(Complex::from), offset: real(offset) },
            Shape::Line { chord } => Shape::Line { chord: chord.into() },
            Shape::Arc { radius, sweep, ratio } => {
                Shape::Arc { radius: radius.into(), sweep: real(sweep), ratio: real(ratio) }
            }
        };
        Piece {
            origin: exact.origin,
            shape,
            interval: exact.interval.map(real),
            feed: real(exact.feed),
            start: exact.start.map(ramp),
            end: exact.end.map(ramp),
            further: None,
            last,
        }
    }

    /// The same piece for the f64 twin of the tick; only its origin is rounded.
    pub fn exact(&self, last: Option<Position>) -> Piece<f64> {
        let [from, to] = self.interval;
        let cut = self.segment.cut(from, to, self.offset);
        Piece {
            origin: round_point(cut.origin),
            shape: cut.shape,
            interval: self.interval,
            feed: self.feed,
            start: self.start,
            end: self.end,
            further: None,
            last,
        }
    }
}

/// A path that the controller accepts: every piece has passed the loader in the controller's own precision.
#[derive(Clone, Debug)]
pub struct Path {
    /// The pieces in order.
    pub pieces: Vec<PathPiece>,
    /// What holds for all of them.
    pub header: Header<f32>,
    /// The weight, unrounded.
    pub weight: f64,
}

impl Path {
    /// Makes the path of a job. Errors: whatever the loader refuses, with the place in the job's file.
    pub fn new(job: &Job, order: Order) -> Result<Self, InputError> {
        let pieces = job
            .pieces
            .iter()
            .map(|given| {
                let ramp = |corner: Option<crate::job::Corner>| corner.map(|corner| corner.ramp(&job.feed));
                let (segment, interval, offset, fill) = match given.along {
                    Along::Segment { segment, from, to } => (job.segments[segment], [from, to], job.offset, false),
                    Along::Fill { node } => (Segment::Arc(fill_arc(job, node)), [0.0, 1.0], 0.0, true),
                };
                PathPiece {
                    segment,
                    interval,
                    offset,
                    fill,
                    feed: job.feed.rate,
                    start: ramp(given.start),
                    end: ramp(given.end),
                }
            })
            .collect();
        let header = Header {
            weight: job.feed.weight as f32,
            order,
            closed: job.closed,
            // The controller sees points that are rounded to f32: a tenth of a micrometre on top.
            tolerance: (job.tolerance + 1e-4) as f32,
            rest: job.rest,
            pace: PaceLimits::USUAL,
        };
        let mut path = Self { pieces, header, weight: job.feed.weight };
        path.header.pace = pacing::usual(&path);
        path.check().map_err(|(piece, error)| job.piece_error(piece, error))?;
        Ok(path)
    }

    /// Loads the whole path as the controller will. Errors: the first piece that is refused, and why.
    fn check(&self) -> Result<(), (usize, PathError)> {
        let mut loader = Loader::new(&self.header, shared::TICK).map_err(|error| (0, error))?;
        for (number, piece) in self.wire().enumerate() {
            loader.load(&piece).map_err(|error| (number, error))?;
        }
        if loader.is_finished() { Ok(()) } else { Err((0, PathError::Empty)) }
    }

    /// The exact last point.
    pub fn end(&self) -> Position {
        let point = self.pieces.last().map_or(Complex::ZERO, |piece| piece.point(piece.interval[1]));
        let [x, y] = round_point(point);
        [x, y, Fixed(0)]
    }

    /// The exact first point.
    pub fn start(&self) -> Position {
        let point = self.pieces.first().map_or(Complex::ZERO, |piece| piece.point(piece.interval[0]));
        let [x, y] = round_point(point);
        [x, y, Fixed(0)]
    }

    /// The pieces as the controller gets them.
    pub fn wire(&self) -> impl Iterator<Item = Piece<f32>> {
        self.in_order().map(|(piece, last)| piece.wire(last))
    }

    /// The pieces for the f64 twin.
    pub fn exact(&self) -> impl Iterator<Item = Piece<f64>> {
        self.in_order().map(|(piece, last)| piece.exact(last))
    }

    fn in_order(&self) -> impl Iterator<Item = (&PathPiece, Option<Position>)> {
        let count = self.pieces.len();
        self.pieces.iter().enumerate().map(move |(k, piece)| (piece, (k + 1 == count).then(|| self.end())))
    }

    /// The length on C in mm.
    pub fn contact_length(&self) -> f64 {
        self.pieces.iter().map(PathPiece::contact_length).sum()
    }

    /// The length of the centre's way in mm.
    pub fn centre_length(&self) -> f64 {
        self.pieces.iter().map(PathPiece::centre_length).sum()
    }
}

/// The arc about a convex node that turns d n of one segment into that of the next one (section 2).
fn fill_arc(job: &Job, node: usize) -> Arc<f64> {
    let before = &job.segments[node];
    let after = &job.segments[(node + 1) % job.segments.len()];
    let sweep = (before.tangent(1.0).conj() * after.tangent(0.0)).arg();
    let radius = before.tangent(1.0).right() * job.offset;
    Arc { start: before.point(1.0) + radius, radius, sweep }
}

//! Pieces before they are cut: a segment, an interval, an offset and the feed, all in f64.

use shared::complex::Complex;
use shared::curve::{Arc, Curve, Line, PhQuintic, Segment, Spline};
use shared::feed::Ramp;
use shared::fixed::{Fixed, Position, round_point};
use shared::piece::{Piece, Shape, SplineShape};
use shared::profile::Profile;
use shared::real::Real;

/// What a planner knows of one piece. Lengths in mm, feeds in mm/s.
#[derive(Clone, Copy, Debug)]
pub struct Draft {
    /// The curve that the piece is cut from.
    pub segment: Segment<f64>,
    /// First and last parameter on it.
    pub interval: [f64; 2],
    /// The signed offset distance d, positive to the right of travel.
    pub offset: f64,
    /// The contact feed V.
    pub feed: f64,
    /// The ramp at the start.
    pub start: Option<Ramp<f64>>,
    /// The ramp at the end.
    pub end: Option<Ramp<f64>>,
    /// The feed over time, in the place of ramps.
    pub profile: Option<Profile<f64>>,
}

impl Draft {
    /// A whole segment without ramps.
    pub fn whole(segment: Segment<f64>, offset: f64, feed: f64) -> Self {
        Self { segment, interval: [0.0, 1.0], offset, feed, start: None, end: None, profile: None }
    }

    /// The same with a ramp of length lambda and factor f at both ends.
    pub fn ramped(self, length: f64, factor: f64) -> Self {
        let ramp = Some(Ramp { length, factor });
        Self { start: ramp, end: ramp, ..self }
    }

    /// The same with F over time by these coefficients.
    pub fn timed(self, factors: [f64; 4]) -> Self {
        Self { profile: Some(Profile { factors }), ..self }
    }

    /// The same over a part of its interval; `from` and `to` are fractions of it.
    pub fn part(self, from: f64, to: f64) -> Self {
        let [a, b] = self.interval;
        Self { interval: [a + (b - a) * from, if to == 1.0 { b } else { a + (b - a) * to }], ..self }
    }

    /// The exact place of the local frame.
    pub fn frame(&self) -> Complex<f64> {
        let [from, to] = self.interval;
        self.segment.cut(from, to, self.offset).origin
    }

    /// The parameter on the segment for the local parameter tau in -1/2..=1/2.
    pub fn xi(&self, tau: f64) -> f64 {
        let [from, to] = self.interval;
        (from + to) * 0.5 + (to - from) * tau
    }

    /// The piece for the kernel, every number rounded to `T` once.
    pub fn piece<T: Real>(&self) -> Piece<T> {
        let [from, to] = self.interval;
        let cut = self.segment.cut(from, to, self.offset);
        let number = T::lit;
        let complex = |z: Complex<f64>| Complex::new(number(z.re), number(z.im));
        let ramp = |ramp: Ramp<f64>| Ramp { length: number(ramp.length), factor: number(ramp.factor) };
        Piece {
            origin: round_point(cut.origin),
            shape: match cut.shape {
                Shape::Ph { preimage, offset } => Shape::Ph { preimage: preimage.map(complex), offset: number(offset) },
                Shape::Line { chord } => Shape::Line { chord: complex(chord) },
                Shape::Arc { radius, sweep, ratio } => {
                    Shape::Arc { radius: complex(radius), sweep: number(sweep), ratio: number(ratio) }
                }
                Shape::Spline(SplineShape { plane, bow, correction }) => {
                    Shape::Spline(SplineShape { plane: plane.map(complex), bow: bow.map(number), correction })
                }
            },
            interval: [number(from), number(to)],
            feed: number(self.feed),
            start: self.start.map(ramp),
            end: self.end.map(ramp),
            profile: self.profile.map(|Profile { factors }| Profile { factors: factors.map(number) }),
            further: None,
            last: None,
        }
    }

    /// The exact last point, rounded to the machine's unit.
    pub fn last(&self) -> Position {
        let [x, y] = round_point(self.segment.offset_point(self.interval[1], self.offset));
        [x, y, Fixed(0)]
    }
}

/// The pieces of a path; the last one carries the exact last point.
pub fn pieces<T: Real>(path: &[Draft]) -> Vec<Piece<T>> {
    let mut pieces: Vec<Piece<T>> = path.iter().map(Draft::piece).collect();
    if let (Some(piece), Some(draft)) = (pieces.last_mut(), path.last()) {
        piece.last = Some(draft.last());
    }
    pieces
}

/// A PH quintic of this length in mm from the direction of its preimage coefficients (re, im), starting at the origin.
pub fn ph(w: [(f64, f64); 3], length: f64) -> Segment<f64> {
    let curve = PhQuintic { start: Complex::ZERO, w: w.map(|(re, im)| Complex::new(re, im)) };
    let scale = (length / curve.length()).sqrt();
    Segment::Ph(PhQuintic { w: curve.w.map(|w| w * scale), ..curve })
}

/// The line from the origin by (`x`, `y`) mm.
pub fn line(x: f64, y: f64) -> Segment<f64> {
    Segment::Line(Line { start: Complex::ZERO, end: Complex::new(x, y) })
}

/// The arc from the origin with its centre at (`x`, `y`) mm through `sweep` rad.
pub fn arc(x: f64, y: f64, sweep: f64) -> Segment<f64> {
    let centre = Complex::new(x, y);
    Segment::Arc(Arc { start: Complex::ZERO, radius: -centre, sweep })
}

/// Curves that bend in every way a contour does: gently, in an S, tightly in the middle, with a tenfold change of speed.
pub fn curves(length: f64) -> [Segment<f64>; 4] {
    [
        ph([(1.0, 0.0), (0.8, 0.3), (0.6, 0.6)], length),
        ph([(3.4, -2.6), (-1.6, 2.5), (4.2, 1.2)], length),
        ph([(1.0, 0.2), (0.3, 0.5), (0.9, -0.3)], length),
        ph([(0.35, 0.0), (0.6, 0.2), (1.0, 0.5)], length),
    ]
}

/// The same segment elsewhere.
pub fn moved(segment: Segment<f64>, by: Complex<f64>) -> Segment<f64> {
    match segment {
        Segment::Ph(curve) => Segment::Ph(PhQuintic { start: curve.start + by, ..curve }),
        Segment::Line(line) => Segment::Line(Line { start: line.start + by, end: line.end + by }),
        Segment::Arc(arc) => Segment::Arc(Arc { start: arc.start + by, ..arc }),
        Segment::Spline(spline) => Segment::Spline(Spline { points: spline.points.map(|p| p + by), ..spline }),
    }
}

/// The same segment turned about the origin of coordinates; `by` has magnitude 1.
pub fn turned(segment: Segment<f64>, by: Complex<f64>) -> Segment<f64> {
    match segment {
        Segment::Ph(curve) => {
            let root = by.sqrt();
            Segment::Ph(PhQuintic { start: curve.start * by, w: curve.w.map(|w| w * root) })
        }
        Segment::Line(line) => Segment::Line(Line { start: line.start * by, end: line.end * by }),
        Segment::Arc(arc) => Segment::Arc(Arc { start: arc.start * by, radius: arc.radius * by, ..arc }),
        Segment::Spline(spline) => Segment::Spline(Spline { points: spline.points.map(|p| p * by), ..spline }),
    }
}

/// Segments that start at the origin, each moved and turned to go on where and as the one before it ends, at one offset.
pub fn smooth_path(segments: &[Segment<f64>], start: Complex<f64>, offset: f64, feed: f64) -> Vec<Draft> {
    let (mut at, mut along) = (start, Complex::new(1.0, 0.0));
    segments
        .iter()
        .map(|&segment| {
            let by = along * Draft::whole(segment, 0.0, feed).direction(0.0).conj();
            let draft = Draft::whole(moved(turned(segment, by), at), offset, feed);
            (at, along) = (draft.contact(1.0), draft.direction(1.0));
            draft
        })
        .collect()
}

//! One piece of the exact path, and the same piece as the controller gets it.

use shared::complex::Complex;
use shared::curve::{Curve as _, Cut, Segment};
use shared::feed::Ramp;
use shared::fixed::{Position, round_point};
use shared::piece::{Piece, Shape, SplineShape};
use shared::profile::Profile;

use crate::contour::{Along, Contour};
use crate::height::Height;
use crate::strokes::{Entry, Pace, Stroke};

/// One piece of the exact path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPiece {
    /// Where on the contour it runs.
    pub along: Along,
    /// The curve; for a fill arc the arc itself.
    pub segment: Segment<f64>,
    /// The parameter interval.
    pub interval: [f64; 2],
    /// The offset distance; 0 on a fill arc, which is its own centre path.
    pub offset: f64,
    /// How it is entered, whatever a plan's own manner is.
    pub entry: Entry,
    /// Whether it is as fast as the machine can: a plan takes the machine's limits in the place of its feed.
    pub is_rapid: bool,
    /// How z goes along the segment; none where the path does not speak of it.
    pub height: Option<Height>,
    /// V in mm/s.
    pub feed: f64,
    /// The same as the job has it, whatever a plan makes of it.
    pub wish: f64,
    /// The turn of the centre's way into it in radians, positive anticlockwise, where that is a corner.
    pub start_corner: Option<f64>,
    /// The turn of the centre's way behind it, where that is a corner.
    pub end_corner: Option<f64>,
    /// The ramp at the start.
    pub start: Option<Ramp<f64>>,
    /// The ramp at the end.
    pub end: Option<Ramp<f64>>,
    /// The feed over time, where it is planned.
    pub profile: Option<Profile<f64>>,
}

impl PathPiece {
    /// A part of the offset at `distance`, not slowed down anywhere. None where the contour has no such segment or node.
    pub(super) fn new(contour: &Contour, along: Along, distance: f64, feed: f64) -> Option<Self> {
        let (segment, interval, offset) = contour.carrier(along, distance)?;
        Some(Self::plain(along, segment, interval, offset, feed))
    }

    /// A part of a segment that nothing else is said of.
    fn plain(along: Along, segment: Segment<f64>, interval: [f64; 2], offset: f64, feed: f64) -> Self {
        Self {
            along,
            segment,
            interval,
            offset,
            entry: Entry::Through,
            is_rapid: false,
            height: None,
            feed,
            wish: feed,
            start_corner: None,
            end_corner: None,
            start: None,
            end: None,
            profile: None,
        }
    }

    /// A stroke of a program, the one of this number; `free` is the feed in mm/s where it has none of its own.
    pub(super) fn of_stroke(number: usize, stroke: &Stroke, free: f64) -> Self {
        let [from, to] = stroke.interval;
        let feed = match stroke.pace {
            Pace::Feed(feed) => feed,
            Pace::Rapid | Pace::Unset => free,
        };
        // The way in space is longer than the one that the feed is along.
        let feed = feed / stroke.height.stretch();
        let along = Along::Segment { segment: number, from, to };
        Self {
            entry: stroke.entry,
            is_rapid: stroke.pace == Pace::Rapid,
            height: Some(stroke.height),
            ..Self::plain(along, stroke.segment, stroke.interval, stroke.offset, feed)
        }
    }

    /// The same over another interval.
    pub fn over(&self, [from, to]: [f64; 2]) -> Self {
        let along = match self.along {
            Along::Segment { segment, .. } => Along::Segment { segment, from, to },
            Along::Fill { node, .. } => Along::Fill { node, from, to },
        };
        Self { along, interval: [from, to], ..*self }
    }

    /// Whether z moves along it.
    pub fn moves_z(&self) -> bool {
        self.height.is_some_and(|height| !height.is_level())
    }

    /// Whether the contact point rests here.
    pub fn is_fill(&self) -> bool {
        matches!(self.along, Along::Fill { .. })
    }

    /// Whether the centre goes the way of C, and not backwards; the same all over a piece that the controller takes.
    pub fn is_forward(&self) -> bool {
        // In the middle, for at an end 1 + kappa d may vanish.
        1.0 + self.segment.curvature(self.parameter(0.0)) * self.offset >= 0.0
    }

    /// The direction of the centre's way: that of C, or the opposite one where it goes backwards.
    pub fn direction(&self, xi: f64) -> Complex<f64> {
        let tangent = self.segment.tangent(xi);
        if self.is_forward() { tangent } else { -tangent }
    }

    /// The parameter on the segment for the local one of its curve in -1/2..=1/2.
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
        if self.is_fill() { 0.0 } else { self.way() }
    }

    /// The length that the feed is along ([`super::Space`]): that of the segment's part, but where z bends or moves alone.
    pub fn way(&self) -> f64 {
        let [from, to] = self.interval;
        self.way_to(to) - self.way_to(from)
    }

    /// The length of the centre's way: |length + d times the turn of the tangent|, from integrating equation (13), and z.
    pub fn centre_length(&self) -> f64 {
        let plane = || (self.way() + self.offset * self.turn()).abs();
        match self.height {
            // Exact but for an offset PH curve, where it is that of an even rise.
            Some(Height::Linear { slope, .. }) => plane().hypot(slope * self.way()),
            Some(Height::Vertical(_) | Height::Bezier(_)) => self.way(),
            None => plane(),
        }
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
            Shape::Spline(SplineShape { plane, bow, correction }) => {
                Shape::Spline(SplineShape { plane: plane.map(Complex::from), bow: bow.map(real), correction })
            }
        };
        Piece {
            origin: exact.origin,
            shape,
            interval: exact.interval.map(real),
            feed: real(exact.feed),
            start: exact.start.map(ramp),
            end: exact.end.map(ramp),
            profile: exact.profile.map(|Profile { factors }| Profile { factors: factors.map(real) }),
            further: exact.further,
            last,
        }
    }

    /// The same piece for the f64 twin of the tick; only its origin is rounded.
    pub fn exact(&self, last: Option<Position>) -> Piece<f64> {
        let [from, to] = self.interval;
        let Cut { origin, mut shape } = self.segment.cut(from, to, self.offset);
        if let Shape::Spline(spline) = &mut shape {
            spline.bow = self.height.map_or([0.0; 4], |height| height.bow(from, to));
        }
        Piece {
            origin: round_point(origin),
            shape,
            interval: self.interval,
            feed: self.feed,
            start: self.start,
            end: self.end,
            profile: self.profile,
            further: self.travel(),
            last,
        }
    }
}

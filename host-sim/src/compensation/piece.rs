//! The pieces of the centre's path.

use shared::complex::Complex;
use shared::curve::{Arc, Curve as _, Line, Segment};

use crate::program::{self, Action, Feed, Item, Motion, Plane};

/// One piece of the path of the tool's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CentrePiece {
    /// The curve: of a PH piece that of the contour, otherwise that of the centre itself.
    pub segment: Segment<f64>,
    /// The parameter interval that is run.
    pub interval: [f64; 2],
    /// How far the centre is from the curve in mm, positive right of travel; other than 0 only for PH pieces.
    pub offset: f64,
    /// The heights at both ends in mm; between them z goes evenly with the parameter of a line or an arc.
    pub z: [f64; 2],
    /// The feed of the motion; what was the time of a whole motion is the rate along the contour here.
    pub feed: Feed,
    /// Whether it is as fast as the machine can.
    pub is_rapid: bool,
    /// Line and column of the motion in the program.
    pub place: [usize; 2],
}

impl CentrePiece {
    /// The part of a curve's offset over `interval`. Lines and arcs become those of the centre.
    pub(super) fn new(curve: &Segment<f64>, [from, to]: [f64; 2], offset: f64) -> Self {
        let (segment, interval, offset) = match curve {
            Segment::Line(line) => {
                let [start, end] = [from, to].map(|xi| line.offset_point(xi, offset));
                (Segment::Line(Line { start, end }), [0.0, 1.0], 0.0)
            }
            Segment::Arc(arc) => {
                let start = arc.offset_point(from, offset);
                let radius = (arc.point(from) - arc.centre()) * (1.0 + arc.curvature(from) * offset);
                (Segment::Arc(Arc { start, radius, sweep: arc.sweep * (to - from) }), [0.0, 1.0], 0.0)
            }
            _ => (*curve, [from, to], offset),
        };
        Self { segment, interval, offset, z: [0.0; 2], feed: Feed::Unset, is_rapid: false, place: [0; 2] }
    }

    /// This piece and the next one as one, if both are of one motion and go straight or around on.
    pub(super) fn with(&self, next: &Self) -> Option<Self> {
        /// What rounding may make of a direction, or of a centre in parts of its radius.
        const ROUNDING: f64 = 1e-9;
        let segment = match (self.segment, next.segment) {
            (Segment::Line(one), Segment::Line(other)) => {
                let is_straight = (one.tangent(1.0) - other.tangent(0.0)).norm() <= ROUNDING;
                is_straight.then_some(Segment::Line(Line { end: other.end, ..one }))
            }
            (Segment::Arc(one), Segment::Arc(other)) => {
                let sweep = one.sweep + other.sweep;
                let is_round = (one.centre() - other.centre()).norm() <= ROUNDING * one.radius.norm();
                let goes_on = one.sweep * other.sweep > 0.0 && sweep.abs() <= std::f64::consts::TAU;
                (is_round && goes_on).then_some(Segment::Arc(Arc { sweep, ..one }))
            }
            _ => None,
        }?;
        let is_one = self.place == next.place && self.feed == next.feed && self.is_rapid == next.is_rapid;
        is_one.then_some(Self { segment, z: [self.z[0], next.z[1]], ..*self })
    }

    /// The centre at a parameter of the segment, in mm.
    pub fn point(&self, xi: f64) -> Complex<f64> {
        self.segment.offset_point(xi, self.offset)
    }

    /// Where it begins.
    pub fn start(&self) -> Complex<f64> {
        self.point(self.interval[0])
    }

    /// Where it ends.
    pub fn end(&self) -> Complex<f64> {
        self.point(self.interval[1])
    }

    /// The same as the motion of a program; none for a PH piece, which no program has.
    pub fn item(&self) -> Option<Item<'static>> {
        let in_space = |p: Complex<f64>, z: f64| [p.re, p.im, z];
        let (from, to) = (in_space(self.start(), self.z[0]), in_space(self.end(), self.z[1]));
        let motion = match self.segment {
            Segment::Line(_) if self.is_rapid => Motion::Rapid { to },
            Segment::Line(_) => Motion::Line { to },
            Segment::Arc(arc) => {
                let centre = arc.centre();
                let sweep = arc.sweep * (self.interval[1] - self.interval[0]);
                Motion::Arc(program::Arc { plane: Plane::Xy, centre: [centre.re, centre.im], to, sweep, turns: 0 })
            }
            Segment::Ph(_) | Segment::Spline(_) => return None,
        };
        let [line, column] = self.place;
        Some(Item { line, column, from, feed: self.feed, action: Action::Motion(motion) })
    }
}

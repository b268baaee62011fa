//! From the steps of a program to its strokes.

use std::f64::consts::TAU;

use shared::complex::Complex;
use shared::curve::{Arc as Circle, Curve as _, Line, Segment, Spline};
use shared::spline::CorrectionOrder;

use super::rounding::{Rounded, rounded};
use super::{Entry, Event, Pace, Stroke, What};
use crate::compensation::CentrePiece;
use crate::fit::program::Step;
use crate::fit::{Curve, Kind, fit};
use crate::height::Height;
use crate::program::item::PathMode;
use crate::program::quintic::{self, Jet, Quintic, quintics};
use crate::program::{Action, Arc, Feed, Item, Motion, Plane};
use crate::vector::Vector;

/// What is shorter is no motion, in mm.
const SHORTEST: f64 = 1e-5;

/// Heights that are the same, in mm.
const LEVEL: f64 = 1e-9;

/// How far a curve that is fitted anew may be from its polyline, in mm.
const ANEW: f64 = 1e-3;

/// How far the centre of an arc may be moved so that both of its ends are on one circle, in mm; programs are rounded.
const MOVED: f64 = 0.01;

/// Collects strokes and events.
#[derive(Clone, Debug, Default)]
pub struct Strokes {
    /// The strokes in order.
    pub strokes: Vec<Stroke>,
    /// What is done between them.
    pub events: Vec<Event>,
    /// What is added to the program's coordinates.
    shift: Vector,
    end: Option<Vector>,
    mode: Entry,
    rests: bool,
    rounding: Option<f64>,
}

/// What all strokes of one motion have.
#[derive(Clone, Copy)]
struct Of {
    feed: Feed,
    is_rapid: bool,
    line: usize,
}

impl Strokes {
    /// Rounds the breaks of chains of lines within a tolerance in mm.
    pub fn rounding(tolerance: f64) -> Self {
        Self { rounding: Some(tolerance), ..Self::default() }
    }

    /// Takes a step of a program. The error is a sentence: what this cannot be done with.
    pub fn take(&mut self, step: &Step<'_>) -> Result<(), String> {
        match step {
            Step::Curves { fit, feed, line } => {
                let of = Of { feed: *feed, is_rapid: false, line: *line };
                fit.parts.iter().try_for_each(|part| self.curve(&part.curve, of))
            }
            Step::Lines { points, feed, line } => {
                let of = Of { feed: *feed, is_rapid: false, line: *line };
                match self.rounding {
                    Some(tolerance) => rounded(points, tolerance).iter().try_for_each(|part| self.rounded(part, of)),
                    None => {
                        points.windows(2).for_each(|ends| self.line(ends[0], ends[1], of));
                        Ok(())
                    }
                }
            }
            Step::Kept(item) => self.item(item),
        }
    }

    fn item(&mut self, item: &Item<'_>) -> Result<(), String> {
        match &item.action {
            Action::Motion(motion) => self.motion(item, motion),
            Action::Further { axis, .. } => {
                Err(format!("the program moves {axis}; jobs have the axes X, Y and Z. Leave {axis} out"))
            }
            Action::PathMode(mode) => {
                self.mode = match mode {
                    PathMode::Exact => Entry::RestInCorner,
                    PathMode::Stop => Entry::Rest,
                    PathMode::Blend { .. } => Entry::Through,
                };
                Ok(())
            }
            other => {
                if let Some(what) = What::of(other) {
                    self.rests |= what.rests();
                    self.events.push(Event { before: self.strokes.len(), line: item.line, what });
                }
                Ok(())
            }
        }
    }

    /// Takes a piece of the path of the tool's centre, from cutter compensation. The error is a sentence.
    pub fn centre(&mut self, piece: &CentrePiece) -> Result<(), String> {
        let of = Of { feed: piece.feed, is_rapid: piece.is_rapid, line: piece.place[0] };
        if piece.offset == 0.0 && piece.interval == [0.0, 1.0] {
            let [from, to] =
                [(piece.start(), piece.z[0]), (piece.end(), piece.z[1])].map(|(p, z)| Vector([p.re, p.im, z]));
            match piece.segment {
                Segment::Line(_) => {
                    self.line(from, to, of);
                    return Ok(());
                }
                Segment::Arc(arc) => {
                    let Complex { re, im } = arc.centre();
                    let arc = Arc { plane: Plane::Xy, centre: [re, im], to: to.0, sweep: arc.sweep, turns: 0 };
                    return self.arc(&arc, from.0, of);
                }
                Segment::Ph(_) | Segment::Spline(_) => {}
            }
        }
        let [from, to] = piece.interval;
        let [before, behind] = [from, to].map(|xi| piece.segment.length_to(xi));
        let shift = self.join(
            Vector([piece.start().re, piece.start().im, piece.z[0]]),
            Vector([piece.end().re, piece.end().im, piece.z[1]]),
        );
        let slope = (piece.z[1] - piece.z[0]) / (behind - before);
        let height = Height::Linear { start: piece.z[0] + shift.0[2] - slope * before, slope };
        let mut segment = piece.segment;
        match &mut segment {
            Segment::Ph(curve) => curve.start = curve.start + flat(shift),
            Segment::Arc(arc) => arc.start = arc.start + flat(shift),
            Segment::Line(line) => {
                (line.start, line.end) = (line.start + flat(shift), line.end + flat(shift));
            }
            Segment::Spline(curve) => curve.points = curve.points.map(|point| point + flat(shift)),
        }
        self.push_part(segment, piece.interval, piece.offset, height, of);
        Ok(())
    }

    fn motion(&mut self, item: &Item<'_>, motion: &Motion<'_>) -> Result<(), String> {
        let from = Vector(item.from);
        let of = Of { feed: item.feed, is_rapid: matches!(motion, Motion::Rapid { .. }), line: item.line };
        match *motion {
            Motion::Rapid { to } | Motion::Line { to } => {
                self.line(from, Vector(to), of);
                Ok(())
            }
            Motion::Arc(arc) => self.arc(&arc, item.from, of),
            Motion::Bezier { .. } | Motion::Nurbs(_) => {
                let parts = quintic::drawn(item.from, motion).map_err(|error| error.to_string())?;
                self.drawn(&parts.unwrap_or_default(), of)
            }
        }
    }

    /// A curve that the program gives as such. Where it all but stands still, as control points that coincide make it, no feed can be kept: it
    /// is fitted anew.
    fn drawn(&mut self, parts: &[Quintic], of: Of) -> Result<(), String> {
        if parts.iter().all(quintic::is_lively) {
            self.quintics(parts, of);
            return Ok(());
        }
        let fit = fit(&quintic::polyline(parts), Kind::Ph, ANEW);
        fit.parts.iter().try_for_each(|part| self.curve(&part.curve, of))
    }

    fn curve(&mut self, curve: &Curve, of: Of) -> Result<(), String> {
        match curve {
            Curve::Line(line) => self.line(line.points[0], line.points[1], of),
            Curve::Cubic(cubic) => {
                let all = cubic.points.map(|Vector([x, y, z])| [x, y, z, 1.0]);
                self.followed(|at| quintic::rational(&all, at), of)?;
            }
            Curve::Arc(arc) => self.arc(&arc.motion(), arc.start.0, of)?,
            Curve::Ph(ph) => {
                let points = ph.bezier().points;
                let [.., z] = points[0].0;
                // The tick moves z evenly along a PH curve; where it bends, the same curve is a quintic.
                if points.iter().any(|point| (point.0[2] - z).abs() > LEVEL) {
                    self.quintics(&[points], of);
                    return Ok(());
                }
                let shift = self.join(points[0], points[5]);
                let mut segment = ph.plane;
                segment.start = flat(points[0] + shift);
                self.push(Segment::Ph(segment), Height::level(z + shift.0[2]), of);
            }
        }
        Ok(())
    }

    fn line(&mut self, from: Vector, to: Vector, of: Of) {
        let shift = self.join(from, to);
        let (from, to) = (from + shift, to + shift);
        let [start, end] = [flat(from), flat(to)];
        let is_upright = (end - start).norm() < SHORTEST;
        let segment = Segment::Line(Line { start, end: if is_upright { start } else { end } });
        self.push(segment, Height::between(&segment, [from.0[2], to.0[2]]), of);
    }

    fn rounded(&mut self, part: &Rounded, of: Of) -> Result<(), String> {
        let Rounded::Arc { ends: [from, to], centre, angle } = *part else {
            if let Rounded::Line([from, to]) = *part {
                self.line(from, to, of);
            }
            return Ok(());
        };
        let ([radius, end], is_level) = ([from - centre, to - centre], (from - to).0[2].abs() <= LEVEL);
        if is_level && (from - centre).0[2].abs() <= LEVEL {
            let sweep = angle.copysign(radius.cross(end).0[2]);
            let arc = Arc { plane: Plane::Xy, centre: [centre.0[0], centre.0[1]], to: to.0, sweep, turns: 0 };
            return self.arc(&arc, from.0, of);
        }
        // In the plane of the arc: its radius, and as long across it.
        let across = (end - radius * angle.cos()) * (1.0 / angle.sin());
        let jet = |at: f64| {
            let (sine, cosine) = (angle * at).sin_cos();
            let spoke = radius * cosine + across * sine;
            [centre + spoke, (across * cosine - radius * sine) * angle, spoke * (-angle * angle)]
        };
        self.followed(jet, of)
    }

    /// Flat arcs and helices about z stay arcs, turn by turn; others become quintics.
    fn arc(&mut self, arc: &Arc, from: [f64; 3], of: Of) -> Result<(), String> {
        let Some((radius, sweep)) = circle(arc, from) else {
            return self.followed(|at| quintic::arc(arc, from, at), of);
        };
        let shift = self.join(Vector(from), Vector(arc.to));
        let [x, y, z] = (Vector(from) + shift).0;
        let rise = arc.to[2] - from[2];
        // One turn at a time.
        let count = (sweep.abs() / TAU - 1e-9).ceil().max(1.0);
        for k in 0..count as u32 {
            let at = |part: u32| f64::from(part) / count;
            let turned = radius * unit(sweep * at(k));
            let start = Complex::new(x, y) - radius + turned;
            let segment = Segment::Arc(Circle { start, radius: turned, sweep: sweep / count });
            self.push(segment, Height::between(&segment, [z + rise * at(k), z + rise * at(k + 1)]), of);
        }
        Ok(())
    }

    fn followed(&mut self, curve: impl Fn(f64) -> Jet, of: Of) -> Result<(), String> {
        self.quintics(&quintics(curve).map_err(|error| error.to_string())?, of);
        Ok(())
    }

    fn quintics(&mut self, parts: &[Quintic], of: Of) {
        for &points in parts {
            let shift = self.join(points[0], points[5]);
            let points = points.map(|point| point + shift);
            let curve = Spline { points: points.map(flat), correction: CorrectionOrder::default() };
            let heights = points.map(|Vector([_, _, z])| z);
            let is_flat = heights.iter().all(|z| (z - heights[0]).abs() <= LEVEL);
            let height = if is_flat { Height::level(heights[0]) } else { Height::Bezier(heights) };
            self.push(Segment::Spline(curve), height, of);
        }
    }

    /// Moves what follows to where the tool is; gives by how much it is moved in all.
    fn join(&mut self, from: Vector, to: Vector) -> Vector {
        if let Some(end) = self.end
            && (end - from).norm() > SHORTEST
        {
            self.shift = self.shift + (end - from);
        }
        self.end = Some(to);
        self.shift
    }

    fn push(&mut self, segment: Segment<f64>, height: Height, of: Of) {
        self.push_part(segment, [0.0, 1.0], 0.0, height, of);
    }

    fn push_part(&mut self, segment: Segment<f64>, interval: [f64; 2], offset: f64, height: Height, of: Of) {
        let mut stroke = Stroke {
            segment,
            interval,
            offset,
            height,
            pace: Pace::Unset,
            entry: if self.rests { Entry::Rest } else { self.mode },
            line: of.line,
        };
        let [before, behind] = interval.map(|xi| height.way_to(&segment, xi));
        let way = (behind - before) * height.stretch();
        if way < SHORTEST {
            return;
        }
        stroke.pace = match of.feed {
            _ if of.is_rapid => Pace::Rapid,
            Feed::Unset => Pace::Unset,
            Feed::Rate(rate) => Pace::Feed(rate),
            Feed::Duration(time) => Pace::Feed(way / time),
        };
        self.rests = false;
        self.strokes.push(stroke);
    }
}

/// Of a flat arc, or a helix about z: from the centre to its start, and the angle. The centre is moved so that both ends are on one circle. None
/// where it would have to be moved far.
fn circle(arc: &Arc, from: [f64; 3]) -> Option<(Complex<f64>, f64)> {
    if arc.plane != Plane::Xy {
        return None;
    }
    let [start, end] = [from, arc.to].map(|[x, y, _]| Complex::new(x, y));
    let given = Complex::new(arc.centre[0], arc.centre[1]);
    let chord = end - start;
    if chord.norm() < SHORTEST {
        return Some((start - given, arc.sweep));
    }
    // The nearest centre on the perpendicular bisector.
    let middle = (start + end) * 0.5;
    let centre = given - chord * ((given - middle).dot(chord) / chord.norm_sqr());
    if (centre - given).norm() > MOVED {
        return None;
    }
    let [first, last] = [start - centre, end - centre];
    let angle = (first.conj() * last).arg();
    // The same number of turns.
    let sweep = angle + TAU * ((arc.sweep - angle) / TAU).round();
    Some((first, sweep))
}

fn unit(angle: f64) -> Complex<f64> {
    let (sine, cosine) = angle.sin_cos();
    Complex::new(cosine, sine)
}

fn flat(Vector([x, y, _]): Vector) -> Complex<f64> {
    Complex::new(x, y)
}

//! Fitted programs in the contour form.
//!
//! A contour is one chain of cuts at one height, so a program may hold several: they end where the tool moves in z, in rapid, or at another
//! feed.

use std::fmt::{self, Write as _};

use shared::complex::Complex;

use super::Curve;
use super::curve::Bezier;
use super::program::Step;
use crate::program::{Action, Arc, Feed, Motion, Plane};
use crate::vector::Vector;

/// One contour.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// Its feed in mm/s; none where nothing says one, as in a drawing.
    pub feed: Option<f64>,
    /// Where it begins.
    pub start: Vector,
    /// Where it ends.
    pub end: Vector,
    segments: Vec<Segment>,
}

/// One segment of the contour form, behind where the last one ended.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Segment {
    Line { to: Vector },
    Arc { to: Vector, centre: [f64; 2], ccw: bool },
    Bezier { points: [Vector; 3] },
    Ph { w: [Complex<f64>; 3] },
}

/// Why steps make no contour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unfit {
    /// A cut has a time in the place of a feed.
    NoFeed,
    /// A curve other than a line, an arc or a fitted one.
    Curve,
    /// A curve that is not at one height.
    Height,
}

impl fmt::Display for Unfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoFeed => "a contour has a feed per minute; give F under G94",
            Self::Curve => "the contour form takes lines and arcs of a program; write to .mpf instead",
            Self::Height => "a curve changes its height, and a contour has none; write to .mpf instead",
        })
    }
}

/// Heights, and ends, that are the same, in mm.
const SAME: f64 = 1e-9;

/// Collects contours.
#[derive(Clone, Debug, Default)]
pub struct Chains {
    /// Those that have ended, and the last one.
    pub chains: Vec<Chain>,
    is_open: bool,
}

impl Chains {
    /// Takes a step of a fitted program. Errors: it is none of a contour.
    pub fn take(&mut self, step: &Step<'_>) -> Result<(), Unfit> {
        match step {
            Step::Curves { fit, feed, .. } => fit.parts.iter().try_for_each(|part| self.curve(&part.curve, *feed)),
            Step::Lines { points, feed, .. } => points
                .windows(2)
                .try_for_each(|ends| self.curve(&Curve::Line(Bezier { points: [ends[0], ends[1]] }), *feed)),
            Step::Kept(item) => match item.action {
                Action::Motion(Motion::Arc(arc)) => self.arc(&arc, Vector(item.from), item.feed),
                Action::Motion(Motion::Bezier { .. } | Motion::Nurbs(_)) => Err(Unfit::Curve),
                Action::Motion(Motion::Rapid { .. } | Motion::Line { .. }) => {
                    self.is_open = false;
                    Ok(())
                }
                _ => Ok(()),
            },
        }
    }

    fn curve(&mut self, curve: &Curve, feed: Feed) -> Result<(), Unfit> {
        let (points, segment) = match curve {
            Curve::Line(line) => {
                let [start, end] = line.points;
                if (start.0[2] - end.0[2]).abs() > SAME {
                    self.is_open = false;
                    return Ok(());
                }
                (line.points.to_vec(), Segment::Line { to: end })
            }
            Curve::Cubic(cubic) => {
                let [_, points @ ..] = cubic.points;
                (cubic.points.to_vec(), Segment::Bezier { points })
            }
            Curve::Arc(arc) => {
                let (to, ccw) = (arc.at(1.0).point, arc.sweep > 0.0);
                (vec![arc.start, to], Segment::Arc { to, centre: arc.centre, ccw })
            }
            Curve::Ph(ph) => (ph.bezier().points.to_vec(), Segment::Ph { w: ph.plane.w }),
        };
        if points.iter().any(|point| (point.0[2] - points[0].0[2]).abs() > SAME) {
            return Err(Unfit::Height);
        }
        self.push([points[0], points[points.len() - 1]], segment, feed)
    }

    fn arc(&mut self, arc: &Arc, from: Vector, feed: Feed) -> Result<(), Unfit> {
        let to = Vector(arc.to);
        if arc.plane != Plane::Xy || (to.0[2] - from.0[2]).abs() > SAME || arc.turns > 0 {
            return Err(Unfit::Height);
        }
        self.push([from, to], Segment::Arc { to, centre: arc.centre, ccw: arc.sweep > 0.0 }, feed)
    }

    fn push(&mut self, [start, end]: [Vector; 2], segment: Segment, feed: Feed) -> Result<(), Unfit> {
        let feed = match feed {
            Feed::Rate(feed) => Some(feed),
            Feed::Unset => None,
            Feed::Duration(_) => return Err(Unfit::NoFeed),
        };
        match self.chains.last_mut().filter(|chain| self.is_open && chain.feed == feed) {
            Some(chain) => {
                chain.end = end;
                chain.segments.push(segment);
            }
            None => self.chains.push(Chain { feed, start, end, segments: vec![segment] }),
        }
        self.is_open = true;
        Ok(())
    }
}

impl fmt::Display for Segment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let flat = |point: Vector| format!("[{:?}, {:?}]", point.0[0], point.0[1]);
        match *self {
            Self::Line { to } => write!(f, "to = {}", flat(to)),
            Self::Arc { to, centre: [x, y], ccw } => {
                write!(f, "to = {}, centre = [{x:?}, {y:?}], ccw = {ccw}", flat(to))
            }
            Self::Bezier { points } => write!(f, "points = [{}]", points.map(flat).join(", ")),
            Self::Ph { w } => {
                write!(f, "w = [{}]", w.map(|w| format!("[{:?}, {:?}]", w.re, w.im)).join(", "))
            }
        }
    }
}

impl Segment {
    /// Its key in the contour form.
    fn key(&self) -> &'static str {
        match self {
            Self::Line { .. } => "line",
            Self::Arc { .. } => "arc",
            Self::Bezier { .. } => "bezier",
            Self::Ph { .. } => "ph",
        }
    }
}

/// The contour of that number, or the only one. The error is a sentence.
pub fn only(chains: &[Chain], number: Option<usize>) -> Result<&Chain, String> {
    let count = chains.len();
    match (number, chains) {
        (_, []) => Err("there is no cut at one height, so no contour".to_string()),
        (None, [only]) => Ok(only),
        (None, _) => {
            Err(format!("there are {count} contours; `hodograph fit` with --contour 0 to {} takes one", count - 1))
        }
        (Some(number), _) => chains
            .get(number)
            .ok_or_else(|| format!("there is no contour {number}; --contour 0 to {} takes one", count - 1)),
    }
}

impl Chain {
    /// How many segments it has.
    pub fn segments(&self) -> usize {
        self.segments.len()
    }

    /// The contour form of it, in mm and mm/min.
    pub fn to_toml(&self) -> String {
        let closed = (self.end - self.start).norm() < SAME;
        let mut text = format!("units = \"mm\"\nclosed = {closed}\n");
        if let Some(feed) = self.feed {
            // Writing to a string does not fail.
            let _ = write!(text, "\n[feed]\nrate = {:?}\n", feed * 60.0);
        }
        let [x, y, _] = self.start.0;
        for (number, segment) in self.segments.iter().enumerate() {
            let start = if number == 0 { format!("start = [{x:?}, {y:?}], ") } else { String::new() };
            // Writing to a string does not fail.
            let _ = write!(text, "\n[[segment]]\n{} = {{ {start}{segment} }}\n", segment.key());
        }
        text
    }
}

//! Curves for the polylines of programs.
//!
//! A program of CAM is thousands of short lines that stand for a curve. Here the curve is found again, under a tolerance that holds both
//! ways: no point of the polyline is farther from the curve, and no point of the curve is farther from the polyline.
//!
//! | module | what |
//! | --- | --- |
//! | [`curve`] | polynomial curves in space |
//! | `corners` | where a polyline is smooth, and what of it is straight (SA 3) |
//! | `tangent`, `seam` | its tangent at a vertex; how a closed one goes on at its start |
//! | `conditions` | both conditions on a curve (SA 1, SA 2), as an upper bound |
//! | `piecewise` | cubics with common tangents, as published |
//! | [`arc`], `arcs` | circular arcs, for comparison |
//! | `polyline`, `spans`, `band` | a polyline by the way along it; least squares of splines |
//! | [`bspline`] | cubic B-splines with continuous curvature (SA 5) |
//! | [`ph`] | PH quintics with continuous curvature |
//! | [`c2`] | PH quintics with two continuous derivatives |
//! | [`joins`] | how smoothly one curve goes on to the next |
//! | [`contour`] | the result in the contour form |
//! | [`program`] | all of that for the lines of a program |

pub mod arc;
mod arcs;
mod band;
pub mod bspline;
pub mod c2;
mod conditions;
pub mod contour;
mod corners;
pub mod curve;
pub mod joins;
pub mod ph;
mod piecewise;
mod polyline;
pub mod program;
mod seam;
mod spans;
mod straights;
mod tangent;

use std::ops::Range;

use crate::vector::{Chord, Vector};
use arc::RisingArc;
use bspline::Bspline;
use corners::Vertex;
use curve::{Bezier, Cubic};
use ph::RisingPh;
use polyline::Polyline;
use straights::{Straight, straights};

/// What is laid through a polyline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Cubics with common tangents.
    Bezier,
    /// Cubic B-splines, with continuous curvature.
    Bspline,
    /// PH quintics with continuous curvature in x and y, along which z goes; cubic B-splines where the way is straight up or down.
    Ph,
    /// What jobs are made of: [`Kind::Ph`] where z stays, [`Kind::Bspline`] where it does not. The tick moves z evenly along a PH curve, and
    /// splines through a relief are run faster.
    Drivable,
    /// As [`Kind::Ph`], with two continuous derivatives between two corners.
    PhC2,
    /// Lines and circular arcs, continuous in direction where no corner is; z goes along evenly.
    Arcs,
}

/// One curve of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Curve {
    /// A line.
    Line(Bezier<2>),
    /// A cubic.
    Cubic(Cubic),
    /// A PH quintic.
    Ph(RisingPh),
    /// A circular arc or a part of a helix.
    Arc(RisingArc),
}

/// A part of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// The curve.
    pub curve: Curve,
    /// The numbers of the polyline's vertices at its ends.
    pub vertices: [usize; 2],
    /// An upper bound of how far curve and polyline are apart anywhere, in mm.
    pub deviation: f64,
    /// Whether it goes on smoothly from the part before it, the first one of a closed loop from the last: in direction, and but for [`Kind::Bezier`] and [`Kind::Arcs`] in curvature.
    pub is_smooth: bool,
}

/// What a polyline comes to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fit {
    /// Curve after curve.
    pub parts: Vec<Part>,
    /// The B-splines among them, with the numbers of the parts that are their spans.
    pub splines: Vec<(Range<usize>, Bspline)>,
}

/// Fits curves to a polyline, none of whose points is repeated, within a tolerance in mm.
///
/// There are never more curves than lines.
pub fn fit(points: &[Vector], kind: Kind, tolerance: f64) -> Fit {
    let mut found = Fit::default();
    if points.len() < 2 {
        return found;
    }
    if kind == Kind::Bezier {
        found.parts = piecewise::fit(points, tolerance);
        return found;
    }
    if kind == Kind::Arcs {
        found.parts = arcs::fit(points, tolerance);
        return found;
    }
    let kinds = corners::vertices(points, tolerance);
    let seam = seam::seam(points, &kinds, tolerance);
    let mut is_closed = seam.is_some();
    let mut from = 0;
    for to in (1..points.len()).filter(|&k| kinds[k] == Vertex::Corner) {
        let held = [seam.filter(|_| from == 0), seam.filter(|_| to + 1 == points.len())];
        if !with_straights(points, [from, to], kind, tolerance, held, &mut found) {
            is_closed &= smooth(points, [from, to], kind, tolerance, held, &mut found);
        }
        from = to;
    }
    // The curvature at the ends of a C2 PH spline is its own.
    if let Some(part) = found.parts.first_mut().filter(|_| is_closed && kind != Kind::PhC2) {
        part.is_smooth = true;
    }
    found
}

/// Fits the vertices between two corners so that long straight segments stay. Where nothing is straight, or where that gives more curves than
/// lines, nothing is done. Whether it is.
fn with_straights(
    points: &[Vector],
    [from, to]: [usize; 2],
    kind: Kind,
    tolerance: f64,
    held: [Option<[Vector; 2]>; 2],
    found: &mut Fit,
) -> bool {
    // The curvature at the ends of a C2 PH spline is its own.
    let straights = if kind == Kind::PhC2 { Vec::new() } else { straights(points, from..to + 1, tolerance) };
    if straights.is_empty() {
        return false;
    }
    let (parts, splines) = (found.parts.len(), found.splines.len());
    let mut is_kept = true;
    // Where the next curve begins: a vertex, the point in its place, and the derivatives there.
    let mut start = (from, points[from], held[0]);
    let along = |straight: &Straight| Some([straight.direction, Vector::default()]);
    let mut curve =
        |start: (usize, Vector, Option<[Vector; 2]>), end: (usize, Vector, Option<[Vector; 2]>), found: &mut Fit| {
            let mut run = points[start.0..=end.0].to_vec();
            let last = run.len() - 1;
            (run[0], run[last]) = (start.1, end.1);
            let first = found.parts.len();
            is_kept &= smooth(&run, [0, last], kind, tolerance, [start.2, end.2], found);
            for part in &mut found.parts[first..] {
                part.vertices = part.vertices.map(|vertex| vertex + start.0);
            }
            if let Some(part) = found.parts.get_mut(first).filter(|_| first > parts) {
                part.is_smooth = true;
            }
        };
    for straight in &straights {
        let Straight { segment, ends, is_led, .. } = *straight;
        if is_led[0] {
            curve(start, (segment + 1, ends[0], along(straight)), found);
        }
        let is_smooth = found.parts.len() > parts;
        let line = Curve::Line(Bezier { points: ends });
        found.parts.push(Part { curve: line, vertices: [segment, segment + 1], deviation: 0.0, is_smooth });
        start = (segment, ends[1], along(straight));
    }
    if straights.last().is_some_and(|straight| straight.is_led[1]) {
        curve(start, (to, points[to], held[1]), found);
    }
    is_kept &= found.parts.len() - parts <= to - from;
    if !is_kept {
        found.parts.truncate(parts);
        found.splines.truncate(splines);
    }
    is_kept
}

/// How far points are from the segment between the first and the last of them, where that is within the tolerance.
fn from_chord(run: &[Vector], tolerance: f64) -> Option<f64> {
    let chord = Chord::new(run[0], run[run.len() - 1]);
    let mut worst = 0.0_f64;
    for &point in run {
        worst = worst.max(chord.square_from(point));
        if worst > tolerance * tolerance {
            return None;
        }
    }
    Some(worst.sqrt())
}

/// Fits the vertices between two corners. Where a vertex turns out to be a corner, both sides of it; where more curves than lines would be
/// needed, the lines stay. `held` are the derivatives at both ends where they are given: where no curves have them, or more than lines would
/// be needed, they are not kept. Whether they are.
fn smooth(
    points: &[Vector],
    ends: [usize; 2],
    kind: Kind,
    tolerance: f64,
    held: [Option<[Vector; 2]>; 2],
    found: &mut Fit,
) -> bool {
    let mut is_kept = true;
    let mut open = vec![(ends, held)];
    while let Some(([from, to], held)) = open.pop() {
        let is_held = held != [None; 2];
        let run = &points[from..=to];
        let ends = [run[0], run[run.len() - 1]];
        if let Some(deviation) = from_chord(run, tolerance) {
            let curve = Curve::Line(Bezier { points: ends });
            found.parts.push(Part { curve, vertices: [from, to], deviation, is_smooth: false });
            is_kept &= !is_held;
            continue;
        }
        // What a tick drives along: evenly along a PH curve, as it likes along a spline.
        let kind = match kind {
            Kind::Drivable if run.iter().all(|point| point.0[2] == run[0].0[2]) => Kind::Ph,
            Kind::Drivable => Kind::Bspline,
            kind => kind,
        };
        let line = Polyline { held, ..Polyline::new(run) };
        let first = found.parts.len();
        let corner = if kind == Kind::Ph {
            ph::fit(&line, from, tolerance, &mut found.parts)
        } else if kind == Kind::PhC2 {
            c2::fit(&line, from, tolerance, &mut found.parts)
        } else {
            bspline::fit(&line, tolerance).map(|fitted| {
                found.parts.extend(fitted.spans.iter().zip(&fitted.curves).enumerate().map(|(k, (span, curve))| {
                    let vertex = |way: f64, is_end: bool| from + line.segment(way) + usize::from(is_end);
                    let [start, end] = span.ends;
                    let vertices = [vertex(start, false), vertex(end, end >= line.length())];
                    let (curve, deviation) = (Curve::Cubic(*curve), span.deviation);
                    Part { curve, vertices, deviation, is_smooth: k > 0 }
                }));
                found.splines.push((first..found.parts.len(), fitted.spline));
            })
        };
        let is_too_many = found.parts.len() - first > to - from;
        if corner.is_err() || is_too_many {
            found.parts.truncate(first);
            found.splines.pop_if(|(spans, _)| spans.start >= first);
        }
        if is_held && (corner.is_err() || is_too_many) {
            is_kept = false;
            open.push(([from, to], [None; 2]));
        } else if let Err(corner) = corner {
            open.extend([[from + corner, to], [from, from + corner]].map(|ends| (ends, [None; 2])));
        } else if is_too_many {
            found.parts.extend((from..to).map(|k| {
                let curve = Curve::Line(Bezier { points: [points[k], points[k + 1]] });
                Part { curve, vertices: [k, k + 1], deviation: 0.0, is_smooth: false }
            }));
        }
    }
    is_kept
}

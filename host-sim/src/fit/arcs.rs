//! Lines and circular arcs (G2, G3), for comparison.
//!
//! What is laid goes on in the direction of what is in front of it wherever no corner is there. From each vertex two are tried, as far
//! along the polyline as they keep the tolerance: one arc that ends at a vertex, which is given by its start's direction, or by least squares
//! where the start has none, or a line there; and a pair of arcs that also has the direction of the polyline at its
//! end [Bolton 1975].

use std::f64::consts::PI;

use super::arc::{Flat, RisingArc, STRAIGHT, cross, dot, flat};
use super::conditions::{Polynomial, across};
use super::curve::Bezier;
use super::joins::break_between;
use super::piecewise::{Run, by_runs, longest};
use super::polyline::Polyline;
use super::{Curve, Part};
use crate::vector::Vector;

/// The part of a way that a last stride may be.
const FINE: usize = 32;

/// One arc must go this many times as far as each of a pair: its direction at the end comes from that at its start, and what is wrong with one
/// is as wrong with the other, the other way round; a pair ends in the direction of the polyline.
const FOLLOWS: f64 = 1.5;

/// Directions that differ by less go on smoothly, in radians.
const SMOOTH: f64 = 1e-7;

/// Fits a polyline of at least two points, none repeated.
pub(super) fn fit(points: &[Vector], tolerance: f64) -> Vec<Part> {
    let mut parts = by_runs(points, tolerance, &mut lay);
    let mut end = None;
    for part in &mut parts {
        let (start, next) = (part.curve.at(0.0), part.curve.at(1.0));
        part.is_smooth = end.is_some_and(|end| break_between(&end, &start).tangent < SMOOTH);
        end = Some(next);
    }
    parts
}

/// One or two curves up to a vertex, with the ways of the polyline along them.
struct Laid {
    curves: Vec<(Curve, [f64; 2], f64)>,
    to: usize,
    /// The direction at the end, in x and y; none behind a way straight up or down.
    direction: Option<Flat>,
}

impl Laid {
    fn value(&self, from: usize) -> f64 {
        (self.to - from) as f64 / self.curves.len() as f64
    }
}

/// Fits what is curved.
fn lay(run: &Run<'_>, parts: &mut Vec<Part>) {
    let mut tries = Tries { run, scratch: Vec::new() };
    let last = run.line.points.len() - 1;
    let (mut from, mut guess) = (0, 8);
    let mut direction = run.given[0].and_then(unit);
    while from < last {
        let one = longest(&mut |to| tries.one(from, to, direction), from, last, guess, FINE);
        let line = match direction {
            None => longest(&mut |to| tries.line(from, to), from, last, guess, FINE),
            Some(_) => None,
        };
        let is_longer = |line: &Laid| one.as_ref().is_none_or(|one| line.to > one.to);
        let one = if line.as_ref().is_some_and(is_longer) { line } else { one };
        let two = longest(&mut |to| tries.two(from, to, direction), from, last, guess, FINE);
        let is_pair_better = |one: &Laid| two.as_ref().is_some_and(|two| FOLLOWS * two.value(from) > one.value(from));
        let best = if one.as_ref().is_none_or(is_pair_better) { two } else { one };
        // Where nothing goes on smoothly, something begins anew.
        let Some(found) = best else {
            if direction.take().is_none() {
                let (vertices, curve) = ([run.first + from, run.first + from + 1], run.segment(from));
                parts.push(Part { curve, vertices, deviation: 0.0, is_smooth: false });
                from += 1;
            }
            continue;
        };
        for (curve, ways, deviation) in found.curves {
            let vertices = ways.map(|way| run.line.segment(way));
            let end = vertices[1] + usize::from(ways[1] > run.line.ways[vertices[1]]);
            let vertices = [run.first + vertices[0], run.first + end];
            parts.push(Part { curve, vertices, deviation, is_smooth: false });
        }
        guess = found.to - from;
        (from, direction) = (found.to, found.direction);
    }
}

/// The direction of a vector in x and y.
fn unit(v: Vector) -> Option<Flat> {
    let [x, y] = flat(v);
    let length = x.hypot(y);
    (length > 1e-6 * v.norm()).then(|| [x / length, y / length])
}

struct Tries<'a> {
    run: &'a Run<'a>,
    scratch: Vec<f64>,
}

impl Tries<'_> {
    fn line_of(&self) -> &Polyline<'_> {
        &self.run.line
    }

    /// How far a curve is from the polyline between two ways, where that is within the tolerance.
    fn deviation(&mut self, curve: &Curve, ways: [f64; 2]) -> Option<f64> {
        let (line, tolerance) = (&self.run.line, self.run.tolerance);
        let scratch = &mut self.scratch;
        let found = match curve {
            Curve::Line(line_curve) => across(line, &Polynomial::new(line_curve), ways, tolerance, scratch),
            Curve::Arc(arc) => across(line, arc, ways, tolerance, scratch),
            // Nothing else is laid here.
            Curve::Cubic(_) | Curve::Ph(_) => return None,
        };
        (found <= tolerance).then_some(found)
    }

    fn ways(&self, from: usize, to: usize) -> [f64; 2] {
        [from, to].map(|k| self.line_of().ways[k])
    }

    /// Whether a curve may end at a vertex in a direction: where something straight follows, it goes on along that.
    fn may_end(&self, to: usize, direction: Flat) -> bool {
        let is_last = to + 1 == self.line_of().points.len();
        let wanted = self.run.given[1].filter(|_| is_last).and_then(unit);
        wanted.is_none_or(|wanted| cross(wanted, direction).abs() < SMOOTH && dot(wanted, direction) > 0.0)
    }

    fn line(&mut self, from: usize, to: usize) -> Option<Laid> {
        let ends = [from, to].map(|k| self.line_of().points[k]);
        let curve = Curve::Line(Bezier { points: ends });
        let ways = self.ways(from, to);
        let deviation = self.deviation(&curve, ways)?;
        Some(Laid { curves: vec![(curve, ways, deviation)], to, direction: unit(ends[1] - ends[0]) })
    }

    fn one(&mut self, from: usize, to: usize, direction: Option<Flat>) -> Option<Laid> {
        let points = &self.line_of().points[from..=to];
        let (curve, end) = match direction {
            Some(direction) => bow(points[0], direction, points[to - from])?,
            None => match RisingArc::through(points) {
                Some(arc) => (Curve::Arc(arc), arc.end_direction()),
                None => {
                    let ends = [points[0], points[to - from]];
                    (Curve::Line(Bezier { points: ends }), unit(ends[1] - ends[0])?)
                }
            },
        };
        if matches!(curve, Curve::Arc(arc) if arc.radius() < self.run.tolerance) {
            return None;
        }
        if !self.may_end(to, end) {
            return None;
        }
        let ways = self.ways(from, to);
        let deviation = self.deviation(&curve, ways)?;
        Some(Laid { curves: vec![(curve, ways, deviation)], to, direction: Some(end) })
    }

    /// The pair whose arcs begin and end as far from where their tangents meet.
    fn two(&mut self, from: usize, to: usize, direction: Option<Flat>) -> Option<Laid> {
        if to - from < 2 {
            return None;
        }
        let run = self.run;
        let [start, end] = [from, to].map(|k| run.line.points[k]);
        let first = direction.or_else(|| run.tangent(from).and_then(unit))?;
        let last = run.tangent(to).and_then(unit)?;
        let chord = flat(end - start);
        let sum = dot(chord, [first[0] + last[0], first[1] + last[1]]);
        let apart = 1.0 - dot(first, last);
        let square = dot(chord, chord);
        // |chord - d (first + last)| = 2 d.
        let handle = if apart > 1e-9 {
            ((sum * sum + 2.0 * apart * square).sqrt() - sum) / (2.0 * apart)
        } else {
            0.5 * square / sum
        };
        if !(handle > 0.0 && handle.is_finite()) {
            return None;
        }
        let middle = |axis: usize| 0.5 * (start.0[axis] + end.0[axis] + handle * (first[axis] - last[axis]));
        let joint = [middle(0), middle(1)];
        // z goes on evenly with the way.
        let flat_joint = Vector([joint[0], joint[1], start.0[2]]);
        let (before, turn) = bow(start, first, flat_joint)?;
        let (after, _) = bow(Vector([joint[0], joint[1], end.0[2]]), turn, end)?;
        let [a, b] = [length(&before), length(&after)];
        let part = a / (a + b);
        let joint = Vector([joint[0], joint[1], start.0[2] + (end.0[2] - start.0[2]) * part]);
        let (before, turn) = bow(start, first, joint)?;
        let (after, out) = bow(joint, turn, end)?;
        let [from_way, to_way] = self.ways(from, to);
        let between = self.nearest(joint, [from, to], from_way + (to_way - from_way) * part);
        let ways = [[from_way, between], [between, to_way]];
        let deviations = [self.deviation(&before, ways[0])?, self.deviation(&after, ways[1])?];
        let curves = vec![(before, ways[0], deviations[0]), (after, ways[1], deviations[1])];
        Some(Laid { curves, to, direction: Some(out) })
    }

    /// The way of the polyline's point that is nearest to a point, of the segments around a guess.
    fn nearest(&self, point: Vector, [from, to]: [usize; 2], guess: f64) -> f64 {
        const AROUND: usize = 4;
        let line = self.line_of();
        let k = line.segment(guess);
        let near = k.saturating_sub(AROUND).max(from)..(k + AROUND + 1).min(to);
        let on = |k: usize| {
            let (start, along) = (line.points[k], line.points[k + 1] - line.points[k]);
            let part = ((point - start).dot(along) / along.dot(along)).clamp(0.0, 1.0);
            ((start + along * part - point).norm(), line.ways[k] + part * (line.ways[k + 1] - line.ways[k]))
        };
        near.map(on).min_by(|a, b| a.0.total_cmp(&b.0)).map_or(guess, |(_, way)| way)
    }
}

/// The length in x and y.
fn length(curve: &Curve) -> f64 {
    match curve {
        Curve::Arc(arc) => arc.radius() * arc.sweep.abs(),
        curve => {
            let [x, y] = flat(curve.at(1.0).point - curve.at(0.0).point);
            x.hypot(y)
        }
    }
}

/// The arc from a point in a direction to another one, or the line where that is straight; and the direction at its end.
fn bow(start: Vector, direction: Flat, end: Vector) -> Option<(Curve, Flat)> {
    if let Some(arc) = RisingArc::along(start, direction, end) {
        // Arcs beyond half a circle are for those who know that they follow one.
        return (arc.sweep.abs() < PI).then(|| (Curve::Arc(arc), arc.end_direction()));
    }
    let chord = flat(end - start);
    let is_straight = cross(direction, chord).abs() < STRAIGHT * dot(direction, chord);
    is_straight.then_some((Curve::Line(Bezier { points: [start, end] }), direction))
}

//! The two conditions on a curve that stands for a polyline [Bolsunovsky & Vermel, (SA 1) and (SA 2)]: no point of the polyline is farther
//! from the curve than the tolerance, and no point of the curve is farther from the polyline.
//!
//! Each vertex has a foot point on the curve, in order. The vertex is as far from it as the distance says. Between two feet the curve stays
//! near the polyline's segment, by one of two bounds; and since the curve goes all the way from foot to foot, no point of the segment is
//! farther from it than that. So one walk bounds both directions.
//!
//! The two bounds: a piece leaves its own chord by at most (dt)^2/8 of its largest second derivative, and the chord is no farther from the
//! segment than the farther of its ends; that costs nothing, and does where vertices are many. Otherwise the piece is within the hull of its
//! control points, and is halved until that is near enough.

use super::curve::{Bezier, Local, Powers};
use super::polyline::Polyline;
use crate::vector::{Chord, Vector};

/// A curve that can be walked along, over 0..=1.
pub(super) trait Course {
    /// Where it is.
    fn at(&self, t: f64) -> Local;

    /// What its second derivative is nowhere longer than.
    fn bend(&self) -> f64;

    /// How far it is from a segment at the most between two parameters; where that is not within the tolerance, something above it.
    fn hull(&self, from: f64, to: f64, chord: &Chord, tolerance: f64) -> f64;
}

/// A polynomial curve, ready to be walked along.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polynomial<'a, const N: usize> {
    curve: &'a Bezier<N>,
    powers: Powers<N>,
}

impl<'a, const N: usize> Polynomial<'a, N> {
    pub(super) fn new(curve: &'a Bezier<N>) -> Self {
        Self { curve, powers: curve.powers() }
    }
}

impl<const N: usize> Course for Polynomial<'_, N> {
    fn at(&self, t: f64) -> Local {
        self.powers.at(t)
    }

    fn bend(&self) -> f64 {
        self.curve.bend()
    }

    fn hull(&self, from: f64, to: f64, chord: &Chord, tolerance: f64) -> f64 {
        hull(&self.curve.part(from, to), chord, tolerance, HALVINGS)
    }
}

/// What a walk along curve and polyline found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Walk {
    /// An upper bound of both deviations in mm where it is within the tolerance; otherwise about how far something is.
    pub deviation: f64,
    /// The part of it that is at vertices.
    pub vertices: f64,
}

/// Newton's steps to a foot point.
const STEPS: usize = 3;

/// A step along the curve that ends them, as a part of the tolerance: the distance is then right to 2e-5 of it, and too large.
const STILL: f64 = 0.005;

/// A curve leaves its chord by no more than this part of its largest second derivative.
pub(super) const SAG: f64 = 0.125;

/// How often a piece of a curve is halved where its hull is too far from its segment.
const HALVINGS: u32 = 4;

/// Walks along a curve and the polyline from one of `ends` over `inner` to the other, whose ends stand for its ends. `feet` are guesses of the
/// foot points of `inner` from 0 to 1, which are improved. None as soon as something is farther off than `most`.
pub(super) fn walk(
    curve: &impl Course,
    ends: [Vector; 2],
    inner: &[Vector],
    feet: &mut [f64],
    tolerance: f64,
    most: f64,
) -> Option<Walk> {
    let still = STILL * tolerance;
    let sag = SAG * curve.bend();
    let [start, end] = [(0.0, ends[0]), (1.0, ends[1])].map(|(t, end)| (curve.at(t).point - end).norm());
    let mut found = Walk { deviation: start.max(end), vertices: start.max(end) };
    let (mut before, mut behind, mut distance) = (ends[0], 0.0, start);
    let last = (ends[1], 1.0, end);
    for vertex in inner.iter().zip(feet).map(Some).chain([None]) {
        let (point, t, off) = match vertex {
            Some((&point, guess)) => {
                let (mut t, mut off) = foot(curve, point, *guess, still);
                if t < behind {
                    (t, off) = (behind, (curve.at(behind).point - point).norm());
                }
                *guess = t;
                (point, t, off)
            }
            None => last,
        };
        found.vertices = found.vertices.max(off);
        let step = t - behind;
        let near = off.max(distance) + sag * step * step;
        let bound = if near <= tolerance || found.deviation > tolerance {
            // Where something is too far already, feet are all that is wanted.
            near.min(tolerance)
        } else {
            let chord = Chord::new(before, point);
            let middle = chord.square_from(curve.at(0.5 * (behind + t)).point);
            if middle > tolerance * tolerance { middle.sqrt() } else { curve.hull(behind, t, &chord, tolerance) }
        };
        found.deviation = found.deviation.max(bound).max(off);
        if found.deviation > most {
            return None;
        }
        (before, behind, distance) = (point, t, off);
    }
    Some(found)
}

/// How far a curve and the polyline between two ways are apart; infinite where it is more than the tolerance.
pub(super) fn across(
    line: &Polyline<'_>,
    curve: &impl Course,
    ways: [f64; 2],
    tolerance: f64,
    feet: &mut Vec<f64>,
) -> f64 {
    // The ends of the curve stand for the points of the polyline that are nearest to them, on their segments.
    let ends = [(ways[0], curve.at(0.0).point), (ways[1], curve.at(1.0).point)].map(|(way, end)| {
        let k = line.segment(way);
        let along = line.points[k + 1] - line.points[k];
        let part = ((end - line.points[k]).dot(along) / along.dot(along)).clamp(0.0, 1.0);
        (line.ways[k] + part * (line.ways[k + 1] - line.ways[k]), line.points[k].toward(line.points[k + 1], part))
    });
    let vertices = line.between(ends[0].0, ends[1].0);
    let inverse = 1.0 / (ends[1].0 - ends[0].0);
    feet.clear();
    feet.extend(line.ways[vertices.clone()].iter().map(|way| (way - ends[0].0) * inverse));
    let ends = ends.map(|(_, point)| point);
    walk(curve, ends, &line.points[vertices], feet, tolerance, tolerance).map_or(f64::INFINITY, |walk| walk.deviation)
}

/// The parameter nearest to a point, from a guess, and how far it is.
fn foot(curve: &impl Course, point: Vector, guess: f64, still: f64) -> (f64, f64) {
    let mut t = guess;
    let mut off = Vector::default();
    for step in 0..=STEPS {
        let Local { point: at, first, second } = curve.at(t);
        off = at - point;
        let square = first.dot(first);
        let (slope, bend) = (off.dot(first), square + off.dot(second));
        if bend <= 0.0 || step == STEPS {
            break;
        }
        let next = (t - slope / bend).clamp(0.0, 1.0);
        let move_square = (next - t) * (next - t) * square;
        if move_square < still * still {
            break;
        }
        t = next;
    }
    (t, off.norm())
}

/// How far a piece is from a segment at the most; where that is not within the tolerance, something above it.
fn hull<const N: usize>(piece: &Bezier<N>, chord: &Chord, tolerance: f64, halvings: u32) -> f64 {
    let mut bound = piece.distance_to(chord);
    if bound <= tolerance {
        return bound;
    }
    let ends = chord.square_from(piece.points[0]).max(chord.square_from(piece.points[N - 1])).sqrt();
    bound = bound.min(ends + SAG * piece.bend());
    if bound <= tolerance || halvings == 0 {
        return bound;
    }
    let halves = piece.split(0.5);
    // The middle is a point of the curve: too far, whatever the halves are.
    let middle = chord.square_from(halves[1].points[0]);
    if middle > tolerance * tolerance {
        return middle.sqrt();
    }
    let first = hull(&halves[0], chord, tolerance, halvings - 1);
    if first > tolerance { first } else { first.max(hull(&halves[1], chord, tolerance, halvings - 1)) }
}

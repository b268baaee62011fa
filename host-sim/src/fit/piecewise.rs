//! Cubics with a common tangent where they meet, as published [Bolsunovsky & Vermel].
//!
//! The ends of each cubic are vertices of the polyline, its end tangents those of the polyline there, and the lengths of its handles come from
//! least squares. Each takes as many vertices as both conditions allow. What is straight (SA 3) stays a line.

use super::conditions::{Polynomial, Walk, walk};
use super::corners::{Vertex, vertices};
use super::curve::{Bezier, Cubic};
use super::polyline::Polyline;
use super::tangent::tangent;
use super::{Curve, Part};
use crate::vector::Vector;

/// How often handles and foot points are improved in turn.
const ROUNDS: usize = 5;

/// How many times the tolerance a first attempt may be off and still be improved.
const HOPE: f64 = 6.0;

/// The part of a way that a last stride may be.
const FINE: usize = 32;

/// A handle is at least this part of a third of the chord.
const SHORTEST: f64 = 0.05;

/// A handle is at most this part of the chord: with longer ones a cubic may come to a cusp. Of half a circle they are two thirds.
const LONGEST: f64 = 1.3;

/// The part of the tolerance that the parabola of a tangent may be off.
const TANGENT: f64 = 0.25;

/// Fits a polyline of at least two points, none repeated.
pub(super) fn fit(points: &[Vector], tolerance: f64) -> Vec<Part> {
    by_runs(points, tolerance, &mut |run, parts| run.fit(parts))
}

/// Fits what is curved by `fit`; what is straight (SA 3) stays a line.
pub(super) fn by_runs(points: &[Vector], tolerance: f64, fit: &mut impl FnMut(&Run<'_>, &mut Vec<Part>)) -> Vec<Part> {
    let kinds = vertices(points, tolerance);
    let mut parts = Vec::new();
    let mut from = 0;
    while from + 1 < points.len() {
        if is_straight(&kinds, from) {
            let vertices = [from, from + 1];
            // Behind a curve that ends along it.
            let behind_curve = parts.last().is_some_and(|part: &Part| !matches!(part.curve, Curve::Line(_)));
            let is_smooth = behind_curve && kinds[from] == Vertex::Tangent { before: false };
            parts.push(Part { curve: line(points, from, from + 1), vertices, deviation: 0.0, is_smooth });
            from += 1;
            continue;
        }
        // Up to where something straight begins, or a corner is.
        let ends = |k: &usize| kinds[*k] != Vertex::Smooth || is_straight(&kinds, *k);
        let to = (from + 1..points.len()).find(ends).unwrap_or(points.len() - 1);
        fit(&Run::new(points, &kinds, [from, to], tolerance), &mut parts);
        from = to;
    }
    parts
}

/// Whether the segment behind vertex `k` is straight.
fn is_straight(kinds: &[Vertex], k: usize) -> bool {
    let begins = matches!(kinds[k], Vertex::Tangent { before: false });
    let ends = matches!(kinds.get(k + 1), Some(Vertex::Tangent { before: true }));
    let between_corners = kinds[k] == Vertex::Corner && kinds.get(k + 1) == Some(&Vertex::Corner);
    begins || ends || between_corners
}

fn line(points: &[Vector], from: usize, to: usize) -> Curve {
    Curve::Line(Bezier { points: [points[from], points[to]] })
}

/// Vertices that lie on a curve.
pub(super) struct Run<'a> {
    pub line: Polyline<'a>,
    /// The number of the first of them.
    pub first: usize,
    /// The directions that a straight neighbour gives to the ends.
    pub given: [Option<Vector>; 2],
    pub tolerance: f64,
}

impl<'a> Run<'a> {
    fn new(all: &'a [Vector], kinds: &[Vertex], [from, to]: [usize; 2], tolerance: f64) -> Self {
        let smooth = |k: usize| kinds[k] != Vertex::Corner;
        let before = from.checked_sub(1).filter(|&k| smooth(from) && is_straight(kinds, k));
        let start = before.and_then(|k| (all[from] - all[k]).unit());
        let behind = (to + 1 < all.len() && smooth(to) && is_straight(kinds, to)).then_some(to + 1);
        let end = behind.and_then(|k| (all[k] - all[to]).unit());
        Self { line: Polyline::new(&all[from..=to]), first: from, given: [start, end], tolerance }
    }

    /// The polyline's segment behind one of them.
    pub(super) fn segment(&self, k: usize) -> Curve {
        line(self.line.points, k, k + 1)
    }

    /// The direction at one of them.
    pub(super) fn tangent(&self, k: usize) -> Option<Vector> {
        let last = self.line.points.len() - 1;
        let given = if k == 0 {
            self.given[0]
        } else if k == last {
            self.given[1]
        } else {
            None
        };
        given.or_else(|| tangent(&self.line, k, TANGENT * self.tolerance))
    }

    fn fit(&self, parts: &mut Vec<Part>) {
        let last = self.line.points.len() - 1;
        let mut feet = Vec::new();
        let (mut from, mut guess) = (0, 4);
        let mut start = self.tangent(0);
        let mut is_smooth = self.given[0].is_some();
        while from < last {
            let mut attempt = |to: usize| {
                let end = self.tangent(to)?;
                let (cubic, walk) = cubic(&self.line, [from, to], [start?, end], self.tolerance, &mut feet)?;
                Some((cubic, walk, to, end))
            };
            let found = longest(&mut attempt, from, last, guess, FINE);
            let to = match found {
                Some((cubic, walk, to, end)) => {
                    let vertices = [self.first + from, self.first + to];
                    parts.push(Part { curve: Curve::Cubic(cubic), vertices, deviation: walk.deviation, is_smooth });
                    (start, is_smooth) = (Some(end), true);
                    to
                }
                None => {
                    let vertices = [self.first + from, self.first + from + 1];
                    let curve = self.segment(from);
                    parts.push(Part { curve, vertices, deviation: 0.0, is_smooth: false });
                    (start, is_smooth) = (self.tangent(from + 1), false);
                    from + 1
                }
            };
            guess = (to - from).max(1);
            from = to;
        }
    }
}

/// The longest success from `from` on that doubling and halving the stride find. A last stride that is the `fine`th part of the way says
/// nothing more.
pub(super) fn longest<T>(
    attempt: &mut impl FnMut(usize) -> Option<T>,
    from: usize,
    last: usize,
    guess: usize,
    fine: usize,
) -> Option<T> {
    let mut best: Option<(usize, T)> = None;
    let mut stride = guess.min(last - from);
    // Down to a success, or up to a failure.
    let mut failed = None;
    loop {
        let to = (best.as_ref().map_or(from, |&(to, _)| to) + stride).min(last);
        match attempt(to) {
            Some(found) => {
                best = Some((to, found));
                if to == last || failed.is_some() {
                    break;
                }
                stride = to - from;
            }
            None => {
                failed = Some(to);
                if best.is_some() || stride == 1 {
                    break;
                }
                stride = stride.div_ceil(2);
            }
        }
    }
    let (mut reached, mut found) = best?;
    let mut beyond = failed.unwrap_or(reached + 1);
    while beyond - reached > 1 + (reached - from) / fine {
        let middle = reached + (beyond - reached) / 2;
        match attempt(middle) {
            Some(better) => (reached, found) = (middle, better),
            None => beyond = middle,
        }
    }
    Some(found)
}

/// The cubic along a part of a run with these unit tangents at its ends. None where it breaks a condition.
fn cubic(
    line: &Polyline<'_>,
    [from, to]: [usize; 2],
    tangents: [Vector; 2],
    tolerance: f64,
    feet: &mut Vec<f64>,
) -> Option<(Cubic, Walk)> {
    let ends = [line.points[from], line.points[to]];
    let inner = &line.points[from + 1..to];
    let inverse = 1.0 / (line.ways[to] - line.ways[from]);
    feet.clear();
    feet.extend(line.ways[from + 1..to].iter().map(|way| (way - line.ways[from]) * inverse));
    let mut before = f64::INFINITY;
    for round in 0..ROUNDS {
        let curve = handles(ends, inner, tangents, feet)?;
        let walk = walk(&Polynomial::new(&curve), ends, inner, feet, tolerance, HOPE * tolerance)?;
        if walk.deviation <= tolerance {
            return Some((curve, walk));
        }
        // What is left shrinks by about the same factor every time.
        let left = (ROUNDS - 1 - round) as i32;
        if walk.deviation * (walk.deviation / before).min(0.9).powi(left) > tolerance {
            return None;
        }
        before = walk.deviation;
    }
    None
}

/// Least squares of the two handles.
fn handles([first, last]: [Vector; 2], inner: &[Vector], [start, end]: [Vector; 2], feet: &[f64]) -> Option<Cubic> {
    let chord = (last - first).norm();
    let along = start.dot(end);
    let (mut aa, mut ab, mut bb, mut ra, mut rb) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (point, &t) in inner.iter().zip(feet) {
        let s = 1.0 - t;
        let (b1, b2) = (3.0 * s * s * t, 3.0 * s * t * t);
        let off = *point - first.toward(last, t * t * (3.0 - 2.0 * t));
        aa += b1 * b1;
        ab -= b1 * b2 * along;
        bb += b2 * b2;
        ra += b1 * off.dot(start);
        rb -= b2 * off.dot(end);
    }
    let least = SHORTEST * chord / 3.0;
    let determinant = aa * bb - ab * ab;
    let [alpha, beta] = if determinant > 1e-12 * aa * bb {
        [(ra * bb - rb * ab) / determinant, (rb * aa - ra * ab) / determinant]
    } else {
        [chord / 3.0; 2]
    };
    let most = LONGEST * chord;
    [alpha, beta]
        .iter()
        .all(|handle| (least..=most).contains(handle))
        .then(|| Bezier { points: [first, first + start * alpha, last - end * beta, last] })
}

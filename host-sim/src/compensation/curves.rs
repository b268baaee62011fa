//! From the motions of a program to segments that have an exact offset.

use std::f64::consts::PI;

use shared::complex::Complex;
use shared::curve::{Arc, Curve as _, Line, Segment};

use super::error::Fault;
use crate::fit::curve::{Bezier, Cubic};
use crate::fit::{Curve, Kind, fit};
use crate::program::bspline::Clamped;
use crate::program::item::Nurbs;
use crate::program::quintic::rational;
use crate::program::{self, Plane};
use crate::vector::Vector;

/// Points that are nearer to each other than this are one, in mm: programs have four decimals, and this tells rounding from a motion.
pub(super) const SAME: f64 = 1e-6;

/// A segment, and the heights at its ends.
pub(super) type Rising = (Segment<f64>, [f64; 2]);

/// x and y of a point.
pub(super) fn flat([x, y, _]: [f64; 3]) -> Complex<f64> {
    Complex::new(x, y)
}

/// A line; none where it does not move in x and y.
pub(super) fn line(from: [f64; 3], to: [f64; 3]) -> Option<Rising> {
    let [start, end] = [flat(from), flat(to)];
    ((end - start).norm() > SAME).then_some((Segment::Line(Line { start, end }), [from[2], to[2]]))
}

/// The arc over a chord whose tangent turns by `sweep`, below a turn; it meets both ends whatever the centre was rounded to.
pub(super) fn arc_over(start: Complex<f64>, end: Complex<f64>, sweep: f64) -> Arc<f64> {
    // end - start = radius (e^(i sweep) - 1).
    let turn = Complex::new(-2.0 * (0.5 * sweep).sin().powi(2), sweep.sin());
    Arc { start, radius: (end - start) * turn.conj() * (1.0 / turn.norm_sqr()), sweep }
}

/// An arc of a program in parts of at most half a turn. Errors: it is in another plane.
pub(super) fn arc(from: [f64; 3], arc: &program::Arc) -> Result<Vec<Rising>, Fault> {
    /// Half a turn but for rounding stays one part.
    const ROUNDING: f64 = 1e-9;
    if arc.plane != Plane::Xy {
        return Err(Fault::Plane);
    }
    let [x, y] = arc.centre;
    let centre = Complex::new(x, y);
    let [first, last] = [from, arc.to].map(|end| flat(end) - centre);
    let radii = [first.norm(), last.norm()];
    let count = (arc.sweep.abs() / PI - ROUNDING).ceil().max(1.0) as usize;
    let part = |k: usize| k as f64 / count as f64;
    let point = |k: usize| match k {
        0 => flat(from),
        k if k == count => flat(arc.to),
        k => {
            let (sine, cosine) = (arc.sweep * part(k)).sin_cos();
            let radius = 1.0 + (radii[1] / radii[0] - 1.0) * part(k);
            centre + first * Complex::new(cosine, sine) * radius
        }
    };
    let z = |k: usize| from[2] + (arc.to[2] - from[2]) * part(k);
    let ends = (0..count).map(|k| ([point(k), point(k + 1)], [z(k), z(k + 1)]));
    let arcs = ends.filter(|([start, end], _)| (*end - *start).norm() > SAME);
    Ok(arcs.map(|([a, b], z)| (Segment::Arc(arc_over(a, b, arc.sweep / count as f64)), z)).collect())
}

/// A Bezier curve as PH quintics within a tolerance in mm. Errors: none follow, or its height changes unevenly.
pub(super) fn bezier(from: [f64; 3], points: &[[f64; 3]], tolerance: f64) -> Result<Vec<Rising>, Fault> {
    let piece: Vec<[f64; 4]> = std::iter::once(&from).chain(points).map(|&[x, y, z]| [x, y, z, 1.0]).collect();
    quintics(&[piece], tolerance)
}

/// A rational B-spline as PH quintics within a tolerance in mm. Errors: as [`bezier`].
pub(super) fn nurbs(curve: &Nurbs<'_>, tolerance: f64) -> Result<Vec<Rising>, Fault> {
    let clamped = Clamped::new(curve).map_err(|_| Fault::NoFit(tolerance))?;
    quintics(&Vec::from_iter(clamped.pieces()), tolerance)
}

/// A chain of lines at one height as lines and PH quintics; with each, the number of the first line in its place. Errors: a run of them
/// stays a cubic.
pub(super) fn polyline(points: &[[f64; 3]], tolerance: f64) -> Result<Vec<(usize, Segment<f64>)>, Fault> {
    let points: Vec<Vector> = points.iter().map(|&[x, y, _]| Vector([x, y, 0.0])).collect();
    let mut at = points.first().map_or(Complex::ZERO, |p| flat(p.0));
    let mut segments = Vec::new();
    for part in fit(&points, Kind::Ph, tolerance).parts {
        let segment = match part.curve {
            Curve::Line(Bezier { points: [_, end] }) => Segment::Line(Line { start: at, end: flat(end.0) }),
            Curve::Ph(curve) => {
                let mut plane = curve.plane;
                plane.start = at;
                Segment::Ph(plane)
            }
            Curve::Cubic(Cubic { .. }) | Curve::Arc(_) => return Err(Fault::NoFit(tolerance)),
        };
        at = segment.point(1.0);
        segments.push((part.vertices[0], segment));
    }
    Ok(segments)
}

/// The part of the tolerance that the chords between the points of a curve take.
const CHORDS: f64 = 0.1;

fn quintics(pieces: &[Vec<[f64; 4]>], tolerance: f64) -> Result<Vec<Rising>, Fault> {
    let mut points: Vec<[f64; 3]> = Vec::new();
    for piece in pieces {
        let count = count(piece, CHORDS * tolerance);
        points.extend((0..=count).map(|k| rational(piece, k as f64 / count as f64)[0].0));
    }
    points.dedup_by(|b, a| (flat(*b) - flat(*a)).norm() <= SAME);
    let (Some(first), Some(last)) = (points.first().copied(), points.last().copied()) else { return Ok(Vec::new()) };
    let mut ways = vec![0.0];
    for pair in points.windows(2) {
        ways.push(ways[ways.len() - 1] + (flat(pair[1]) - flat(pair[0])).norm());
    }
    let length = ways[ways.len() - 1];
    let height = |way: f64| first[2] + (last[2] - first[2]) * way / length;
    if points.iter().zip(&ways).any(|(point, &way)| (point[2] - height(way)).abs() > tolerance.max(SAME)) {
        return Err(Fault::Height);
    }
    let mut segments = polyline(&points, (1.0 - CHORDS) * tolerance)?;
    if segments.len() == 1
        && let Some((number, segment)) = segments.pop()
    {
        // A closed curve is cut in two, so that each half has two ends.
        segments.extend(split(&segment, 0.5).map(|half| (number, half)));
    }
    let whole: f64 = segments.iter().map(|(_, segment)| segment.length()).sum();
    let mut way = 0.0;
    let rising = segments.into_iter().map(|(_, segment)| {
        let from = way;
        way += segment.length() * length / whole;
        (segment, [height(from), height(way)])
    });
    Ok(rising.collect())
}

/// How many chords a rational Bezier curve needs to be followed within a tolerance.
fn count(piece: &[[f64; 4]], tolerance: f64) -> usize {
    /// More chords than this are never made.
    const MOST: usize = 1 << 14;
    let mut count = 8;
    loop {
        let step = 1.0 / count as f64;
        let is_near = (0..count).all(|k| {
            let [a, middle, b] = [0.0, 0.5, 1.0].map(|part| rational(piece, step * (k as f64 + part))[0]);
            middle.from_segment(a, b) <= tolerance
        });
        if is_near || count >= MOST {
            return count;
        }
        count *= 2;
    }
}

/// The parts of a segment before and behind a parameter.
pub(super) fn split(segment: &Segment<f64>, xi: f64) -> [Segment<f64>; 2] {
    let middle = segment.point(xi);
    match *segment {
        Segment::Line(Line { start, end }) => {
            [Line { start, end: middle }, Line { start: middle, end }].map(Segment::Line)
        }
        Segment::Arc(arc) => {
            let radius = middle - arc.centre();
            let low = Arc { sweep: arc.sweep * xi, ..arc };
            [low, Arc { start: middle, radius, sweep: arc.sweep * (1.0 - xi) }].map(Segment::Arc)
        }
        Segment::Ph(curve) => {
            // r' over a part of the parameters is as much smaller: w by the root.
            let [w0, w1, w2] = curve.w;
            let [a, b] = [w0 + (w1 - w0) * xi, w1 + (w2 - w1) * xi];
            let c = a + (b - a) * xi;
            let [low, high] = [xi.sqrt(), (1.0 - xi).sqrt()];
            let mut halves = [curve; 2];
            halves[0].w = [w0, a, c].map(|w| w * low);
            halves[1].w = [c, b, w2].map(|w| w * high);
            halves[1].start = middle;
            halves.map(Segment::Ph)
        }
        Segment::Spline(_) => [*segment; 2],
    }
}

//! PH quintics with continuous curvature.
//!
//! A quintic w = w0, w1, w2 has six numbers. Point, tangent and curvature at both ends of a segment are as many conditions: two for the chord,
//! two for the directions of w0 and w2, two for the curvatures, of which the one at the start is 4 Im(conj w0 w1)/|w0|^4 and the one at the
//! end -4 Im(conj w2 w1)/|w2|^4. So neighbours that share point, tangent and curvature need nothing else of each other, and each segment
//! is found by itself. What it follows is a B-spline through the polyline; how far it is from the polyline itself is measured.

use shared::complex::Complex;
use shared::curve::PhQuintic;

use super::bspline::{self, Fitted};
use super::conditions::{Polynomial, across};
use super::curve::{Bezier, Local};
use super::joins::STRAIGHT;
use super::piecewise::longest;
use super::polyline::Polyline;
use super::{Curve, Part};
use crate::vector::Vector;

/// The part of the tolerance that the B-spline takes.
const SPLINE: f64 = 0.4;

/// The part of a way that a last stride may be: each of them is a system to solve.
const FINE: usize = 16;

/// A PH quintic in x and y that rises and falls on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RisingPh {
    /// The curve in x and y.
    pub plane: PhQuintic<f64>,
    /// The Bernstein coefficients of z in mm, over the same parameter.
    pub z: [f64; 6],
}

impl RisingPh {
    /// By its control points.
    pub fn bezier(&self) -> Bezier<6> {
        let mut points = self.plane.control_points().map(|p| Vector([p.re, p.im, 0.0]));
        points.iter_mut().zip(self.z).for_each(|(point, z)| point.0[2] = z);
        Bezier { points }
    }
}

/// What both ends of a segment share with their neighbours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Node {
    pub point: Complex<f64>,
    /// The direction, a unit.
    pub tangent: Complex<f64>,
    /// In 1/mm, positive to the left.
    pub curvature: f64,
    /// z, and its first and second derivative by the way in x and y.
    pub z: [f64; 3],
}

/// A way in x and y that is this part of the way in space is none.
const STEEP: f64 = 0.02;

impl Node {
    /// None where the way goes straight up or down. Derivatives are by the way along the polyline.
    pub(super) fn of(at: &Local) -> Option<Self> {
        let flat = |v: Vector| Complex::new(v.0[0], v.0[1]);
        let (first, second) = (flat(at.first), flat(at.second));
        let speed = first.norm();
        if speed.is_nan() || speed <= STEEP * at.first.norm() {
            return None;
        }
        let tangent = first * (1.0 / speed);
        let slope = at.first.0[2] / speed;
        let bend = (at.second.0[2] - slope * tangent.dot(second)) / (speed * speed);
        let curvature = first.cross(second) / (speed * speed * speed);
        Some(Self { point: flat(at.point), tangent, curvature, z: [at.point.0[2], slope, bend] })
    }
}

/// z over the parameter of a curve, so that it and two derivatives by the way are those of the nodes.
pub(super) fn rise(plane: &PhQuintic<f64>, from: &Node, to: &Node) -> [f64; 6] {
    let sigma = plane.speed_coefficients();
    // By the parameter: z' = z_s sigma, z'' = z_ss sigma^2 + z_s sigma'.
    let by_parameter = |[_, slope, bend]: [f64; 3], sigma: f64, change: f64| {
        [slope * sigma / 5.0, (bend * sigma * sigma + slope * change) / 20.0]
    };
    let [first, second] = by_parameter(from.z, sigma[0], 4.0 * (sigma[1] - sigma[0]));
    let [last, before] = by_parameter(to.z, sigma[4], 4.0 * (sigma[4] - sigma[3]));
    let ([start, ..], [end, ..]) = (from.z, to.z);
    [start, start + first, start + 2.0 * first + second, end - 2.0 * last + before, end - last, end]
}

/// Where a curve may end.
#[derive(Clone, Copy, Debug)]
struct Place {
    way: f64,
    /// The span that begins there or goes over it.
    span: usize,
}

/// Fits a run of at least two points. Where no PH quintic follows, and where the way goes straight up or down, the cubics of the B-spline
/// stay, which share point, tangent and curvature with it. The error is as that of [`bspline::fit`].
pub(super) fn fit(line: &Polyline<'_>, first: usize, tolerance: f64, parts: &mut Vec<Part>) -> Result<(), usize> {
    let fitted = bspline::fit(line, SPLINE * tolerance)?;
    let places = candidates(line, &fitted);
    let last = places.len() - 1;
    let node = |number: usize| {
        let Place { way, span } = places[number];
        let local = fitted.on(span, way);
        Node::of(&local).map(|node| (node, local))
    };
    let (mut from, mut guess) = (0, 8);
    let mut scratch = Vec::new();
    let before = parts.len();
    while from < last {
        let start = node(from);
        let mut attempt = |to: usize| {
            let ways = [places[from].way, places[to].way];
            let (curve, deviation) = between(line, [start.as_ref()?, &node(to)?], ways, tolerance, &mut scratch)?;
            Some((curve, deviation, to))
        };
        let (curve, deviation, to) = longest(&mut attempt, from, last, guess, FINE).unwrap_or_else(|| {
            // To the end of the span.
            let Place { way, span } = places[from];
            let (span, curve) = (&fitted.spans[span], &fitted.curves[span]);
            let to = places.partition_point(|place| place.way < span.ends[1]).clamp(from + 1, last);
            let inverse = 1.0 / (span.ends[1] - span.ends[0]);
            let [start, end] = [way, places[to].way].map(|way| ((way - span.ends[0]) * inverse).clamp(0.0, 1.0));
            (Curve::Cubic(curve.part(start, end)), span.deviation, to)
        });
        let [start, end] = [places[from].way, places[to].way];
        let vertices = [first + line.segment(start), first + line.segment(end) + usize::from(end >= line.length())];
        parts.push(Part { curve, vertices, deviation, is_smooth: from > 0 });
        if parts.len() - before >= line.points.len() {
            // More curves than lines: the lines stay, whatever else is found.
            return Ok(());
        }
        guess = to - from;
        from = to;
    }
    Ok(())
}

/// What a curve's ends may differ in from the spline that it follows: mm, radians, and parts of the curvature.
const FAITHFUL: [f64; 3] = [1e-10, 1e-8, 1e-7];

/// Whether a curve's end is where the spline is, and goes on from it.
fn is_faithful(found: &Local, wanted: &Local) -> bool {
    let across = found.first.cross(wanted.first).norm();
    let (a, b) = (found.curvature(), wanted.curvature());
    (found.point - wanted.point).norm() < FAITHFUL[0]
        && across < FAITHFUL[1] * found.first.dot(wanted.first)
        && (a - b).norm() < FAITHFUL[2] * a.norm().max(b.norm()).max(STRAIGHT)
}

/// The curve between two nodes where it follows within the tolerance and goes on from its neighbours; and its deviation.
fn between(
    line: &Polyline<'_>,
    [start, end]: [&(Node, Local); 2],
    ways: [f64; 2],
    tolerance: f64,
    scratch: &mut Vec<f64>,
) -> Option<(Curve, f64)> {
    let plane = hermite(&start.0, &end.0)?;
    let curve = RisingPh { plane, z: rise(&plane, &start.0, &end.0) };
    let bezier = curve.bezier();
    let deviation = across(line, &Polynomial::new(&bezier), ways, tolerance, scratch);
    if deviation > tolerance || deviation.is_nan() {
        return None;
    }
    let is_one = is_faithful(&bezier.at(0.0), &start.1) && is_faithful(&bezier.at(1.0), &end.1);
    is_one.then_some((Curve::Ph(curve), deviation))
}

/// Where a segment may end: at the ends of the spline's spans, and at vertices that are not next to one.
fn candidates(line: &Polyline<'_>, fitted: &Fitted) -> Vec<Place> {
    /// In mm: the curvature of a shorter curve drowns in the digits of its points.
    const NEXT: f64 = 2e-3;
    let mut places = Vec::with_capacity(line.points.len() + fitted.spans.len());
    for (number, span) in fitted.spans.iter().enumerate() {
        let [from, to] = span.ends;
        places.push(Place { way: from, span: number });
        let vertices = line.ways[line.between(from, to)].iter().copied();
        let apart = vertices.filter(|way| way - from >= NEXT && to - way >= NEXT);
        places.extend(apart.map(|way| Place { way, span: number }));
    }
    places.push(Place { way: line.length(), span: fitted.spans.len() - 1 });
    places
}

/// Newton's steps at the most.
const STEPS: usize = 30;

/// What may be left of the conditions once steps make it no smaller, in parts of the chord and of a turn.
const EXACT: f64 = 1e-11;

/// The segment between two nodes; none where none is near.
pub(super) fn hermite(from: &Node, to: &Node) -> Option<PhQuintic<f64>> {
    let chord = to.point - from.point;
    let length = chord.norm();
    // In a frame in which the chord is 1 along the real axis.
    let turned = |tangent: Complex<f64>| tangent * chord.conj() * (1.0 / length);
    let (e0, e2) = (turned(from.tangent).sqrt(), turned(to.tangent).sqrt());
    if !(length > 0.0 && (turned(from.tangent).re > 0.0) && (turned(to.tangent).re > 0.0)) {
        return None;
    }
    let curvatures = [from.curvature * length, to.curvature * length];
    // a, b and w1: as if the curve were passed evenly.
    let even = (2.0 / (turned(from.tangent).re + turned(to.tangent).re)).powf(0.25);
    let mut x = [even, even, even, 0.25 * (curvatures[0] - curvatures[1]) * 0.5];
    let mut before = f64::INFINITY;
    for _ in 0..STEPS {
        let (rows, left) = conditions(x, [e0, e2], curvatures);
        let size = left.iter().map(|left| left.abs()).fold(0.0, f64::max);
        if size > 1e3 || size.is_nan() {
            return None;
        }
        if size == 0.0 || (size < EXACT && size > 0.5 * before) {
            let back = (chord * (1.0 / length)).sqrt() * length.sqrt();
            let w = [e0 * x[0], Complex::new(x[2], x[3]), e2 * x[1]].map(|w| w * back);
            return (x[0] > 0.0 && x[1] > 0.0 && is_lively(w)).then_some(PhQuintic { start: from.point, w });
        }
        before = size;
        // The least step that would do: on a straight way the speeds along it are open.
        let step = least_step(&rows, &left)?;
        let longest = step.iter().map(|step| step.abs()).fold(0.0, f64::max);
        let damped = if longest > 0.5 { 0.5 / longest } else { 1.0 };
        x.iter_mut().zip(step).for_each(|(x, step)| *x -= damped * step);
    }
    None
}

/// Whether a curve with this preimage nowhere comes near to standing still, where no feed could be kept in the digits of a controller.
fn is_lively([w0, w1, w2]: [Complex<f64>; 3]) -> bool {
    /// The least speed, as a part of the largest.
    const PART: f64 = 0.02;
    const LOOKS: u32 = 8;
    let speeds = (0..=LOOKS).map(|k| {
        let t = f64::from(k) / f64::from(LOOKS);
        (w0 * ((1.0 - t) * (1.0 - t)) + w1 * (2.0 * t * (1.0 - t)) + w2 * (t * t)).norm_sqr()
    });
    let (least, most) = speeds.fold((f64::INFINITY, 0.0), |(least, most), speed| (speed.min(least), speed.max(most)));
    least > PART * most
}

/// The four conditions' derivatives and what is left of them.
fn conditions([a, b, re, im]: [f64; 4], [e0, e2]: [Complex<f64>; 2], [k0, k2]: [f64; 2]) -> ([[f64; 4]; 4], [f64; 4]) {
    let (w0, w1, w2) = (e0 * a, Complex::new(re, im), e2 * b);
    let square = |w: Complex<f64>| w * w;
    let chord = (square(w0) * 3.0 + w0 * w1 * 3.0 + square(w1) * 2.0 + w0 * w2 + w1 * w2 * 3.0 + square(w2) * 3.0)
        * (1.0 / 15.0);
    let by_a = e0 * (w0 * 6.0 + w1 * 3.0 + w2) * (1.0 / 15.0);
    let by_b = e2 * (w0 + w1 * 3.0 + w2 * 6.0) * (1.0 / 15.0);
    let by_w1 = (w0 * 3.0 + w1 * 4.0 + w2 * 3.0) * (1.0 / 15.0);
    let rows = [
        [by_a.re, by_b.re, by_w1.re, -by_w1.im],
        [by_a.im, by_b.im, by_w1.im, by_w1.re],
        [0.75 * k0 * a * a, 0.0, e0.im, -e0.re],
        [0.0, 0.75 * k2 * b * b, -e2.im, e2.re],
    ];
    let left = [chord.re - 1.0, chord.im, 0.25 * k0 * a * a * a - e0.cross(w1), 0.25 * k2 * b * b * b + e2.cross(w1)];
    (rows, left)
}

/// J^T (J J^T + m)^-1 r by Cholesky's factors.
fn least_step(rows: &[[f64; 4]; 4], right: &[f64; 4]) -> Option<[f64; 4]> {
    /// What keeps the matrix regular where a condition says nothing new.
    const REGULAR: f64 = 1e-13;
    let mut matrix = [[0.0; 4]; 4];
    for (i, row) in matrix.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            *entry = (0..4).map(|k| rows[i][k] * rows[j][k]).sum::<f64>() + if i == j { REGULAR } else { 0.0 };
        }
    }
    let mut y = *right;
    for k in 0..4 {
        let top = matrix[k];
        let pivot = top[k];
        if pivot.is_nan() || pivot <= 0.0 {
            return None;
        }
        for row in k + 1..4 {
            let factor = matrix[row][k] / pivot;
            matrix[row].iter_mut().zip(top).for_each(|(entry, above)| *entry -= factor * above);
            y[row] -= factor * y[k];
        }
    }
    for k in (0..4).rev() {
        let sum: f64 = (k + 1..4).map(|column| matrix[k][column] * y[column]).sum();
        y[k] = (y[k] - sum) / matrix[k][k];
    }
    let mut step = [0.0; 4];
    for (k, step) in step.iter_mut().enumerate() {
        *step = (0..4).map(|row| rows[row][k] * y[row]).sum();
    }
    Some(step)
}

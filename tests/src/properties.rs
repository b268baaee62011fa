//! What must be true of every trimmed offset, measured without what found it.

use std::collections::HashMap;
use std::fmt;

use host_sim::contour::{Along, Contour};
use host_sim::measure::clearance_with;
use host_sim::offset::{Loop, Offset, OffsetError, Piece, trim};
use shared::complex::Complex;
use shared::curve::Curve as _;

use crate::chain::size;
use crate::random::unit;
use crate::winding::Polygon;

/// The project's bar for clearances, gaps and trim points, relative to |d| or to the size.
const BAR: f64 = 1e-9;
/// The largest tool is told so exactly, relatively.
const LARGEST: f64 = 1e-7;
/// Lengths and areas against quadrature, relative.
const MEASURES: f64 = 1e-7;
/// What lengths and areas may be wrong by at least, in parts of the size and of its square: a loop that nearly vanishes is a
/// difference of numbers that large.
const ROUNDING: f64 = 1e-14;
/// Turning angles in radians: tangents at parameters that are good to 1e-9 and better.
const ANGLES: f64 = 1e-7;

/// What came of an offset that holds every property.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// So many loops.
    Loops(usize),
    /// Rightly nothing.
    Empty,
    /// A contour that touches itself was refused.
    Refused,
}

/// A property that does not hold.
#[derive(Clone, Debug)]
pub struct Failure {
    /// Which one.
    pub property: &'static str,
    /// Numbers.
    pub detail: String,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.property, self.detail)
    }
}

fn failure<T>(property: &'static str, detail: impl Into<String>) -> Result<T, Failure> {
    Err(Failure { property, detail: detail.into() })
}

/// Trims a simple contour (or, if it `touches`, one that meets itself at a node) and checks everything, with so many samples on
/// each piece. Errors: the first property that does not hold.
pub fn check(contour: &Contour, distance: f64, touches: bool, samples: usize) -> Result<Outcome, Failure> {
    match trim(contour, distance) {
        Ok(offset) => {
            check_offset(contour, distance, &offset, samples)?;
            if !touches {
                check_topology(contour, &offset)?;
            }
            Ok(Outcome::Loops(offset.loops.len()))
        }
        Err(OffsetError::Empty { largest }) => {
            check_empty(contour, distance, largest, samples).map(|()| Outcome::Empty)
        }
        Err(OffsetError::Crossing { .. }) if touches => Ok(Outcome::Refused),
        Err(error) => failure("refused", format!("{error:?}")),
    }
}

/// Everything but the topology, which only simple contours have.
pub fn check_offset(contour: &Contour, distance: f64, offset: &Offset, samples: usize) -> Result<(), Failure> {
    let size = size(contour).max(distance.abs());
    if offset.distance != distance {
        return failure("distance", format!("{} instead of {distance}", offset.distance));
    }
    if offset.loops.is_empty() {
        return failure("no loops", "an offset without loops is an error");
    }
    for (number, ring) in offset.loops.iter().enumerate() {
        if contour.closed && !ring.closed {
            return failure("open loop", format!("loop {number} of {} pieces", ring.pieces.len()));
        }
        check_pieces(contour, distance, ring, size)?;
        check_turns(contour, distance, ring)?;
        check_measures(contour, distance, ring, size)?;
    }
    check_order(offset)?;
    check_disjoint(offset)?;
    check_nesting(contour, offset)?;
    check_clearance(contour, offset, samples)
}

/// Where a piece begins and ends, by its carrier.
fn ends(contour: &Contour, distance: f64, piece: &Piece) -> Option<[Complex<f64>; 2]> {
    let (segment, [from, to], offset) = contour.carrier(piece.along, distance)?;
    Some([from, to].map(|xi| segment.offset_point(xi, offset)))
}

fn check_pieces(contour: &Contour, distance: f64, ring: &Loop, size: f64) -> Result<(), Failure> {
    let Some(last) = ring.pieces.last() else { return failure("no pieces", "a loop without pieces") };
    let mut before = ring.closed.then_some(last);
    for piece in &ring.pieces {
        let (Along::Segment { from, to, .. } | Along::Fill { from, to, .. }) = piece.along;
        if !(0.0 <= from && from < to && to <= 1.0) {
            return failure("interval", format!("{:?}", piece.along));
        }
        let Some([start, end]) = ends(contour, distance, piece) else {
            return failure("carrier", format!("{:?}", piece.along));
        };
        let off = (start - piece.start).norm().max((end - piece.end).norm());
        if off.is_nan() || off > BAR * size {
            return failure("ends", format!("{:e} of the size off: {piece:?}", off / size));
        }
        if let Some(before) = before {
            let gap = (before.end - piece.start).norm();
            if gap > BAR * size {
                return failure(
                    "gap",
                    format!("{:e} of the size between {:?} and {:?}", gap / size, before.along, piece.along),
                );
            }
        }
        before = Some(piece);
    }
    Ok(())
}

fn check_turns(contour: &Contour, distance: f64, ring: &Loop) -> Result<(), Failure> {
    let tangents = |piece: &Piece| {
        let (segment, interval, _) = contour.carrier(piece.along, distance)?;
        Some(interval.map(|xi| segment.tangent(xi)))
    };
    let count = ring.pieces.len();
    for (k, piece) in ring.pieces.iter().enumerate() {
        let at_end = k + 1 == count && !ring.closed;
        let next = &ring.pieces[(k + 1) % count];
        let (Some([_, here]), Some([there, _])) = (tangents(piece), tangents(next)) else {
            return failure("carrier", format!("{:?}", piece.along));
        };
        let turn = if at_end { 0.0 } else { (here.conj() * there).arg() };
        let next_turn = if at_end { turn } else { next.start_turn };
        for said in [piece.end_turn, next_turn] {
            // As directions, so that half turns to the left and to the right are one.
            let off = (unit(said) - unit(turn)).norm();
            if off.is_nan() || off > ANGLES {
                return failure(
                    "turn",
                    format!("{said} instead of {turn} between {:?} and {:?}", piece.along, next.along),
                );
            }
        }
    }
    let first = ring.pieces.first().map_or(0.0, |piece| piece.start_turn);
    if !ring.closed && first != 0.0 {
        return failure("turn", format!("{first} at the start of an open loop"));
    }
    Ok(())
}

fn check_measures(contour: &Contour, distance: f64, ring: &Loop, size: f64) -> Result<(), Failure> {
    let [mut length, mut area] = [0.0; 2];
    let origin = ring.pieces.first().map_or(Complex::ZERO, |piece| piece.start);
    for piece in &ring.pieces {
        let Some((segment, [from, to], offset)) = contour.carrier(piece.along, distance) else { continue };
        let pace = |xi: f64| {
            let stretch = if offset == 0.0 { 1.0 } else { 1.0 + segment.curvature(xi) * offset };
            segment.derivative(xi) * stretch
        };
        let at = |xi: f64| segment.offset_point(xi, offset) - origin;
        length += integral(&|xi| pace(xi).norm(), from, to, 1e-10 * size);
        area += integral(&|xi| 0.5 * at(xi).cross(pace(xi)), from, to, 1e-11 * size * size);
    }
    let rounding = ROUNDING * size + gaps(ring);
    if (length - ring.length).abs() > MEASURES * length + rounding {
        let off = (length - ring.length) / size;
        return failure("length", format!("{} instead of {length}, {off:.1e} of the size", ring.length));
    }
    let area = if ring.closed { area } else { 0.0 };
    if (area - ring.area).abs() > MEASURES * area.abs() + rounding * size {
        let off = (area - ring.area) / (size * size);
        return failure("area", format!("{:e} instead of {area:e}, {off:.1e} of the size squared", ring.area));
    }
    Ok(())
}

/// The sum of the gaps in a loop: its length is not defined better than this, nor its area better than this times its size.
fn gaps(ring: &Loop) -> f64 {
    let inner: f64 = ring.pieces.windows(2).map(|pair| (pair[1].start - pair[0].end).norm()).sum();
    match (ring.pieces.first(), ring.pieces.last()) {
        (Some(first), Some(last)) if ring.closed => inner + (first.start - last.end).norm(),
        _ => inner,
    }
}

/// The integral of `f` to `tolerance`, by halving until a Gauss rule of five points agrees with itself.
fn integral(f: &impl Fn(f64) -> f64, from: f64, to: f64, tolerance: f64) -> f64 {
    fn rule(f: &impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
        let gauss = <f64 as shared::real::Real>::GAUSS;
        gauss.iter().map(|&(x, weight)| weight * f(from + (to - from) * x)).sum::<f64>() * (to - from)
    }
    fn refine(f: &impl Fn(f64) -> f64, [from, to]: [f64; 2], whole: f64, tolerance: f64, depth: u32) -> f64 {
        let middle = 0.5 * (from + to);
        let [left, right] = [rule(f, from, middle), rule(f, middle, to)];
        if depth == 0 || (left + right - whole).abs() <= tolerance {
            return left + right;
        }
        refine(f, [from, middle], left, 0.5 * tolerance, depth - 1)
            + refine(f, [middle, to], right, 0.5 * tolerance, depth - 1)
    }
    refine(f, [from, to], rule(f, from, to), tolerance, 24)
}

/// Where a piece begins along C: segment, then fill arc of the node at its end.
fn place(piece: &Piece) -> (usize, bool, f64) {
    match piece.along {
        Along::Segment { segment, from, .. } => (segment, false, from),
        Along::Fill { node, from, .. } => (node, true, from),
    }
}

fn check_order(offset: &Offset) -> Result<(), Failure> {
    let mut before = None;
    for (number, ring) in offset.loops.iter().enumerate() {
        let Some(first) = ring.pieces.first().map(place) else { continue };
        if ring.closed && ring.pieces.iter().any(|piece| place(piece) < first) {
            return failure("order", format!("the first piece of loop {number} is not the first along C"));
        }
        if before.is_some_and(|before| first <= before) {
            return failure("order", format!("loop {number} stands before the loop before it"));
        }
        before = Some(first);
    }
    Ok(())
}

/// No part of the untrimmed offset is travelled twice.
fn check_disjoint(offset: &Offset) -> Result<(), Failure> {
    let mut intervals: HashMap<(usize, bool), Vec<[f64; 2]>> = HashMap::new();
    for piece in offset.loops.iter().flat_map(|ring| &ring.pieces) {
        let (key, interval) = match piece.along {
            Along::Segment { segment, from, to } => ((segment, false), [from, to]),
            Along::Fill { node, from, to } => ((node, true), [from, to]),
        };
        intervals.entry(key).or_default().push(interval);
    }
    for (key, intervals) in &mut intervals {
        intervals.sort_by(|a, b| a[0].total_cmp(&b[0]));
        if let Some(pair) = intervals.windows(2).find(|pair| pair[1][0] < pair[0][1] - BAR) {
            return failure("twice", format!("{key:?}: {pair:?}"));
        }
    }
    Ok(())
}

/// Depth and parent against winding numbers.
fn check_nesting(contour: &Contour, offset: &Offset) -> Result<(), Failure> {
    let polygons: Vec<_> = offset.loops.iter().map(|ring| Polygon::of_loop(contour, offset.distance, ring)).collect();
    // Whether the loop lies inside the other one, by its point that is farthest from it; none if no point is far enough.
    let inside = |one: usize, other: usize| {
        let points = polygons[one].points();
        let some = points.iter().step_by((points.len() / 24).max(1));
        let (far, point) = some.map(|p| (polygons[other].distance(*p), *p)).max_by(|a, b| a.0.total_cmp(&b.0))?;
        (far > polygons[other].off).then(|| polygons[other].winding(point) != 0)
    };
    let closed = |k: usize| offset.loops[k].closed;
    for (number, ring) in offset.loops.iter().enumerate() {
        let mut around = Vec::new();
        let others = (0..offset.loops.len()).filter(|&other| other != number && closed(other));
        let mut unsure = false;
        for other in others {
            match inside(number, other) {
                Some(true) => around.push(other),
                Some(false) => {}
                None => unsure = true,
            }
        }
        if unsure {
            continue;
        }
        if ring.depth != around.len() {
            return failure("depth", format!("loop {number}: {} instead of {around:?}", ring.depth));
        }
        // The innermost of those around is the one that lies in all the others.
        let parent = around.iter().copied().max_by_key(|&k| offset.loops[k].depth);
        if ring.parent != parent {
            return failure("parent", format!("loop {number}: {:?} instead of {parent:?}", ring.parent));
        }
    }
    Ok(())
}

fn check_clearance(contour: &Contour, offset: &Offset, samples: usize) -> Result<(), Failure> {
    let d = offset.distance.abs();
    let found = clearance_with(contour, offset, samples, |_| ());
    if found.smallest.is_nan() || found.smallest < d * (1.0 - BAR) {
        return failure("gouge", format!("clearance {} of |d|, at {:?}", found.smallest / d, found.smallest_at));
    }
    if found.largest_removed.is_nan() || found.largest_removed > d * (1.0 + BAR) {
        let detail = format!("a tool of {} |d| touches at {:?}", found.largest_removed / d, found.largest_removed_at);
        return failure("wrongly removed", detail);
    }
    Ok(())
}

/// Around the inside of a simple closed curve lies one connected wall, so that offsets to the inside are not nested and run as
/// C does; outside there is one outermost loop that runs as C does, and all the others are voids in it that run against C.
fn check_topology(contour: &Contour, offset: &Offset) -> Result<(), Failure> {
    if !contour.closed {
        return Ok(());
    }
    let polygon = Polygon::of_contour(contour);
    let corners = polygon.points();
    let area: f64 = corners.iter().enumerate().map(|(k, a)| 0.5 * a.cross(corners[(k + 1) % corners.len()])).sum();
    let sense = area.signum();
    let inside = offset.distance * sense < 0.0;
    let mut outermost = 0;
    for (number, ring) in offset.loops.iter().enumerate() {
        let is_void = !inside && ring.depth == 1;
        outermost += usize::from(ring.depth == 0);
        if ring.depth > usize::from(!inside) {
            return failure("topology", format!("loop {number} has depth {}", ring.depth));
        }
        let expected = if is_void { -sense } else { sense };
        // A loop that encloses no more than its own gaps may add has no sense, nor has one whose sides keep apart from their
        // walls by |d| within the bar, but lie the wrong way round by less than that.
        let scale = size(contour).max(offset.distance.abs());
        let open = (ROUNDING * (scale + ring.length) + gaps(ring)) * scale;
        let thin = ring.area.abs() < open + BAR * offset.distance.abs() * ring.length;
        if ring.area * expected < 0.0 && !thin {
            return failure("topology", format!("loop {number} of depth {} has area {}", ring.depth, ring.area));
        }
    }
    if !inside && outermost != 1 {
        return failure("topology", format!("{outermost} outermost loops outside"));
    }
    Ok(())
}

/// Nothing may be left only if no point of C can be touched; and then a tool of the size that is told as the largest must leave
/// nothing either, but one that is a hundred-thousandth smaller something.
fn check_empty(contour: &Contour, distance: f64, largest: f64, samples: usize) -> Result<(), Failure> {
    let none = |distance: f64| Offset { distance, loops: Vec::new() };
    let d = distance.abs();
    let reach = clearance_with(contour, &none(distance), samples, |_| ()).largest_removed;
    if reach > d * (1.0 + BAR) {
        return failure("wrongly empty", format!("a tool of {} |d| touches", reach / d));
    }
    if largest.is_nan() || largest > d * (1.0 + BAR) || reach > largest * (1.0 + LARGEST) {
        return failure("largest", format!("{largest} at |d| = {d}, but a tool of {reach} touches"));
    }
    // A loop that is left a hundred-thousandth below the largest tool is as small: behind a neck narrower than 1e-9 of the size its
    // ends are known to some 1e-8 of |d| only, so its clearance is judged a thousandth below.
    let smaller = |part: f64| largest * distance.signum() * (1.0 - part);
    if let Err(error) = trim(contour, smaller(1e-5)) {
        return failure("largest", format!("{largest} at |d| = {d}, but at a hundred-thousandth less: {error:?}"));
    }
    match trim(contour, smaller(1e-3)) {
        Ok(offset) => check_clearance(contour, &offset, samples)
            .or_else(|found| failure("largest", format!("{largest} at |d| = {d}, but at a thousandth less {found}"))),
        Err(error) => failure("largest", format!("{largest} at |d| = {d}, but at a thousandth less: {error:?}")),
    }
}

//! From what was traced to loops of pieces: exact trim points, lengths, areas, turns, nesting.

use shared::complex::Complex;
use shared::curve::{Curve as _, Segment};
use shared::real::Real;

use super::crossing::newton_step;
use super::ground::Ground;
use super::nesting::nest;
use super::strand::{Source, Strand};
use super::stretch::Stretch;
use super::trace::{End, Traced, TracedLoop, interval};
use super::{Along, Contour, Loop, Piece};

/// A piece shorter than this, in the unit of the frame, is left out: the gap that it leaves is as small.
const SHORTEST: f64 = 1e-10;

/// A part whose tangent turns by less than this, in radians, has its area from Gauss's rule: eight nodes leave nothing to see.
const STRAIGHT: f64 = 0.02;

/// A loop shorter than this is a tool that just fits a place, to rounding: left out, as the largest tool that fits is.
const PLUNGE: f64 = 2.5e-9;

/// How many times farther than the change of the distance asks for a trim point may move when it is made exact.
const POLISH: f64 = 8.0;

/// A piece on its way, in the frame.
#[derive(Clone, Copy, Debug)]
struct Draft {
    source: Source,
    from: f64,
    to: f64,
    /// The length of the centre's way.
    length: f64,
    /// Its part of the closed integral of p x dp / 2.
    area: f64,
}

/// The loops of `traced`, in mm, at exactly `distance` (mm) from `contour`.
pub fn loops(contour: &Contour, ground: &Ground, traced: &Traced, distance: f64) -> Vec<Loop> {
    let exact = ground.to_frame(distance);
    let strands: Vec<Stretch> =
        traced.untrimmed.strands.iter().map(|strand| at_distance(ground, strand, exact)).collect();
    let trims: Vec<[f64; 2]> = traced
        .joints
        .iter()
        .map(|joint| {
            let given = [joint.ends.1, joint.begins.1];
            let sides = [joint.ends.0, joint.begins.0].map(|k| strands.get(k));
            if joint.exact { given } else { polish(sides, given, (exact - traced.distance).abs()) }
        })
        .collect();
    let mut loops: Vec<Loop> = traced
        .loops
        .iter()
        .filter_map(|traced_loop| {
            let drafts = drafts(ground, traced, traced_loop, &strands, &trims, exact);
            finish(contour, ground, drafts, traced_loop.closed, distance)
        })
        .collect();
    loops.sort_by(|a, b| {
        let first = |l: &Loop| l.pieces.first().map_or((0, 0.0), |piece| place(&piece.along));
        first(a).partial_cmp(&first(b)).unwrap_or(std::cmp::Ordering::Equal)
    });
    nest(contour, distance, &mut loops);
    loops
}

/// The strand at another distance than it was traced at.
fn at_distance(ground: &Ground, strand: &Strand, distance: f64) -> Stretch {
    match strand.source {
        Source::Segment(_) => strand.stretch.with_offset(distance),
        Source::Fill(node) => match ground.contour.fill_arc(node, distance) {
            Some(arc) => Stretch::new(&Segment::Arc(arc), strand.stretch.from, strand.stretch.to, 0.0),
            None => strand.stretch,
        },
        Source::Border => strand.stretch,
    }
}

/// The parameters at which two strands cross, by Newton's method from where they cross at a distance that differs by `change`; as
/// given where that leads away.
fn polish(strands: [Option<&Stretch>; 2], given: [f64; 2], change: f64) -> [f64; 2] {
    let [Some(first), Some(second)] = strands else { return given };
    let sine = first.at(given[0]).tangent.cross(second.at(given[1]).tangent).abs();
    let reach = POLISH * (change + 1e-15) / sine;
    let gap = |[xi, eta]: [f64; 2]| (first.at(xi).point - second.at(eta).point).norm();
    let mut best = given;
    let mut tau = given;
    for _ in 0..8 {
        let Some([a, b]) = newton_step([first, second], tau) else { break };
        tau = [tau[0] + a, tau[1] + b];
        let moved = (first.at(tau[0]).point - first.at(given[0]).point).norm()
            + (second.at(tau[1]).point - second.at(given[1]).point).norm();
        if moved.is_nan() || moved >= reach {
            break;
        }
        if gap(tau) <= gap(best) {
            best = tau;
        }
        if a.abs().max(b.abs()) < 1e-15 {
            break;
        }
    }
    best
}

/// The pieces of a loop: strands that go on along the same curve are one.
fn drafts(
    ground: &Ground,
    traced: &Traced,
    traced_loop: &TracedLoop,
    strands: &[Stretch],
    trims: &[[f64; 2]],
    distance: f64,
) -> Vec<Draft> {
    let mut drafts: Vec<Draft> = Vec::new();
    let first = traced_loop.fragments.first().and_then(|fragment| fragment.strands.first());
    let origin = first.and_then(|&strand| strands.get(strand)).map_or(Complex::ZERO, |strand| strand.at(0.0).point);
    for fragment in &traced_loop.fragments {
        let count = fragment.strands.len();
        for (position, &number) in fragment.strands.iter().enumerate() {
            let [mut from, mut to] = interval(fragment, &traced.joints, position);
            if let (0, End::Joint(joint)) = (position, fragment.start) {
                from = trims.get(joint).map_or(from, |tau| tau[1]);
            }
            if let (true, End::Joint(joint)) = (position + 1 == count, fragment.end) {
                to = trims.get(joint).map_or(to, |tau| tau[0]);
            }
            let (Some(strand), Some(stretch)) = (traced.untrimmed.strands.get(number), strands.get(number)) else {
                continue;
            };
            let draft = draft(ground, strand.source, stretch, [from, to], distance, origin);
            match drafts.last_mut().filter(|last| position > 0 && goes_on(last, &draft)) {
                Some(last) => {
                    last.to = draft.to;
                    last.length += draft.length;
                    last.area += draft.area;
                }
                None => drafts.push(draft),
            }
        }
    }
    drafts.retain(|draft| draft.length > SHORTEST && draft.from < draft.to);
    let least = (0..drafts.len()).min_by(|&a, &b| order(&drafts[a]).total_cmp(&order(&drafts[b])));
    if traced_loop.closed {
        drafts.rotate_left(least.unwrap_or(0));
    }
    drafts
}

fn goes_on(before: &Draft, after: &Draft) -> bool {
    before.source == after.source && (after.from - before.to).abs() < 1e-9
}

/// Where along C a draft stands.
fn order(draft: &Draft) -> f64 {
    match draft.source {
        Source::Segment(segment) => segment as f64 + 0.5 * draft.from,
        Source::Fill(node) => node as f64 + 0.5 + 0.25 * draft.from,
        Source::Border => f64::INFINITY,
    }
}

/// The same for a finished piece.
fn place(along: &Along) -> (usize, f64) {
    match *along {
        Along::Segment { segment, from, .. } => (segment, from),
        Along::Fill { node, from, .. } => (node, 1.0 + from),
    }
}

/// A part of a strand, measured; areas are swept about `origin`.
///
/// Length: integrating (13), the length on C plus d times the turn. Area: with p = r + d n, integrating p x p' by parts leaves
/// the integral of r x r', a polynomial, 2 d times the length on C, d^2 times the turn, and d times r x n at both ends. Where the
/// tangent hardly turns, these cancel, and Gauss's rule on p x p' itself is as exact.
fn draft(
    ground: &Ground,
    source: Source,
    stretch: &Stretch,
    [a, b]: [f64; 2],
    distance: f64,
    origin: Complex<f64>,
) -> Draft {
    let (from, to) = (stretch.parameter(a).clamp(0.0, 1.0), stretch.parameter(b).clamp(0.0, 1.0));
    let (curve, d) = match source {
        Source::Segment(segment) => (ground.contour.segments.get(segment).copied(), distance),
        Source::Fill(node) => (ground.contour.fill_arc(node, distance).map(Segment::Arc), 0.0),
        Source::Border => (None, 0.0),
    };
    let Some(curve) = curve else { return Draft { source, from, to, length: 0.0, area: 0.0 } };
    let [start, end] = [from, to].map(|xi| (curve.point(xi) - origin, curve.tangent(xi)));
    let turn = (start.1.conj() * end.1).arg();
    let way = curve.length_to(to) - curve.length_to(from);
    let integral = |function: &dyn Fn(f64) -> f64| -> f64 {
        let width = to - from;
        <f64 as Real>::GAUSS.iter().map(|&(x, weight)| weight * width * function(from + width * x)).sum()
    };
    let twice = if turn.abs() < STRAIGHT {
        integral(&|xi| {
            let forwards = curve.speed(xi) * (1.0 + curve.curvature(xi) * d);
            (curve.offset_point(xi, d) - origin).cross(curve.tangent(xi)) * forwards
        })
    } else {
        let normal = |(point, tangent): (Complex<f64>, Complex<f64>)| point.cross(tangent.right());
        integral(&|xi| (curve.point(xi) - origin).cross(curve.derivative(xi)))
            + 2.0 * d * way
            + d * d * turn
            + d * (normal(end) - normal(start))
    };
    Draft { source, from, to, length: way + d * turn, area: 0.5 * twice }
}

/// Turns drafts into a loop; none where nothing is left.
fn finish(contour: &Contour, ground: &Ground, drafts: Vec<Draft>, closed: bool, distance: f64) -> Option<Loop> {
    if drafts.iter().map(|draft| draft.length).sum::<f64>() < PLUNGE {
        return None;
    }
    let (mut length, mut area) = (0.0, 0.0);
    let mut pieces = Vec::with_capacity(drafts.len());
    let mut tangents = Vec::with_capacity(drafts.len());
    for draft in &drafts {
        let (from, to) = (draft.from, draft.to);
        let along = match draft.source {
            Source::Segment(segment) => Along::Segment { segment, from, to },
            Source::Fill(node) => Along::Fill { node, from, to },
            Source::Border => continue,
        };
        let (curve, _, d) = contour.carrier(along, distance)?;
        // Of a very short segment the turned frame may round the direction, and see a gap at a node that has none.
        if let Segment::Arc(arc) = curve
            && matches!(along, Along::Fill { .. })
            && arc.sweep * distance <= 0.0
        {
            continue;
        }
        let [start, end] = [from, to].map(|xi| curve.offset_point(xi, d));
        pieces.push(Piece { along, start, end, start_turn: 0.0, end_turn: 0.0 });
        tangents.push([from, to].map(|xi| curve.tangent(xi)));
        length += draft.length;
        area += draft.area;
    }
    if pieces.is_empty() {
        return None;
    }
    let count = pieces.len();
    for k in 0..count {
        let next = (k + 1) % count;
        if next > k || closed {
            let turn = (tangents[k][1].conj() * tangents[next][0]).arg();
            pieces[k].end_turn = turn;
            pieces[next].start_turn = turn;
        }
    }
    let mm = ground.to_mm(1.0);
    let area = if closed { area * mm * mm } else { 0.0 };
    Some(Loop { closed, pieces, length: length * mm, area, parent: None, depth: 0 })
}

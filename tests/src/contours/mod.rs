//! Random contours to be offset: each seed gives one simple contour and one distance, the same on every machine.
//!
//! Half of the families look like parts that people cut; the others are made of what breaks offsets: slots and necks as wide
//! as the tool to 1e-12, fillets of the tool's radius, osculating bends, symmetric figures whose trim points meet at nodes,
//! lattices on which many events fall together.
//!
//! Tests keep seeds that failed once. Whatever changes what a seed gives, a family or the order of random numbers, voids them:
//! add families at the price of collecting those anew, or under seeds of their own.

mod closed;
mod open;
mod tight;

use host_sim::contour::Contour;
use shared::complex::Complex;
use shared::curve::{Curve as _, Segment};

use crate::chain::{Placing, reversed, size};
use crate::random::{Random, unit};
use crate::simple::crossing;

/// One contour and one distance.
#[derive(Clone, Debug)]
pub struct Case {
    /// What it was made from.
    pub seed: u64,
    /// The family's name.
    pub family: &'static str,
    /// The contour, without crossings.
    pub contour: Contour,
    /// The signed distance.
    pub distance: f64,
    /// Whether the contour touches itself at a node: it may then be refused as crossing.
    pub touches: bool,
}

/// A contour before it is placed, and distances at which something happens to it; negative ones left of travel alone.
struct Drawn {
    contour: Contour,
    special: Vec<f64>,
}

type Family = (&'static str, fn(&mut Random) -> Drawn);

const FAMILIES: &[Family] = &[
    ("blob", closed::blob),
    ("blob", closed::blob),
    ("blob", closed::blob),
    ("smooth blob", closed::smooth_blob),
    ("smooth blob", closed::smooth_blob),
    ("nearly smooth blob", closed::nearly_smooth_blob),
    ("filleted polygon", closed::filleted_polygon),
    ("filleted polygon", closed::filleted_polygon),
    ("star", closed::star),
    ("spikes", closed::spikes),
    ("gear", closed::gear),
    ("comb", closed::comb),
    ("fine polygon", closed::fine_polygon),
    ("many segments", closed::many),
    ("tiny segments", closed::tiny_segments),
    ("nearly straight arcs", closed::flat_arcs),
    ("polyomino", tight::polyomino),
    ("polyomino", tight::polyomino),
    ("slot", tight::slot),
    ("bone", tight::bone),
    ("hourglass", tight::hourglass),
    ("ring with a mouth", tight::ring),
    ("notch", tight::notch),
    ("notch", tight::notch),
    ("lobe", tight::lobe),
    ("spiral slot", tight::spiral_slot),
    ("touching", tight::touching),
    ("walk", open::walk),
    ("walk", open::walk),
    ("smooth walk", open::smooth_walk),
    ("zigzag", open::zigzag),
    ("spiral", open::spiral),
    ("open ring", open::ring),
    ("single", open::single),
    ("opened", open::opened),
];

/// Attempts to draw a contour that does not cross itself.
const ATTEMPTS: u64 = 400;

/// The contour and distance of a seed.
pub fn case(seed: u64) -> Case {
    let mut random = Random::new(seed);
    let (family, draw) = FAMILIES[(random.bits() % FAMILIES.len() as u64) as usize];
    let touches = family == "touching";
    for attempt in 0..ATTEMPTS {
        let mut random = Random::new(seed.wrapping_mul(0x2545_f491_4f6c_dd1d).wrapping_add(attempt));
        let Drawn { contour, special } = draw(&mut random);
        if !is_sound(&contour) || (!touches && crossing(&contour).is_some()) {
            continue;
        }
        let distance = distance(&mut random, &contour, &special);
        let placing = placing(&mut random);
        let distance = placing.distance(distance);
        let contour = placing.contour(&contour);
        let (contour, distance) =
            if random.chance(0.5) { (reversed(&contour), -distance) } else { (contour, distance) };
        // Placing rounds: what has just been simple may not be any more.
        if touches || crossing(&contour).is_none() {
            return Case { seed, family, contour, distance, touches };
        }
    }
    // No family is that unlucky; a square keeps the promise if one is.
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| Complex::new(x, y));
    let contour = crate::chain::Chain::through(&corners).close();
    Case { seed, family: "square", contour, distance: random.within(-0.6, 0.6), touches: false }
}

/// A signed distance: one at which something happens, or any from tiny to huge.
fn distance(random: &mut Random, contour: &Contour, special: &[f64]) -> f64 {
    let size = size(contour);
    let mut sign = random.sign();
    let magnitude = if !special.is_empty() && random.chance(0.6) {
        let chosen = random.pick(special);
        if chosen < 0.0 && random.chance(0.8) {
            sign = -1.0;
        }
        chosen.abs() * random.nearly_one()
    } else {
        match random.whole(0, 9) {
            0 => size * 1e-4,
            1 => size * random.scale(1e-4, 1e-2),
            2..=5 => size * random.scale(1e-2, 0.3),
            6 => size * random.scale(0.3, 100.0),
            7 => bend(random, contour).unwrap_or(0.1 * size) * random.nearly_one(),
            _ => crate::largest_disc::inside(contour).unwrap_or(0.2 * size) * random.nearly_one(),
        }
    };
    let usable = magnitude.clamp(1e-4 * size, 100.0 * size);
    usable * sign
}

/// The radius of curvature at the sharpest of some points of a random curved segment.
fn bend(random: &mut Random, contour: &Contour) -> Option<f64> {
    let curved: Vec<_> = contour.segments.iter().filter(|s| !matches!(s, Segment::Line(_))).copied().collect();
    let curve = (!curved.is_empty()).then(|| random.pick(&curved))?;
    // The peak, by narrowing around the best of a grid.
    let sharpness = |xi: &f64| curve.curvature(*xi).abs();
    let [mut from, mut to] = [0.0, 1.0];
    let mut best = 0.5;
    for _ in 0..12 {
        let grid = (0..=16).map(|k| from + (to - from) * f64::from(k) / 16.0);
        best = grid.max_by(|a, b| sharpness(a).total_cmp(&sharpness(b))).unwrap_or(best);
        let width: f64 = 0.125 * (to - from);
        [from, to] = [(best - width).max(0.0), (best + width).min(1.0)];
    }
    Some(1.0 / sharpness(&best)).filter(|radius| radius.is_finite())
}

/// Turned or not, mirrored or not, of any size, at the origin or some sizes away.
fn placing(random: &mut Random) -> Placing {
    let turn = if random.chance(0.4) { Complex::new(1.0, 0.0) } else { random.direction() };
    let scale = if random.chance(0.5) { 1.0 } else { random.scale(1e-2, 1e3) };
    let shift = if random.chance(0.5) { Complex::ZERO } else { random.direction() * (scale * random.scale(0.1, 10.0)) };
    Placing { factor: turn * scale, shift, mirror: random.chance(0.5) }
}

/// Whether every segment has length and speed, and no node turns back.
fn is_sound(contour: &Contour) -> bool {
    let size = size(contour);
    let moves = |segment: &Segment<f64>| {
        let speeds = (0..=64).map(|k| segment.speed(f64::from(k) / 64.0));
        let (low, high) = speeds.fold((f64::INFINITY, 0.0_f64), |(l, h), s| (l.min(s), h.max(s)));
        let whole = match segment {
            Segment::Arc(arc) => arc.sweep.abs() <= std::f64::consts::TAU,
            _ => true,
        };
        whole && low > 1e-6 * high && segment.length() > 1e-8 * size && high.is_finite()
    };
    let turns = (0..contour.nodes()).filter_map(|node| contour.turning_angle(node));
    !contour.segments.is_empty()
        && contour.segments.iter().all(moves)
        && turns.fold(0.0_f64, |most, turn| most.max(turn.abs())) < std::f64::consts::PI - 1e-5
}

/// What a segment of a random chain is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Line,
    Arc,
    Ph,
}

/// A chain through `points` (closed if `closed`) of mixed segments. A node is smooth with probability `smooth`; its tangents
/// then differ by `break_angle`.
fn mixed(random: &mut Random, points: &[Complex<f64>], closed: bool, smooth: f64, break_angle: f64) -> Contour {
    let count = points.len();
    let edges = if closed { count } else { count - 1 };
    let preference = random.pick(&[[0.33, 0.67], [0.1, 0.2], [0.6, 0.9], [0.0, 0.5], [1.0, 1.0], [0.0, 1.0]]);
    let kinds: Vec<Kind> = (0..edges)
        .map(|_| match random.unit() {
            x if x < preference[0] => Kind::Line,
            x if x < preference[1] => Kind::Arc,
            _ => Kind::Ph,
        })
        .collect();
    let chord = |edge: usize| points[(edge + 1) % count] - points[edge];
    let heading = |z: Complex<f64>| z * (1.0 / z.norm());
    // A tangent at each smooth node: along a line that ends there, else between the chords.
    let tangents: Vec<Option<Complex<f64>>> = (0..count)
        .map(|node| {
            let has = |edge: usize| edge < edges;
            let before = if closed { (node + count - 1) % count } else { node.wrapping_sub(1) };
            if !(has(before) && has(node)) || !random.chance(smooth) {
                return None;
            }
            match (kinds[before], kinds[node]) {
                (Kind::Line, Kind::Line) => None,
                (Kind::Line, _) => Some(heading(chord(before))),
                (_, Kind::Line) => Some(heading(chord(node))),
                _ => Some(heading(heading(chord(before)) + heading(chord(node)))),
            }
        })
        .collect();
    let strength = random.pick(&[0.7, 1.0, 1.3]);
    let mut chain = crate::chain::Chain::at(points[0]);
    for edge in 0..edges {
        let (to, chord) = (points[(edge + 1) % count], chord(edge));
        let mut leaving = tangents[edge];
        let arriving = tangents[(edge + 1) % count];
        if break_angle != 0.0 {
            leaving = leaving.map(|t| t * unit(break_angle * random.sign()));
        }
        chain = match kinds[edge] {
            Kind::Line => chain.line(to),
            Kind::Arc => {
                // An arc leaves its chord by half its sweep.
                let angle = leaving.map(|t| -(chord.conj() * t).arg());
                let sweep = 2.0 * angle.unwrap_or_else(|| random.within(-0.9, 0.9));
                chain.bow(to, if sweep.abs() < 1e-9 { 0.3 } else { sweep })
            }
            Kind::Ph => {
                let mut any = || heading(chord) * unit(random.within(-0.8, 0.8));
                let [d0, d1] = [leaving.unwrap_or_else(&mut any), arriving.unwrap_or_else(&mut any)];
                let [s0, s1] = [random.within(0.6, 1.4), random.within(0.6, 1.4)];
                chain.hermite(to, d0 * (strength * s0 * chord.norm()), d1 * (strength * s1 * chord.norm()))
            }
        };
    }
    if closed { chain.closed_as_it_is() } else { chain.open() }
}

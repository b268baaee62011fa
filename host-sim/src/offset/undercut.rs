//! What the tool cannot touch: where the part keeps material, and how much.

use shared::complex::Complex;

use super::field::Field;
use super::golden::golden;
use super::ground::Ground;
use super::stretch::Stretch;
use super::{Along, Offset, Undercut};

/// Parts of C shorter than this, in parameters, are touched.
const SHORTEST: f64 = 1e-9;

/// Points of a stretch at which the thickness is looked at before the thickest place is narrowed down.
const LOOKS: u32 = 8;

/// Where the tool of `offset` leaves material, in order along C.
pub fn undercuts(ground: &Ground, offset: &Offset) -> Vec<Undercut> {
    let way = Field::new(way(ground, offset));
    let radius = ground.to_frame(offset.distance).abs();
    regions(ground, offset)
        .into_iter()
        .filter_map(|[from, to]| {
            let (depth, deepest) = deepest(ground, &way, radius, from, to)?;
            // A region begins on the segment behind a node and ends on the one before it.
            let count = ground.contour.segments.len();
            let place = |number: f64, at: f64| (number as usize % count, at - number);
            (depth > 0.0).then(|| Undercut {
                from: place(from.floor(), from),
                to: place(to.ceil() - 1.0, to),
                depth: ground.to_mm(depth),
                deepest: ground.place(deepest),
            })
        })
        .collect()
}

/// The tool's way in the frame, in stretches.
fn way(ground: &Ground, offset: &Offset) -> Vec<Stretch> {
    let distance = ground.to_frame(offset.distance);
    let mut stretches = Vec::new();
    for piece in offset.loops.iter().flat_map(|l| &l.pieces) {
        let Some((curve, [from, to], d)) = ground.contour.carrier(piece.along, distance) else { continue };
        let cuts = match piece.along {
            Along::Segment { segment, .. } => ground.cuts.get(segment).cloned().unwrap_or_default(),
            Along::Fill { .. } => super::stretch::cuts(&curve),
        };
        let inside = cuts.into_iter().filter(|&xi| xi > from && xi < to);
        let ends: Vec<f64> = std::iter::once(from).chain(inside).chain([to]).collect();
        stretches.extend(ends.windows(2).filter_map(|pair| match *pair {
            [from, to] => Some(Stretch::new(&curve, from, to, d)),
            _ => None,
        }));
    }
    stretches
}

/// The parts of C that no piece touches, as pairs of segment number plus parameter; the last one may run on beyond the end.
fn regions(ground: &Ground, offset: &Offset) -> Vec<[f64; 2]> {
    let count = ground.contour.segments.len() as f64;
    let mut touched: Vec<[f64; 2]> = offset
        .loops
        .iter()
        .flat_map(|l| &l.pieces)
        .map(|piece| match piece.along {
            Along::Segment { segment, from, to } => [segment as f64 + from, segment as f64 + to],
            // A fill arc touches its node.
            Along::Fill { node, .. } => [node as f64 + 1.0; 2],
        })
        .collect();
    if touched.is_empty() {
        return vec![[0.0, count]];
    }
    touched.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut regions: Vec<[f64; 2]> = Vec::new();
    let mut reached = 0.0;
    for [from, to] in touched {
        if from - reached > SHORTEST {
            regions.push([reached, from]);
        }
        reached = to.max(reached);
    }
    if count - reached > SHORTEST {
        regions.push([reached, count]);
    }
    // Over the start of a closed contour a region goes on.
    if ground.contour.closed
        && regions.len() > 1
        && let (Some(&[0.0, to]), Some(last)) = (regions.first(), regions.last().copied())
        && last[1] == count
    {
        regions.remove(0);
        if let Some(last) = regions.last_mut() {
            last[1] = count + to;
        }
    }
    regions
}

/// The thickest place of a region: how far the tool's way is, beyond the tool's radius, and the point of C.
fn deepest(ground: &Ground, way: &Field, radius: f64, from: f64, to: f64) -> Option<(f64, Complex<f64>)> {
    let count = ground.contour.segments.len() as f64;
    let thickness =
        |point: Complex<f64>| way.nearest(point, f64::INFINITY).map_or(0.0, |(_, foot)| foot.distance - radius);
    let mut best: Option<(f64, Complex<f64>)> = None;
    // Behind the start of a closed contour first: in the order of the stretches.
    for round in [count, 0.0] {
        let first = ground.segment_of.partition_point(|&segment| segment as f64 + 1.0 + round < from);
        let behind = ground.segment_of.partition_point(|&segment| segment as f64 + round <= to);
        let stretches = ground.field.stretches().iter().zip(&ground.segment_of);
        for (stretch, &segment) in stretches.take(behind).skip(first) {
            let base = segment as f64 + round;
            let within = |at: f64| (at - base - stretch.from) / (stretch.to - stretch.from) - 0.5;
            let (a, b) = (within(from).max(-0.5), within(to).min(0.5));
            if a >= b {
                continue;
            }
            let look = |tau: f64| {
                let point = stretch.at(tau).point;
                (thickness(point), point)
            };
            let step = (b - a) / f64::from(LOOKS);
            let looks = (0..=LOOKS).map(|k| (a + step * f64::from(k), look(a + step * f64::from(k))));
            let Some((tau, found)) = looks.max_by(|x, y| x.1.0.total_cmp(&y.1.0)) else { continue };
            let refined = if best.is_none_or(|(depth, _)| found.0 + step * (stretch.at(tau).speed) > depth) {
                let tau = golden(|tau| -look(tau).0, (tau - step).max(a), (tau + step).min(b));
                let narrowed = look(tau);
                if narrowed.0 > found.0 { narrowed } else { found }
            } else {
                found
            };
            if best.is_none_or(|(depth, _)| refined.0 > depth) {
                best = Some(refined);
            }
        }
    }
    best
}

//! An offset measured again, with nothing of what found it: dense samples against foot points on all of C.

use serde::Serialize;
use shared::complex::Complex;
use shared::curve::{Curve as _, Segment};

use super::nearest::Nearest;
use super::path_distance::PathDistance;
use super::touching::{Contact, touching_radius};
use crate::contour::{Along, Contour};
use crate::offset::Offset;

/// Samples that a measurement spends in all, if pieces are not too many or too few for it.
const BUDGET: usize = 200_000;
/// The least and the most samples of one piece.
const PER_PIECE: [usize; 2] = [16, 256];
/// Parts of a parameter interval at its ends that get samples of their own: a wrong trim point shows there first.
const NEAR_ENDS: [f64; 3] = [1e-6, 1e-4, 1e-2];
/// Around a trim point the removed side is left out as far as this, in the segment's parameter: trim points are rounded.
const AT_TRIM: f64 = 1e-9;
/// How finely two contacts of one tool must be told apart for its radius to be judged, in parts of the radius.
const JUDGED: f64 = 1e-9;
/// What is shorter than this part of the size is no more than a gap that rounding leaves.
const NO_GAP: f64 = 1e-9;

/// How far an offset keeps away from its contour, and what it leaves; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Clearance {
    /// The smallest distance between a point of the offset and a point of C: |d| if nothing is gouged.
    pub smallest: f64,
    /// The point of the offset where that is.
    pub smallest_at: Complex<f64>,
    /// The largest radius of a tool that could touch C somewhere where the offset says that one of |d| cannot: at most |d| if
    /// nothing was removed that is clear of C. 0 where nothing was removed; looked for up to 2 |d|.
    pub largest_removed: f64,
    /// The point of the untrimmed offset where that is.
    pub largest_removed_at: Complex<f64>,
    /// How much farther than |d| a point of C is from the offset, at most: the material that is left. Of a path that touches
    /// all of C this is 0 to rounding.
    pub largest_undercut: f64,
    /// The point of C where that is.
    pub largest_undercut_at: Complex<f64>,
    /// How many points were measured.
    pub samples: usize,
}

/// Measures `offset` against `contour`, in a second or two.
pub fn clearance(contour: &Contour, offset: &Offset) -> Clearance {
    let pieces = offset.loops.iter().map(|l| l.pieces.len()).sum::<usize>() + contour.segments.len();
    let [least, most] = PER_PIECE;
    clearance_with(contour, offset, (BUDGET / (2 * pieces.max(1))).clamp(least, most), |_| ())
}

/// As [`clearance`], with so many samples on each piece, each removed part and each segment (at least 2). `progress` is told
/// the part done in 0..=1 now and then.
pub fn clearance_with(contour: &Contour, offset: &Offset, samples: usize, mut progress: impl FnMut(f64)) -> Clearance {
    let nearest = Nearest::new(contour);
    let alongs: Vec<Along> = offset.loops.iter().flat_map(|l| &l.pieces).map(|piece| piece.along).collect();
    let retained: Vec<_> = alongs.iter().filter_map(|along| contour.carrier(*along, offset.distance)).collect();
    let removed = removed(contour, offset.distance, &alongs, nearest.size());
    let path = PathDistance::new(retained.iter().copied());

    let steps = (retained.len() + removed.len() + contour.segments.len()).max(1) as f64;
    let mut done = 0.0;
    let mut tell = || {
        done += 1.0;
        progress(done / steps);
    };
    let far = f64::INFINITY;
    let [mut smallest, mut largest_removed, mut largest_undercut] =
        [(far, Complex::ZERO), (0.0, Complex::ZERO), (-far, Complex::ZERO)];
    let mut count = 0;
    for (segment, interval, distance) in &retained {
        for xi in with_ends(*interval, samples) {
            let point = segment.offset_point(xi, *distance);
            let found = nearest.at(point).distance;
            if found < smallest.0 {
                smallest = (found, point);
            }
            count += 1;
        }
        tell();
    }
    // A second contact at the chord t from the first, in radii, limits a radius to roundoffs over t^2/2. Where a part of C
    // comes so close to a contact that this is too little, nothing can be said.
    let blurred = (2.0 * 8.0 * f64::EPSILON * (nearest.size() / offset.distance.abs() + 2.0) / JUDGED).sqrt();
    for part in &removed {
        for xi in inside(part.interval, samples) {
            let contact = part.contact(xi, offset.distance);
            if nearest.any_within(contact.point, blurred * offset.distance.abs(), part.own) {
                continue;
            }
            let radius = touching_radius(&nearest, contact, 2.0 * offset.distance.abs());
            if radius > largest_removed.0 {
                largest_removed = (radius, contact.point + contact.normal * offset.distance.abs());
            }
            count += 1;
        }
        tell();
    }
    for segment in &contour.segments {
        for xi in with_ends([0.0, 1.0], samples) {
            let point = segment.point(xi);
            let left = path.at(point) - offset.distance.abs();
            if left > largest_undercut.0 {
                largest_undercut = (left, point);
            }
            count += 1;
        }
        tell();
    }
    Clearance {
        smallest: smallest.0,
        smallest_at: smallest.1,
        largest_removed: largest_removed.0,
        largest_removed_at: largest_removed.1,
        largest_undercut: largest_undercut.0,
        largest_undercut_at: largest_undercut.1,
        samples: count,
    }
}

/// A stretch of the untrimmed offset that is not retained.
#[derive(Clone, Copy)]
struct Removed {
    /// The segment, or the fill arc about a node.
    curve: Segment<f64>,
    /// The node, on a fill arc.
    node: Option<Complex<f64>>,
    interval: [f64; 2],
    /// The segment, or those that meet at the node.
    own: [usize; 2],
    /// The larger curvature of those at the node.
    beside: f64,
}

impl Removed {
    /// About how long it is.
    fn length(&self, distance: f64) -> f64 {
        /// Chords that are long enough together.
        const CHORDS: u32 = 16;
        let [from, to] = self.interval;
        let offset = if self.node.is_some() { 0.0 } else { distance };
        let point = |k: u32| self.curve.offset_point(from + (to - from) * f64::from(k) / f64::from(CHORDS), offset);
        (0..CHORDS).map(|k| (point(k + 1) - point(k)).norm()).sum()
    }

    /// Where a tool at the signed `distance` would touch for this parameter.
    fn contact(&self, xi: f64, distance: f64) -> Contact {
        match self.node {
            Some(node) => {
                let out = self.curve.point(xi) - node;
                Contact { point: node, normal: out * (1.0 / out.norm()), bend: 0.0, beside: self.beside }
            }
            None => {
                let normal = self.curve.tangent(xi).right() * distance.signum();
                let bend = bend(&self.curve, xi, distance);
                Contact { point: self.curve.point(xi), normal, bend, beside: bend }
            }
        }
    }
}

/// The curvature towards a tool at the signed `distance`: the right of travel is the outside of what bends to the left.
fn bend(curve: &Segment<f64>, xi: f64, distance: f64) -> f64 {
    -curve.curvature(xi) * distance.signum()
}

/// All of the untrimmed offset without the parts `retained`.
fn removed(contour: &Contour, distance: f64, retained: &[Along], size: f64) -> Vec<Removed> {
    let mut on_segment = vec![Vec::new(); contour.segments.len()];
    let mut on_fill = vec![Vec::new(); contour.segments.len()];
    for along in retained {
        let (intervals, number, interval) = match *along {
            Along::Segment { segment, from, to } => (&mut on_segment, segment, [from, to]),
            Along::Fill { node, from, to } => (&mut on_fill, node, [from, to]),
        };
        if let Some(intervals) = intervals.get_mut(number) {
            intervals.push(interval);
        }
    }
    let mut parts = Vec::new();
    for (number, (segment, intervals)) in contour.segments.iter().zip(on_segment).enumerate() {
        let whole = Removed { curve: *segment, node: None, interval: [0.0, 1.0], own: [number; 2], beside: 0.0 };
        parts.extend(gaps(intervals).map(|interval| Removed { interval, ..whole }));
    }
    for (node, intervals) in on_fill.into_iter().enumerate().take(contour.nodes()) {
        let (Some(turn), Some(arc)) = (contour.turning_angle(node), contour.fill_arc(node, distance)) else { continue };
        let Some([before, after]) = contour.at_node(node) else { continue };
        // Only convex nodes have a gap to fill.
        if turn * distance > 0.0 {
            let own = [node, (node + 1) % contour.segments.len()];
            let beside = bend(before, 1.0, distance).max(bend(after, 0.0, distance));
            let (curve, node) = (Segment::Arc(arc), Some(before.point(1.0)));
            let whole = Removed { curve, node, interval: [0.0, 1.0], own, beside };
            parts.extend(gaps(intervals).map(|interval| Removed { interval, ..whole }));
        }
    }
    parts.retain(|part| part.length(distance) > NO_GAP * size.max(distance.abs()));
    parts
}

/// What `intervals` leave of 0..=1, without the neighbourhoods of their ends.
fn gaps(mut intervals: Vec<[f64; 2]>) -> impl Iterator<Item = [f64; 2]> {
    intervals.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut end = 0.0_f64;
    let mut gaps = Vec::new();
    for [from, to] in intervals.into_iter().chain([[1.0, 1.0]]) {
        let left = if end > 0.0 { end + AT_TRIM } else { end };
        let right = if from < 1.0 { from - AT_TRIM } else { from };
        if right - left > AT_TRIM {
            gaps.push([left, right]);
        }
        end = end.max(to);
    }
    gaps.into_iter()
}

/// Samples of an interval: both ends, points close to them, and an even grid.
fn with_ends([from, to]: [f64; 2], samples: usize) -> impl Iterator<Item = f64> {
    let grid = (0..samples).map(move |k| k as f64 / (samples.max(2) - 1) as f64);
    // The last one is `to` itself, not `to` to rounding.
    grid.chain(NEAR_ENDS)
        .chain(NEAR_ENDS.map(|x| 1.0 - x))
        .map(move |x| if x < 1.0 { from + (to - from) * x } else { to })
}

/// Samples inside an interval: points close to its ends, and an even grid.
fn inside([from, to]: [f64; 2], samples: usize) -> impl Iterator<Item = f64> {
    let grid = (0..samples).map(move |k| (k as f64 + 0.5) / samples as f64);
    grid.chain(NEAR_ENDS).chain(NEAR_ENDS.map(|x| 1.0 - x)).map(move |x| from + (to - from) * x)
}

#[cfg(test)]
#[path = "clearance_tests.rs"]
mod tests;

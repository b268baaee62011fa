//! The part's curve C: a chain of segments, and what happens at its nodes (Farouki & Srinathu 2018, section 2).

use shared::complex::Complex;
use shared::curve::{Arc, Curve as _, Segment};

/// Tangents that differ by less than this angle, in radians, meet smoothly: no ramp stands there.
pub const SMOOTH: f64 = 1e-6;

/// A chain of segments, each beginning where the one before it ends. Lengths in mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Contour {
    /// The segments r_i in order of travel; at least one.
    pub segments: Vec<Segment<f64>>,
    /// Whether the last one ends where the first one starts.
    pub closed: bool,
}

/// What a part of an offset runs along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Along {
    /// A part of a segment's offset.
    Segment {
        /// Its number, from 0.
        segment: usize,
        /// First parameter.
        from: f64,
        /// Last parameter.
        to: f64,
    },
    /// A part of the arc that fills the gap at a convex node.
    Fill {
        /// The node at the end of the segment of this number.
        node: usize,
        /// First parameter on the arc, within 0..=1.
        from: f64,
        /// Last parameter on the arc.
        to: f64,
    },
}

impl Contour {
    /// How many nodes there are: one at the end of each segment, but none at the end of an open contour.
    pub fn nodes(&self) -> usize {
        if self.closed { self.segments.len() } else { self.segments.len().saturating_sub(1) }
    }

    /// The segments that meet at `node`: the one of that number, and the one after it. None where there is no such node.
    pub fn at_node(&self, node: usize) -> Option<[&Segment<f64>; 2]> {
        let before = self.segments.get(node)?;
        let after = match self.segments.get(node + 1) {
            Some(after) => after,
            None if self.closed => self.segments.first()?,
            None => return None,
        };
        Some([before, after])
    }

    /// The angle of equation (3) at `node` in -pi..=pi, positive anticlockwise; none where there is no such node.
    pub fn turning_angle(&self, node: usize) -> Option<f64> {
        let [before, after] = self.at_node(node)?;
        Some((before.tangent(1.0).conj() * after.tangent(0.0)).arg())
    }

    /// The arc about a node that turns d n of one segment into d n of the next one; none where there is no such node.
    pub fn fill_arc(&self, node: usize, distance: f64) -> Option<Arc<f64>> {
        let sweep = self.turning_angle(node)?;
        let [before, _] = self.at_node(node)?;
        let radius = before.tangent(1.0).right() * distance;
        Some(Arc { start: before.point(1.0) + radius, radius, sweep })
    }

    /// The curve that carries a part of the offset at `distance`, and its distance from that curve: a segment at `distance`,
    /// or a fill arc, which is its own centre path. None where there is no such segment or node.
    pub fn carrier(&self, along: Along, distance: f64) -> Option<(Segment<f64>, [f64; 2], f64)> {
        match along {
            Along::Segment { segment, from, to } => Some((*self.segments.get(segment)?, [from, to], distance)),
            Along::Fill { node, from, to } => Some((Segment::Arc(self.fill_arc(node, distance)?), [from, to], 0.0)),
        }
    }

    /// Lower left and upper right corner of a box around all nodes and a few points of every segment: the contour's size.
    pub fn extent(&self) -> [Complex<f64>; 2] {
        let points = self.segments.iter().flat_map(|s| [0.0, 0.25, 0.5, 0.75, 1.0].map(|xi| s.point(xi)));
        let far = f64::INFINITY;
        points.fold([Complex::new(far, far), Complex::new(-far, -far)], |[low, high], p| {
            [Complex::new(low.re.min(p.re), low.im.min(p.im)), Complex::new(high.re.max(p.re), high.im.max(p.im))]
        })
    }
}

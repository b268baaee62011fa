//! The contour of a compensated run: links, and the places at which it comes back to itself.

use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree};
use shared::complex::Complex;
use shared::curve::{Curve as _, Line, Segment};

use super::curves::{SAME, arc_over, split};
use crate::contour::Contour;
use crate::program::{Feed, Item};

/// Places of the contour that are nearer to each other than this, in mm, are one if the way between them is much longer: programs have
/// three or four decimals, and a point within a line or an arc cannot be written more exactly.
const NEAR: f64 = 1e-3;

/// How many times [`NEAR`] is much longer.
const LONGER: f64 = 16.0;

/// A segment of the contour.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub curve: Segment<f64>,
    /// The heights at its ends.
    pub z: [f64; 2],
    pub feed: Feed,
    pub is_rapid: bool,
    /// Line and column of its motion.
    pub place: [usize; 2],
    /// The number of its motion.
    pub motion: usize,
}

/// Something that the program does at a node: no motion in x and y.
#[derive(Clone, Copy, Debug)]
pub(super) struct Event {
    /// How many links are before it.
    pub node: usize,
    pub item: Item<'static>,
}

/// Links in order of travel, each beginning where the one before it ends, and what happens between them.
#[derive(Clone, Debug, Default)]
pub(super) struct Chain {
    pub links: Vec<Link>,
    pub events: Vec<Event>,
}

impl Chain {
    /// The links of a part of the chain as a contour.
    pub fn contour(&self, from: usize, to: usize, closed: bool) -> Contour {
        Contour { segments: self.links[from..to].iter().map(|link| link.curve).collect(), closed }
    }

    /// The point between link `node - 1` and link `node`; none of an empty chain.
    fn node(&self, node: usize) -> Option<Complex<f64>> {
        match self.links.get(node) {
            Some(link) => Some(link.curve.point(0.0)),
            None => self.links.last().map(|link| link.curve.point(1.0)),
        }
    }

    /// Makes two links of one.
    pub fn split(&mut self, number: usize, xi: f64) {
        let link = self.links[number];
        let [low, high] = split(&link.curve, xi);
        let middle = link.z[0] + (link.z[1] - link.z[0]) * xi;
        self.links[number] = Link { curve: low, z: [link.z[0], middle], ..link };
        self.links.insert(number + 1, Link { curve: high, z: [middle, link.z[1]], ..link });
        for event in self.events.iter_mut().filter(|event| event.node > number) {
            event.node += 1;
        }
    }

    /// Splits lines and arcs where they pass through a node: where the contour runs over itself again.
    pub fn split_at_nodes(&mut self) {
        let nodes = self.nodes();
        for number in (0..self.links.len()).rev() {
            let curve = self.links[number].curve;
            let mut cuts: Vec<f64> =
                nodes.locate_in_envelope(bounds(&curve)).filter_map(|node| passes(&curve, point(node))).collect();
            cuts.sort_by(f64::total_cmp);
            let length = curve.length();
            cuts.dedup_by(|b, a| (*b - *a) * length <= NEAR);
            // From the end on, so that what is left begins at 0.
            let mut left = 1.0;
            for cut in cuts.into_iter().rev() {
                self.split(number, cut / left);
                left = cut;
            }
        }
    }

    /// Whether a link runs over another one again, in the same direction; if so it is made the same to the last digit.
    pub fn run_again(&mut self, number: usize, other: usize) -> bool {
        let (Some(one), Some(other)) = (self.links.get(number), self.links.get(other)) else { return false };
        let curve = other.curve;
        let is_again = [0.0, 0.5, 1.0].iter().all(|&xi| (one.curve.point(xi) - curve.point(xi)).norm() <= 2.0 * NEAR);
        if is_again {
            self.links[number].curve = curve;
            if let Some(next) = self.links.get_mut(number + 1) {
                next.curve = with_ends(&next.curve, curve.point(1.0), next.curve.point(1.0));
            }
        }
        is_again
    }

    /// Makes the end of a round meet its start to the last digit.
    pub fn close_round(&mut self, start: usize, end: usize) {
        if let (Some(node), Some(last)) = (self.node(start), self.links.get_mut(end - 1)) {
            last.curve = with_ends(&last.curve, last.curve.point(0.0), node);
        }
    }

    /// Splits a link at the point of it that is nearest to `at`, unless that is an end.
    pub fn split_near(&mut self, number: usize, at: Complex<f64>) -> bool {
        let Some(link) = self.links.get(number) else { return false };
        let xi = nearest(&link.curve, at);
        let is_inside = [0.0, 1.0].iter().all(|&end| (link.curve.point(end) - at).norm() > SAME);
        if is_inside {
            self.split(number, xi);
        }
        is_inside
    }

    fn nodes(&self) -> RTree<Node> {
        let nodes = (0..=self.links.len()).filter_map(|node| Some((self.node(node)?, node)));
        RTree::bulk_load(nodes.map(|(p, node)| Node::new([p.re, p.im], node)).collect())
    }

    /// The two nodes, from `from` to `to`, between which the chain first comes back to itself.
    pub fn first_loop(&self, from: usize, to: usize) -> Option<[usize; 2]> {
        let nodes = self.nodes();
        let mut ways = vec![0.0; to + 1];
        for link in from..to {
            ways[link + 1] = ways[link] + self.links[link].curve.length();
        }
        (from + 1..=to).find_map(|end| {
            let at = self.node(end)?;
            let near = nodes.locate_within_distance([at.re, at.im], NEAR * NEAR).map(|node| node.data);
            let is_before = |&start: &usize| start >= from && start < end && ways[end] - ways[start] > LONGER * NEAR;
            near.filter(is_before).max().map(|start| [start, end])
        })
    }
}

/// A point, and the number of its node.
type Node = GeomWithData<[f64; 2], usize>;

fn point(node: &Node) -> Complex<f64> {
    let &[x, y] = node.geom();
    Complex::new(x, y)
}

/// A line or an arc with ends that are moved a little; other curves as they are.
fn with_ends(curve: &Segment<f64>, start: Complex<f64>, end: Complex<f64>) -> Segment<f64> {
    match curve {
        Segment::Line(_) => Segment::Line(Line { start, end }),
        Segment::Arc(arc) => Segment::Arc(arc_over(start, end, arc.sweep)),
        Segment::Ph(_) | Segment::Spline(_) => *curve,
    }
}

/// A box around a segment.
pub(super) fn bounds(curve: &Segment<f64>) -> AABB<[f64; 2]> {
    let points = match curve {
        Segment::Arc(arc) => {
            let (centre, radius) = (arc.centre(), arc.radius.norm());
            let corner = Complex::new(radius, radius);
            vec![centre - corner, centre + corner]
        }
        Segment::Line(line) => vec![line.start, line.end],
        Segment::Ph(curve) => curve.control_points().to_vec(),
        // No motion becomes one.
        Segment::Spline(_) => Vec::new(),
    };
    let far = f64::INFINITY;
    let (low, high) = points.iter().fold(([far; 2], [-far; 2]), |(low, high), p| {
        ([p.re.min(low[0]), p.im.min(low[1])], [p.re.max(high[0]), p.im.max(high[1])])
    });
    AABB::from_corners(low.map(|x| x - NEAR), high.map(|x| x + NEAR))
}

/// The parameter at which a line or an arc passes through a point, but for its ends.
fn passes(curve: &Segment<f64>, at: Complex<f64>) -> Option<f64> {
    if !matches!(curve, Segment::Line(_) | Segment::Arc(_)) {
        return None;
    }
    let xi = nearest(curve, at);
    let margin = NEAR / curve.length();
    let is_inside = xi > margin && xi < 1.0 - margin;
    (is_inside && (curve.point(xi) - at).norm() <= NEAR).then_some(xi)
}

/// The parameter of a segment's point that is nearest to another one.
pub(super) fn nearest(curve: &Segment<f64>, at: Complex<f64>) -> f64 {
    match curve {
        Segment::Line(line) => {
            let chord = line.end - line.start;
            ((at - line.start).dot(chord) / chord.norm_sqr()).clamp(0.0, 1.0)
        }
        Segment::Arc(arc) => {
            let angle = (arc.radius.conj() * (at - arc.centre())).arg();
            let whole = if angle * arc.sweep < 0.0 { angle + std::f64::consts::TAU.copysign(arc.sweep) } else { angle };
            // Just before the start is nearer to it than to the end.
            let xi = whole / arc.sweep;
            let behind = (arc.point(1.0) - at).norm() > (arc.start - at).norm();
            if xi <= 1.0 {
                xi
            } else if behind {
                0.0
            } else {
                1.0
            }
        }
        Segment::Ph(_) | Segment::Spline(_) => {
            // Steps that leave the second derivative out end there, if it is near.
            const SAMPLES: u32 = 64;
            const STEPS: u32 = 20;
            let samples = (0..=SAMPLES).map(|k| f64::from(k) / f64::from(SAMPLES));
            let off = |xi: f64| (curve.point(xi) - at).norm_sqr();
            let start = samples.min_by(|&a, &b| off(a).total_cmp(&off(b))).unwrap_or(0.0);
            (0..STEPS).fold(start, |xi, _| {
                let slope = curve.derivative(xi);
                (xi - (curve.point(xi) - at).dot(slope) / slope.norm_sqr()).clamp(0.0, 1.0)
            })
        }
    }
}

//! Stretches in a spatial index: what is near to a point, and what is near to each other.

use rstar::{AABB, PointDistance, RTree, RTreeObject};
use shared::complex::Complex;

use super::foot::{Foot, foot};
use super::stretch::Stretch;

/// A set of stretches under an R*-tree of their boxes. Building it takes n log n, a look-up log n.
#[derive(Debug)]
pub struct Field {
    stretches: Vec<Stretch>,
    tree: RTree<Entry>,
}

/// A stretch's box in the tree.
#[derive(Clone, Copy, Debug)]
struct Entry {
    number: usize,
    bounds: AABB<[f64; 2]>,
}

impl RTreeObject for Entry {
    type Envelope = AABB<[f64; 2]>;

    fn envelope(&self) -> Self::Envelope {
        self.bounds
    }
}

impl PointDistance for Entry {
    /// The square of the distance from the box: never more than that from the stretch.
    fn distance_2(&self, &[x, y]: &[f64; 2]) -> f64 {
        let (low, high) = (self.bounds.lower(), self.bounds.upper());
        let outside = |value: f64, low: f64, high: f64| (low - value).max(value - high).max(0.0);
        let (dx, dy) = (outside(x, low[0], high[0]), outside(y, low[1], high[1]));
        dx * dx + dy * dy
    }
}

impl Field {
    /// An index of `stretches`; they keep their numbers.
    pub fn new(stretches: Vec<Stretch>) -> Self {
        let boxed = |(number, stretch): (usize, &Stretch)| {
            let [low, high] = stretch.bounds();
            Entry { number, bounds: AABB::from_corners([low.re, low.im], [high.re, high.im]) }
        };
        let tree = RTree::bulk_load(stretches.iter().enumerate().map(boxed).collect());
        Self { stretches, tree }
    }

    /// All stretches, by number.
    pub fn stretches(&self) -> &[Stretch] {
        &self.stretches
    }

    /// The nearest place on any stretch, if one is nearer to `point` than `limit`.
    pub fn nearest(&self, point: Complex<f64>, limit: f64) -> Option<(usize, Foot)> {
        let mut best: Option<(usize, Foot)> = None;
        let mut limit = limit;
        for (entry, distance_sqr) in self.tree.nearest_neighbor_iter_with_distance_2([point.re, point.im]) {
            if distance_sqr > limit * limit {
                break;
            }
            if let Some(stretch) = self.stretches.get(entry.number) {
                let here = foot(stretch, point);
                if here.distance < limit {
                    limit = here.distance;
                    best = Some((entry.number, here));
                }
            }
        }
        best
    }

    /// The distance of some stretch that is nearer to `point` than `limit`; not always the nearest. None if there is none.
    pub fn any_nearer(&self, point: Complex<f64>, limit: f64) -> Option<f64> {
        self.tree
            .nearest_neighbor_iter_with_distance_2([point.re, point.im])
            .take_while(|(_, distance_sqr)| *distance_sqr <= limit * limit)
            .filter_map(|(entry, _)| Some(foot(self.stretches.get(entry.number)?, point).distance))
            .find(|&distance| distance < limit)
    }

    /// Calls `look` for every two stretches whose boxes meet, once, the lower number first.
    pub fn pairs(&self, mut look: impl FnMut(usize, usize)) {
        for entry in &self.tree {
            for other in self.tree.locate_in_envelope_intersecting(entry.bounds) {
                if entry.number < other.number {
                    look(entry.number, other.number);
                }
            }
        }
    }
}

//! Stretches in a spatial index: what is near to a point, and what is near to each other.

use rstar::{AABB, PointDistance, RTree, RTreeObject};
use shared::complex::Complex;

use super::foot::{Foot, foot};
use super::stretch::Stretch;

/// A set of stretches under an R*-tree of their boxes. Building it takes n log n, a look-up log n.
#[derive(Debug)]
pub struct Field {
    stretches: Vec<Stretch>,
    hulls: Vec<Hull>,
    tree: RTree<Entry>,
}

/// A triangle around a stretch, wider on all sides by a margin.
#[derive(Clone, Copy, Debug)]
struct Hull {
    corners: [Complex<f64>; 3],
    margin: f64,
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
        let hulls: Vec<Hull> =
            stretches.iter().map(Stretch::hull).map(|(corners, margin)| Hull { corners, margin }).collect();
        let boxed = |(number, hull): (usize, &Hull)| Entry { number, bounds: hull.bounds() };
        let tree = RTree::bulk_load(hulls.iter().enumerate().map(boxed).collect());
        Self { stretches, hulls, tree }
    }

    /// All stretches, by number.
    pub fn stretches(&self) -> &[Stretch] {
        &self.stretches
    }

    /// The nearest place on any stretch, if one is nearer to `point` than `limit`.
    pub fn nearest(&self, point: Complex<f64>, limit: f64) -> Option<(usize, Foot)> {
        self.nearest_but(point, limit, |_| 0.0)
    }

    /// The same where a stretch counts as farther away by what `slack` says for its number, which is not below zero.
    pub fn nearest_but(&self, point: Complex<f64>, limit: f64, slack: impl Fn(usize) -> f64) -> Option<(usize, Foot)> {
        let mut best: Option<(usize, Foot)> = None;
        let mut limit = limit;
        for (entry, distance_sqr) in self.tree.nearest_neighbor_iter_with_distance_2([point.re, point.im]) {
            if distance_sqr > limit * limit {
                break;
            }
            let Some(stretch) = self.stretches.get(entry.number) else { continue };
            let here = foot(stretch, point);
            let distance = here.distance + slack(entry.number);
            if distance < limit {
                limit = distance;
                best = Some((entry.number, Foot { distance, ..here }));
            }
        }
        best
    }

    /// Whether some stretch is nearer to `point` than `limit`, with the same slack. It ends at the first one that is.
    pub fn any_nearer(&self, point: Complex<f64>, limit: f64, slack: impl Fn(usize) -> f64) -> bool {
        self.tree
            .nearest_neighbor_iter_with_distance_2([point.re, point.im])
            .take_while(|(_, distance_sqr)| *distance_sqr <= limit * limit)
            .filter_map(|(entry, _)| Some((entry.number, foot(self.stretches.get(entry.number)?, point))))
            .any(|(number, foot)| foot.distance + slack(number) < limit)
    }

    /// Calls `look` for every two stretches whose triangles meet, once, the lower number first.
    pub fn pairs(&self, mut look: impl FnMut(usize, usize)) {
        for entry in &self.tree {
            for other in self.tree.locate_in_envelope_intersecting(entry.bounds) {
                let (a, b) = (entry.number, other.number);
                if a < b
                    && let (Some(one), Some(two)) = (self.hulls.get(a), self.hulls.get(b))
                    && !one.apart_from(two)
                    && !two.apart_from(one)
                {
                    look(a, b);
                }
            }
        }
    }
}

impl Hull {
    /// The box around the triangle.
    fn bounds(&self) -> AABB<[f64; 2]> {
        let far = f64::INFINITY;
        let (low, high) = self.corners.iter().fold(([far, far], [-far, -far]), |(low, high), p| {
            ([p.re.min(low[0]), p.im.min(low[1])], [p.re.max(high[0]), p.im.max(high[1])])
        });
        let margin = self.margin;
        AABB::from_corners(low.map(|x| x - margin), high.map(|x| x + margin))
    }

    /// Whether the line along a side of this triangle parts the two.
    fn apart_from(&self, other: &Self) -> bool {
        let [a, b, c] = self.corners;
        let margin = self.margin + other.margin;
        [(a, b, c), (b, c, a), (c, a, b)].into_iter().any(|(from, to, third)| {
            let normal = (to - from).left();
            let slack = margin * (normal.re.abs() + normal.im.abs());
            let height = |p: Complex<f64>| normal.dot(p - from);
            let [low, high] = spread([0.0, 0.0, height(third)]);
            let [least, most] = spread(other.corners.map(height));
            least > high + slack || most < low - slack
        })
    }
}

/// The least and the greatest of three.
fn spread([a, b, c]: [f64; 3]) -> [f64; 2] {
    [a.min(b).min(c), a.max(b).max(c)]
}

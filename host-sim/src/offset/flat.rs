//! Trim points that are too flat to be found as crossings.
//!
//! Where two strands pass each other under a small angle a, over a length l, they differ in height by a l / 2. At a concave node
//! that turns by a, l is |d| a; at the mouth of a neck, l is the neck's width. If that height drowns in rounding, no sign tells
//! that they cross. But then the ends that reach beyond the crossing reach so little beyond it that C is no nearer to them than
//! |d|, to rounding. So such ends are looked for, and joined half-way.

use rstar::RTree;
use rstar::primitives::GeomWithData;

use super::bury::Cover;
use super::ground::Ground;
use super::strand::Untrimmed;
use super::stretch::At;
use super::trace::{Joint, ROUNDING};

/// An end that is nearer to C than |d| by no more than this, in the unit of the frame and as a part of |d|, is not covered for
/// certain.
const UNCERTAIN: [f64; 2] = [1e-13, 1e-10];

/// Ends farther from each other than this do not belong together.
const NEAR: f64 = 1e-6;

/// The strands of an untrimmed offset, for joints that no sign tells.
pub struct Flat<'a> {
    ground: &'a Ground,
    untrimmed: &'a Untrimmed,
    covers: &'a [Cover],
    /// What is nearer to C than this is covered for certain.
    certain: f64,
}

impl<'a> Flat<'a> {
    /// The strands of the offset at |d| = `limit`, with what covers each.
    pub fn new(ground: &'a Ground, untrimmed: &'a Untrimmed, covers: &'a [Cover], limit: f64) -> Self {
        let [absolute, relative] = UNCERTAIN;
        let certain = limit - absolute.min(relative * limit).max(ROUNDING);
        Self { ground, untrimmed, covers, certain }
    }

    /// Joins ends of strands that nothing covers for certain with the nearest such beginnings.
    pub fn ends(&self) -> Vec<Joint> {
        let free = |number: usize| !self.ground.contour.closed && number == 0;
        let mut ends: Vec<(usize, At)> = Vec::new();
        let mut starts: Vec<GeomWithData<[f64; 2], (usize, At)>> = Vec::new();
        for k in (0..self.untrimmed.own).filter(|&k| self.cover(k).lives()) {
            if !self.goes_on(k) && !free(self.next(k)) {
                ends.extend(self.open_end(k, 0.5));
            }
            if !self.goes_on(self.before(k)) && !free(k) {
                let start = self.open_end(k, -0.5);
                starts.extend(start.map(|(k, at)| GeomWithData::new([at.point.re, at.point.im], (k, at))));
            }
        }
        let mut starts = RTree::bulk_load(starts);
        let mut joints = Vec::new();
        for (strand, end) in ends {
            let place = [end.point.re, end.point.im];
            let near = starts.nearest_neighbor_iter_with_distance_2(place).next();
            let Some(start) = near.filter(|(_, square)| *square < NEAR * NEAR).map(|(start, _)| *start) else {
                continue;
            };
            starts.remove(&start);
            joints.push(self.half_way((strand, &end), (start.data.0, &start.data.1)));
        }
        joints
    }

    /// At the mouth of a neck that is narrower than rounding can tell: strands that lead to a place which nothing covers for
    /// certain, with the strands that lead away from one so near that they overlap. The way comes along the latter and goes on along
    /// the former.
    ///
    /// That these are kept at all is not certain; whoever asks must see whether loops come of it.
    pub fn mouths(&self) -> Vec<Joint> {
        // From the covered end of a run into a clear strand, and from a clear strand into the covered beginning of one.
        let leading = |clear: usize, covered: usize, at: f64| {
            let both = self.cover(clear) == Cover::Clear && self.cover(covered) == Cover::Partly;
            both.then(|| self.open_end(covered, at)).flatten()
        };
        let pairs = || (0..self.untrimmed.own).map(|k| (k, self.next(k))).filter(|&(_, next)| self.follows(next));
        let into: Vec<(usize, At)> = pairs().filter_map(|(k, next)| leading(next, k, 0.5)).collect();
        let away: Vec<(usize, At)> = pairs().filter_map(|(k, next)| leading(k, next, -0.5)).collect();
        let mut joints = Vec::new();
        for (strand, end) in &into {
            for (other, start) in &away {
                let over = end.point - start.point;
                let along = over.dot(end.tangent) > 0.0 && end.tangent.dot(start.tangent) > 0.5;
                if over.norm() < NEAR && along && strand != other {
                    let Joint { ends, begins, exact } = self.half_way((*strand, end), (*other, start));
                    joints.push(Joint { ends: begins, begins: ends, exact });
                }
            }
        }
        joints
    }

    fn next(&self, k: usize) -> usize {
        if k + 1 < self.untrimmed.own { k + 1 } else { 0 }
    }

    fn before(&self, k: usize) -> usize {
        if k > 0 { k - 1 } else { self.untrimmed.own.saturating_sub(1) }
    }

    fn cover(&self, k: usize) -> Cover {
        self.covers.get(k).copied().unwrap_or(Cover::Buried)
    }

    fn follows(&self, k: usize) -> bool {
        self.untrimmed.strands.get(k).is_some_and(|strand| strand.follows)
    }

    /// Whether the next strand begins where strand `k` ends, and neither is buried.
    fn goes_on(&self, k: usize) -> bool {
        let next = self.next(k);
        self.cover(k).lives() && self.cover(next).lives() && self.follows(next)
    }

    /// The end of strand `k` at tau = `at`, if nothing covers it for certain.
    fn open_end(&self, k: usize, at: f64) -> Option<(usize, At)> {
        let strand = self.untrimmed.strands.get(k)?;
        let place = strand.stretch.at(at);
        let slack = |stretch: usize| self.ground.slack(strand.source, stretch);
        (!self.ground.field.any_nearer(place.point, self.certain, slack)).then_some((k, place))
    }

    /// The joint of an end with a beginning: where they stand over each other, half of that is cut from each.
    fn half_way(&self, (strand, end): (usize, &At), (other, start): (usize, &At)) -> Joint {
        let over = (end.point - start.point).dot(end.tangent).max(0.0) * 0.5;
        let cut = |number: usize, from: f64, to: f64, at: &At| {
            let Some(strand) = self.untrimmed.strands.get(number) else { return from };
            let ahead = |tau: f64| (strand.stretch.at(tau).point - at.point).dot(at.tangent).abs() - over;
            if over > 0.0 { zero_between(ahead, from, to) } else { from }
        };
        Joint {
            ends: (strand, cut(strand, 0.5, -0.5, end)),
            begins: (other, cut(other, -0.5, 0.5, start)),
            exact: true,
        }
    }
}

/// Where a function that rises from below zero at `from` passes zero before `to`, by halving; `to` where it does not.
fn zero_between(function: impl Fn(f64) -> f64, mut from: f64, mut to: f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (from + to);
        if function(middle) < 0.0 { from = middle } else { to = middle }
    }
    to
}

//! The control points of a spline and its knots, by the rule of the [module above](super).

use super::block::Number;
use super::fault::{Checked, Fault, Misplaced, Place, fail};
use crate::program::Feed;
use crate::program::item::Nurbs;

/// The most control points of one spline: memory is bounded, and no curve of a part has so many.
const MOST: usize = 100_000;

/// A spline while its blocks are read; it keeps its memory for the next one.
#[derive(Clone, Debug)]
pub struct Spline {
    /// The degree, 2 or 3.
    pub degree: usize,
    /// The feed of the whole of it.
    pub feed: Feed,
    /// The line and column of its first point, from 1.
    pub begins: (usize, usize),
    /// The line and column of its last point.
    last: (usize, usize),
    points: Vec<[f64; 3]>,
    weights: Vec<f64>,
    knots: Vec<f64>,
    /// How many intervals of 0 stand at the end.
    zeros: usize,
}

impl Spline {
    /// The degree where no SD says another one.
    pub const DEGREE: usize = 3;

    /// No spline.
    pub fn new() -> Self {
        let (points, weights, knots) = (Vec::new(), Vec::new(), Vec::new());
        Self { degree: Self::DEGREE, feed: Feed::Unset, begins: (0, 0), last: (0, 0), points, weights, knots, zeros: 0 }
    }

    /// Whether it has a point.
    pub fn is_open(&self) -> bool {
        !self.points.is_empty()
    }

    /// Where it begins.
    pub fn start(&self) -> Option<[f64; 3]> {
        self.points.first().copied()
    }

    /// Begins at `start`, with a point at the line and column `place` behind it.
    pub fn begin(&mut self, start: [f64; 3], feed: Feed, place: (usize, usize)) {
        self.feed = feed;
        self.begins = place;
        self.zeros = 0;
        self.points.push(start);
        self.weights.push(1.0);
        self.knots.resize(self.degree + 1, 0.0);
    }

    /// Adds a point, which the block at the byte `at` asks for in the line and column `place`.
    pub fn add(
        &mut self,
        point: [f64; 3],
        weight: Option<Number>,
        interval: Option<Number>,
        at: usize,
        place: (usize, usize),
    ) -> Checked<()> {
        let (degree, index) = (self.degree, self.points.len());
        if index >= MOST {
            return fail(at, Fault::Many(MOST));
        }
        if let Some(Number { at, .. }) = weight.filter(|weight| weight.value <= 0.0) {
            return fail(at, Fault::Weight);
        }
        let length = interval.map_or(if index < degree { 0.0 } else { 1.0 }, |interval| interval.value);
        let at = interval.map_or(at, |interval| interval.at);
        if length < 0.0 {
            return fail(at, Fault::Negative);
        }
        if index < degree && length > 0.0 {
            return fail(at, Fault::EarlyInterval(degree));
        }
        if index == degree && length == 0.0 {
            return fail(at, Fault::FirstInterval(degree));
        }
        if index >= degree {
            self.zeros = if length == 0.0 { self.zeros + 1 } else { 0 };
            if self.zeros >= degree {
                return fail(at, Fault::Torn(degree));
            }
            let before = self.knots.last().copied().unwrap_or(0.0);
            self.knots.push(before + length);
        }
        self.points.push(point);
        self.weights.push(weight.map_or(1.0, |weight| weight.value));
        self.last = place;
        Ok(())
    }

    /// Puts the last knots behind the others. Errors: too few points, or the last interval is 0.
    pub fn close(&mut self) -> Checked<Nurbs<'_>> {
        let (line, column) = self.last;
        let fail = |fault| Err(Misplaced { place: Place::Before { line, column }, fault });
        if self.points.len() <= self.degree {
            return fail(Fault::Few(self.points.len(), self.degree + 1));
        }
        if self.zeros > 0 {
            return fail(Fault::LastInterval);
        }
        let end = self.knots.last().copied().unwrap_or(0.0);
        self.knots.resize(self.points.len() + self.degree + 1, end);
        Ok(Nurbs { order: self.degree + 1, points: &self.points, weights: &self.weights, knots: &self.knots })
    }

    /// Forgets the points.
    pub fn clear(&mut self) {
        self.points.clear();
        self.weights.clear();
        self.knots.clear();
    }
}

//! The way of the tool's centre as a grid of places.

use shared::curve::Segment;

use super::manner::{Manner, Rests};
use crate::contour::SMOOTH;
use crate::path::{Path, PathPiece, Space};
use crate::strokes::Entry;
use crate::vector::Vector;

/// One place on the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The number of the piece.
    pub piece: usize,
    /// The parameter on its segment.
    pub xi: f64,
    /// The fraction of its contact length that lies behind, 0..=1 (that of the arc's angle on a fill arc).
    pub fraction: f64,
    /// The way from the place before, in mm; 0 at the first place of a piece.
    pub step: f64,
    /// The unit tangent.
    pub direction: Vector,
    /// The curvature of the centre's way as a vector: the derivative of the direction by the way, in 1/mm.
    pub bend: Vector,
    /// How far the centre moves for a unit of the length that the feed is along: |1 + kappa d| where z stays ([`crate::path::Space`]).
    pub stretch: f64,
    /// The derivative of that along this length, in 1/mm.
    pub stretching: f64,
    /// The centre's feed at the job's own V, without ramps, in mm/s.
    pub feed: f64,
    /// Whether the way turns between the place before and this one: both stand on one corner.
    pub is_corner: bool,
    /// Whether the motion rests between the place before and this one.
    pub is_rest: bool,
}

impl Place {
    /// The curvature in 1/mm, whatever its side.
    pub fn curvature(&self) -> f64 {
        self.bend.norm()
    }

    /// By how much the curvature changes on the way from the place before, beside turning with the way, in 1/mm.
    pub fn bending(&self, before: &Self) -> Vector {
        let turning = 0.5 * (self.bend.dot(self.bend) + before.bend.dot(before.bend)) * self.step;
        self.bend - before.bend + (self.direction + before.direction) * (0.5 * turning)
    }
}

/// All places, in order.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// The places; the last one of a piece and the first one of the next stand at one point.
    pub places: Vec<Place>,
    /// The speeds at which it begins and ends, in mm/s; none where that is free.
    pub ends: [Option<f64>; 2],
}

impl Course {
    /// The way of a path, in steps of at most about `step` mm and at least sixteen a piece.
    pub fn new(path: &Path, step: f64) -> Self {
        // A plan begins and ends at rest by itself.
        let rest = (path.header.rest || path.is_planned()).then_some(0.0);
        let even = |_: usize, piece: &PathPiece| {
            let count = (piece.centre_length() / step).ceil().clamp(16.0, 1e6) as u32;
            (0..=count).map(|k| f64::from(k) / f64::from(count)).collect()
        };
        Self { places: places(&path.pieces, path.weight, even), ends: [rest; 2] }
    }

    /// The way of some pieces through the places that `parts` says for each, by its number: parts of its parameter interval, from 0 to 1.
    pub fn through(
        pieces: &[PathPiece],
        weight: f64,
        manner: &Manner,
        parts: impl FnMut(usize, &PathPiece) -> Vec<f64>,
    ) -> Self {
        let mut places = places(pieces, weight, parts);
        if manner.reductions {
            reduce(&mut places, pieces);
        }
        for k in 1..places.len() {
            let (before, after) = (places[k - 1].piece, places[k].piece);
            let is_node = before != after && pieces[before].segment != pieces[after].segment;
            let place = &mut places[k];
            // What a program asks for itself holds beside the manner.
            let entry = pieces[after].entry;
            let in_corner = manner.rests == Rests::InCorners || entry == Entry::RestInCorner;
            let at_node = manner.rests == Rests::AtNodes || entry == Entry::Rest;
            place.is_rest = (in_corner && place.is_corner) || (at_node && is_node);
        }
        Self { places, ends: manner.ends }
    }

    /// Its length in mm.
    pub fn length(&self) -> f64 {
        self.places.iter().map(|place| place.step).sum()
    }
}

/// Lowers the feed at corners to what the job's own ramps leave of it.
fn reduce(places: &mut [Place], pieces: &[PathPiece]) {
    let last = places.len().saturating_sub(1);
    for k in 0..places.len() {
        let number = places[k].piece;
        let is_first = k == 0 || places[k - 1].piece != number;
        let is_last = k == last || places[k + 1].piece != number;
        let ramp = match (is_first, is_last) {
            (true, _) => pieces[number].start,
            (_, true) => pieces[number].end,
            _ => None,
        };
        places[k].feed *= ramp.map_or(1.0, |ramp| ramp.factor);
    }
}

/// The places of pieces, at the parts of each that `parts` says.
fn places(pieces: &[PathPiece], weight: f64, mut parts: impl FnMut(usize, &PathPiece) -> Vec<f64>) -> Vec<Place> {
    let mut places: Vec<Place> = Vec::new();
    for (number, piece) in pieces.iter().enumerate() {
        let [from, to] = piece.interval;
        let lengths = [from, to].map(|xi| piece.way_to(xi));
        let mut before = from;
        for (k, part) in parts(number, piece).into_iter().enumerate() {
            let xi = if part == 1.0 { to } else { from + (to - from) * part };
            let step = if k == 0 { 0.0 } else { length(piece, before, xi) };
            before = xi;
            let mut place = place(piece, weight, xi);
            (place.piece, place.step) = (number, step);
            place.fraction =
                if part == 1.0 { 1.0 } else { (piece.way_to(xi) - lengths[0]) / (lengths[1] - lengths[0]) };
            let turns = |last: &Place| (last.direction - place.direction).norm() > SMOOTH;
            place.is_corner = k == 0 && places.last().is_some_and(turns);
            places.push(place);
        }
    }
    places
}

/// The centre's speed |1 + kappa d| sigma, by Simpson's rule.
fn length(piece: &PathPiece, from: f64, to: f64) -> f64 {
    let speed = |xi: f64| piece.space(xi).stretch * piece.way_speed(xi);
    if let Segment::Line(_) = piece.segment {
        return speed(from) * (to - from);
    }
    (speed(from) + 4.0 * speed(0.5 * (from + to)) + speed(to)) * (to - from) / 6.0
}

fn place(piece: &PathPiece, weight: f64, xi: f64) -> Place {
    let Space { direction, bend, stretch, stretching } = piece.space(xi);
    let rise = piece.height.map_or(1.0, |height| height.stretch());
    Place {
        piece: 0,
        xi,
        fraction: 0.0,
        step: 0.0,
        direction,
        bend,
        stretch,
        stretching,
        // Equation (20): V_d = V ((1 - w) |1 + kappa d| + w).
        feed: if piece.is_rapid { f64::INFINITY } else { piece.wish * ((1.0 - weight) * stretch + weight * rise) },
        is_corner: false,
        is_rest: false,
    }
}

#[cfg(test)]
mod tests {
    use shared::piece::Order;

    use super::*;
    use crate::job::Job;

    /// An offset to both sides of an arc: its length, its curvature, and its feed at both weights.
    #[test]
    fn the_offset_of_an_arc_is_an_arc() {
        for (distance, weight) in [(2.0, 0.0), (2.0, 1.0), (-3.0, 0.5)] {
            let text = format!(
                "units = \"mm\"\nclosed = true\n[offset]\ndistance = {distance}\n[feed]\nrate = 600.0\nweight = {weight}\n\
                 [[segment]]\narc = {{ start = [10.0, 0.0], to = [10.0, 0.0], centre = [0.0, 0.0], ccw = true }}\n"
            );
            let path = Path::new(&Job::from_toml("job.toml", &text).unwrap(), Order::First).unwrap();
            let course = Course::new(&path, 0.1);
            let radius = 10.0 + distance;
            assert!((course.length() / (std::f64::consts::TAU * radius) - 1.0).abs() < 1e-9);
            for place in &course.places {
                assert!((place.curvature() * radius - 1.0).abs() < 1e-12 && !place.is_corner);
                let stretch = radius / 10.0;
                assert!((place.feed - 10.0 * ((1.0 - weight) * stretch + weight)).abs() < 1e-12);
            }
        }
    }
}

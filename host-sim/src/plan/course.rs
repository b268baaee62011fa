//! The way of the tool's centre as a grid of places.

use shared::complex::Complex;
use shared::curve::Curve as _;

use crate::contour::SMOOTH;
use crate::path::{Path, PathPiece};

/// One place on the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The number of the piece.
    pub piece: usize,
    /// The way from the place before, in mm; 0 at the first place of a piece.
    pub step: f64,
    /// The unit tangent.
    pub direction: Complex<f64>,
    /// The curvature of the centre's way in 1/mm, positive to the left.
    pub curvature: f64,
    /// The centre's feed at the job's own V, without ramps, in mm/s.
    pub feed: f64,
    /// Whether the way turns between the place before and this one: both stand on one corner.
    pub is_corner: bool,
}

/// All places, in order.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// The places; the last one of a piece and the first one of the next stand at one point.
    pub places: Vec<Place>,
    /// Whether it begins and ends at rest.
    pub rest: bool,
}

impl Course {
    /// The way of a path, in steps of at most about `step` mm and at least sixteen a piece.
    pub fn new(path: &Path, step: f64) -> Self {
        let mut places: Vec<Place> = Vec::new();
        for (number, piece) in path.pieces.iter().enumerate() {
            let count = (piece.centre_length() / step).ceil().clamp(16.0, 1e6) as u32;
            let [from, to] = piece.interval;
            let width = (to - from) / f64::from(count);
            for k in 0..=count {
                let xi = if k == count { to } else { from + width * f64::from(k) };
                // The middle of the step before, for its length: Simpson's rule.
                let before = if k == 0 { 0.0 } else { length(piece, xi - width, xi) };
                let place = place(piece, path.weight, number, xi, before);
                let turns = |last: &Place| {
                    last.direction.cross(place.direction).abs() > SMOOTH || last.direction.dot(place.direction) < 0.0
                };
                let is_corner = k == 0 && places.last().is_some_and(turns);
                places.push(Place { is_corner, ..place });
            }
        }
        Self { places, rest: path.header.rest }
    }

    /// Its length in mm.
    pub fn length(&self) -> f64 {
        self.places.iter().map(|place| place.step).sum()
    }
}

/// The centre's speed |1 + kappa d| sigma, by Simpson's rule.
fn length(piece: &PathPiece, from: f64, to: f64) -> f64 {
    let speed = |xi: f64| piece.stretch(xi) * piece.segment.speed(xi);
    (speed(from) + 4.0 * speed(0.5 * (from + to)) + speed(to)) * (to - from) / 6.0
}

fn place(piece: &PathPiece, weight: f64, number: usize, xi: f64, step: f64) -> Place {
    let stretch = piece.stretch(xi);
    let kappa = piece.segment.curvature(xi);
    // The tangents of curve and offset turn alike, over lengths in the ratio |1 + kappa d|; backwards the turn per length changes sign.
    let curvature = if piece.is_forward() { kappa / stretch } else { -kappa / stretch };
    Place {
        piece: number,
        step,
        direction: piece.direction(xi),
        curvature,
        // Equation (20): V_d = V ((1 - w) |1 + kappa d| + w).
        feed: piece.feed * ((1.0 - weight) * stretch + weight),
        is_corner: false,
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
                assert!((place.curvature * radius - 1.0).abs() < 1e-12 && !place.is_corner);
                let stretch = radius / 10.0;
                assert!((place.feed - 10.0 * ((1.0 - weight) * stretch + weight)).abs() < 1e-12);
            }
        }
    }
}

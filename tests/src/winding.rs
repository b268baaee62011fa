//! How often a closed curve goes around a point, by a polygon that follows it closely.

use host_sim::contour::Contour;
use host_sim::offset::Loop;
use shared::complex::Complex;
use shared::curve::{Curve as _, Segment};

/// Chords of a curved piece.
const CHORDS: u32 = 64;

/// A closed polygon that follows a curve, and how far it may be off it.
#[derive(Clone, Debug)]
pub struct Polygon {
    points: Vec<Complex<f64>>,
    /// A bound of the distance between curve and polygon, estimated from the bends of the polygon.
    pub off: f64,
}

impl Polygon {
    /// Of a closed contour.
    pub fn of_contour(contour: &Contour) -> Self {
        Self::new(contour.segments.iter().map(|segment| (*segment, [0.0, 1.0], 0.0)))
    }

    /// Of a closed loop of an offset.
    pub fn of_loop(contour: &Contour, distance: f64, ring: &Loop) -> Self {
        Self::new(ring.pieces.iter().filter_map(|piece| contour.carrier(piece.along, distance)))
    }

    fn new(curves: impl Iterator<Item = (Segment<f64>, [f64; 2], f64)>) -> Self {
        let mut points = Vec::new();
        let mut off = 0.0_f64;
        for (segment, [from, to], offset) in curves {
            let at = |x: f64| segment.offset_point(from + (to - from) * x, offset);
            let chords = if matches!(segment, Segment::Line(_)) { 1 } else { CHORDS };
            for k in 0..chords {
                let [a, b] = [k, k + 1].map(|k| at(f64::from(k) / f64::from(chords)));
                points.push(a);
                if chords > 1 {
                    let middle = at((f64::from(k) + 0.5) / f64::from(chords));
                    off = off.max((middle - (a + b) * 0.5).norm());
                }
            }
        }
        Self { points, off: 2.0 * off }
    }

    /// The corners.
    pub fn points(&self) -> &[Complex<f64>] {
        &self.points
    }

    /// How often it goes around `p`, anticlockwise positive.
    pub fn winding(&self, p: Complex<f64>) -> i32 {
        let mut turns = 0;
        for (k, a) in self.points.iter().enumerate() {
            let b = self.points[(k + 1) % self.points.len()];
            // Crossings of the ray to the right.
            if (a.im <= p.im) != (b.im <= p.im) {
                let side = (b - *a).cross(p - *a);
                if b.im > a.im && side > 0.0 {
                    turns += 1;
                } else if b.im <= a.im && side < 0.0 {
                    turns -= 1;
                }
            }
        }
        turns
    }

    /// The distance of `p` from the polygon.
    pub fn distance(&self, p: Complex<f64>) -> f64 {
        let edges = self.points.iter().enumerate().map(|(k, a)| (*a, self.points[(k + 1) % self.points.len()]));
        edges.fold(f64::INFINITY, |least, (a, b)| {
            let chord = b - a;
            let square = chord.norm_sqr();
            let t = if square > 0.0 { ((p - a).dot(chord) / square).clamp(0.0, 1.0) } else { 0.0 };
            least.min((p - a - chord * t).norm())
        })
    }
}

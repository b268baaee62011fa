//! Whether the way in stays clear of a round.

use rstar::{AABB, RTree, RTreeObject};
use shared::complex::Complex;
use shared::curve::{Curve as _, Segment};

use super::chain::{bounds, nearest};

/// Points of the way in at which its distance is looked at before the nearest place is narrowed down.
const LOOKS: u32 = 64;

/// Halvings of the interval around the nearest of them.
const STEPS: u32 = 40;

struct Boxed<'a> {
    curve: &'a Segment<f64>,
    bounds: AABB<[f64; 2]>,
}

impl RTreeObject for Boxed<'_> {
    type Envelope = AABB<[f64; 2]>;

    fn envelope(&self) -> Self::Envelope {
        self.bounds
    }
}

/// Where a way comes nearest to some segments, if that is nearer than the radius: by how much, and the point there.
pub(super) fn too_near<'a>(
    way: &[Segment<f64>],
    part: impl Iterator<Item = &'a Segment<f64>>,
    radius: f64,
) -> Option<(f64, Complex<f64>)> {
    let part = RTree::bulk_load(part.map(|curve| Boxed { curve, bounds: bounds(curve) }).collect());
    let mut worst: Option<(f64, Complex<f64>)> = None;
    for way in way {
        let around = bounds(way);
        let around = AABB::from_corners(around.lower().map(|x| x - radius), around.upper().map(|x| x + radius));
        for near in part.locate_in_envelope_intersecting(around) {
            let foot = |xi: f64| {
                let at = way.point(xi);
                let foot = near.curve.point(nearest(near.curve, at));
                ((foot - at).norm(), foot)
            };
            let looks = (0..=LOOKS).map(|k| f64::from(k) / f64::from(LOOKS));
            let Some(best) = looks.min_by(|&a, &b| foot(a).0.total_cmp(&foot(b).0)) else { continue };
            let (mut at, mut width) = (best, 1.0 / f64::from(LOOKS));
            for _ in 0..STEPS {
                let sides = [at - width, at, at + width].map(|xi| xi.clamp(0.0, 1.0));
                at = sides.into_iter().min_by(|&a, &b| foot(a).0.total_cmp(&foot(b).0)).unwrap_or(at);
                width *= 0.5;
            }
            let (distance, place) = foot(at);
            if distance < radius && worst.is_none_or(|(depth, _)| radius - distance > depth) {
                worst = Some((radius - distance, place));
            }
        }
    }
    worst
}

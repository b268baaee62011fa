//! Arcs among cubic curves.
//!
//! The usual cubic curve for an arc of the angle a touches the circle at its ends, with control points 4/3 tan(a/4) of the
//! radius away. All programs draw arcs by it, `usvg` among them, up to a quarter of a circle each.

use crate::program::item::{Arc, Plane};

/// The angles that are looked for: no program uses wider ones, and narrow ones are as good as what is drawn.
const ANGLES: std::ops::Range<f64> = 0.02..1.6;
/// A control point is so many roundings away from its end, or nothing is certain.
const CERTAIN: f64 = 500.0;

/// The arc that a curve in XY stands for, if its control points are within `rounding` of those of one.
pub fn arc(from: [f64; 3], points: [[f64; 3]; 3], rounding: f64) -> Option<Arc> {
    let [p1, p2, to] = points;
    let between = |p: [f64; 3], q: [f64; 3]| [q[0] - p[0], q[1] - p[1]];
    let (first, last, chord) = (between(from, p1), between(p2, to), between(from, to));
    let length = |v: [f64; 2]| v[0].hypot(v[1]);
    if length(first).min(length(last)) < CERTAIN * rounding {
        return None;
    }
    let angle = (first[0] * last[1] - first[1] * last[0]).atan2(first[0] * last[0] + first[1] * last[1]);
    if !ANGLES.contains(&angle.abs()) {
        return None;
    }
    // Along the chord and to the left of it: the tangents at the ends are turned by half of the angle.
    let (sin, cos) = (0.5 * angle).sin_cos();
    let half = 0.5 * length(chord);
    let (along, left) = (chord.map(|x| x / (2.0 * half)), [-chord[1] / (2.0 * half), chord[0] / (2.0 * half)]);
    let radius = half / sin;
    let arm = 4.0 / 3.0 * (0.25 * angle).tan() * radius;
    let near = |found: [f64; 2], left_by: f64| {
        (0..2).all(|k| (found[k] - arm * (along[k] * cos + left[k] * left_by)).abs() <= rounding)
    };
    if !(near(first, -sin) && near(last, sin)) {
        return None;
    }
    let centre = std::array::from_fn(|k| 0.5 * (from[k] + to[k]) + left[k] * radius * cos);
    Some(Arc { plane: Plane::Xy, centre, to, sweep: angle, turns: 0 })
}

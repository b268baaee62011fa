//! Where a polyline is smooth: the bending deflection [Bolsunovsky & Vermel, (SA 3); Faux & Pratt 1982].
//!
//! An arc through three vertices in a row leaves its two chords by their sagittas. Where a sagitta is above the tolerance, no smooth curve
//! through the vertices follows that segment: it is straight, and not the chord of anything. A vertex between two such segments is a corner.

use crate::vector::Vector;

/// What a polyline is at a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Vertex {
    /// On a curve.
    Smooth,
    /// Where a curve begins or ends smoothly at a straight segment: the one in front of it, or the one behind it.
    Tangent {
        /// Whether the straight one is in front.
        before: bool,
    },
    /// A tangent break, or an end.
    Corner,
}

/// The angle in radians from which on a straight segment does not go on smoothly: the first chord of an arc that begins there turns by half as
/// much as the others, and an arc of so few chords is nobody's curve.
const ABRUPT: f64 = 0.4;

/// See [`is_alone`].
const ALONE: f64 = 4.0;

/// The vertices of a polyline without repeated points.
pub(super) fn vertices(points: &[Vector], tolerance: f64) -> Vec<Vertex> {
    let of = |k: usize| {
        let (Some(before), Some(after)) = (k.checked_sub(1).map(|k| points[k]), points.get(k + 1)) else {
            return Vertex::Corner;
        };
        match sagittas(before, points[k], *after).map(|sagitta| sagitta > tolerance) {
            [false, false] if is_alone(points, k) => Vertex::Corner,
            [false, false] => Vertex::Smooth,
            [true, true] => Vertex::Corner,
            [straight, _] if turn(before, points[k], *after) < ABRUPT => Vertex::Tangent { before: straight },
            _ => Vertex::Corner,
        }
    };
    (0..points.len()).map(of).collect()
}

/// Whether the way turns abruptly at a vertex, and more than [`ALONE`] times as much as at both of its neighbours: between short segments a
/// corner deflects by less than any tolerance, and yet is one.
fn is_alone(points: &[Vector], k: usize) -> bool {
    let turn_at = |k: usize| match points.get(k.wrapping_sub(1)..k.wrapping_add(2)) {
        Some(&[a, b, c]) => turn(a, b, c),
        _ => 0.0,
    };
    let here = turn_at(k);
    here > ABRUPT && here > ALONE * turn_at(k.wrapping_sub(1)).max(turn_at(k + 1))
}

fn turn(a: Vector, b: Vector, c: Vector) -> f64 {
    let (before, after) = (b - a, c - b);
    before.cross(after).norm().atan2(before.dot(after))
}

/// How far the arc through three points leaves the chords between them.
pub(super) fn sagittas(a: Vector, b: Vector, c: Vector) -> [f64; 2] {
    let (before, after, whole) = (b - a, c - b, c - a);
    let across = before.cross(after).norm();
    let product = before.norm() * after.norm() * whole.norm();
    // Back on the way that it came.
    let turns_back = before.dot(after) < 0.0;
    // 1/R = 2 |a x b|/(|a| |b| |c|).
    let curvature = 2.0 * across / product;
    [before, after].map(|chord| {
        let half = 0.5 * chord.norm();
        if turns_back {
            return half;
        }
        let sine = (half * curvature).min(1.0);
        // R (1 - cos) without a difference of equal numbers.
        half * sine / (1.0 + (1.0 - sine * sine).sqrt())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chords_of_a_circle_have_its_sagitta() {
        let on = |angle: f64| Vector([3.0 * angle.cos(), 3.0 * angle.sin(), 1.0]);
        let [a, b] = sagittas(on(0.0), on(0.2), on(0.5));
        assert!((a - 3.0 * (1.0 - 0.1_f64.cos())).abs() < 1e-12 && (b - 3.0 * (1.0 - 0.15_f64.cos())).abs() < 1e-12);
    }

    /// A line of 10 mm into an arc of 1 mm radius, in chords of 0.1 rad, and a right angle.
    #[test]
    fn a_line_an_arc_and_a_corner() {
        let on = |k: i32| Vector([(0.1 * f64::from(k)).sin(), 1.0 - (0.1 * f64::from(k)).cos(), 0.0]);
        let mut points = vec![Vector([-10.0, 0.0, 0.0])];
        points.extend((0..=8).map(on));
        points.push(on(8) + Vector([-10.0, 0.0, 0.0]));
        let kinds = vertices(&points, 0.002);
        assert_eq!(kinds[1], Vertex::Tangent { before: true });
        assert!(kinds[2..9].iter().all(|&kind| kind == Vertex::Smooth));
        assert_eq!([kinds[0], kinds[9], kinds[10]], [Vertex::Corner; 3]);
    }

    /// Steps of 0.01 mm around a right angle: a corner under any tolerance. The vertices of a hexagon of that size are none under 0.1 mm.
    #[test]
    fn a_corner_between_short_segments_is_one() {
        let points: Vec<Vector> =
            (-5..=5).map(|k| f64::from(k) * 0.01).map(|x| Vector([x.min(0.0), x.max(0.0), 0.0])).collect();
        for (k, kind) in vertices(&points, 0.1).into_iter().enumerate().skip(1).take(9) {
            assert_eq!(kind, if k == 5 { Vertex::Corner } else { Vertex::Smooth }, "{k}");
        }
        let hexagon: Vec<Vector> = (0..7)
            .map(|k| f64::from(k) * std::f64::consts::FRAC_PI_3)
            .map(|a| Vector([0.01 * a.cos(), 0.01 * a.sin(), 0.0]))
            .collect();
        assert!(vertices(&hexagon, 0.1)[1..6].iter().all(|&kind| kind == Vertex::Smooth));
    }
}

//! Lines with rounded breaks: what a control makes of a program under a tolerance (G64 P), arc by arc.
//!
//! At a break that turns by theta an arc begins and ends t before and behind the vertex, and passes it at t tan(theta/4). So t is what the
//! tolerance lets it be, and at most half of each line: where lines are short, arc follows arc, and they are as round as the curve that the
//! lines stand for.

use crate::vector::Vector;

/// A part of a rounded polyline, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rounded {
    /// A line.
    Line([Vector; 2]),
    /// An arc from one point to another, about a centre, turning by an angle in radians.
    Arc {
        /// Start and end.
        ends: [Vector; 2],
        /// The centre.
        centre: Vector,
        /// The angle.
        angle: f64,
    },
}

/// A break that is none, in radians.
const STRAIGHT: f64 = 1e-9;

/// A turn that no arc rounds: the way goes back.
const BACK: f64 = 3.1;

/// A polyline with an arc at each of its breaks that is at most `tolerance` mm from its vertex.
pub fn rounded(points: &[Vector], tolerance: f64) -> Vec<Rounded> {
    let mut parts = Vec::with_capacity(2 * points.len());
    let Some(&(mut at)) = points.first() else { return parts };
    for window in points.windows(3) {
        let [before, vertex, after] = [window[0], window[1], window[2]];
        if let Some(arc) = arc(before, vertex, after, tolerance) {
            if let Rounded::Arc { ends: [start, end], .. } = arc {
                line(&mut parts, at, start);
                at = end;
            }
            parts.push(arc);
        } else {
            line(&mut parts, at, vertex);
            at = vertex;
        }
    }
    if let Some(&end) = points.last() {
        line(&mut parts, at, end);
    }
    parts
}

fn line(parts: &mut Vec<Rounded>, from: Vector, to: Vector) {
    /// What is left between two arcs that meet.
    const NONE: f64 = 1e-9;
    if (to - from).norm() > NONE {
        parts.push(Rounded::Line([from, to]));
    }
}

fn arc(before: Vector, vertex: Vector, after: Vector, tolerance: f64) -> Option<Rounded> {
    let [into, out] = [(vertex - before).unit()?, (after - vertex).unit()?];
    let angle = into.angle(out);
    if !(STRAIGHT..BACK).contains(&angle) {
        return None;
    }
    let reach = 0.5 * (vertex - before).norm().min((after - vertex).norm());
    let reach = reach.min(tolerance / (0.25 * angle).tan());
    let radius = reach / (0.5 * angle).tan();
    let ends = [vertex - into * reach, vertex + out * reach];
    // Across the way into it, towards the way out.
    let inward = (out - into * into.dot(out)).unit()?;
    Some(Rounded::Arc { ends, centre: ends[0] + inward * radius, angle })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At a right angle under 0.1 mm: t = 0.1/tan(22.5 deg), and the arc passes the vertex at 0.1 mm.
    #[test]
    fn a_right_angle_has_its_arc() {
        let points = [[0.0, 0.0, 1.0], [10.0, 0.0, 1.0], [10.0, 10.0, 1.0]].map(Vector);
        let [Rounded::Line(_), Rounded::Arc { ends, centre, angle }, Rounded::Line(_)] = rounded(&points, 0.1)[..]
        else {
            panic!("other parts")
        };
        let radius = (ends[0] - centre).norm();
        assert!(
            (radius - 0.1 / (2.0_f64.sqrt() - 1.0)).abs() < 1e-12
                && (angle - std::f64::consts::FRAC_PI_2).abs() < 1e-12
        );
        assert!(((points[1] - centre).norm() - radius - 0.1).abs() < 1e-12);
        assert!(((ends[1] - centre).norm() - radius).abs() < 1e-12);
    }

    /// Short chords of a circle, on a slope, under a wide tolerance: arcs alone, each as round as the circle but for the square of a turn.
    #[test]
    fn short_lines_of_a_circle_become_the_circle() {
        let points: Vec<Vector> = (0..=100)
            .map(|k| f64::from(k) * 0.02)
            .map(|t| Vector([8.0 * t.cos(), 8.0 * t.sin(), 6.0 * t.sin()]))
            .map(|Vector([x, y, z])| Vector([x, 0.8 * y, z * 0.8]))
            .collect();
        let parts = rounded(&points, 1.0);
        let arcs = parts.iter().filter(|part| matches!(part, Rounded::Arc { .. })).count();
        assert_eq!((arcs, parts.len()), (99, 101));
        for pair in parts.windows(2) {
            let end = |part: &Rounded| match *part {
                Rounded::Line([_, end]) | Rounded::Arc { ends: [_, end], .. } => end,
            };
            let start = |part: &Rounded| match *part {
                Rounded::Line([start, _]) | Rounded::Arc { ends: [start, _], .. } => start,
            };
            assert!((end(&pair[0]) - start(&pair[1])).norm() < 1e-8);
        }
        for part in &parts[1..100] {
            let Rounded::Arc { ends, centre, .. } = *part else { panic!("{part:?}") };
            assert!(((ends[0] - centre).norm() / 8.0 - 1.0).abs() < 1e-3, "{part:?}");
        }
    }
}

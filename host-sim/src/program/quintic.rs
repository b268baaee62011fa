//! Quintics for curves that the tick does not know: rational ones, and arcs that stand upright.
//!
//! Each part takes point, first and second derivative of the curve at both of its ends. A polynomial up to degree 5 comes out as it is;
//! other curves are halved until they are within [`TOLERANCE_MM`]. All parts of a curve have the derivatives by its own parameter in common, so
//! that direction and curvature go on at their ends.

use std::fmt;

use super::bspline::{Clamped, NoCurve};
use super::{Arc, Motion};
use crate::vector::Vector;

/// How far a quintic may be from the curve it stands for, in mm: a tenth of a micrometre.
pub const TOLERANCE_MM: f64 = 1e-4;

/// How far the chords of a polyline are from its curve, in mm.
pub const CHORD_MM: f64 = 2e-4;

/// Points that are one, in mm.
const APART_MM: f64 = 1e-4;

/// How often a curve is halved at the most.
const HALVINGS: u32 = 12;

/// The most quintics for one curve; no curve that is cut takes so many, and behind it they would no longer be near to it.
const MOST: usize = 1024;

/// Why a curve has no quintics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoQuintics {
    /// It is no curve.
    NoCurve(NoCurve),
    /// It turns too often or too sharply.
    TooMany,
}

impl fmt::Display for NoQuintics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoCurve(error) => error.fmt(f),
            Self::TooMany => {
                write!(
                    f,
                    "more than {MOST} quintics are needed to follow this curve; give it in parts, or with fewer turns"
                )
            }
        }
    }
}

/// Control points, in mm.
pub type Quintic = [Vector; 6];

/// Point, first and second derivative.
pub type Jet = [Vector; 3];

/// The quintics for a curve over 0..=1. Errors: it needs too many.
pub fn quintics(curve: impl Fn(f64) -> Jet) -> Result<Vec<Quintic>, NoQuintics> {
    /// Parts of 1 where the curve is compared; the difference is greatest near the middle.
    const LOOKS: [f64; 3] = [0.25, 0.5, 0.75];
    let mut found = Vec::new();
    let mut open = vec![(0.0, 1.0, 0)];
    while let Some((from, to, halvings)) = open.pop() {
        let quintic = hermite(curve(from), curve(to), to - from);
        let off = |part: f64| (point(&quintic, part) - curve(from + (to - from) * part)[0]).norm();
        if halvings == HALVINGS || LOOKS.into_iter().all(|part| off(part) <= TOLERANCE_MM) {
            if found.len() == MOST {
                return Err(NoQuintics::TooMany);
            }
            found.push(quintic);
        } else {
            let middle = 0.5 * (from + to);
            open.extend([(middle, to, halvings + 1), (from, middle, halvings + 1)]);
        }
    }
    Ok(found)
}

/// The quintic with these ends over a parameter interval of this width.
fn hermite([p, p1, p2]: Jet, [q, q1, q2]: Jet, width: f64) -> Quintic {
    let (first, second) = (width / 5.0, width * width / 20.0);
    [p, p + p1 * first, p + p1 * (2.0 * first) + p2 * second, q - q1 * (2.0 * first) + q2 * second, q - q1 * first, q]
}

/// A point of a quintic.
pub fn point(quintic: &Quintic, at: f64) -> Vector {
    casteljau(quintic.to_vec(), at)[0]
}

/// The quintics of a curve that a program or a drawing gives as such; none of a motion that is no such curve. Errors: it is none at all,
/// or needs too many.
pub fn drawn(from: [f64; 3], motion: &Motion<'_>) -> Result<Option<Vec<Quintic>>, NoQuintics> {
    Ok(match *motion {
        Motion::Bezier { points } => {
            let all: Vec<[f64; 4]> = [from].iter().chain(points).map(|&[x, y, z]| [x, y, z, 1.0]).collect();
            Some(quintics(|at| rational(&all, at))?)
        }
        Motion::Nurbs(nurbs) => {
            let curve = Clamped::new(&nurbs).map_err(NoQuintics::NoCurve)?;
            let mut all = Vec::new();
            for piece in curve.pieces() {
                all.extend(quintics(|at| rational(&piece, at))?);
            }
            Some(all)
        }
        Motion::Rapid { .. } | Motion::Line { .. } | Motion::Arc(_) => None,
    })
}

/// Points of curves that follow each other, without repetition, whose chords are within [`CHORD_MM`] of them.
pub fn polyline(parts: &[Quintic]) -> Vec<Vector> {
    let mut points: Vec<Vector> = Vec::new();
    for point in parts.iter().flat_map(|part| samples(part, CHORD_MM)) {
        if points.last().is_none_or(|&last| (point - last).norm() > APART_MM) {
            points.push(point);
        }
    }
    points
}

/// Whether it is passed at a speed by its parameter that nowhere comes near to none: to a hundredth of its mean.
pub fn is_lively(quintic: &Quintic) -> bool {
    const LOOKS: u32 = 32;
    const PART: f64 = 0.01;
    let speeds = (0..=LOOKS).map(|k| casteljau(quintic.to_vec(), f64::from(k) / f64::from(LOOKS))[1].norm());
    let (least, sum) = speeds.fold((f64::INFINITY, 0.0), |(least, sum), speed| (speed.min(least), sum + speed));
    least > PART * sum / f64::from(LOOKS + 1)
}

/// Points on it, both ends among them, whose chords are about so near to it, in mm.
fn samples(quintic: &Quintic, chord: f64) -> impl Iterator<Item = Vector> {
    let bends = quintic.windows(3).map(|w| (w[0] - w[1] * 2.0 + w[2]).norm() * 20.0);
    // A chord over h is off by |r''| h^2/8.
    let count = (bends.fold(0.0, f64::max) / (8.0 * chord)).sqrt().ceil().clamp(8.0, 4096.0);
    (0..=count as u32).map(move |k| point(quintic, f64::from(k) / count))
}

/// A curve of Bernstein form at a parameter, by its control points: point, first and second derivative.
fn casteljau(mut points: Vec<Vector>, at: f64) -> Jet {
    let degree = points.len() - 1;
    let mut jet = [Vector::default(); 3];
    for left in (1..=degree).rev() {
        // With `left` + 1 points left, differences give the derivatives.
        if left == 2 {
            jet[2] = (points[2] - points[1] * 2.0 + points[0]) * (degree * (degree - 1)) as f64;
        }
        if left == 1 {
            jet[1] = (points[1] - points[0]) * degree as f64;
        }
        for k in 0..left {
            points[k] = points[k].toward(points[k + 1], at);
        }
    }
    jet[0] = points[0];
    jet
}

/// A rational curve of Bernstein form: x w, y w, z w and w of each control point.
pub fn rational(points: &[[f64; 4]], at: f64) -> Jet {
    let weighted = casteljau(points.iter().map(|&[x, y, z, _]| Vector([x, y, z])).collect(), at);
    let weights = casteljau(points.iter().map(|&[.., w]| Vector([w, 0.0, 0.0])).collect(), at);
    let [[w, ..], [w1, ..], [w2, ..]] = weights.map(|Vector(w)| w);
    let point = weighted[0] * (1.0 / w);
    let first = (weighted[1] - point * w1) * (1.0 / w);
    [point, first, (weighted[2] - first * (2.0 * w1) - point * w2) * (1.0 / w)]
}

/// An arc or helix about any axis; where its ends are not equally far from the centre, its radius goes evenly from one to the other.
pub fn arc(arc: &Arc, from: [f64; 3], at: f64) -> Jet {
    let [a, b, c] = arc.plane.axes();
    let [x, y] = [from[a] - arc.centre[0], from[b] - arc.centre[1]];
    let [start, end] = [x.hypot(y), (arc.to[a] - arc.centre[0]).hypot(arc.to[b] - arc.centre[1])];
    let (radius, growth) = (start + (end - start) * at, end - start);
    let (sine, cosine) = (y.atan2(x) + arc.sweep * at).sin_cos();
    let spread = |along: f64, left: f64| {
        let mut all = [0.0; 3];
        (all[a], all[b]) = (along * cosine - left * sine, along * sine + left * cosine);
        all
    };
    let mut point = spread(radius, 0.0);
    point[a] += arc.centre[0];
    point[b] += arc.centre[1];
    point[c] = from[c] + (arc.to[c] - from[c]) * at;
    let mut first = spread(growth, radius * arc.sweep);
    first[c] = arc.to[c] - from[c];
    let second = spread(-radius * arc.sweep * arc.sweep, 2.0 * growth * arc.sweep);
    [point, first, second].map(Vector)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::*;
    use crate::program::Plane;

    /// A quarter of a circle as a rational quadratic, an upright turn, and a spiral: within the tolerance everywhere, looked at by dense
    /// samples, and smooth where parts meet.
    #[test]
    fn curves_are_kept_within_the_tolerance() {
        let half = 0.5_f64.sqrt();
        let quarter = [[50.0, 0.0, 0.0, 1.0], [50.0 * half, 50.0 * half, 0.0, half], [0.0, 50.0, 0.0, 1.0]];
        let upright = Arc { plane: Plane::Zx, centre: [3.0, -40.0], to: [-40.0, 2.0, 53.0], sweep: TAU, turns: 0 };
        let spiral = Arc { plane: Plane::Xy, centre: [0.0, 0.0], to: [0.0, 9.5, 1.0], sweep: PI / 2.0, turns: 0 };
        let curves: [&dyn Fn(f64) -> Jet; 3] =
            [&|at| rational(&quarter, at), &|at| arc(&upright, [-40.0, 2.0, 53.0], at), &|at| {
                arc(&spiral, [9.0, 0.0, 0.0], at)
            }];
        for (number, curve) in curves.into_iter().enumerate() {
            let found = quintics(curve).unwrap();
            let exact: Vec<Vector> = (0..=20_000).map(|k| curve(f64::from(k) / 2e4)[0]).collect();
            for quintic in &found {
                for j in 0..=20 {
                    let here = point(quintic, f64::from(j) / 20.0);
                    let off = exact.windows(2).map(|w| here.from_segment(w[0], w[1])).fold(f64::INFINITY, f64::min);
                    assert!(off <= TOLERANCE_MM * 1.05, "{number} {j}: {off}");
                }
            }
            for pair in found.windows(2) {
                let [end, start] = [casteljau(pair[0].to_vec(), 1.0), casteljau(pair[1].to_vec(), 0.0)];
                let bend = |[_, first, second]: Jet| first.cross(second) * (1.0 / first.norm().powi(3));
                assert!((end[0] - start[0]).norm() < 1e-9 && end[1].angle(start[1]) < 1e-9);
                assert!((bend(end) - bend(start)).norm() < 1e-9 * bend(end).norm());
            }
        }
        // The quarter is of radius 50 indeed.
        assert!((rational(&quarter, 0.3)[0].norm() - 50.0).abs() < 1e-12);
    }

    /// A cubic and a whole quintic come out as they are.
    #[test]
    fn polynomials_are_kept() {
        let points = [[0.0, 0.0, 0.0, 1.0], [3.0, 1.0, -2.0, 1.0], [5.0, -4.0, 1.0, 1.0], [9.0, 2.0, 0.0, 1.0]];
        let found = quintics(|at| rational(&points, at)).unwrap();
        assert_eq!(found.len(), 1);
        for k in 0..=10 {
            let at = f64::from(k) / 10.0;
            assert!((point(&found[0], at) - rational(&points, at)[0]).norm() < 1e-13);
        }
    }
    /// An upright thread of a hundred turns is followed; of ten thousand, no quintic would turn as often as it.
    #[test]
    fn what_needs_too_many_is_refused() {
        let with = |turns: f64| {
            let thread =
                Arc { plane: Plane::Zx, centre: [0.0, 0.0], to: [1.0, 9.0, 0.0], sweep: TAU * turns, turns: 0 };
            quintics(|at| arc(&thread, [1.0, 0.0, 0.0], at)).map(|found| found.len())
        };
        assert!(with(100.0).is_ok_and(|count| count > 200));
        assert_eq!(with(1e4), Err(NoQuintics::TooMany));
    }
}

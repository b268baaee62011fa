//! Circular arcs in x and y along which z goes evenly: parts of helices.

use std::f64::consts::{PI, TAU};

use super::conditions::{Course, SAG};
use super::curve::Local;
use crate::program::{Arc, Plane};
use crate::vector::{Chord, Vector};

/// A part of a circle in x and y that rises or falls evenly, at most once around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RisingArc {
    /// Where it begins, in mm.
    pub start: Vector,
    /// The centre in x and y, in mm.
    pub centre: [f64; 2],
    /// The angle in radians, positive anticlockwise.
    pub sweep: f64,
    /// How far z goes, in mm.
    pub rise: f64,
}

/// A direction in x and y, or a difference of places.
pub(super) type Flat = [f64; 2];

pub(super) fn flat(v: Vector) -> Flat {
    [v.0[0], v.0[1]]
}

pub(super) fn dot(a: Flat, b: Flat) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

pub(super) fn cross(a: Flat, b: Flat) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(super) fn turned([x, y]: Flat, angle: f64) -> Flat {
    let (sin, cos) = angle.sin_cos();
    [x * cos - y * sin, x * sin + y * cos]
}

/// Arcs that turn by less than this are lines, in radians: they leave their chords by less than 1e-7 of their length.
pub(super) const STRAIGHT: f64 = 1e-6;

/// The largest radius in mm: the digits of the centre of a larger one say less than 1e-9 mm.
const LARGEST: f64 = 1e5;

impl RisingArc {
    /// The arc that leaves `start` in a direction and comes to `end`. None where it would be straight, or turn by more than 19/20 of a circle.
    pub(super) fn along(start: Vector, direction: Flat, end: Vector) -> Option<Self> {
        let chord = flat(end - start);
        let (across, along) = (cross(direction, chord), dot(direction, chord));
        let sweep = 2.0 * across.atan2(along);
        let radius = 0.5 * dot(chord, chord) / across;
        let is_one = (STRAIGHT..0.95 * TAU).contains(&sweep.abs()) && radius.abs() < LARGEST;
        let centre = [start.0[0] - radius * direction[1], start.0[1] + radius * direction[0]];
        is_one.then_some(Self { start, centre, sweep, rise: end.0[2] - start.0[2] })
    }

    /// The arc from the first of some points to the last that is nearest to all of them in the sense of least squares. None where it would be
    /// straight.
    pub(super) fn through(points: &[Vector]) -> Option<Self> {
        let (start, end) = (*points.first()?, *points.last()?);
        let chord = flat(end - start);
        let places = || points.iter().map(|&point| flat(point - start));
        // Twice the area between the points and the chord: anticlockwise arcs have it on their left.
        let mut area = 0.0;
        for pair in points.windows(2) {
            area += cross(flat(pair[0] - start), flat(pair[1] - start));
        }
        let square = dot(chord, chord);
        let mut is_flat = false;
        let from_start = if square > 1e-18 {
            // The centre is on the bisector, `s` to the left of the chord's middle. Of a point with the height h over the chord and the
            // product p of its parts of the chord, p - 2 s h is 2 r times its distance from the circle.
            let length = square.sqrt();
            let left = [-chord[1] / length, chord[0] / length];
            let (mut hh, mut ph, mut pp, mut highest) = (0.0, 0.0, 0.0, 0.0_f64);
            for place in places() {
                let (height, product) = (dot(place, left), dot(place, place) - dot(place, chord));
                (hh, ph, pp) = (hh + height * height, ph + height * product, pp + product * product);
                highest = highest.max(height.abs());
            }
            // Flat arcs by their curvature, so that noise does not bend them; others by their radius.
            is_flat = highest < 0.25 * length;
            let s = if is_flat { 0.5 * pp / ph } else { 0.5 * ph / hh };
            [0.5 * chord[0] + s * left[0], 0.5 * chord[1] + s * left[1]]
        } else {
            // A whole turn: the circle through the start that is nearest to the others.
            let (mut xx, mut xy, mut yy, mut right) = (0.0, 0.0, 0.0, [0.0; 2]);
            for place @ [x, y] in places() {
                let q = dot(place, place);
                (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
                right = [right[0] + q * x, right[1] + q * y];
            }
            let determinant = 2.0 * (xx * yy - xy * xy);
            [(right[0] * yy - right[1] * xy) / determinant, (right[1] * xx - right[0] * xy) / determinant]
        };
        let radius = from_start[0].hypot(from_start[1]);
        let out = [-from_start[0], -from_start[1]];
        let to = [chord[0] + out[0], chord[1] + out[1]];
        let angle = cross(out, to).atan2(dot(out, to));
        let sweep = match area > 0.0 {
            _ if is_flat => angle,
            true if angle <= STRAIGHT => angle + TAU,
            false if angle >= -STRAIGHT => angle - TAU,
            _ => angle,
        };
        let sweep = if square > 1e-18 { sweep } else { TAU.copysign(area) };
        let is_one = (STRAIGHT..=TAU).contains(&sweep.abs()) && radius < LARGEST && radius > 0.0;
        let centre = [start.0[0] + from_start[0], start.0[1] + from_start[1]];
        is_one.then_some(Self { start, centre, sweep, rise: end.0[2] - start.0[2] })
    }

    fn out(&self) -> Flat {
        [self.start.0[0] - self.centre[0], self.start.0[1] - self.centre[1]]
    }

    /// The same as a motion of a program, from its start.
    pub fn motion(&self) -> Arc {
        Arc { plane: Plane::Xy, centre: self.centre, to: self.at(1.0).point.0, sweep: self.sweep, turns: 0 }
    }

    /// The radius in mm.
    pub fn radius(&self) -> f64 {
        let [x, y] = self.out();
        x.hypot(y)
    }

    /// The direction at its end, in x and y.
    pub(super) fn end_direction(&self) -> Flat {
        let [x, y] = turned(self.out(), self.sweep);
        let scale = self.sweep.signum() / x.hypot(y);
        [-y * scale, x * scale]
    }

    /// Where it is at a parameter of 0..=1.
    pub fn at(&self, t: f64) -> Local {
        let [x, y] = turned(self.out(), self.sweep * t);
        let point = Vector([self.centre[0] + x, self.centre[1] + y, self.start.0[2] + self.rise * t]);
        let (one, two) = (self.sweep, -self.sweep * self.sweep);
        Local { point, first: Vector([-y * one, x * one, self.rise]), second: Vector([x * two, y * two, 0.0]) }
    }
}

impl Course for RisingArc {
    fn at(&self, t: f64) -> Local {
        Self::at(self, t)
    }

    fn bend(&self) -> f64 {
        self.radius() * self.sweep * self.sweep
    }

    /// By halves, each of which leaves its chord by its sagitta.
    fn hull(&self, from: f64, to: f64, chord: &Chord, tolerance: f64) -> f64 {
        let ends = [from, to].map(|t| chord.square_from(self.at(t).point).sqrt());
        halves(self, [from, to], ends, chord, tolerance, HALVINGS)
    }
}

/// How often a part of an arc is halved where it may be too far from its segment.
const HALVINGS: u32 = 6;

fn halves(arc: &RisingArc, [from, to]: [f64; 2], ends: [f64; 2], chord: &Chord, tolerance: f64, left: u32) -> f64 {
    let angle = arc.sweep * (to - from);
    let bound =
        ends[0].max(ends[1]) + if angle.abs() < PI { SAG * arc.radius() * angle * angle } else { f64::INFINITY };
    if bound <= tolerance || left == 0 {
        return bound;
    }
    let middle = 0.5 * (from + to);
    let off = chord.square_from(arc.at(middle).point).sqrt();
    if off > tolerance {
        return off;
    }
    let first = halves(arc, [from, middle], [ends[0], off], chord, tolerance, left - 1);
    if first > tolerance {
        return first;
    }
    first.max(halves(arc, [middle, to], [off, ends[1]], chord, tolerance, left - 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on(radius: f64, angle: f64, z: f64) -> Vector {
        Vector([3.0 + radius * angle.cos(), -1.0 + radius * angle.sin(), z])
    }

    /// Points of circles give these circles: flat, high, beyond half a turn, whole turns, both ways round, and helices.
    #[test]
    fn points_of_a_circle_give_the_circle() {
        for sweep in [0.01, 0.5, 2.0, 4.0, 6.0, TAU] {
            for sign in [1.0, -1.0] {
                let points: Vec<Vector> =
                    (0..=20).map(|k| f64::from(k) / 20.0).map(|t| on(5.0, 1.0 + sign * sweep * t, 2.0 * t)).collect();
                let mut points = points;
                if sweep == TAU {
                    // The sine of a whole turn is not quite zero.
                    points[20] = Vector([points[0].0[0], points[0].0[1], 2.0]);
                }
                let arc = RisingArc::through(&points).unwrap();
                assert!((arc.sweep - sign * sweep).abs() < 1e-9, "{sweep} {arc:?}");
                assert!((arc.centre[0] - 3.0).abs() < 1e-8 && (arc.centre[1] + 1.0).abs() < 1e-8);
                for (k, point) in points.iter().enumerate() {
                    assert!((arc.at(k as f64 / 20.0).point - *point).norm() < 1e-8);
                }
            }
        }
    }

    #[test]
    fn a_direction_and_an_end_give_the_arc() {
        let (start, end) = (on(5.0, 1.0, 0.0), on(5.0, 4.5, 1.0));
        let arc = RisingArc::along(start, [-1.0_f64.sin(), 1.0_f64.cos()], end).unwrap();
        assert!((arc.sweep - 3.5).abs() < 1e-12 && (arc.radius() - 5.0).abs() < 1e-12);
        let [x, y] = arc.end_direction();
        assert!((x + 4.5_f64.sin()).abs() < 1e-12 && (y - 4.5_f64.cos()).abs() < 1e-12);
    }

    #[test]
    fn derivatives_are_those_of_the_points() {
        let arc = RisingArc { start: on(5.0, 1.0, 0.0), centre: [3.0, -1.0], sweep: -2.0, rise: 3.0 };
        let h = 1e-4;
        let [before, here, after] = [0.3 - h, 0.3, 0.3 + h].map(|t| arc.at(t));
        assert!(((after.point - before.point) * (0.5 / h) - here.first).norm() < 1e-6);
        assert!(((after.first - before.first) * (0.5 / h) - here.second).norm() < 1e-6);
    }

    /// The part of a circle over a chord is as far from it as its sagitta.
    #[test]
    fn a_hull_is_a_bound_and_not_much_more() {
        let arc = RisingArc { start: on(5.0, 1.0, 0.0), centre: [3.0, -1.0], sweep: 0.4, rise: 0.0 };
        let chord = Chord::new(arc.at(0.25).point, arc.at(0.75).point);
        let sagitta = 5.0 * (1.0 - 0.1_f64.cos());
        let bound = arc.hull(0.25, 0.75, &chord, 1.01 * sagitta);
        assert!((sagitta..1.01 * sagitta).contains(&bound), "{bound} {sagitta}");
        assert!(arc.hull(0.25, 0.75, &chord, 0.9 * sagitta) > 0.9 * sagitta);
    }
}

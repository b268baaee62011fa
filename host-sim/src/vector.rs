//! Points and directions in space.

use std::ops::{Add, Mul, Neg, Sub};

/// x, y and z: a point in mm, or a direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vector(pub [f64; 3]);

impl Vector {
    /// The scalar product.
    pub fn dot(self, other: Self) -> f64 {
        self.0[0] * other.0[0] + self.0[1] * other.0[1] + self.0[2] * other.0[2]
    }

    /// The vector product.
    pub fn cross(self, other: Self) -> Self {
        let ([a, b, c], [d, e, f]) = (self.0, other.0);
        Self([b * f - c * e, c * d - a * f, a * e - b * d])
    }

    /// The length.
    pub fn norm(self) -> f64 {
        self.dot(self).sqrt()
    }

    /// The direction; none of a vector without length.
    pub fn unit(self) -> Option<Self> {
        let norm = self.norm();
        (norm > 0.0 && norm.is_finite()).then(|| self * (1.0 / norm))
    }

    /// The angle to another direction, in radians.
    pub fn angle(self, other: Self) -> f64 {
        self.cross(other).norm().atan2(self.dot(other))
    }

    /// The point at a part of the way to another.
    pub fn toward(self, other: Self, part: f64) -> Self {
        self + (other - self) * part
    }

    /// The distance from the segment between two points.
    pub fn from_segment(self, from: Self, to: Self) -> f64 {
        Chord::new(from, to).square_from(self).sqrt()
    }
}

/// A segment from which many distances are taken.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chord {
    from: Vector,
    along: Vector,
    /// 1 over the square of its length; 0 where it has none.
    inverse: f64,
}

impl Chord {
    pub(super) fn new(from: Vector, to: Vector) -> Self {
        let along = to - from;
        let square = along.dot(along);
        Self { from, along, inverse: if square > 0.0 { 1.0 / square } else { 0.0 } }
    }

    /// The square of a point's distance.
    pub(super) fn square_from(&self, point: Vector) -> f64 {
        let off = point - self.from;
        let part = (off.dot(self.along) * self.inverse).clamp(0.0, 1.0);
        let across = off - self.along * part;
        across.dot(across)
    }
}

impl Add for Vector {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self([self.0[0] + other.0[0], self.0[1] + other.0[1], self.0[2] + other.0[2]])
    }
}

impl Sub for Vector {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self([self.0[0] - other.0[0], self.0[1] - other.0[1], self.0[2] - other.0[2]])
    }
}

impl Mul<f64> for Vector {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self(self.0.map(|x| x * factor))
    }
}

impl Neg for Vector {
    type Output = Self;

    fn neg(self) -> Self {
        self * -1.0
    }
}

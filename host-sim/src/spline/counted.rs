//! A scalar that counts what is done with it.

use std::cell::Cell;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

use serde::Serialize;
use shared::real::Real;

/// How often what was done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Operations {
    /// Multiplications.
    pub multiplications: u64,
    /// Divisions.
    pub divisions: u64,
    /// Additions.
    pub additions: u64,
    /// Subtractions.
    pub subtractions: u64,
    /// Square roots.
    pub roots: u64,
}

impl Operations {
    /// All of them, a root as one.
    pub fn sum(&self) -> u64 {
        self.multiplications + self.divisions + self.additions + self.subtractions + self.roots
    }
}

thread_local! {
    static DONE: Cell<Operations> = Cell::new(Operations::default());
}

/// A double that counts. A change of sign and a comparison count as nothing, as in the paper's tables.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Counted(pub f64);

/// What `work` does with [`Counted`] numbers on this thread, and what comes of it.
pub fn count<R>(work: impl FnOnce() -> R) -> (Operations, R) {
    DONE.set(Operations::default());
    let result = work();
    (DONE.get(), result)
}

/// One more of that kind.
fn note(kind: impl FnOnce(&mut Operations) -> &mut u64) {
    let mut done = DONE.get();
    *kind(&mut done) += 1;
    DONE.set(done);
}

impl Add for Counted {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        note(|done| &mut done.additions);
        Self(self.0 + other.0)
    }
}

impl Sub for Counted {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        note(|done| &mut done.subtractions);
        Self(self.0 - other.0)
    }
}

impl Mul for Counted {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        note(|done| &mut done.multiplications);
        Self(self.0 * other.0)
    }
}

impl Div for Counted {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        note(|done| &mut done.divisions);
        Self(self.0 / other.0)
    }
}

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl AddAssign for Counted {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Counted {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl Real for Counted {
    const ZERO: Self = Self(0.0);
    const HALF: Self = Self(0.5);
    const ONE: Self = Self(1.0);
    const TWO: Self = Self(2.0);
    const ROUNDOFF: Self = Self(f64::ROUNDOFF);
    const QUADRANT: [Self; 2] = [Self(f64::QUADRANT[0]), Self(f64::QUADRANT[1])];
    const QUADRANTS_PER_RADIAN: Self = Self(f64::QUADRANTS_PER_RADIAN);
    // No angle is counted.
    const SINE: &'static [Self] = &[];
    const VERSINE: &'static [Self] = &[];
    /// As many nodes as the controller has.
    const GAUSS: &'static [(Self, Self)] = &{
        let mut nodes = [(Self(0.0), Self(0.0)); f32::GAUSS.len()];
        let mut k = 0;
        while k < nodes.len() {
            nodes[k] = (Self(f32::GAUSS[k].0 as f64), Self(f32::GAUSS[k].1 as f64));
            k += 1;
        }
        nodes
    };

    fn lit(value: f64) -> Self {
        Self(value)
    }

    fn from_int(value: i32) -> Self {
        Self(f64::from(value))
    }

    fn abs(self) -> Self {
        Self(self.0.abs())
    }

    fn to_int(self) -> i32 {
        Real::to_int(self.0)
    }

    fn is_finite(self) -> bool {
        self.0.is_finite()
    }

    fn sqrt(self) -> Self {
        note(|done| &mut done.roots);
        Self(self.0.sqrt())
    }

    fn atan2(self, x: Self) -> Self {
        Self(self.0.atan2(x.0))
    }

    fn to_f32(self) -> f32 {
        self.0 as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_done_is_counted() {
        let (done, result) = count(|| {
            let mut x = Counted(2.0) * Counted(3.0) + Counted(1.0);
            x -= Counted(3.0);
            -(x / Counted(2.0)).sqrt()
        });
        let one = Operations { multiplications: 1, divisions: 1, additions: 1, subtractions: 1, roots: 1 };
        assert_eq!((done, done.sum(), result.0), (one, 5, -(2.0_f64.sqrt())));
    }
}

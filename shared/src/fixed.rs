//! Machine coordinates as integers: what a tick puts out, what pieces stand on.
//!
//! The unit is 2^-18 mm, 3.8 nm; the range is +-8.19 m. A power of two, because scaling by it is exact in every float: the only
//! rounding of a setpoint is the one to the unit.

use serde::{Deserialize, Serialize};

use crate::complex::Complex;
use crate::real::Real;

/// Units of a coordinate in one millimetre.
pub const UNITS_PER_MM: f64 = 262_144.0;

/// The farthest a machine coordinate may be from the origin, in mm; validated data stays inside, so that sums cannot overflow.
pub const REACH_MM: f64 = 4_000.0;

/// One machine coordinate in units of 2^-18 mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Fixed(pub i32);

/// A position of the machine: x, y, z.
pub type Position = [Fixed; 3];

impl Fixed {
    /// The nearest coordinate to `mm`; saturates outside +-8.19 m.
    #[inline(always)]
    pub fn from_mm<T: Real>(mm: T) -> Self {
        Self((mm * T::lit(UNITS_PER_MM)).to_int())
    }

    /// This coordinate plus a local distance in mm. Wraps instead of panicking; validated data never comes near.
    #[inline(always)]
    pub fn offset_by<T: Real>(self, mm: T) -> Self {
        Self(self.0.wrapping_add(Self::from_mm(mm).0))
    }

    /// In mm, exactly: a double holds every coordinate. Not for the tick.
    pub fn to_mm(self) -> f64 {
        f64::from(self.0) / UNITS_PER_MM
    }

    /// The distance from `other` in mm, rounded once. Exact in integers first, so that nearby points far from home keep their
    /// distance.
    #[inline(always)]
    pub fn minus<T: Real>(self, other: Self) -> T {
        T::from_int(self.0.wrapping_sub(other.0)) * T::lit(1.0 / UNITS_PER_MM)
    }

    /// Whether this coordinate is within [`REACH_MM`].
    pub fn is_in_reach(self) -> bool {
        self.0.unsigned_abs() <= (REACH_MM * UNITS_PER_MM) as u32
    }
}

/// The nearest fixed-point to `point`, in mm.
pub fn round_point<T: Real>(point: Complex<T>) -> [Fixed; 2] {
    [Fixed::from_mm(point.re), Fixed::from_mm(point.im)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coordinate_keeps_ten_nanometres_on_two_metres() {
        for mm in [0.0, 1e-5, 999.999_99, -2_000.000_01, 1_234.567_891] {
            assert!((Fixed::from_mm(mm).to_mm() - mm).abs() <= 0.5 / UNITS_PER_MM);
            assert!(Fixed::from_mm(mm).is_in_reach());
        }
        assert!(!Fixed::from_mm(4_000.1).is_in_reach());
        assert_eq!(Fixed::from_mm(f32::NAN), Fixed(0));
    }
}

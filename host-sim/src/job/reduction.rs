//! How far the feed goes down at a corner: by one factor everywhere, or as much as the corner's angle asks for.
//!
//! At a corner that turns by theta the velocity changes its direction at once, by a step of 2 f V sin(|theta|/2): that is what
//! shakes a machine. [`Reduction::Auto`] keeps this step the same at every corner, and the same as the published f = 0.25
//! makes it at a right angle:
//!
//! | | rule |
//! | --- | --- |
//! | factor | f = min(1, f90 sin(45 deg)/sin(\|theta\|/2)), f90 = 0.25 |
//! | ramp | lambda = ramp (1 - f^2)/(1 - f90^2), at most 1/2; none where f = 1 |
//!
//! A ramp takes V^2 - (f V)^2 out of the motion, so that a smaller slowdown takes a proportionally shorter way and the work of
//! the deceleration is the same on each unit of length; `ramp` is the job's, and a right angle gets just that. A full turn back
//! leaves f = 0.177, and a corner of less than 20.4 degrees needs no ramp at all. What a job says of a single corner
//! (`end_reduction`, `end_ramp`) stands; where it gives a factor alone, lambda follows from that factor.

use std::fmt;
use std::str::FromStr;

use shared::feed::Ramp;

/// f at a right angle, that of the published runs that go round their corners most slowly.
const RIGHT_ANGLE: f64 = 0.25;
/// lambda that the rule does not exceed, so that a piece has room for the ramps of both its ends.
const LONGEST: f64 = 0.5;

/// What is left of the feed at a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reduction {
    /// f, above 0 and at most 1, at every corner.
    Fixed(f64),
    /// By the angle of each corner.
    Auto,
}

/// What a corner at an end of a piece says of its ramp: a value of its own, or the job's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Corner {
    /// f, in the place of the job's.
    pub reduction: Option<f64>,
    /// lambda, in the place of the job's.
    pub ramp: Option<f64>,
}

impl Corner {
    /// The ramp at this corner, at which the path turns by `angle` radians, under the job's `reduction` and `ramp`. None where
    /// the rule asks for no slowing down.
    pub fn ramp(&self, reduction: Reduction, ramp: f64, angle: f64) -> Option<Ramp<f64>> {
        let (factor, length) = match reduction {
            Reduction::Fixed(factor) => (self.reduction.unwrap_or(factor), ramp),
            Reduction::Auto => {
                let factor = self.reduction.unwrap_or_else(|| factor_at(angle));
                if factor >= 1.0 {
                    return None;
                }
                (factor, (ramp * ((1.0 - factor * factor) / (1.0 - RIGHT_ANGLE * RIGHT_ANGLE))).min(LONGEST))
            }
        };
        Some(Ramp { length: self.ramp.unwrap_or(length), factor })
    }
}

/// The factor that makes the step of velocity at a corner of this angle that of a right angle; 1 where it is smaller anyway.
fn factor_at(angle: f64) -> f64 {
    let right = std::f64::consts::FRAC_PI_4.sin();
    // A corner of no angle at all divides by zero; the infinite quotient is cut to 1.
    (RIGHT_ANGLE * right / (0.5 * angle.abs()).sin()).min(1.0)
}

impl fmt::Display for Reduction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fixed(factor) => write!(f, "{factor}"),
            Self::Auto => write!(f, "auto"),
        }
    }
}

impl FromStr for Reduction {
    type Err = String;

    /// A number, whose range is not checked here, or the word `auto`.
    fn from_str(text: &str) -> Result<Self, String> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        text.parse().map(Self::Fixed).map_err(|_| "it must be a number above 0 and at most 1, or `auto`".to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn auto(ramp: f64, angle: f64) -> Option<Ramp<f64>> {
        Corner::default().ramp(Reduction::Auto, ramp, angle)
    }

    /// The published pair at the angle that defines the rule, to the last bit, whichever way the corner turns.
    #[test]
    fn a_right_angle_gets_the_published_ramp() {
        for angle in [FRAC_PI_2, -FRAC_PI_2] {
            assert_eq!(auto(0.25, angle), Some(Ramp { length: 0.25, factor: 0.25 }));
            assert_eq!(auto(0.1, angle), Some(Ramp { length: 0.1, factor: 0.25 }));
        }
    }

    /// sin(90 deg) = 1: f = 0.25 sin 45 deg = sqrt(1/32), and lambda/ramp = (1 - 1/32)/(1 - 1/16) = 31/30.
    #[test]
    fn turning_back_takes_the_most() {
        let ramp = auto(0.25, PI).unwrap();
        assert!((ramp.factor - 0.031_25_f64.sqrt()).abs() < 1e-15);
        assert!((ramp.length - 0.25 * 31.0 / 30.0).abs() < 1e-15);
        assert_eq!(auto(0.9, PI).unwrap().length, 0.5, "a piece has two ends");
    }

    /// 2 f sin(|theta|/2) is 0.25 sqrt 2 wherever f < 1, and less where f = 1.
    #[test]
    fn the_step_of_velocity_is_the_same_everywhere() {
        for k in 1..=180 {
            let angle = f64::from(k).to_radians();
            let step = |f: f64| 2.0 * f * (0.5 * angle).sin();
            match auto(0.25, angle) {
                Some(ramp) => {
                    assert!((step(ramp.factor) - 0.25 * 2.0_f64.sqrt()).abs() < 1e-14, "{k} degrees");
                    let work = (1.0 - ramp.factor * ramp.factor) / ramp.length;
                    assert!((work - 0.9375 / 0.25).abs() < 1e-12, "{k} degrees: work on a unit of length");
                }
                None => assert!(step(1.0) <= 0.25 * 2.0_f64.sqrt(), "{k} degrees"),
            }
        }
    }

    /// f reaches 1 where sin(theta/2) = 0.25 sin 45 deg, at 20.364 degrees.
    #[test]
    fn small_angles_need_no_ramp() {
        for degrees in [0.0_f64, 1e-9, 5.0, 20.36] {
            assert_eq!(auto(0.25, degrees.to_radians()), None, "{degrees}");
            assert_eq!(auto(0.25, -degrees.to_radians()), None, "{degrees}");
        }
        assert!(auto(0.25, 20.37_f64.to_radians()).is_some());
    }

    #[test]
    fn what_a_corner_says_itself_stands() {
        let corner = Corner { reduction: Some(0.5), ramp: Some(0.7) };
        for reduction in [Reduction::Auto, Reduction::Fixed(0.3)] {
            assert_eq!(corner.ramp(reduction, 0.25, FRAC_PI_2), Some(Ramp { length: 0.7, factor: 0.5 }));
        }
        let factor = Corner { reduction: Some(0.5), ramp: None };
        assert_eq!(factor.ramp(Reduction::Auto, 0.25, PI), Some(Ramp { length: 0.2, factor: 0.5 }));
        assert_eq!(factor.ramp(Reduction::Fixed(0.3), 0.25, PI), Some(Ramp { length: 0.25, factor: 0.5 }));
        let plain = Corner::default().ramp(Reduction::Fixed(1.0), 0.25, 0.0);
        assert_eq!(plain, Some(Ramp { length: 0.25, factor: 1.0 }), "a fixed factor is not judged by the angle");
    }

    #[test]
    fn both_forms_are_read() {
        assert_eq!("auto".parse(), Ok(Reduction::Auto));
        assert_eq!("0.3".parse(), Ok(Reduction::Fixed(0.3)));
        assert!("Auto".parse::<Reduction>().is_err());
    }
}

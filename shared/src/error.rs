//! Why a path is refused. Small and `Copy`, so that it travels over the wire; the host adds file, line and column.

use core::fmt;

use serde::{Deserialize, Serialize};

/// What is wrong with a job, before anything moves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PathError {
    /// The weight is outside 0..=1.
    Weight {
        /// What was given.
        weight: f32,
    },
    /// The tolerance for gaps is not above zero.
    Tolerance {
        /// What was given, in mm.
        tolerance: f32,
    },
    /// The feed is zero, negative or not a number.
    Feed {
        /// What was given, in mm/s.
        feed: f32,
    },
    /// A ramp's length lambda is outside 0..=1.
    RampLength {
        /// What was given.
        length: f32,
    },
    /// A ramp's factor f is outside 1e-12 <= f <= 1.
    Reduction {
        /// What was given.
        factor: f32,
    },
    /// The ramps of a piece cover more than all of it.
    Ramps {
        /// lambda_0 + lambda_1, which may be at most 1.
        sum: f32,
    },
    /// A feed profile with a coefficient outside 0..=1, or without any that is a half or more, or beside ramps.
    Profile {
        /// What was given.
        factors: [f32; 4],
    },
    /// The interval of a piece is reversed, empty, or leaves 0..=1.
    Interval {
        /// The first parameter.
        from: f32,
        /// The last parameter.
        to: f32,
    },
    /// A piece is shorter than a machine could resolve.
    Length {
        /// Its length, in mm.
        length: f32,
    },
    /// 1 + kappa d vanishes inside a piece: the offset has a cusp there, and turns back.
    Cusp,
    /// A polynomial curve stands still inside a piece, or so nearly that its feed cannot be told.
    Standstill,
    /// The parametric speed of a polynomial curve varies so much that its feed correction polynomial would run backwards.
    Uneven,
    /// A polynomial curve bends in z, and the piece does not say where z begins and ends.
    Bow,
    /// An arc turns by nothing or by more than one turn.
    Sweep {
        /// What was given, in radians.
        sweep: f32,
    },
    /// A number is infinite or not a number.
    NotFinite,
    /// A piece lies outside the range of machine coordinates.
    Reach,
    /// A piece does not begin where the one before it ended.
    Gap {
        /// The gap, in mm.
        width: f32,
    },
    /// A closed path does not end where it starts.
    Open {
        /// The gap, in mm.
        width: f32,
    },
    /// The exact last point is not where the last piece ends.
    LastPoint {
        /// The gap, in mm.
        width: f32,
    },
    /// A piece follows the last one.
    AfterLast,
    /// The path has no pieces.
    Empty,
    /// A piece moves a further axis, and the first one did not say where that begins.
    LateFurther,
    /// A piece leaves the travel of an axis.
    SoftLimit {
        /// Which axis, from 0.
        axis: u8,
        /// By how much, in mm: above zero at the high end, below zero at the low one.
        beyond: f32,
    },
    /// Limits of the pace that are no positive numbers, or a largest pace outside 1..=2.
    Pace {
        /// The largest |q'|, in 1/s.
        slope: f32,
        /// The largest |q''|, in 1/s^2.
        bend: f32,
        /// The largest q.
        most: f32,
    },
    /// With these limits of the pace a stop would take too long.
    SlowStop {
        /// The largest |q'|, in 1/s.
        slope: f32,
        /// The largest |q''|, in 1/s^2.
        bend: f32,
    },
}

/// The axes of a piece, as people call them.
const AXIS_NAMES: [&str; 3] = ["x", "y", "z"];

impl fmt::Display for PathError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Weight { weight } => write!(f, "the weight is {weight}; it must be within 0..1"),
            Self::Tolerance { tolerance } => write!(f, "the tolerance is {tolerance} mm; it must be above zero"),
            Self::Feed { feed } => write!(f, "the feed is {feed} mm/s; it must be a number above zero"),
            Self::RampLength { length } => write!(f, "a ramp takes {length} of its piece; it must be within 0..1"),
            Self::Reduction { factor } => {
                write!(
                    f,
                    "the reduction is {factor}; it must be at least 1e-12 and at most 1, or the corner is never reached"
                )
            }
            Self::Ramps { sum } => {
                write!(f, "the ramps of a piece cover {sum} of it; lambda at both ends may sum to at most 1")
            }
            Self::Profile { factors: [a, b, c, d] } => {
                write!(
                    f,
                    "the feed profile is {a}, {b}, {c}, {d}; it needs parts of the feed within 0..1, one of them at least 0.5, and no ramps"
                )
            }
            Self::Interval { from, to } => {
                write!(f, "the piece runs from {from} to {to}; it needs 0 <= from < to <= 1")
            }
            Self::Length { length } => {
                write!(f, "the piece is {length} mm long, too short to be a motion; leave it out")
            }
            Self::Cusp => {
                write!(f, "1 + kappa d vanishes inside the piece, where its offset has a cusp; trim it before")
            }
            Self::Standstill => {
                write!(
                    f,
                    "the spline stands still inside the piece, as at a cusp; end the piece there or move its points apart"
                )
            }
            Self::Uneven => {
                write!(f, "the spline's speed varies too much along the piece for its correction polynomial; split it")
            }
            Self::Bow => write!(f, "the spline bends in z, but the piece does not say where z begins and ends"),
            Self::Sweep { sweep } => write!(f, "the arc turns by {sweep} rad; it must turn, and by one turn at most"),
            Self::NotFinite => write!(f, "a number of the piece is infinite or not a number"),
            Self::Reach => write!(f, "the piece leaves the range of machine coordinates, 4 m from the origin"),
            Self::Gap { width } => write!(f, "the piece begins {width} mm away from where the one before it ends"),
            Self::Open { width } => write!(f, "the path is called closed, but ends {width} mm away from its start"),
            Self::LastPoint { width } => write!(f, "the last point is {width} mm away from where the last piece ends"),
            Self::AfterLast => write!(f, "a piece follows the one that was called the last"),
            Self::Empty => write!(f, "the path has no pieces"),
            Self::LateFurther => {
                write!(
                    f,
                    "the piece moves z, and the path did not begin with where z is; give its first piece a travel in z"
                )
            }
            Self::SoftLimit { axis, beyond } => {
                let (end, name) =
                    (if beyond < 0.0 { "low" } else { "high" }, AXIS_NAMES.get(usize::from(axis)).unwrap_or(&"?"));
                let by = beyond.max(-beyond);
                write!(
                    f,
                    "the piece leaves the travel of axis {name} by {by} mm at its {end} end; move the part or the travel"
                )
            }
            Self::Pace { slope, bend, most } => {
                write!(
                    f,
                    "the pace is limited to {slope}/s, {bend}/s2 and {most}; it needs rates above zero and 1 to 2 at most"
                )
            }
            Self::SlowStop { slope, bend } => {
                write!(
                    f,
                    "a pace that changes by {slope}/s and {bend}/s2 would stop too slowly; 0.6/s and 6/s2 are enough"
                )
            }
        }
    }
}

impl core::error::Error for PathError {}

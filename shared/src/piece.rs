//! A piece of a path as it travels: from the planner on the host, over the wire, to the loader on the controller.
//!
//! Anything may be wrong in it; [`crate::loader::Loader`] is the only way from here to an [`crate::active::ActivePiece`] that
//! the tick executes. A piece stands in a frame of its own: parameter tau in -1/2..=1/2 over the piece's interval, coordinates
//! relative to the fixed-point [`Piece::origin`] in the middle of it. In that frame the polynomial coefficients are as small
//! as they can be, which is what keeps the f32 tick within nanometres of the curve.

use serde::{Deserialize, Serialize};

use crate::complex::Complex;
use crate::feed::Ramp;
use crate::fixed::{Fixed, Position};
use crate::further::Travel;
use crate::pace::PaceLimits;
use crate::profile::Profile;
use crate::real::Real;
use crate::spline::{CorrectionOrder, PolynomialSegment};

/// The curve of a piece in its local frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Shape<T> {
    /// A quintic PH curve at an offset distance.
    Ph {
        /// Coefficients of the preimage w = w_0 + w_1 tau + w_2 tau^2, in mm^(1/2); r' = w^2, and r(0) is the origin.
        preimage: [Complex<T>; 3],
        /// The signed offset distance d of equation (2) in mm, positive to the right of travel.
        offset: T,
    },
    /// A straight line that the tool's centre follows.
    Line {
        /// From the first to the last point, in mm; the origin is half-way.
        chord: Complex<T>,
    },
    /// A circular arc that the tool's centre follows.
    Arc {
        /// From the circle's centre to the middle of the arc, in mm; the origin is that middle.
        radius: Complex<T>,
        /// The signed angle from start to end in radians, positive anticlockwise; at most one turn.
        sweep: T,
        /// |1 + kappa d|: the centre's distance for a unit distance of the contact point. 1 on a fill arc, where the contact
        /// point rests and the feed is the centre's.
        ratio: T,
    },
    /// A polynomial curve that the tool's centre follows.
    Spline(SplineShape<T>),
}

/// A quintic or cubic in a frame with its origin at v = 0.
///
/// z is the first of the further axes. On the travel of the piece it goes to - rise (1/2 - v) + (1/4 - v^2) (b_0 + b_1 v + ..): its ends
/// are exact, whatever the bow.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SplineShape<T> {
    /// The coefficients of v to v^5, in mm.
    pub plane: [Complex<T>; 5],
    /// b_0 to b_3, in mm; zeros where z does not bend.
    pub bow: [T; 4],
    /// The feed correction polynomial that is fitted where the piece is loaded.
    pub correction: CorrectionOrder,
}

impl<T: Real> SplineShape<T> {
    /// The same curve in space, with a z that rises by so much from end to end, and is 0 in the middle without a bow.
    pub fn segment(&self, rise: T) -> PolynomialSegment<T, 3> {
        let [b0, b1, b2, b3] = self.bow;
        let quarter = T::lit(0.25);
        let z = [rise + b1 * quarter, b2 * quarter - b0, b3 * quarter - b1, -b2, -b3];
        let mut coefficients = [[T::ZERO, T::ZERO, b0 * quarter]; 6];
        for ((slot, plane), z) in coefficients.iter_mut().skip(1).zip(self.plane).zip(z) {
            *slot = [plane.re, plane.im, z];
        }
        PolynomialSegment(coefficients)
    }
}

/// A segment, a parameter interval and an offset distance, with the feed along it: the unit that a tick executes. `F` axes may
/// move with it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Piece<T, const F: usize = 1> {
    /// Where the local frame stands on the machine.
    pub origin: [Fixed; 2],
    /// The curve.
    pub shape: Shape<T>,
    /// First and last parameter on the segment that this piece was cut from, within 0..=1; for reports.
    pub interval: [T; 2],
    /// The contact feed V in mm/s (the centre feed on a fill arc).
    pub feed: T,
    /// The ramp at the start; none where the path enters smoothly.
    pub start: Option<Ramp<T>>,
    /// The ramp at the end; none where the path leaves smoothly.
    pub end: Option<Ramp<T>>,
    /// The feed over time, in the place of ramps and weight: from a planner. A piece has ramps or this.
    pub profile: Option<Profile<T>>,
    /// How the further axes move with it, linearly in arc length (but for the z of a spline); none where they stay. With it a line may have no chord: then it
    /// is as long as this.
    pub further: Option<Travel<F>>,
    /// On the last piece of a path, and only there: the exact point where the path ends. Further axes end where `further` does.
    pub last: Option<Position>,
}

/// What holds for all pieces of a job.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Header<T> {
    /// The weight w of equation (18), 0..=1: 0 keeps the contact feed, 1 the centre feed.
    pub weight: T,
    /// How the tick integrates equation (21).
    pub order: Order,
    /// Whether the path ends where it starts.
    pub closed: bool,
    /// The widest gap between two pieces that is taken for none, in mm.
    pub tolerance: T,
    /// Whether the path begins and ends at rest; otherwise at its feed.
    pub rest: bool,
    /// How starts, stops and overrides may change the pace.
    pub pace: PaceLimits<T>,
}

/// How a tick integrates equation (21).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Order {
    /// The first-order step of equation (22).
    First,
    /// With the Taylor term in dt^2.
    Second,
    /// With the Taylor terms in dt^2 and dt^3.
    Third,
    /// The integral itself, to rounding.
    Exact,
}

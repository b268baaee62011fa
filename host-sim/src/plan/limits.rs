//! What the axes and the path bear.

use shared::machine::{AxisSettings, MachineSettings};

use crate::machine::PathSettings;
use crate::path::PathPiece;

/// The time in s over which an acceleration is a mean, for a jerk: 8 ticks. A step of acceleration that is no larger than the jerk makes in
/// this time counts as none. Without such a time every change of curvature would be a rest: on the way from a line into an arc the jerk is
/// infinite at any speed.
pub const JERK_WINDOW: f64 = 8.0 * shared::TICK as f64;

/// x, y and z.
pub const AXES: usize = 3;

/// Limits of the axes, and of the path. Lengths in mm, times in s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// The largest |velocity| of each axis.
    pub velocity: [f64; AXES],
    /// The largest |acceleration| of each axis.
    pub acceleration: [f64; AXES],
    /// The largest |jerk| of each axis, over [`JERK_WINDOW`]; infinite where it has none.
    pub jerk: [f64; AXES],
    /// The largest step of each axis' velocity at a corner; 0 stops there.
    pub corner_step: [f64; AXES],
    /// The largest feed of the centre.
    pub feed: f64,
    /// The largest acceleration across the path; infinite where only the axes count.
    pub centripetal: f64,
}

impl Limits {
    /// Of a machine. None where it has no two axes; a third one that it does not have has no limits, and a path that moves it
    /// cannot be planned.
    ///
    /// Where nobody says what an axis' velocity may step by at a corner, it is what its acceleration makes in [`JERK_WINDOW`].
    pub fn of(machine: &MachineSettings, path: &PathSettings) -> Option<Self> {
        machine.axes.get(1)?;
        let of = |limit: fn(&AxisSettings) -> f64| {
            std::array::from_fn(|axis| machine.axes.get(axis).map_or(f64::INFINITY, limit))
        };
        let acceleration: [f64; AXES] = of(|axis| axis.acceleration);
        let mut corner_step = acceleration.map(|acceleration| acceleration * JERK_WINDOW);
        for (step, said) in corner_step.iter_mut().zip(path.corner_step.into_iter().flatten()) {
            *step = said;
        }
        Some(Self {
            velocity: of(|axis| axis.velocity),
            acceleration,
            jerk: of(|axis| axis.jerk),
            corner_step,
            feed: path.feed.unwrap_or(f64::INFINITY),
            centripetal: path.centripetal.unwrap_or(f64::INFINITY),
        })
    }

    /// The same without those of z where no piece moves it, so that they say nothing of a plane path.
    pub(super) fn of_moving(&self, pieces: &[PathPiece]) -> Self {
        let mut limits = *self;
        if !pieces.iter().any(PathPiece::moves_z) {
            for of_axes in [&mut limits.velocity, &mut limits.acceleration, &mut limits.jerk, &mut limits.corner_step] {
                of_axes[2] = f64::INFINITY;
            }
        }
        limits
    }

    /// Whether a piece moves z, of which there are no limits.
    pub(super) fn leave_open(&self, pieces: &[PathPiece]) -> bool {
        (self.acceleration[2].is_infinite() || self.velocity[2].is_infinite()) && pieces.iter().any(PathPiece::moves_z)
    }

    /// The same with every limit but the corner step times a factor.
    pub(super) fn with_margin(&self, [velocity, acceleration, jerk]: [f64; 3]) -> Self {
        Self {
            velocity: self.velocity.map(|v| v * velocity),
            acceleration: self.acceleration.map(|a| a * acceleration),
            jerk: self.jerk.map(|j| j * jerk),
            corner_step: self.corner_step,
            feed: self.feed * velocity,
            centripetal: self.centripetal * acceleration,
        }
    }
}

//! What the axes and the path bear.

use shared::machine::MachineSettings;

use crate::machine::PathSettings;

/// The time in s over which an acceleration is a mean, for a jerk: 8 ticks. A step of acceleration that is no larger than the jerk makes in
/// this time counts as none. Without such a time every change of curvature would be a rest: on the way from a line into an arc the jerk is
/// infinite at any speed.
pub const JERK_WINDOW: f64 = 8.0 * shared::TICK as f64;

/// Limits of x and y, and of the path. Lengths in mm, times in s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// The largest |velocity| of each axis.
    pub velocity: [f64; 2],
    /// The largest |acceleration| of each axis.
    pub acceleration: [f64; 2],
    /// The largest |jerk| of each axis, over [`JERK_WINDOW`]; infinite where it has none.
    pub jerk: [f64; 2],
    /// The largest step of each axis' velocity at a corner; 0 stops there.
    pub corner_step: [f64; 2],
    /// The largest feed of the centre.
    pub feed: f64,
    /// The largest acceleration across the path; infinite where only the axes count.
    pub centripetal: f64,
}

impl Limits {
    /// Of a machine's x and y. None where it has no two axes.
    ///
    /// Where nobody says what an axis' velocity may step by at a corner, it is what its acceleration makes in [`JERK_WINDOW`].
    pub fn of(machine: &MachineSettings, path: &PathSettings) -> Option<Self> {
        let [x, y] = [machine.axes.first()?, machine.axes.get(1)?];
        let usual = |acceleration: f64| acceleration * JERK_WINDOW;
        Some(Self {
            velocity: [x.velocity, y.velocity],
            acceleration: [x.acceleration, y.acceleration],
            jerk: [x.jerk, y.jerk],
            corner_step: path.corner_step.unwrap_or([usual(x.acceleration), usual(y.acceleration)]),
            feed: path.feed.unwrap_or(f64::INFINITY),
            centripetal: path.centripetal.unwrap_or(f64::INFINITY),
        })
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

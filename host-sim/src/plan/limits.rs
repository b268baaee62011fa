//! What the axes and the path bear.

use shared::machine::MachineSettings;

/// Limits of x and y, and of the path. Lengths in mm, times in s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// The largest |velocity| of each axis.
    pub velocity: [f64; 2],
    /// The largest |acceleration| of each axis.
    pub acceleration: [f64; 2],
    /// The largest step of each axis' velocity at a corner; 0 stops there.
    pub corner_step: [f64; 2],
    /// The largest acceleration across the path; infinite where only the axes count.
    pub centripetal: f64,
}

impl Limits {
    /// Of a machine's x and y. None where it has no two axes.
    pub fn of(machine: &MachineSettings, corner_step: [f64; 2]) -> Option<Self> {
        let [x, y] = [machine.axes.first()?, machine.axes.get(1)?];
        Some(Self {
            velocity: [x.velocity, y.velocity],
            acceleration: [x.acceleration, y.acceleration],
            corner_step,
            centripetal: f64::INFINITY,
        })
    }
}

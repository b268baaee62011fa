//! The axes of the machine that this firmware is built for.
//!
//! A bench-top mill: ball screws of 5 mm lead, encoders of 1000 lines read four-fold on the screws, and drives that close their own
//! velocity loop from an analog command of +-10 V.

use shared::servo::{DriveSettings, Servo, ServoSettings};

/// Axes with a servo: x and y.
pub const AXES: usize = 2;

/// The velocity that a drive's full command stands for, in mm/s.
pub const FULL_COMMAND: f64 = 250.0;

const AXIS: ServoSettings = ServoSettings {
    counts_per_mm: 800.0,
    position_gain: 50.0,
    integral_gain: 0.0,
    velocity_feedforward: 1.0,
    acceleration_feedforward: 0.0,
    drive: DriveSettings::Velocity { lag: 0.0, limit: FULL_COMMAND },
};

/// The servos of all axes. Load time.
pub fn settings() -> [Servo<f32>; AXES] {
    [AXIS, AXIS].map(|axis| match axis.activate(f64::from(shared::TICK)) {
        Ok(servo) => servo,
        // The settings are constants above: the first start of an image with faulty ones ends here, with the drives off.
        Err(_) => cortex_m::asm::udf(),
    })
}

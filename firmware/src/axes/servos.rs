//! Servo axes.
//!
//! A bench-top mill: ball screws of 5 mm lead, encoders of 1000 lines read four-fold on the screws, and drives that close their own
//! velocity loop from an analog command of +-10 V.

use shared::fixed::{Fixed, Position};
use shared::servo::{DriveSettings, Servo, ServoSettings, ServoState};

use super::Fault;
use crate::hardware::{Actuators, Drives, Encoders, enable};

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

/// See the module.
pub struct Axes {
    servos: [(Servo<f32>, ServoState<f32>); AXES],
    encoders: Encoders,
    drives: Drives,
    counts: [i32; AXES],
    commands: [f32; AXES],
}

impl Axes {
    /// At rest at the origin, wherever the machine stands. Load time.
    pub fn new(Actuators { encoders, drives }: Actuators) -> Self {
        let servos = [AXIS, AXIS].map(|axis| match axis.activate(f64::from(shared::TICK)) {
            Ok(servo) => (servo, servo.at_rest(Fixed(0), 0)),
            // The settings are constants above: the first start of an image with faulty ones ends here, with the drives off.
            Err(_) => cortex_m::asm::udf(),
        });
        Self { servos, encoders, drives, counts: [0; AXES], commands: [0.0; AXES] }
    }

    /// Reads the encoders: first in the tick, so that no sample depends on what the tick does.
    #[inline(always)]
    pub fn sense(&mut self) {
        self.counts = self.encoders.read();
    }

    /// Takes the axes to stand at `position`, and switches the drives on.
    pub fn start(&mut self, position: Position) {
        for ((servo, state), (coordinate, count)) in self.servos.iter_mut().zip(position.into_iter().zip(self.counts)) {
            *state = servo.at_rest(coordinate, count);
        }
        enable();
    }

    /// Motion is given up. The loops stay closed; whether the drives listen is up to their enable output.
    #[inline(always)]
    pub fn halt(&mut self) {}

    /// One tick: commands the drives so that the axes stand at `setpoint` at the next one.
    #[inline(always)]
    pub fn follow(&mut self, setpoint: Position) -> Result<(), Fault> {
        let inputs = setpoint.into_iter().zip(self.counts);
        for ((command, (servo, state)), (setpoint, count)) in self.commands.iter_mut().zip(&mut self.servos).zip(inputs)
        {
            *command = servo.step(state, setpoint, count);
        }
        self.drives.write(self.commands);
        Ok(())
    }

    /// What was put out: the drives' commands in mm/s, as the bits of f32.
    #[inline(always)]
    pub fn outputs(&self) -> [u32; AXES] {
        self.commands.map(f32::to_bits)
    }
}

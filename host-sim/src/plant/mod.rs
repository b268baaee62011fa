//! The machine on the simulator's axes: drives, motors, screws, friction, tables and encoders, in f64 and deterministic.
//!
//! A plant is read from TOML ([`parameters`]; errors name line, column, key and what would do) and runs beside the kernel, one
//! call a tick. A servo axis runs the very servo of the firmware ([`shared::servo`], f32); a stepping axis gets the very pulses of the
//! firmware ([`shared::steps`]), each at its slot. What stands behind those commands is an [`axis::Axis`], which knows nothing of ticks
//! and can hang on a virtual board's pins as well.
//!
//! | model | file | integration |
//! | --- | --- | --- |
//! | servo drive, one body | [`servo_axis`] | exact between two samples of the drive |
//! | servo drive, two bodies and a spring | [`servo_axis`] | leapfrog, second order |
//! | stepping motor | [`stepper_axis`] | leapfrog, second order |
//! | friction with rest | [`friction`] | exact |
//!
//! Lengths in mm, times in s. What went wrong on a machine (a drive at its limit, lost steps) is data in [`Measured`], not an error.

pub mod axis;
pub mod error;
pub mod friction;
pub mod parameters;
pub mod pulses;
pub mod servo_axis;
pub mod stepper_axis;
mod validate;

#[cfg(test)]
mod tests;

use shared::fixed::{Fixed, Position};
use shared::servo::{Servo, ServoState};

use axis::{Axis, Command};
pub use error::{Place, PlantError};
use pulses::Pulses;
use servo_axis::ServoAxis;
use stepper_axis::StepperAxis;
use validate::{Block, Checked};

/// The fitted drive of the published experiment.
pub const MILL: &str = include_str!("../../../examples/farouki2018-mill.toml");

/// Names of the coordinates, in the order of a [`Position`].
const NAMES: [&str; 3] = ["x", "y", "z"];

/// What is to be seen at the end of a tick, per coordinate. An axis that the plant does not model stands on its setpoint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured {
    /// Position by the encoder in mm; the true position of an axis that has none.
    pub encoder: [f64; 3],
    /// Where the table truly stands, in mm.
    pub position: [f64; 3],
    /// Whether the drive, or the servo's command, was at its limit.
    pub saturated: [bool; 3],
    /// Full steps by which a stepping axis has fallen away from its field; see [`axis::Reading::lost_steps`].
    pub lost_steps: [i32; 3],
    /// Whether a stepping axis was asked for more steps than its pulses allow, so that its field is not where the setpoint is.
    pub overrun: [bool; 3],
}

/// A machine in motion.
#[derive(Clone, Debug)]
pub struct Plant {
    name: String,
    source: String,
    tick: f64,
    axes: Vec<Driven>,
}

/// One coordinate with what moves it.
#[derive(Clone, Debug)]
pub struct Driven {
    coordinate: usize,
    drive: Drive,
}

#[derive(Clone, Debug)]
enum Drive {
    Servo { servo: Servo<f32>, state: ServoState<f32>, axis: ServoAxis, takes_velocity: bool, counts: i32, count: f64 },
    Stepper { pulses: Pulses, axis: StepperAxis, count: Option<f64> },
}

impl Plant {
    /// Reads a plant for a controller with this `tick` in s. All its axes rest at 0.
    pub fn from_toml(text: &str, tick: f64) -> Result<Self, PlantError> {
        let parameters = validate::read(text)?;
        if !(1e-7..=0.01).contains(&parameters.step) {
            let found = parameters.step.to_string();
            return Err(validate::fault(text, &["step"], "step", found, "1e-7 to 0.01 s"));
        }
        if parameters.axes.is_empty() {
            return Err(validate::fault(text, &["axis"], "axis", "an empty list".into(), "at least one axis"));
        }
        let mut axes: Vec<Driven> = Vec::new();
        for (index, axis) in parameters.axes.iter().enumerate() {
            let block = Block { text, index, step: parameters.step, axis };
            let checked = block.check()?;
            if axis.names.is_empty() {
                return Err(block.names_fault("an empty list".into()));
            }
            for name in &axis.names {
                let known = NAMES.iter().position(|known| known == name);
                let Some(coordinate) = known.filter(|known| axes.iter().all(|other| other.coordinate != *known)) else {
                    return Err(block.names_fault(format!("{name:?}")));
                };
                let drive = match checked {
                    Checked::Servo(settings, model) => {
                        let servo = settings.activate(tick).map_err(|error| block.refused(error))?;
                        let takes_velocity = matches!(model.law, servo_axis::DriveLaw::Velocity(_));
                        let (state, count) = (servo.at_rest(Fixed(0), 0), 1.0 / model.encoder.counts_per_mm);
                        Drive::Servo { servo, state, axis: ServoAxis::new(model), takes_velocity, counts: 0, count }
                    }
                    Checked::Stepper(model, times) => {
                        let pulses = Pulses::new(1.0 / model.microstep, times, tick);
                        let pulses = pulses.map_err(|error| block.pulses_refused(error))?;
                        let count = model.encoder.map(|encoder| 1.0 / encoder.counts_per_mm);
                        Drive::Stepper { pulses, axis: StepperAxis::new(model), count }
                    }
                };
                axes.push(Driven { coordinate, drive });
            }
        }
        Ok(Self { name: parameters.name, source: parameters.source, tick, axes })
    }

    /// The mill of the published experiment, [`MILL`].
    pub fn default_mill(tick: f64) -> Result<Self, PlantError> {
        Self::from_toml(MILL, tick)
    }

    /// What a person calls this plant.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Where its figures come from.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// The modelled coordinates.
    pub fn axes(&self) -> &[Driven] {
        &self.axes
    }

    /// Puts every axis at rest at `position`, as a machine that has been homed and sent there.
    pub fn rest_at(&mut self, position: Position) -> Measured {
        let mut measured = Measured::ideal(position);
        for axis in &mut self.axes {
            axis.rest_at(position, &mut measured);
        }
        measured
    }

    /// One tick: `setpoint` is where the machine shall be at its end, and what comes back is where it is then.
    #[inline]
    pub fn advance(&mut self, setpoint: Position) -> Measured {
        let mut measured = Measured::ideal(setpoint);
        for axis in &mut self.axes {
            axis.advance(setpoint, self.tick, &mut measured);
        }
        measured
    }
}

impl Measured {
    /// Every axis on its setpoint: a machine without drives.
    pub fn ideal(setpoint: Position) -> Self {
        let position = setpoint.map(Fixed::to_mm);
        Self { encoder: position, position, ..Self::default() }
    }
}

impl Driven {
    /// 0, 1, 2 for x, y, z.
    pub fn coordinate(&self) -> usize {
        self.coordinate
    }

    /// `x`, `y` or `z`.
    pub fn name(&self) -> &'static str {
        NAMES.get(self.coordinate).copied().unwrap_or("?")
    }

    /// Whether a stepping motor moves it; a servo otherwise.
    pub fn is_stepper(&self) -> bool {
        matches!(self.drive, Drive::Stepper { .. })
    }

    /// The drive, motor and table alone, as they stand, for a controller elsewhere: a virtual board's pins.
    pub fn detached(&self) -> Box<dyn Axis + Send> {
        match &self.drive {
            Drive::Servo { axis, .. } => Box::new(*axis),
            Drive::Stepper { axis, .. } => Box::new(*axis),
        }
    }

    fn rest_at(&mut self, position: Position, measured: &mut Measured) {
        let at = position[self.coordinate];
        match &mut self.drive {
            Drive::Servo { servo, state, axis, counts, count, .. } => {
                let reading = axis.rest_at(at.to_mm());
                *counts = reading.counts;
                *state = servo.at_rest(at, reading.counts);
                measured.position[self.coordinate] = reading.position;
                measured.encoder[self.coordinate] = f64::from(reading.counts) * *count;
            }
            Drive::Stepper { pulses, axis, count } => {
                let reading = axis.rest_at_microstep(pulses.rest_at(at).into());
                measured.position[self.coordinate] = reading.position;
                measured.encoder[self.coordinate] = count.map_or(reading.position, |mm| f64::from(reading.counts) * mm);
            }
        }
    }

    #[inline]
    fn advance(&mut self, setpoint: Position, tick: f64, measured: &mut Measured) {
        let at = setpoint[self.coordinate];
        let (reading, count) = match &mut self.drive {
            Drive::Servo { servo, state, axis, takes_velocity, counts, count } => {
                let command = f64::from(servo.step(state, at, *counts));
                let command = if *takes_velocity { Command::Velocity(command) } else { Command::Acceleration(command) };
                let mut reading = axis.advance(command, tick);
                reading.saturated |= state.is_saturated();
                *counts = reading.counts;
                (reading, Some(*count))
            }
            Drive::Stepper { pulses, axis, count } => {
                let (pulses, result) = pulses.play(at);
                measured.overrun[self.coordinate] = result.is_err();
                (axis.advance_through(pulses, tick), *count)
            }
        };
        measured.position[self.coordinate] = reading.position;
        measured.encoder[self.coordinate] = count.map_or(reading.position, |mm| f64::from(reading.counts) * mm);
        measured.saturated[self.coordinate] = reading.saturated;
        measured.lost_steps[self.coordinate] = reading.lost_steps;
    }
}

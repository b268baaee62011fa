//! From what a person writes to what the models integrate: every value checked, units turned into mm, s and pushes per mass.
//!
//! With R = 2 pi / lead, in rad/m: an inertia J weighs J R^2 at the nut, a torque T pushes with T R, a viscous torque D with D R^2.

use std::f64::consts::TAU;

use shared::servo::{DriveSettings, ServoError, ServoSettings};
use shared::steps::StepError;
use shared::steps::settings::{LEAST_STEPS_PER_MM, MOST_STEPS_PER_MM};
use toml::de::{DeTable, DeValue};

use super::axis::Encoder;
use super::error::{Place, PlantError};
use super::friction::Friction;
use super::parameters::{AxisParameters, DriveParameters, EncoderParameters, PlantParameters};
use super::pulses::InputTimes;
use super::servo_axis::{DriveLaw, ServoAxisModel, Spring};
use super::stepper_axis::StepperAxisModel;

/// The longest time at a stepping drive's input, in s.
const LONGEST_INPUT: f64 = 1e-4;

/// What a block of axes has become.
#[derive(Clone, Copy, Debug)]
pub enum Checked {
    /// A servo drive with its controller.
    Servo(ServoSettings, ServoAxisModel),
    /// A stepping drive, with the times at its inputs.
    Stepper(StepperAxisModel, InputTimes),
}

/// Reads the form; ranges are [`Block::check`]'s.
pub fn read(text: &str) -> Result<PlantParameters, PlantError> {
    toml::from_str(text).map_err(|error| PlantError::Form {
        place: Place::of(text, error.span().map_or(0, |span| span.start)),
        message: error.message().trim().replace('\n', "; "),
    })
}

/// A fault in the plant as a whole.
pub fn fault(text: &str, path: &[&str], key: &str, found: String, needed: &str) -> PlantError {
    PlantError::Value { place: locate(text, None, path), key: key.into(), found, needed: needed.into() }
}

/// The place of a key, or of the innermost table that should hold it.
fn locate(text: &str, block: Option<usize>, path: &[&str]) -> Place {
    let mut at = 0;
    if let Ok(document) = DeTable::parse(text) {
        let mut table = Some(document.get_ref());
        if let Some(index) = block {
            let axis = document.get_ref().get("axis").and_then(|axes| axes.get_ref().as_array()?.get(index));
            at = axis.map_or(0, |axis| axis.span().start);
            table = axis.and_then(|axis| axis.get_ref().as_table());
        }
        for key in path {
            let Some((name, value)) = table.and_then(|table| table.get_key_value(*key)) else { break };
            at = if matches!(value.get_ref(), DeValue::Table(_)) { name.span().start } else { value.span().start };
            table = value.get_ref().as_table();
        }
    }
    Place::of(text, at)
}

/// A bound as a person would write it: three digits, and no row of zeros.
fn written(bound: f64) -> String {
    // Rounding by way of the text keeps the shortest decimal.
    let short = format!("{bound:.2e}").parse().unwrap_or(bound);
    let bound = if (short - bound).abs() > 1e-9 * bound.abs() && bound.abs() < 1000.0 { short } else { bound };
    if bound != 0.0 && bound.abs() < 1e-3 { format!("{bound:e}") } else { bound.to_string() }
}

/// One block of axes under examination.
pub struct Block<'a> {
    /// The file.
    pub text: &'a str,
    /// Which `[[axis]]` it is.
    pub index: usize,
    /// The longest integration step in s.
    pub step: f64,
    /// What it says.
    pub axis: &'a AxisParameters,
}

impl Block<'_> {
    fn fault(&self, path: &[&str], found: String, needed: String) -> PlantError {
        let key = format!("axis {}: {}", self.axis.names.join(", "), path.join("."));
        PlantError::Value { place: locate(self.text, Some(self.index), path), key, found, needed }
    }

    /// `value` where it lies in `least..=most`; a NaN does not.
    fn within(&self, path: &[&str], value: f64, least: f64, most: f64, unit: &str) -> Result<f64, PlantError> {
        if value >= least && value <= most {
            return Ok(value);
        }
        Err(self.fault(path, value.to_string(), format!("{} to {} {unit}", written(least), written(most))))
    }

    /// The names of the block are not what a plant can use.
    pub fn names_fault(&self, found: String) -> PlantError {
        self.fault(&["names"], found, "some of \"x\", \"y\", \"z\", each once in the file".into())
    }

    /// The key of a servo's setting that the shared code refused.
    pub fn refused(&self, error: ServoError) -> PlantError {
        let section = if matches!(error, ServoError::CountsPerMm(_)) { "encoder" } else { "servo" };
        self.fault(&[section, error.key()], error.found().to_string(), error.remedy().into())
    }

    /// The shared code refused the pulses.
    pub fn pulses_refused(&self, error: StepError) -> PlantError {
        let path = match error {
            StepError::Time { time, .. } => ["drive", "stepper", time.key()],
            _ => ["drive", "stepper", "microsteps"],
        };
        PlantError::Form { place: locate(self.text, Some(self.index), &path), message: error.to_string() }
    }

    /// Sliding friction and what it takes to leave rest.
    fn dry(&self, section: &str, sliding: f64, rest: Option<f64>, unit: &str) -> Result<[f64; 2], PlantError> {
        self.within(&[section, "coulomb"], sliding, 0.0, 1e6, unit)?;
        let rest = rest.unwrap_or(sliding);
        self.within(&[section, "breakaway"], rest, sliding, 1e6, unit)?;
        Ok([sliding, rest])
    }

    fn encoder(&self, encoder: &EncoderParameters) -> Result<Encoder, PlantError> {
        let counts_per_mm =
            self.within(&["encoder", "counts_per_mm"], encoder.counts_per_mm, 0.01, 131_072.0, "counts/mm")?;
        Ok(Encoder { counts_per_mm, on_table: encoder.on_table })
    }

    /// Every range, and the models that the values amount to.
    pub fn check(&self) -> Result<Checked, PlantError> {
        let axis = self.axis;
        let (motor, table) = (&axis.motor, &axis.table);
        let per_metre = TAU / (1e-3 * self.within(&["lead"], axis.lead, 0.01, 10_000.0, "mm per turn")?);
        let play = self.within(&["play"], axis.play, 0.0, 100.0, "mm")?;
        let rotor = self.within(&["motor", "motor_inertia"], motor.motor_inertia, 0.0, 1e3, "kg m^2")?;
        let screw = self.within(&["motor", "screw_inertia"], motor.screw_inertia, 0.0, 1e3, "kg m^2")?;
        let motor_viscous = self.within(&["motor", "viscous"], motor.viscous, 0.0, 1e3, "N m s/rad")?;
        let motor_dry = self.dry("motor", motor.coulomb, motor.breakaway, "N m")?;
        let mass = self.within(&["table", "mass"], table.mass, 0.0, 1e6, "kg")?;
        let table_viscous = self.within(&["table", "viscous"], table.viscous, 0.0, 1e6, "N s/mm")?;
        let table_dry = self.dry("table", table.coulomb, table.breakaway, "N")?;
        let load = self.within(&["table", "load"], table.load, -1e6, 1e6, "N")?;

        let turning = (rotor + screw) * per_metre * per_metre;
        let all = turning + mass;
        if all <= 0.0 {
            return Err(self.fault(
                &["motor", "motor_inertia"],
                "0".into(),
                "above 0, unless the table has a mass".into(),
            ));
        }
        // Forces of the motor's side at the nut, in N and N s/m.
        let motor_dry = motor_dry.map(|torque| torque * per_metre);
        let motor_viscous = motor_viscous * per_metre * per_metre;
        let table_viscous = 1e3 * table_viscous;
        let friction = |viscous: f64, dry: [f64; 2], mass: f64| Friction {
            viscous: viscous / mass,
            coulomb: 1e3 * dry[0] / mass,
            breakaway: 1e3 * dry[1] / mass,
        };
        let together =
            friction(motor_viscous + table_viscous, [motor_dry[0] + table_dry[0], motor_dry[1] + table_dry[1]], all);
        let spring = match &axis.coupling {
            None => None,
            Some(coupling) => {
                let stiffness = self.within(&["coupling", "stiffness"], coupling.stiffness, 1e-3, 1e9, "N/mm")?;
                let damping = coupling.damping;
                let fault = |path: &[&str]| {
                    self.fault(path, "0".into(), "above 0, because the coupling separates motor and table".into())
                };
                if mass <= 0.0 {
                    return Err(fault(&["table", "mass"]));
                }
                if turning <= 0.0 {
                    return Err(fault(&["motor", "motor_inertia"]));
                }
                let frequency = (1e3 * stiffness * (1.0 / turning + 1.0 / mass)).sqrt() / TAU;
                self.resolved(&["coupling", "stiffness"], stiffness, frequency)?;
                let most = 1e-3 / (self.step * (1.0 / turning + 1.0 / mass));
                self.within(&["coupling", "damping"], damping, 0.0, most, "N s/mm with this step")?;
                let spring = Spring { stiffness, damping, backlash: play, masses: [turning, mass] };
                Some((spring, friction(table_viscous, table_dry, mass)))
            }
        };
        let driven = if spring.is_some() { turning } else { all };
        let load = 1e3 * load / if spring.is_some() { mass } else { all };
        let push = |torque: f64| 1e3 * torque * per_metre / driven;
        let servo = |law, limit, sample_time, encoder| ServoAxisModel {
            law,
            limit,
            sample_time,
            friction: if spring.is_some() { friction(motor_viscous, motor_dry, turning) } else { together },
            spring,
            play: if spring.is_some() { 0.0 } else { play },
            load,
            encoder,
            step: self.step,
        };

        match axis.drive {
            DriveParameters::Velocity { peak_torque, loop_gain, sample_time } => {
                let section = ["drive", "velocity"];
                let peak = self.within(&[&section[..], &["peak_torque"]].concat(), peak_torque, 1e-9, 1e6, "N m")?;
                self.within(&[&section[..], &["sample_time"]].concat(), sample_time, 0.0, 1.0, "s")?;
                // A sampled loop overshoots at once where it makes up for more than the whole error in one sample.
                let rate = per_metre * per_metre / driven;
                let most = 1.0 / (rate * sample_time.max(self.step));
                self.within(&[&section[..], &["loop_gain"]].concat(), loop_gain, 1e-12, most, "N m s/rad")?;
                let encoder = self.servo_encoder()?;
                let lag = all / (loop_gain * per_metre * per_metre);
                let settings = self.tuning(encoder, Some(lag))?;
                Ok(Checked::Servo(
                    settings,
                    servo(DriveLaw::Velocity(loop_gain * rate), push(peak), sample_time, encoder),
                ))
            }
            DriveParameters::Torque { peak_torque } => {
                let peak = self.within(&["drive", "torque", "peak_torque"], peak_torque, 1e-9, 1e6, "N m")?;
                let encoder = self.servo_encoder()?;
                let settings = self.tuning(encoder, None)?;
                Ok(Checked::Servo(settings, servo(DriveLaw::Torque(all / driven), push(peak), 0.0, encoder)))
            }
            DriveParameters::Stepper {
                full_steps,
                microsteps,
                holding_torque,
                corner_speed,
                pulse,
                gap,
                setup,
                hold,
            } => {
                let path = |key: &'static str| ["drive", "stepper", key];
                if spring.is_some() {
                    return Err(self.fault(&["coupling"], "given".into(), "left out with a stepper drive".into()));
                }
                if axis.servo.is_some() {
                    return Err(self.fault(&["servo"], "given".into(), "left out with a stepper drive".into()));
                }
                if !(4..=4000).contains(&full_steps) || full_steps % 4 != 0 {
                    let needed = "a multiple of 4 in 4 to 4000".into();
                    return Err(self.fault(&path("full_steps"), full_steps.to_string(), needed));
                }
                self.within(&path("microsteps"), microsteps.into(), 1.0, 256.0, "in a full step")?;
                self.within(&path("holding_torque"), holding_torque, 1e-9, 1e6, "N m")?;
                self.within(&path("corner_speed"), corner_speed, 1e-3, 1e6, "rad/s")?;
                let holding = push(holding_torque);
                let time = |key, value| self.within(&path(key), value, 0.0, LONGEST_INPUT, "s");
                let times = InputTimes {
                    pulse: time("pulse", pulse)?,
                    gap: time("gap", gap)?,
                    setup: time("setup", setup)?,
                    hold: time("hold", hold)?,
                };
                let turn = 4.0 * axis.lead / f64::from(full_steps);
                let steps_per_mm = f64::from(4 * microsteps) / turn;
                if !(LEAST_STEPS_PER_MM..=MOST_STEPS_PER_MM).contains(&steps_per_mm) {
                    let needed = format!("such that a mm has {LEAST_STEPS_PER_MM} to {MOST_STEPS_PER_MM} of them");
                    return Err(self.fault(&path("microsteps"), microsteps.to_string(), needed));
                }
                self.resolved(&path("holding_torque"), holding_torque, (holding * TAU / turn).sqrt() / TAU)?;
                let model = StepperAxisModel {
                    microstep: turn / f64::from(4 * microsteps),
                    turn: 4 * microsteps as i32,
                    holding,
                    corner_speed: 1e3 * corner_speed / per_metre,
                    friction: together,
                    load,
                    play,
                    encoder: axis.encoder.as_ref().map(|encoder| self.encoder(encoder)).transpose()?,
                    step: self.step,
                };
                Ok(Checked::Stepper(model, times))
            }
        }
    }

    /// An oscillation of `frequency` Hz must be followed by the integration step.
    fn resolved(&self, path: &[&str], value: f64, frequency: f64) -> Result<(), PlantError> {
        if frequency * TAU * self.step <= 1.0 {
            return Ok(());
        }
        let step = 0.5 / (frequency * TAU);
        let needed = format!("lower, or step at most {step:.2e} s, because it makes a resonance of {frequency:.0} Hz");
        Err(self.fault(path, value.to_string(), needed))
    }

    fn servo_encoder(&self) -> Result<Encoder, PlantError> {
        let missing = || self.fault(&["encoder"], "missing".into(), "given for a servo drive".into());
        self.encoder(self.axis.encoder.as_ref().ok_or_else(missing)?)
    }

    /// The controller's settings; `lag` is the time constant of a velocity drive, `None` stands for a torque drive.
    fn tuning(&self, encoder: Encoder, lag: Option<f64>) -> Result<ServoSettings, PlantError> {
        let missing = || self.fault(&["servo"], "missing".into(), "given for a servo drive".into());
        let tuning = self.axis.servo.as_ref().ok_or_else(missing)?;
        let path = ["servo", "velocity_gain"];
        let drive = match (lag, tuning.velocity_gain) {
            (Some(lag), None) => DriveSettings::Velocity { lag, limit: tuning.limit },
            (None, Some(velocity_gain)) => DriveSettings::Acceleration { velocity_gain, limit: tuning.limit },
            (Some(_), Some(gain)) => {
                return Err(self.fault(
                    &path,
                    gain.to_string(),
                    "left out with a velocity drive, which has loop_gain".into(),
                ));
            }
            (None, None) => {
                return Err(self.fault(&path, "missing".into(), "given for a torque drive, in 1/s".into()));
            }
        };
        Ok(ServoSettings {
            counts_per_mm: encoder.counts_per_mm,
            position_gain: tuning.position_gain,
            integral_gain: tuning.integral_gain,
            velocity_feedforward: tuning.velocity_feedforward,
            acceleration_feedforward: tuning.acceleration_feedforward,
            drive,
        })
    }
}

//! The machine as the tick uses it; made only by [`MachineSettings::activate`], so every value is in range.

use heapless::Vec;

use super::check::MachineError;
use super::settings::{AxisDrive, AxisName, HostLost, MachineSettings, StepDrive};
use super::{End, HomeSwitch, Input};
use crate::TICK;
use crate::extent::SoftLimits;
use crate::fixed::{Fixed, REACH_MM};
use crate::homing::HomingPlan;
use crate::safety::{Levels, SafetyConfig, Wiring};
use crate::servo::Servo;
use crate::steps::MOST_AXES;

/// A machine. Bit k of a set of axes is axis k.
#[derive(Clone, Debug)]
pub struct Machine {
    /// The axes.
    pub axes: Vec<Axis, MOST_AXES>,
    /// What [`crate::safety::Safety::step`] goes by.
    pub safety: SafetyConfig,
    /// Which inputs there are, and their polarity.
    pub wiring: Wiring,
    /// The axes with an output that gives power.
    pub enables: u8,
    /// Those of them whose output acts while low.
    pub enables_low: u8,
    /// What to do with a motion whose host has vanished.
    pub host_lost: HostLost,
    /// How the axes find home.
    pub homing: HomingPlan,
}

/// An axis.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// Its name.
    pub name: AxisName,
    /// The lowest and the highest coordinate of a job.
    pub travel: [Fixed; 2],
    /// The highest velocity in mm/s.
    pub velocity: f32,
    /// The highest acceleration in mm/s^2.
    pub acceleration: f32,
    /// The highest jerk in mm/s^3.
    pub jerk: f32,
    /// What moves it.
    pub drive: Drive,
}

/// What moves an axis.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant, reason = "six of them at most, and no heap")]
pub enum Drive {
    /// Steps; the pins are the board's to add, by [`StepDrive::on_pins`].
    Step(StepDrive),
    /// A servo loop.
    Servo {
        /// The loop.
        servo: Servo<f32>,
        /// The distance between setpoint and encoder that is a fault, in mm.
        following_error: f32,
        /// Whether the encoder counts down in the positive direction.
        encoder_inverted: bool,
        /// Whether the command's sign is to be changed.
        command_inverted: bool,
    },
}

impl MachineSettings {
    /// Checks every value and turns the settings into what the tick uses. Load time.
    pub fn activate(&self) -> Result<Machine, MachineError> {
        self.check()?;
        let mut machine = Machine {
            axes: Vec::new(),
            safety: SafetyConfig {
                debounce: ticks(self.debounce),
                release: ticks(self.release),
                ..SafetyConfig::default()
            },
            wiring: Wiring {
                connected: Levels { estop: true, ..Levels::default() },
                active_low: Levels { estop: self.estop.active_low, ..Levels::default() },
            },
            enables: 0,
            enables_low: 0,
            host_lost: self.host_lost,
            homing: HomingPlan::new(ticks(self.debounce)),
        };
        for (axis, one) in (0_u8..).zip(&self.axes) {
            let bit = 1_u8.wrapping_shl(u32::from(axis));
            machine.connect(one, bit);
            machine.homing.add(axis, one);
            let drive = match &one.drive {
                AxisDrive::Step(drive) => Drive::Step(*drive),
                AxisDrive::Servo(drive) => {
                    machine.safety.encoders |= bit;
                    let servo = drive.control.activate(f64::from(TICK));
                    Drive::Servo {
                        servo: servo.map_err(|error| MachineError::Servo { axis, error })?,
                        following_error: drive.following_error as f32,
                        encoder_inverted: drive.encoder_inverted,
                        command_inverted: drive.command_inverted,
                    }
                }
            };
            let axis = Axis {
                name: one.name,
                travel: one.travel.map(Fixed::from_mm),
                velocity: one.velocity as f32,
                acceleration: one.acceleration as f32,
                jerk: one.jerk as f32,
                drive,
            };
            // As many fit as there were settings.
            if machine.axes.push(axis).is_err() {
                break;
            }
        }
        Ok(machine)
    }
}

impl Machine {
    /// No machine: no axis moves, and a stop that is open is pressed.
    pub fn none() -> Self {
        Self {
            axes: Vec::new(),
            safety: SafetyConfig { debounce: 1, release: 1, ..SafetyConfig::default() },
            wiring: Wiring { connected: Levels { estop: true, ..Levels::default() }, active_low: Levels::default() },
            enables: 0,
            enables_low: 0,
            host_lost: HostLost::default(),
            homing: HomingPlan::new(1),
        }
    }

    /// What jobs may use of the axes x, y and z. An axis that there is not has no limits but the range of coordinates.
    pub fn soft_limits(&self) -> SoftLimits {
        let travel = |name| {
            let axis = self.axes.iter().find(|axis| axis.name == name);
            axis.map_or([-REACH_MM, REACH_MM].map(Fixed::from_mm), |axis| axis.travel)
        };
        SoftLimits { plane: [travel(AxisName::X), travel(AxisName::Y)], further: [travel(AxisName::Z)] }
    }

    /// Takes over the inputs and outputs of one axis.
    fn connect(&mut self, one: &super::AxisSettings, bit: u8) {
        let Wiring { connected, active_low } = &mut self.wiring;
        let mut input = |input: Option<Input>, of: fn(&mut Levels) -> &mut u8| {
            if let Some(Input { active_low: low }) = input {
                *of(connected) |= bit;
                *of(active_low) |= if low { bit } else { 0 };
            }
        };
        input(one.low_limit, |levels| &mut levels.low);
        input(one.high_limit, |levels| &mut levels.high);
        input(one.home_switch, |levels| &mut levels.home);
        input(one.drive_fault, |levels| &mut levels.drive_fault);
        if let Some(enable) = one.enable {
            self.enables |= bit;
            self.enables_low |= if enable.active_low { bit } else { 0 };
        }
        let safety = &mut self.safety;
        safety.axes |= bit;
        if let Some(homing) = one.homing {
            safety.homing |= bit;
            match (homing.switch, homing.toward) {
                (HomeSwitch::Home, _) => {}
                (HomeSwitch::Limit, End::Low) => safety.home_low |= bit,
                (HomeSwitch::Limit, End::High) => safety.home_high |= bit,
            }
        }
    }
}

/// The ticks that last at least `seconds`, which are checked to be at most 0.2.
fn ticks(seconds: f64) -> u8 {
    libm::ceil(seconds / f64::from(TICK) * (1.0 - 1e-9)) as u8
}

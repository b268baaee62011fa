//! What a person writes about a machine; anything may be wrong in it. Lengths in mm, times in s.

use heapless::{String, Vec};
use serde::{Deserialize, Serialize};

use crate::safety::End;
use crate::servo::ServoSettings;
use crate::steps::{MOST_AXES, Pin, StepSettings, slots_in};

/// The longest name of a machine, in bytes.
pub const NAME_SIZE: usize = 32;

/// A machine: what `machine.toml` says, and what the controller keeps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MachineSettings {
    /// What people call it.
    pub name: String<NAME_SIZE>,
    /// What to do with a motion whose host has vanished.
    #[serde(default)]
    pub host_lost: HostLost,
    /// The emergency stop's input. There is no machine without.
    pub estop: Input,
    /// For how long a limit or home switch must act, in s; 0 to 0.1.
    pub debounce: f64,
    /// For how long an emergency stop or a drive's fault must have ended, in s; 0 to 0.2.
    pub release: f64,
    /// The axes, in the order of the boards' connectors; one to six.
    #[serde(rename = "axis")]
    pub axes: Vec<AxisSettings, MOST_AXES>,
}

/// What to do with a motion whose host has vanished.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HostLost {
    /// Run to the end of what is queued, and rest there.
    Finish,
    /// Brake on the path at once.
    #[default]
    Brake,
}

/// An input that is connected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// Whether it acts while low.
    #[serde(default)]
    pub active_low: bool,
}

/// An output that is connected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Output {
    /// Whether it acts while low.
    #[serde(default)]
    pub active_low: bool,
}

/// The name of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AxisName {
    /// x, first of the plane.
    X,
    /// y, second of the plane.
    Y,
    /// z.
    Z,
    /// a.
    A,
    /// b.
    B,
    /// c.
    C,
}

impl AxisName {
    /// The letter.
    pub const fn letter(self) -> char {
        match self {
            Self::X => 'x',
            Self::Y => 'y',
            Self::Z => 'z',
            Self::A => 'a',
            Self::B => 'b',
            Self::C => 'c',
        }
    }
}

/// One axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisSettings {
    /// Its name, each once.
    pub name: AxisName,
    /// The lowest and the highest coordinate that a job may ask for, in mm; within 4 m of zero.
    pub travel: [f64; 2],
    /// The highest velocity in mm/s; 0.001 to 10 000.
    pub velocity: f64,
    /// The highest acceleration in mm/s^2; 4 to 1e6.
    pub acceleration: f64,
    /// The highest jerk in mm/s^3; 4 to 1e9.
    pub jerk: f64,
    /// What moves it.
    pub drive: AxisDrive,
    /// The output that gives its drive power, where it has one.
    #[serde(default)]
    pub enable: Option<Output>,
    /// The input by which its drive reports a fault, where it has one.
    #[serde(default)]
    pub drive_fault: Option<Input>,
    /// The limit switch at its low end, where there is one.
    #[serde(default)]
    pub low_limit: Option<Input>,
    /// The limit switch at its high end, where there is one.
    #[serde(default)]
    pub high_limit: Option<Input>,
    /// The home switch, where there is one.
    #[serde(default)]
    pub home_switch: Option<Input>,
    /// How it finds home; without it the position of the axis stays unknown.
    #[serde(default)]
    pub homing: Option<HomingSettings>,
}

/// What moves an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AxisDrive {
    /// A step and direction drive.
    Step(StepDrive),
    /// A servo drive with an encoder.
    Servo(ServoDrive),
}

/// A step and direction drive. Its pins are the board's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepDrive {
    /// Steps per mm; 0.01 to 131 072.
    pub steps_per_mm: f64,
    /// The least width of a pulse in s; 1e-7 to 1e-4.
    pub pulse: f64,
    /// The least pause between two pulses in s; 1e-7 to 1e-4.
    pub gap: f64,
    /// The least time from a change of direction to a pulse in s; 1e-7 to 1e-4.
    pub setup: f64,
    /// The least time from a pulse to a change of direction in s; 0 to 1e-4.
    pub hold: f64,
    /// Whether a pulse is low.
    #[serde(default)]
    pub step_inverted: bool,
    /// Whether low is the positive direction.
    #[serde(default)]
    pub direction_inverted: bool,
}

impl StepDrive {
    /// The settings of the pulses on a board that has this axis on these pins, as port and bit, and so many slots in a tick. What a
    /// slot cannot resolve becomes longer. Load time.
    pub fn on_pins(&self, step: (u8, u8), direction: (u8, u8), slots: usize) -> StepSettings {
        StepSettings {
            steps_per_mm: self.steps_per_mm,
            step: Pin { port: step.0, bit: step.1, inverted: self.step_inverted },
            direction: Pin { port: direction.0, bit: direction.1, inverted: self.direction_inverted },
            pulse: slots_in(self.pulse, slots),
            gap: slots_in(self.gap, slots),
            setup: slots_in(self.setup, slots),
            hold: slots_in(self.hold, slots),
        }
    }
}

/// A servo drive with an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ServoDrive {
    /// The distance between setpoint and encoder that is a fault, in mm; 0.001 to 100.
    pub following_error: f64,
    /// Whether the encoder counts down in the positive direction.
    #[serde(default)]
    pub encoder_inverted: bool,
    /// Whether the command's sign is to be changed.
    #[serde(default)]
    pub command_inverted: bool,
    /// Encoder and loop.
    pub control: ServoSettings,
}

/// How an axis finds home: fast to the switch, back off, slowly to the switch, and off it to the home position.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HomingSettings {
    /// Which switch it looks for.
    pub switch: HomeSwitch,
    /// Towards which end.
    pub toward: End,
    /// The velocity of the first approach in mm/s; at most that of the axis.
    pub fast: f64,
    /// The velocity of the second approach in mm/s, which the accuracy is proportional to; 0.01 and more, at most `fast`.
    pub slow: f64,
    /// How far behind the switch the second approach begins, in mm; 0.01 to 100, more than the switch's hysteresis.
    pub back_off: f64,
    /// How far from the switch home is, in mm; 0.01 to 100, more than the switch's hysteresis.
    pub pull_off: f64,
    /// The coordinate of home, in mm; within the travel.
    pub position: f64,
    /// The axes of the lowest number go first, those of the same number together; 0 to 5.
    #[serde(default)]
    pub order: u8,
}

/// Which switch marks home.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HomeSwitch {
    /// The home switch.
    Home,
    /// The limit switch at the end towards which the axis goes.
    Limit,
}

impl AxisSettings {
    /// The input by which this axis finds home, if it is connected.
    pub fn homing_input(&self) -> Option<Input> {
        let homing = self.homing?;
        match (homing.switch, homing.toward) {
            (HomeSwitch::Home, _) => self.home_switch,
            (HomeSwitch::Limit, End::Low) => self.low_limit,
            (HomeSwitch::Limit, End::High) => self.high_limit,
        }
    }
}

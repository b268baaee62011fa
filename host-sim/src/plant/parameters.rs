//! What a plant's TOML file holds, in the units of data sheets. Anything may be wrong in it; `Plant::from_toml` says what.
//!
//! ```toml
//! name = "small mill"
//! source = "data sheets of ..."            # where the figures come from
//! step = 0.000244140625                    # s, the longest integration step
//! [[axis]]                                 # one block may stand for several like axes; an axis without a block is ideal
//! names = ["x", "y"]
//! lead = 5.0                               # mm per turn of the screw
//! play = 0.0                               # mm between nut and table; with a coupling its dead zone
//! [axis.motor]                             # the motor, with the screw on its shaft
//! motor_inertia = 0.0003                   # kg m^2
//! screw_inertia = 0.0001                   # kg m^2
//! viscous = 0.001                          # N m s/rad
//! coulomb = 0.05                           # N m; breakaway = 0.07 where leaving rest takes more
//! [axis.table]
//! mass = 60.0                              # kg
//! viscous = 0.2                            # N s/mm
//! coulomb = 30.0                           # N; breakaway likewise
//! load = 0.0                               # N, constant, along the axis
//! [axis.coupling]                          # the resonance; left out, motor and table are one body
//! stiffness = 40000.0                      # N/mm
//! damping = 5.0                            # N s/mm
//! [axis.encoder]
//! counts_per_mm = 1000.0
//! on_table = false
//! [axis.drive.velocity]                    # or axis.drive.torque, or axis.drive.stepper
//! peak_torque = 9.0                        # N m: the peak current times the motor's torque constant
//! loop_gain = 0.08                         # N m s/rad
//! sample_time = 0.0                        # s; 0 looks at every integration step
//! [axis.servo]                             # the tuning of the controller for this axis; see shared::servo
//! position_gain = 170.0
//! velocity_feedforward = 1.0
//! limit = 500.0                            # mm/s, or mm/s^2 for a torque drive, which also takes velocity_gain
//! ```

use serde::{Deserialize, Serialize};

/// A whole plant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlantParameters {
    /// What a person calls it.
    pub name: String,
    /// Where the figures come from.
    pub source: String,
    /// The longest integration step in s, 1e-7..=0.01.
    #[serde(default = "default_step")]
    pub step: f64,
    /// The axes; at least one.
    #[serde(rename = "axis")]
    pub axes: Vec<AxisParameters>,
}

/// 2^-14 s: 16 steps in a tick of 1/1024 s. Resolves a resonance of 2.6 kHz.
fn default_step() -> f64 {
    1.0 / 16_384.0
}

/// 2.5 us, for pulses of up to 200 kHz.
fn default_width() -> f64 {
    2.5e-6
}

/// 5 us.
fn default_turn() -> f64 {
    5e-6
}

/// One axis, or several that are alike.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisParameters {
    /// `x`, `y`, `z`, each in at most one block.
    pub names: Vec<String>,
    /// mm per turn of the motor, above 0.
    pub lead: f64,
    /// Play between nut and table in mm, 0 or more.
    #[serde(default)]
    pub play: f64,
    /// The rotating part.
    pub motor: MotorParameters,
    /// The sliding part.
    pub table: TableParameters,
    /// A spring between them.
    pub coupling: Option<CouplingParameters>,
    /// The encoder; a servo drive needs one.
    pub encoder: Option<EncoderParameters>,
    /// What turns the motor.
    pub drive: DriveParameters,
    /// The controller's tuning; a servo drive needs it.
    pub servo: Option<TuningParameters>,
}

/// Motor and screw.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotorParameters {
    /// Inertia of the motor's rotor in kg m^2, 0 or more.
    pub motor_inertia: f64,
    /// Inertia of screw and clutch in kg m^2, 0 or more.
    #[serde(default)]
    pub screw_inertia: f64,
    /// N m s/rad, 0 or more.
    #[serde(default)]
    pub viscous: f64,
    /// Sliding friction in N m, 0 or more.
    #[serde(default)]
    pub coulomb: f64,
    /// What it takes to leave rest in N m, at least `coulomb`; that where it is left out.
    pub breakaway: Option<f64>,
}

/// The table, or gantry, with all that moves along the axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableParameters {
    /// kg, 0 or more; above 0 behind a coupling.
    pub mass: f64,
    /// N s/mm, 0 or more.
    #[serde(default)]
    pub viscous: f64,
    /// Sliding friction in N, 0 or more.
    #[serde(default)]
    pub coulomb: f64,
    /// What it takes to leave rest in N, at least `coulomb`; that where it is left out.
    pub breakaway: Option<f64>,
    /// A constant force on the table in N, positive in the positive direction.
    #[serde(default)]
    pub load: f64,
}

/// The elastic part of the drive train.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CouplingParameters {
    /// N/mm, above 0.
    pub stiffness: f64,
    /// N s/mm, 0 or more.
    #[serde(default)]
    pub damping: f64,
}

/// An incremental encoder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EncoderParameters {
    /// Counts per mm of travel, four to a line.
    pub counts_per_mm: f64,
    /// A scale on the table instead of an encoder on the motor.
    #[serde(default)]
    pub on_table: bool,
}

/// The three kinds of drive.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum DriveParameters {
    /// Takes a velocity and closes its own loop with a tachometer.
    Velocity {
        /// N m, above 0.
        peak_torque: f64,
        /// N m of torque per rad/s of velocity error, above 0.
        loop_gain: f64,
        /// s between two refreshes of the torque, 0..=1; 0 refreshes it at every integration step.
        #[serde(default)]
        sample_time: f64,
    },
    /// Takes an acceleration, scaled by the inertia of the whole axis, and makes that torque.
    Torque {
        /// N m, above 0.
        peak_torque: f64,
    },
    /// Takes step pulses.
    Stepper {
        /// Full steps in a turn, a multiple of 4 in 4..=4000.
        full_steps: u32,
        /// Microsteps in a full step, 1..=256.
        microsteps: u32,
        /// N m, above 0.
        holding_torque: f64,
        /// rad/s at which the torque has fallen to 71 %, above 0.
        corner_speed: f64,
        /// The shortest pulse that the drive counts, in s, 0 to 100 us like the three below. What is left out is typical of a
        /// microstepping drive.
        #[serde(default = "default_width")]
        pulse: f64,
        /// The shortest pause between two pulses, in s.
        #[serde(default = "default_width")]
        gap: f64,
        /// The time from a change of direction to a pulse, in s.
        #[serde(default = "default_turn")]
        setup: f64,
        /// The time from the end of a pulse to a change of direction, in s.
        #[serde(default = "default_turn")]
        hold: f64,
    },
}

/// The controller's gains; [`shared::servo::ServoSettings`] without what the rest of the file says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TuningParameters {
    /// 1/s.
    pub position_gain: f64,
    /// 1/s; of a torque drive only.
    pub velocity_gain: Option<f64>,
    /// 1/s.
    #[serde(default)]
    pub integral_gain: f64,
    /// 0..=2.
    #[serde(default)]
    pub velocity_feedforward: f64,
    /// 0..=2.
    #[serde(default)]
    pub acceleration_feedforward: f64,
    /// mm/s for a velocity drive, mm/s^2 for a torque drive.
    pub limit: f64,
}

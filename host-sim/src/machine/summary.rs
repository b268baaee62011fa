//! What a machine amounts to: the numbers that the controller will use.

use serde::Serialize;
use shared::machine::{AxisDrive, AxisSettings, End, HomeSwitch, HostLost, MachineSettings};

/// A machine, for people and for JSON. Lengths in mm, times in s.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Its name.
    pub name: String,
    /// What it does when its host vanishes.
    pub host_lost: HostLost,
    /// Ticks for which a switch must act.
    pub debounce_ticks: u32,
    /// Ticks for which an emergency stop or a drive's fault must have ended.
    pub release_ticks: u32,
    /// Bytes that the controller stores.
    pub image_bytes: usize,
    /// The axes.
    pub axes: Vec<AxisSummary>,
}

/// An axis.
#[derive(Clone, Debug, Serialize)]
pub struct AxisSummary {
    /// Its letter.
    pub name: char,
    /// Lowest and highest coordinate.
    pub travel: [f64; 2],
    /// Highest velocity in mm/s.
    pub velocity: f64,
    /// Highest acceleration in mm/s^2.
    pub acceleration: f64,
    /// Highest jerk in mm/s^3.
    pub jerk: f64,
    /// What moves it.
    pub drive: DriveSummary,
    /// The switches that are connected.
    pub switches: Vec<&'static str>,
    /// How it finds home, if it can.
    pub homing: Option<HomingSummary>,
}

/// What moves an axis.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DriveSummary {
    /// A step and direction drive.
    Step {
        /// Steps per mm.
        steps_per_mm: f64,
        /// Steps per second at the highest velocity.
        step_rate: f64,
        /// What the drive takes at most with these pulses.
        most_step_rate: f64,
    },
    /// A servo drive.
    Servo {
        /// Counts per mm.
        counts_per_mm: f64,
        /// The following error that is a fault, in mm.
        following_error: f64,
    },
}

/// How an axis finds home.
#[derive(Clone, Debug, Serialize)]
pub struct HomingSummary {
    /// Which switch.
    pub switch: HomeSwitch,
    /// Towards which end.
    pub toward: End,
    /// Where home is, in mm.
    pub position: f64,
    /// How far the fast approach runs on behind the switch, in mm: what the switch must allow.
    pub overrun: f64,
    /// What the second approach resolves, in mm: the way of one tick.
    pub resolution: f64,
    /// When it goes, from 0.
    pub order: u8,
}

impl Summary {
    /// The summary of settings that were checked; `image_bytes` is the length of their image.
    pub fn new(settings: &MachineSettings, image_bytes: usize) -> Self {
        let ticks = |seconds: f64| (seconds / f64::from(shared::TICK) * (1.0 - 1e-9)).ceil() as u32;
        Self {
            name: settings.name.to_string(),
            host_lost: settings.host_lost,
            debounce_ticks: ticks(settings.debounce),
            release_ticks: ticks(settings.release),
            image_bytes,
            axes: settings.axes.iter().map(AxisSummary::new).collect(),
        }
    }
}

impl AxisSummary {
    fn new(axis: &AxisSettings) -> Self {
        let drive = match &axis.drive {
            AxisDrive::Step(step) => DriveSummary::Step {
                steps_per_mm: step.steps_per_mm,
                step_rate: axis.velocity * step.steps_per_mm,
                most_step_rate: 1.0 / (step.pulse + step.gap),
            },
            AxisDrive::Servo(servo) => DriveSummary::Servo {
                counts_per_mm: servo.control.counts_per_mm,
                following_error: servo.following_error,
            },
        };
        let switches =
            [("low limit", axis.low_limit), ("high limit", axis.high_limit), ("home switch", axis.home_switch)];
        let tick = f64::from(shared::TICK);
        Self {
            name: axis.name.letter(),
            travel: axis.travel,
            velocity: axis.velocity,
            acceleration: axis.acceleration,
            jerk: axis.jerk,
            drive,
            switches: switches.into_iter().filter_map(|(name, input)| input.map(|_| name)).collect(),
            homing: axis.homing.map(|homing| HomingSummary {
                switch: homing.switch,
                toward: homing.toward,
                position: homing.position,
                overrun: homing.fast * homing.fast / (2.0 * axis.acceleration) + homing.fast * tick,
                resolution: homing.slow * tick,
                order: homing.order,
            }),
        }
    }
}

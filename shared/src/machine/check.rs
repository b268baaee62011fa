//! What every value of a machine may be, and what is wrong with one that is not.

use core::fmt;

use super::settings::{AxisDrive, AxisSettings, MachineSettings};
use crate::servo::ServoError;

/// A number of the settings that has a range of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[allow(missing_docs, reason = "each is the field of its name; the ranges are one table below")]
pub enum Key {
    Debounce,
    Release,
    Travel,
    Velocity,
    Acceleration,
    Jerk,
    StepsPerMm,
    Pulse,
    Gap,
    Setup,
    Hold,
    FollowingError,
    HomingFast,
    HomingSlow,
    BackOff,
    PullOff,
    HomePosition,
    HomingOrder,
}

/// Where a number stands in the file, and the range it must be in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The keys that lead to it: from the `[[axis]]` if it is an axis's, from the top otherwise.
    pub path: &'static [&'static str],
    /// The smallest value.
    pub least: f64,
    /// The largest value.
    pub most: f64,
    /// The unit of both.
    pub unit: &'static str,
}

impl Key {
    /// The table of all ranges.
    pub const fn range(self) -> Range {
        const fn row(path: &'static [&'static str], least: f64, most: f64, unit: &'static str) -> Range {
            Range { path, least, most, unit }
        }
        match self {
            Self::Debounce => row(&["debounce"], 0.0, 0.1, "s"),
            Self::Release => row(&["release"], 0.0, 0.2, "s"),
            Self::Travel => row(&["travel"], -4_000.0, 4_000.0, "mm"),
            Self::Velocity => row(&["velocity"], 1e-3, 1e4, "mm/s"),
            Self::Acceleration => row(&["acceleration"], 4.0, 1e6, "mm/s2"),
            Self::Jerk => row(&["jerk"], 4.0, 1e9, "mm/s3"),
            Self::StepsPerMm => row(&["drive", "step", "steps_per_mm"], 0.01, 131_072.0, "steps/mm"),
            Self::Pulse => row(&["drive", "step", "pulse"], 1e-7, 1e-4, "s"),
            Self::Gap => row(&["drive", "step", "gap"], 1e-7, 1e-4, "s"),
            Self::Setup => row(&["drive", "step", "setup"], 1e-7, 1e-4, "s"),
            Self::Hold => row(&["drive", "step", "hold"], 0.0, 1e-4, "s"),
            Self::FollowingError => row(&["drive", "servo", "following_error"], 1e-3, 100.0, "mm"),
            Self::HomingFast => row(&["homing", "fast"], 0.01, 1e4, "mm/s"),
            Self::HomingSlow => row(&["homing", "slow"], 0.01, 1e4, "mm/s"),
            Self::BackOff => row(&["homing", "back_off"], 0.01, 100.0, "mm"),
            Self::PullOff => row(&["homing", "pull_off"], 0.01, 100.0, "mm"),
            Self::HomePosition => row(&["homing", "position"], -4_000.0, 4_000.0, "mm"),
            Self::HomingOrder => row(&["homing", "order"], 0.0, 5.0, ""),
        }
    }
}

/// What is wrong with settings; axes count from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MachineError {
    /// There is no axis.
    NoAxis,
    /// A number is out of its range, or none at all.
    Number {
        /// Of which axis; none where it is the machine's.
        axis: Option<u8>,
        /// Which one.
        key: Key,
        /// What was found.
        found: f64,
    },
    /// Two axes have the same name.
    SameName {
        /// The second of them.
        axis: u8,
    },
    /// The travel does not end above its begin.
    EmptyTravel {
        /// Of which axis.
        axis: u8,
    },
    /// At the highest velocity the pulses would follow too closely.
    StepRate {
        /// Of which axis.
        axis: u8,
        /// Steps per second.
        asked: f64,
        /// The most that pulse and gap leave.
        most: f64,
    },
    /// The servo's settings are refused.
    Servo {
        /// Of which axis.
        axis: u8,
        /// Why.
        error: ServoError,
    },
    /// The fast approach is faster than the axis, or the slow one faster than the fast one.
    HomingVelocity {
        /// Of which axis.
        axis: u8,
        /// Which of them.
        key: Key,
        /// What was found, in mm/s.
        found: f64,
        /// The most, in mm/s.
        most: f64,
    },
    /// Home lies outside of the travel.
    HomeOutside {
        /// Of which axis.
        axis: u8,
        /// Where, in mm.
        found: f64,
    },
    /// The switch that marks home is not connected.
    NoSwitch {
        /// Of which axis.
        axis: u8,
    },
}

impl MachineError {
    /// The axis at fault, from 0; none where it is the machine.
    pub const fn axis(self) -> Option<u8> {
        match self {
            Self::NoAxis => None,
            Self::Number { axis, .. } => axis,
            Self::SameName { axis }
            | Self::EmptyTravel { axis }
            | Self::StepRate { axis, .. }
            | Self::Servo { axis, .. }
            | Self::HomingVelocity { axis, .. }
            | Self::HomeOutside { axis, .. }
            | Self::NoSwitch { axis } => Some(axis),
        }
    }

    /// The keys that lead to the value at fault. A servo's own is [`ServoError::key`], below the last of these.
    pub const fn path(self) -> &'static [&'static str] {
        match self {
            Self::NoAxis => &[],
            Self::Number { key, .. } | Self::HomingVelocity { key, .. } => key.range().path,
            Self::SameName { .. } => &["name"],
            Self::EmptyTravel { .. } => &["travel"],
            Self::StepRate { .. } => &["drive", "step", "steps_per_mm"],
            Self::Servo { .. } => &["drive", "servo", "control"],
            Self::HomeOutside { .. } => &["homing", "position"],
            Self::NoSwitch { .. } => &["homing", "switch"],
        }
    }
}

impl fmt::Display for MachineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NoAxis => write!(f, "the machine has no axis; describe each in an [[axis]]"),
            Self::Number { key, found, .. } => {
                let Range { path, least, most, unit } = key.range();
                for (number, part) in path.iter().enumerate() {
                    write!(f, "{}{part}", if number == 0 { "" } else { "." })?;
                }
                let space = if unit.is_empty() { "" } else { " " };
                write!(f, " is {found}; it must be {least} to {most}{space}{unit}")
            }
            Self::SameName { .. } => write!(f, "an axis before this one has the same name; each needs its own"),
            Self::EmptyTravel { .. } => write!(f, "the travel ends where it begins or below; give [lowest, highest]"),
            Self::StepRate { asked, most, .. } => write!(
                f,
                "the highest velocity takes {asked} steps/s, but pulse and gap leave {most}; lower one or shorten the other"
            ),
            Self::Servo { error, .. } => error.fmt(f),
            Self::HomingVelocity { key, found, most, .. } => {
                let name = if key == Key::HomingSlow { "slow" } else { "fast" };
                write!(f, "homing.{name} is {found} mm/s; it must be at most {most}, ")?;
                write!(f, "{}", if key == Key::HomingSlow { "the fast approach" } else { "the velocity of the axis" })
            }
            Self::HomeOutside { found, .. } => write!(f, "home is at {found} mm, outside of the axis's travel"),
            Self::NoSwitch { .. } => {
                write!(f, "the switch that marks home is not described; add it to the axis, as home_switch = {{}}")
            }
        }
    }
}

impl core::error::Error for MachineError {}

impl MachineSettings {
    /// Checks every value. Errors: the first that will not do.
    pub fn check(&self) -> Result<(), MachineError> {
        let within = |axis, key: Key, found| {
            let Range { least, most, .. } = key.range();
            // Written so that a NaN fails.
            if found >= least && found <= most { Ok(()) } else { Err(MachineError::Number { axis, key, found }) }
        };
        within(None, Key::Debounce, self.debounce)?;
        within(None, Key::Release, self.release)?;
        if self.axes.is_empty() {
            return Err(MachineError::NoAxis);
        }
        for (axis, one) in (0_u8..).zip(&self.axes) {
            if self.axes.iter().take(usize::from(axis)).any(|other| other.name == one.name) {
                return Err(MachineError::SameName { axis });
            }
            one.check(axis, |key, found| within(Some(axis), key, found))?;
        }
        Ok(())
    }
}

impl AxisSettings {
    fn check(&self, axis: u8, within: impl Fn(Key, f64) -> Result<(), MachineError>) -> Result<(), MachineError> {
        let [low, high] = self.travel;
        within(Key::Travel, low)?;
        within(Key::Travel, high)?;
        if low >= high {
            return Err(MachineError::EmptyTravel { axis });
        }
        within(Key::Velocity, self.velocity)?;
        within(Key::Acceleration, self.acceleration)?;
        within(Key::Jerk, self.jerk)?;
        match &self.drive {
            AxisDrive::Step(drive) => {
                within(Key::StepsPerMm, drive.steps_per_mm)?;
                within(Key::Pulse, drive.pulse)?;
                within(Key::Gap, drive.gap)?;
                within(Key::Setup, drive.setup)?;
                within(Key::Hold, drive.hold)?;
                let (asked, most) = (self.velocity * drive.steps_per_mm, 1.0 / (drive.pulse + drive.gap));
                if asked > most {
                    return Err(MachineError::StepRate { axis, asked, most });
                }
            }
            AxisDrive::Servo(drive) => {
                within(Key::FollowingError, drive.following_error)?;
                let checked = drive.control.activate::<f32>(f64::from(crate::TICK));
                checked.map_err(|error| MachineError::Servo { axis, error })?;
            }
        }
        let Some(homing) = self.homing else { return Ok(()) };
        within(Key::HomingFast, homing.fast)?;
        within(Key::HomingSlow, homing.slow)?;
        within(Key::BackOff, homing.back_off)?;
        within(Key::PullOff, homing.pull_off)?;
        within(Key::HomePosition, homing.position)?;
        within(Key::HomingOrder, f64::from(homing.order))?;
        for (key, found, most) in
            [(Key::HomingFast, homing.fast, self.velocity), (Key::HomingSlow, homing.slow, homing.fast)]
        {
            if found > most {
                return Err(MachineError::HomingVelocity { axis, key, found, most });
            }
        }
        if homing.position < low || homing.position > high {
            return Err(MachineError::HomeOutside { axis, found: homing.position });
        }
        if self.homing_input().is_none() {
            return Err(MachineError::NoSwitch { axis });
        }
        Ok(())
    }
}

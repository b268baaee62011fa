//! What may be wrong with a machine, and why a command is refused. Small and `Copy`, so that they travel over the wire.

use core::fmt;

use serde::{Deserialize, Serialize};

/// One end of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum End {
    /// The end of the smaller coordinates.
    Low,
    /// The end of the larger coordinates.
    High,
}

/// Why the processor started.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ResetCause {
    /// Power came, or somebody asked for it: nothing is wrong.
    Ordinary,
    /// The tick did not live, and the watchdog was not fed.
    Watchdog,
    /// The supply fell below what the processor needs.
    BrownOut,
    /// The processor met an instruction or an address that it could not use.
    HardFault,
}

/// How a search for home fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum HomingFault {
    /// The switch did not act within the way that was allowed.
    NotFound,
    /// The switch still acted after the axis had backed off.
    Stuck,
}

/// What is wrong. The first one stays until it is acknowledged. Axes count from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Fault {
    /// A limit switch acts.
    Limit {
        /// Of which axis.
        axis: u8,
        /// At which end.
        end: End,
    },
    /// A drive says that it cannot go on.
    Drive {
        /// Of which axis.
        axis: u8,
    },
    /// A servo axis is too far from its setpoint.
    FollowingError {
        /// Which axis.
        axis: u8,
    },
    /// A step axis was asked for more than can be played.
    Steps {
        /// Which axis.
        axis: u8,
    },
    /// A setpoint left the travel of an axis: the checks before motion should have refused it.
    SoftLimit {
        /// Of which axis.
        axis: u8,
    },
    /// Home was not found.
    Homing {
        /// Of which axis.
        axis: u8,
        /// How it failed.
        fault: HomingFault,
    },
    /// A tick came too late to prepare the pulses of the next one.
    LateTick,
    /// The processor was started again.
    Reset {
        /// By what.
        cause: ResetCause,
    },
}

/// Why a command to the machine was refused; nothing has changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refused {
    /// Not in this state.
    State {
        /// The state.
        state: super::State,
    },
    /// A job in machine coordinates, where the position of an axis is unknown.
    PositionUnknown {
        /// The first such axis.
        axis: u8,
    },
    /// A job where an axis stands on a limit switch.
    OnLimit {
        /// Which axis.
        axis: u8,
    },
    /// A job that does not begin where the machine stands.
    Away {
        /// The first axis that is elsewhere; 0, 1, 2 are x, y, z.
        axis: u8,
    },
    /// An acknowledgement while the emergency stop is pressed.
    EStopPressed,
    /// An acknowledgement while a drive is at fault.
    DriveFault {
        /// Of which axis.
        axis: u8,
    },
    /// A search for home without an axis, or with one that has no home switch.
    NoHome,
    /// A job for a controller that knows no machine.
    NoMachine,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Limit { axis, end } => {
                let end = if end == End::Low { "low" } else { "high" };
                write!(f, "the limit switch at the {end} end of axis {axis} acts")
            }
            Self::Drive { axis } => write!(f, "the drive of axis {axis} reports a fault"),
            Self::FollowingError { axis } => write!(f, "axis {axis} is too far from its setpoint"),
            Self::Steps { axis } => write!(f, "axis {axis} was asked for more steps than can be played"),
            Self::SoftLimit { axis } => write!(f, "a setpoint left the travel of axis {axis}"),
            Self::Homing { axis, fault: HomingFault::NotFound } => {
                write!(f, "the home switch of axis {axis} was not found within its travel")
            }
            Self::Homing { axis, fault: HomingFault::Stuck } => {
                write!(f, "the home switch of axis {axis} did not let go when the axis backed off")
            }
            Self::LateTick => write!(f, "a tick came too late for its pulses"),
            Self::Reset { cause: ResetCause::Ordinary } => write!(f, "the controller was started"),
            Self::Reset { cause: ResetCause::Watchdog } => write!(f, "the watchdog restarted the controller"),
            Self::Reset { cause: ResetCause::BrownOut } => write!(f, "the supply of the controller failed"),
            Self::Reset { cause: ResetCause::HardFault } => write!(f, "the controller's program failed"),
        }
    }
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::State { state } => write!(f, "the machine is in state {}, which does not allow it", state.name()),
            Self::PositionUnknown { axis } => {
                write!(f, "the position of axis {axis} is unknown; home it before a job in machine coordinates")
            }
            Self::OnLimit { axis } => write!(f, "axis {axis} stands on a limit switch; home it or move it off first"),
            Self::Away { axis } => {
                write!(
                    f,
                    "axis {axis} does not stand where the job begins; go there first, or run the job from where it stands"
                )
            }
            Self::EStopPressed => write!(f, "the emergency stop is pressed; release it first"),
            Self::DriveFault { axis } => write!(f, "the drive of axis {axis} still reports a fault; clear it first"),
            Self::NoMachine => {
                write!(f, "the controller knows no machine; send it one with `hodograph machine FILE --port P --write`")
            }
            Self::NoHome => write!(f, "no axis was named, or one without a home switch"),
        }
    }
}

impl core::error::Error for Fault {}
impl core::error::Error for Refused {}

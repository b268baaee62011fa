//! The machine: what is connected, how it moves, and how far.
//!
//! A person writes [`MachineSettings`] as `machine.toml`; the host checks them and sends their [`image`], which the controller checks
//! again, keeps in flash, and turns into the [`Machine`] that the tick uses. Load time, all of it: the tick only reads.

mod active;
mod check;
pub mod image;
mod settings;

#[cfg(test)]
mod tests;

pub use crate::safety::End;
pub use active::{Axis, Drive, Machine};
pub use check::{Key, MachineError, Range};
pub use settings::{
    AxisDrive, AxisName, AxisSettings, HomeSwitch, HomingSettings, HostLost, Input, MachineSettings, NAME_SIZE, Output,
    ServoDrive, StepDrive,
};

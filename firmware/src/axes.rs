//! The axes of the machine that this firmware is built for: servos, or with the feature `steps` step axes.
//!
//! Both are an `Axes` of the same methods, and the tick does not know which it moves. Settings are constants here until a machine's
//! own are kept in flash.

#[cfg(not(feature = "steps"))]
mod servos;
#[cfg(feature = "steps")]
mod steps;

#[cfg(not(feature = "steps"))]
pub use servos::{AXES, Axes, FULL_COMMAND};
#[cfg(feature = "steps")]
pub use steps::{AXES, Axes};

/// What stops the axes in the middle of a motion. The numbers are the mailbox's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(not(feature = "steps"), allow(dead_code, reason = "servo axes have no ring"))]
pub enum Fault {
    /// The tick came too late to fill its half of the step ring, or the ring is not played.
    MissedHalf = 1,
    /// An axis was asked for more steps than it can make.
    Steps = 2,
}

//! Everything that runs in a tick of the Hodograph motion controller, and the messages on its wire.
//!
//! A setpoint's way through this crate: a [`curve::Segment`] is cut into a [`piece::Piece`], which travels over the [`link`]; the
//! [`loader`] checks it and makes the [`active::ActivePiece`] that the [`executor`] walks, moved by the [`interpolator`] under
//! the [`feed`] law, or along a planned [`profile`], at the [`pace`] that a [`motion`] has come to; a [`servo`] turns setpoint and encoder into a command, or
//! [`steps`] turns setpoints into the pulses of a tick. [`safety`] decides in every tick whether any of it may move.
//!
//! This crate knows no clock, no log, no heap and no board; time and inputs are arguments. All of it is generic over
//! [`real::Real`]: `f32` on the target and in the simulator, bit for bit the same, and `f64` as the oracle of the same code.
//! Lengths are millimetres, times seconds, angles radians. Equation numbers (n) are those of Farouki & Srinathu, *Feedrate
//! modulation for accurate traversal of trimmed planar offset paths*, Int. J. Adv. Manuf. Technol. (2018).
//!
//! What a stage costs on the target is counted by `cargo xtask budget` and stands in `budget.toml`.
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

pub mod accumulator;
pub mod active;
pub mod complex;
pub mod control;
pub mod curve;
pub mod duration;
pub mod error;
pub mod executor;
pub mod extent;
pub mod feed;
pub mod fixed;
pub mod further;
pub mod hash;
pub mod homing;
pub mod interpolator;
pub mod jet;
pub mod link;
pub mod loader;
pub mod machine;
pub mod motion;
pub mod pace;
pub mod piece;
pub mod polynomial;
pub mod profile;
pub mod real;
pub mod safety;
pub mod servo;
pub mod spline;
pub mod steps;
pub mod supply;

/// The tick period in s: 1024 Hz, exactly a power of two, so that times are exact in every float.
pub const TICK: f32 = 1.0 / 1024.0;

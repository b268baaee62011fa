//! Independent measurements of a motion and of an offset: nothing here asks what made them.

mod bounds;
mod clearance;
mod foot_point;
mod integral;
mod nearest;
mod path_distance;
pub mod peaks;
mod quintic;
mod touching;

pub use clearance::{Clearance, clearance, clearance_with};
pub use foot_point::ContourError;
pub use integral::{Slowness, exact_time, piece_time};
pub use nearest::{Foot, Nearest};

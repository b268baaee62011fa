//! Independent measurements of a motion: nothing here asks the kernel.

mod foot_point;
mod integral;

pub use foot_point::ContourError;
pub use integral::exact_time;

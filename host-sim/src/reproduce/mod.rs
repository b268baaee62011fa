//! Published experiments, run again and laid beside their published figures.

pub mod farouki2018;
pub mod feed_correction;
pub mod spline_fit;

use serde::Serialize;

/// One published figure and what came out here.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Which figure of which run.
    pub name: String,
    /// What was published.
    pub published: f64,
    /// What came out here.
    pub measured: f64,
    /// (measured - published)/published.
    pub relative_difference: f64,
}

impl Row {
    /// A row of figures in the same unit.
    pub fn new(name: String, published: f64, measured: f64) -> Self {
        Self { name, published, measured, relative_difference: measured / published - 1.0 }
    }
}

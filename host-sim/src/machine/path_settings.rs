//! What a machine's file says of the path: for the planner on the host, not for the controller.

use serde::Deserialize;

/// The table `[path]`: limits of a plan beside those of the axes. Lengths in mm, times in s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PathSettings {
    /// The largest feed of the tool's centre.
    pub feed: Option<f64>,
    /// The largest acceleration across the path.
    pub centripetal: Option<f64>,
    /// The steps of the velocities of x and y that a corner may make.
    pub corner_step: Option<[f64; 2]>,
    /// The largest contour error that the machine may make.
    pub contour_error: Option<f64>,
}

impl PathSettings {
    /// A value that is no limit, and what would do: a number above zero, or for a corner's step not below it.
    pub(super) fn fault(&self) -> Option<(&'static str, f64, &'static str)> {
        let above = [("feed", self.feed), ("centripetal", self.centripetal), ("contour_error", self.contour_error)];
        let above = above
            .into_iter()
            .filter_map(|(key, value)| Some((key, value?, "a number above zero")))
            .find(|&(_, x, _)| !(x > 0.0 && x.is_finite()));
        let steps = self.corner_step.into_iter().flatten().find(|&x| !(x >= 0.0 && x.is_finite()));
        above.or(steps.map(|step| ("corner_step", step, "a number, zero or above")))
    }
}

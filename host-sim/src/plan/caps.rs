//! What every place of a course bears by itself: the largest speed at which it can be passed at all, and what says so.

use std::fmt;

use serde::Serialize;

use super::course::{Course, Place};
use super::limits::{AXES, JERK_WINDOW, Limits};

/// What limits the speed at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case", tag = "limit", content = "axis")]
pub enum Reason {
    /// The job's own feed, or the machine's largest.
    Feed,
    /// The velocity of an axis, 0 for x.
    Velocity(usize),
    /// The acceleration of an axis: across the way in a bend, or along it where the speed changes.
    Acceleration(usize),
    /// The acceleration across the path.
    Centripetal,
    /// The jerk of an axis.
    Jerk(usize),
    /// The step of an axis' velocity at a corner.
    Corner(usize),
    /// A rest.
    Rest,
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const NAMES: [&str; 3] = ["x", "y", "z"];
        let name = |axis: usize| NAMES.get(axis).copied().unwrap_or("?");
        match *self {
            Self::Feed => f.write_str("the job's feed"),
            Self::Velocity(axis) => write!(f, "velocity of {}", name(axis)),
            Self::Acceleration(axis) => write!(f, "acceleration of {}", name(axis)),
            Self::Centripetal => f.write_str("acceleration across the path"),
            Self::Jerk(axis) => write!(f, "jerk of {}", name(axis)),
            Self::Corner(axis) => write!(f, "corner step of {}", name(axis)),
            Self::Rest => f.write_str("rest"),
        }
    }
}

/// A largest speed and its reason.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cap {
    /// In mm/s.
    pub speed: f64,
    /// What says so.
    pub reason: Reason,
}

impl Cap {
    fn lower(&mut self, speed: f64, reason: Reason) {
        if speed < self.speed {
            *self = Self { speed, reason };
        }
    }
}

/// The part of a jerk that a bend may take: what is left changes the speed.
const JERK_OF_BEND: f64 = 0.8;

/// Whether a bend is passed no faster than at a speed that could be kept in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bends {
    /// Then there is always the way out of keeping the speed.
    Steady,
    /// Faster where slowing down, or speeding up, takes the place of a part of the bend's acceleration.
    Free,
}

/// The caps of all places; `scale` is the part of acceleration and jerk that may be used at each.
pub(super) fn caps(course: &Course, limits: &Limits, bends: Bends, scale: &[f64]) -> Vec<Cap> {
    let places = &course.places;
    let of = |(place, &scale): (&Place, &f64)| alone(place, limits, bends, scale);
    let mut caps: Vec<Cap> = places.iter().zip(scale).map(of).collect();
    for k in 1..places.len() {
        let (before, after) = (&places[k - 1], &places[k]);
        let scale = scale[k - 1].min(scale[k]);
        let mut cap = caps[k - 1];
        if caps[k].speed < cap.speed && after.step == 0.0 {
            cap = caps[k];
        }
        if after.step == 0.0 {
            corner(&mut cap, before, after, limits, near(places, k));
        }
        if after.is_rest {
            cap.lower(0.0, Reason::Rest);
        }
        for (axis, jump) in after.bending(before).0.map(f64::abs).into_iter().enumerate() {
            // v^2 |d(kappa n)| within the window, or within the time that the step takes.
            let jerk = JERK_OF_BEND * limits.jerk[axis] * scale;
            if jump > 0.0 && jerk.is_finite() && !after.is_corner {
                let speed = (jerk * JERK_WINDOW / jump).sqrt().max((jerk * after.step / jump).cbrt());
                cap.lower(speed, Reason::Jerk(axis));
            }
        }
        if after.step == 0.0 || cap.speed < caps[k - 1].speed {
            caps[k - 1] = cap;
            caps[k].lower(cap.speed, cap.reason);
        }
    }
    for (end, k) in course.ends.into_iter().zip([0, places.len().saturating_sub(1)]) {
        if let (Some(speed), Some(cap)) = (end, caps.get_mut(k)) {
            cap.lower(speed, Reason::Rest);
        }
    }
    caps
}

/// What one place bears without its neighbours.
pub(super) fn alone(place: &Place, limits: &Limits, bends: Bends, scale: f64) -> Cap {
    let mut cap = Cap { speed: place.feed.min(limits.feed), reason: Reason::Feed };
    let curvature = place.curvature();
    cap.lower((limits.centripetal * scale / curvature).sqrt(), Reason::Centripetal);
    let (along, across) = (place.direction.0.map(f64::abs), place.bend.0.map(f64::abs));
    for axis in 0..AXES {
        cap.lower(limits.velocity[axis] / along[axis], Reason::Velocity(axis));
        if bends == Bends::Steady {
            cap.lower((limits.acceleration[axis] * scale / across[axis]).sqrt(), Reason::Acceleration(axis));
        }
        let turning = curvature * curvature * along[axis];
        cap.lower((JERK_OF_BEND * limits.jerk[axis] * scale / turning).cbrt(), Reason::Jerk(axis));
    }
    cap
}

/// At a node: an axis' velocity may step by its corner step, but by no more than its acceleration makes on the way between neighbouring
/// nodes. So a chain of short lines is run like the curve that it stands for.
fn corner(cap: &mut Cap, before: &Place, after: &Place, limits: &Limits, near: f64) {
    /// A turn that is rounding.
    const NONE: f64 = 1e-9;
    let turn = after.direction - before.direction;
    for (axis, turn) in turn.0.map(f64::abs).into_iter().enumerate() {
        if turn > NONE {
            let bend = (limits.acceleration[axis] * near / turn).sqrt();
            cap.lower(bend.min(limits.corner_step[axis] / turn), Reason::Corner(axis));
        }
    }
}

/// Half the way from the corner before place `k` to the one behind it, as far as neighbouring pieces tell.
fn near(places: &[Place], k: usize) -> f64 {
    /// Places looked at on each side: a piece with more of them is long.
    const MOST: usize = 8;
    let back: f64 =
        places[..k].iter().rev().take(MOST).take_while(|place| place.step > 0.0).map(|place| place.step).sum();
    let on: f64 = places[k + 1..].iter().take(MOST).take_while(|place| place.step > 0.0).map(|place| place.step).sum();
    0.5 * (back + on)
}

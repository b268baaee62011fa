//! Steps of velocity at corners.
//!
//! Each side is continued to the corner by the parabola through its three nearest setpoints. The instant of the corner lies
//! somewhere between them, and with an acceleration that differs by 2000 mm/s^2 between the sides a tick is 2 mm/s: so it is
//! sought first, as the instant at which the two parabolas come closest.

use std::ops::Range;

use serde::Serialize;
use shared::fixed::{Position, UNITS_PER_MM};

use super::{PERIOD, norm};

/// Rounds of Newton's method for the instant. The gap is a parabola over a tick or two, all but straight.
const ROUNDS: u32 = 4;

/// The largest step of one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Step {
    /// Its magnitude, in mm/s.
    pub velocity: f64,
    /// The corner's number among the setpoints.
    pub tick: usize,
    /// How far the errors of setpoints may put it off, in mm/s: 16 e/T for a corner of one tick, 0.031 mm/s where e is half a
    /// unit. Beyond that, a jerk J beside the corner may put it off by 9 J T^2, which is 0.9 mm/s at 10^5 mm/s^3, and a step
    /// too small to tell the corner's instant by the change of acceleration times T.
    pub noise: f64,
}

/// The steps of velocity at the corners of a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Steps {
    /// The largest, of x, y and z.
    pub axes: [Step; 3],
    /// Corners, not those at an end, without three setpoints on both sides before the next corner or the end.
    pub unmeasured: usize,
}

/// Corners inside the motion, in order; those side by side are one.
pub(super) fn groups(corners: &[usize], setpoints: usize) -> Vec<Range<usize>> {
    let mut sorted: Vec<usize> = corners.iter().copied().filter(|&corner| corner < setpoints).collect();
    sorted.sort_unstable();
    let mut groups: Vec<Range<usize>> = Vec::new();
    for corner in sorted {
        match groups.last_mut() {
            Some(last) if corner <= last.end => last.end = corner + 1,
            _ => groups.push(corner..corner + 1),
        }
    }
    groups
}

pub(super) fn steps(setpoints: &[Position], groups: &[Range<usize>], error: f64) -> Steps {
    let mut steps = Steps::default();
    for (k, group) in groups.iter().enumerate() {
        let before = k.checked_sub(1).map_or(0, |k| groups[k].end);
        let after = groups.get(k + 1).map_or(setpoints.len(), |next| next.start);
        // At an end there is no step.
        if group.start == 0 || group.end == setpoints.len() {
            continue;
        }
        if group.start - before < 3 || after - group.end < 3 {
            steps.unmeasured += 1;
            continue;
        }
        let width = (group.len() + 1) as f64;
        let left = [1, 2, 3].map(|back| setpoints[group.start - back]);
        let right = [0, 1, 2].map(|ahead| setpoints[group.end + ahead]);
        // Both parabolas together have weights of 8 and 4 for each tick between their nearest setpoints.
        let noise = (8.0 + 4.0 * width) * error / PERIOD;
        let tick = group.start + group.len() / 2;
        for (largest, step) in steps.axes.iter_mut().zip(step(left, right, width)) {
            if step.abs() >= largest.velocity {
                *largest = Step { velocity: step.abs(), tick, noise };
            }
        }
    }
    steps
}

/// The step of each axis between two sides, nearest setpoint first, that are `width` ticks apart.
fn step(left: [Position; 3], right: [Position; 3], width: f64) -> [f64; 3] {
    let at = |instant: f64| {
        let gap = [0, 1, 2].map(|axis| {
            // From a common origin, so that nearby points far from home keep their distance.
            let [l, r] = [left, right].map(|side| side.map(|at| f64::from(at[axis].0) - f64::from(left[0][axis].0)));
            let ([l, l_rate], [r, r_rate]) = (continued(l, instant), continued(r, width - instant));
            [r - l, -r_rate - l_rate]
        });
        (gap.map(|[gap, _]| gap), gap.map(|[_, step]| step))
    };
    let mut instant = width / 2.0;
    for _ in 0..ROUNDS {
        let (gap, step) = at(instant);
        let square = norm(step) * norm(step);
        if square > 0.0 {
            let product: f64 = gap.iter().zip(step).map(|(gap, step)| gap * step).sum();
            instant = (instant - product / square).clamp(0.0, width);
        }
    }
    at(instant).1.map(|units| units / UNITS_PER_MM / PERIOD)
}

/// The parabola through three setpoints `way` ticks beyond the first one, and its rate.
fn continued([a, b, c]: [f64; 3], way: f64) -> [f64; 2] {
    let bend = a - 2.0 * b + c;
    [a + way * (a - b) + way * (way + 1.0) / 2.0 * bend, (a - b) + (way + 0.5) * bend]
}

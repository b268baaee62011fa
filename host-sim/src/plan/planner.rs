//! The plan of a path: speeds at places, within limits, and the profiles that make them.

use std::collections::BTreeMap;

use shared::pace::PaceLimits;
use shared::piece::Header;

use super::caps::{Bends, Reason};
use super::course::Course;
use super::draft::{Draft, lessen};
use super::grid;
use super::limits::{AXES, Limits};
use super::manner::Manner;
use crate::path::{Path, PathPiece};

/// Parts of velocity, acceleration and jerk that a plan uses: what lies between places, and what a cubic departs by, is in the rest.
const USED: [f64; 3] = [0.999, 0.994, 0.96];

/// How often places where a plan asks for too much are given less.
const ROUNDS: usize = 12;

/// The part of a time that is worth running bends faster than steadily.
const GAIN: f64 = 1e-3;

/// A planned motion.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The pieces with their profiles; a piece of the path may have become several.
    pub pieces: Vec<PathPiece>,
    /// For each of them the number of the piece of the path.
    pub from: Vec<usize>,
    /// The time that it takes, in s.
    pub time: f64,
    /// The grid.
    pub course: Course,
    /// The speed of the centre at each place, in mm/s.
    pub speed: Vec<f64>,
    /// What limits it there.
    pub reason: Vec<Reason>,
}

/// The part of an axis' acceleration and jerk that a hold adds to what the plan asks for, since the plan may ask for all of it.
const HOLD: f64 = 0.25;

impl Plan {
    /// What a plan uses of limits: what lies between its places, and what a cubic departs by, is in the rest.
    pub fn used(limits: &Limits) -> Limits {
        limits.with_margin(USED)
    }

    /// How long each reason limits the speed, in s; the longest first.
    pub fn shares(&self) -> Vec<(Reason, f64)> {
        let mut shares: BTreeMap<Reason, f64> = BTreeMap::new();
        for (k, place) in self.course.places.iter().enumerate().skip(1) {
            let sum = self.speed[k] + self.speed[k - 1];
            if place.step > 0.0 && sum > 0.0 {
                *shares.entry(self.reason[k]).or_default() += 2.0 * place.step / sum;
            }
        }
        let mut shares: Vec<(Reason, f64)> = shares.into_iter().collect();
        shares.sort_by(|a, b| b.1.total_cmp(&a.1));
        shares
    }
}

/// Why a path cannot be planned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlanError {
    /// It cannot begin at the speed that is asked for.
    Start {
        /// The largest possible one, in mm/s.
        most: f64,
    },
    /// It moves z, and the limits say nothing of z.
    NoLimit,
    /// It cannot end at the speed that is asked for.
    End {
        /// The largest possible one, in mm/s.
        most: f64,
    },
}

/// A path as it is planned: its pieces have profiles.
///
/// An override above 100 % would ask for more than the plan, so there is none. A hold takes a quarter of the accelerations and jerks
/// on top of what the plan asks for where it happens. Errors: a speed at an end that the limits do not let be.
pub fn planned(path: &Path, limits: &Limits, manner: &Manner) -> Result<(Path, Plan), PlanError> {
    let plan = plan(&path.pieces, path.weight, limits, manner)?;
    let limits = limits.of_moving(&path.pieces);
    let [x, y, z] = limits.velocity;
    let fastest = plan.speed.iter().copied().fold(0.0, f64::max).min(x.hypot(y).hypot(z));
    let part = |of: [f64; AXES]| (HOLD * of.into_iter().fold(f64::INFINITY, f64::min) / fastest).clamp(0.0, 1e6) as f32;
    let slowest = PaceLimits::SLOWEST;
    let pace = PaceLimits {
        slope: part(limits.acceleration).max(slowest.slope),
        bend: part(limits.jerk).max(slowest.bend),
        most: 1.0,
    };
    let header = Header { rest: false, pace, ..path.header };
    Ok((Path { pieces: plan.pieces.clone(), header, ..path.clone() }, plan))
}

/// Plans pieces within limits. Errors: as [`planned`].
pub fn plan(pieces: &[PathPiece], weight: f64, limits: &Limits, manner: &Manner) -> Result<Plan, PlanError> {
    if limits.leave_open(pieces) {
        return Err(PlanError::NoLimit);
    }
    check_ends(best(pieces, weight, limits, manner), manner.ends)
}

/// Plans pieces as near to the speeds at their ends as can be.
pub(super) fn best(pieces: &[PathPiece], weight: f64, limits: &Limits, manner: &Manner) -> Plan {
    let used = Plan::used(&limits.of_moving(pieces));
    let course = grid::places(pieces, weight, &used, manner);
    let lengths: Vec<f64> = pieces.iter().map(PathPiece::way).collect();
    let draft = |bends: Bends, scale: &[f64]| Draft::new(course.clone(), &used, bends, scale);
    let settled = |bends: Bends| {
        let mut scale = vec![1.0; course.places.len()];
        let mut round = 0;
        loop {
            let draft = draft(bends, &scale);
            round += 1;
            let over = draft.over(&used, &lengths);
            if round >= ROUNDS || over.iter().all(|&over| over <= 1.0) {
                return draft.slowed(over.iter().copied().fold(1.0, f64::max));
            }
            lessen(&mut scale, &over);
        }
    };
    let steady = settled(Bends::Steady);
    // Without a jerk smooth bends gain by being free, and rugged ones lose it in the rounds.
    let is_worth_it = |free: f64| free < steady.time() * (1.0 - GAIN);
    let has_jerk = limits.jerk.iter().any(|jerk| jerk.is_finite());
    if has_jerk || !is_worth_it(draft(Bends::Free, &vec![1.0; course.places.len()]).time()) {
        return steady.finish(pieces, &used);
    }
    let free = settled(Bends::Free);
    if is_worth_it(free.time()) { free.finish(pieces, &used) } else { steady.finish(pieces, &used) }
}

/// Whether the ends are as fast as they should be.
pub(super) fn check_ends(plan: Plan, ends: [Option<f64>; 2]) -> Result<Plan, PlanError> {
    /// The part of an end's speed that may be missing.
    const MISSING: f64 = 2e-3;
    let short = |asked: Option<f64>, most: Option<&f64>| {
        let (asked, most) = (asked?, *most?);
        (most < asked * (1.0 - MISSING)).then_some(most)
    };
    if let Some(most) = short(ends[0], plan.speed.first()) {
        return Err(PlanError::Start { most });
    }
    match short(ends[1], plan.speed.last()) {
        Some(most) => Err(PlanError::End { most }),
        None => Ok(plan),
    }
}

//! Plans a path while it comes, in a window of it: any length in the same memory.
//!
//! How far one has to look ahead depends on the path, so no length of the window is right. Instead it is asked whether what lies beyond could
//! matter: a window is bounded twice ([`mod@super::bound`]), as if the path ended at rest at its end, and as if it went on as fast as it likes.
//! Up to where both agree nothing beyond changes the speed, and a little before that, by the reach of a jerk, nothing changes the plan. So much
//! goes out; where that is nothing, the window grows. The next window begins a little before its first new piece, at the speed that the plan
//! had there, so that the plan of both is one.

use std::collections::VecDeque;

use super::bound;
use super::caps::{Bends, caps};
use super::draft::allowed;
use super::limits::{AXES, JERK_WINDOW, Limits};
use super::manner::Manner;
use super::planner::{Plan, PlanError, best, check_ends};
use crate::path::PathPiece;

/// Pieces in a window, if that is enough.
const PIECES: usize = 2048;

/// The relative difference of speeds that are the same.
const SAME: f64 = 1e-9;

/// Planned pieces of a path whose pieces come from an iterator.
#[derive(Debug)]
pub struct Streamed<I> {
    source: I,
    weight: f64,
    limits: Limits,
    manner: Manner,
    window: Vec<PathPiece>,
    /// The first of them that is not planned yet.
    fresh: usize,
    /// The speed at the start of the window.
    start: Option<f64>,
    /// How many pieces a window has.
    size: usize,
    planned: VecDeque<PathPiece>,
    is_first: bool,
    is_over: bool,
    most: usize,
}

impl<I: Iterator<Item = PathPiece>> Streamed<I> {
    /// Plans what `source` gives, at the weight of its path.
    pub fn new(source: I, weight: f64, limits: &Limits, manner: &Manner) -> Self {
        Self {
            source,
            weight,
            limits: *limits,
            manner: *manner,
            window: Vec::new(),
            fresh: 0,
            start: manner.ends[0],
            size: PIECES,
            planned: VecDeque::new(),
            is_first: true,
            is_over: false,
            most: 0,
        }
    }

    /// The most pieces of the path that were held at once.
    pub fn most_held(&self) -> usize {
        self.most
    }

    /// Plans one window, or makes it larger.
    fn advance(&mut self) -> Result<(), PlanError> {
        let missing = self.size.saturating_sub(self.window.len());
        self.window.extend(self.source.by_ref().take(missing));
        self.most = self.most.max(self.window.len());
        if self.window.len() < self.size {
            self.is_over = true;
            let manner = Manner { ends: [self.start, self.manner.ends[1]], ..self.manner };
            let plan = self.best(&manner, true)?;
            self.release(&plan, self.window.len());
            return Ok(());
        }
        let manner = Manner { ends: [self.start, Some(0.0)], ..self.manner };
        let plan = self.best(&manner, false)?;
        let reach = self.reach(&plan);
        let sure = self.sure(&plan, reach);
        if sure <= self.fresh {
            self.size *= 2;
            return Ok(());
        }
        self.release(&plan, sure);
        // The next window begins with so many pieces that are planned already.
        let first_place = |piece: usize| plan.course.places.partition_point(|place| place.piece < piece);
        let ways = ways(&plan);
        let border = ways.get(first_place(sure)).copied().unwrap_or(0.0);
        let keep = (0..sure).rev().find(|&piece| border - ways[first_place(piece)] >= reach).unwrap_or(0);
        self.start = plan.speed.get(first_place(keep)).copied();
        self.window.drain(..keep);
        self.is_first = false;
        self.fresh = sure - keep;
        self.size = PIECES.max(2 * self.fresh);
        Ok(())
    }

    /// The plan of the window. Errors: an end of the path itself that cannot be as fast as it should.
    fn best(&self, manner: &Manner, is_last: bool) -> Result<Plan, PlanError> {
        if self.limits.leave_open(&self.window) {
            return Err(PlanError::NoLimit);
        }
        let plan = best(&self.window, self.weight, &self.limits, manner);
        let first = self.is_first.then_some(self.manner.ends[0]).flatten();
        check_ends(plan, [first, self.manner.ends[1].filter(|_| is_last)])
    }

    /// The way over which a change of speed may be felt through its jerk, in mm.
    fn reach(&self, plan: &Plan) -> f64 {
        let fastest = plan.speed.iter().copied().fold(0.0, f64::max);
        let time = |axis: usize| self.limits.acceleration[axis] / self.limits.jerk[axis];
        6.0 * fastest * (0..AXES).map(time).fold(4.0 * JERK_WINDOW, f64::max)
    }

    /// How many pieces nothing beyond the window can change.
    fn sure(&self, plan: &Plan, reach: f64) -> usize {
        let scale = vec![1.0; plan.course.places.len()];
        let mut course = plan.course.clone();
        let caps = caps(&course, &self.limits, Bends::Steady, &scale);
        let allowed = allowed(&course, &caps, &self.limits, &scale);
        let resting = bound::within(&course, &self.limits, &allowed).speed;
        course.ends[1] = None;
        let going_on = bound::within(&course, &self.limits, &allowed).speed;
        let same = resting.iter().zip(&going_on).take_while(|&(a, b)| (a - b).abs() <= SAME * b).count();
        let ways = ways(plan);
        let border = ways.get(same.saturating_sub(1)).copied().unwrap_or(0.0) - reach;
        let last = ways.partition_point(|&way| way <= border);
        // The piece of that place is begun; those before it are whole.
        plan.course.places.get(last.saturating_sub(1)).map_or(0, |place| place.piece)
    }

    fn release(&mut self, plan: &Plan, until: usize) {
        let numbered = plan.pieces.iter().zip(&plan.from);
        self.planned.extend(numbered.filter(|&(_, &from)| from >= self.fresh && from < until).map(|(piece, _)| *piece));
    }
}

impl<I: Iterator<Item = PathPiece>> Iterator for Streamed<I> {
    type Item = Result<PathPiece, PlanError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(piece) = self.planned.pop_front() {
                return Some(Ok(piece));
            }
            if self.is_over {
                return None;
            }
            if let Err(error) = self.advance() {
                self.is_over = true;
                return Some(Err(error));
            }
        }
    }
}

/// The way to each place, in mm.
fn ways(plan: &Plan) -> Vec<f64> {
    let mut way = 0.0;
    let sum = |place: &super::course::Place| {
        way += place.step;
        way
    };
    plan.course.places.iter().map(sum).collect()
}

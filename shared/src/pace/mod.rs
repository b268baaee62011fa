//! The pace q: how fast path time runs, T' = q. It starts, stops and overrides a motion without leaving its path.
//!
//! The position is x(T), so with q the velocity is q x', the acceleration q^2 x'' + q' x' and the jerk
//! q^3 x''' + 3 q q' x'' + q'' x'. What the path asks for by itself, x'' and x''', is the planner's; what the pace adds is
//! bounded here by |q'| <= slope and |q''| <= bend, for which the planner divides what the axes have left by their largest
//! speed on the path. Being the same all along a path, these two bounds make every stop take the same time, wherever it begins.
//!
//! Inside, the pace is a whole number of steps, q = level/N, and changes by a whole number a tick, its slope, which changes
//! by -1, 0 or 1: the second difference is q'' tick^2 = 1/N. So a ramp is exact, ends where it should after any history of
//! commands, is the same on every machine, and never needs a root. In every tick the largest slope is taken from which
//! the wanted level can still be met ([`Pacer::step`]), and from which a stop within the way that is left is still possible:
//! the last is a closed form. What is true once stays true, since to lower the slope by one is always allowed.
//!
//! | part | cost, f32 on a Cortex-M4F |
//! | --- | --- |
//! | a steady pace, far from any end | none: the executor keeps its time |
//! | [`Pacer::step`] where the pace changes | some 30 instructions |
//! | and near an end | at most twice the 40 of the stopping way, with an integer division each; and [`crate::duration::of_rest`] |

mod lattice;

use serde::{Deserialize, Serialize};

use crate::error::PathError;
use crate::real::Real;

/// How the pace of a path may change, as it travels: anything may be wrong in it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PaceLimits<T> {
    /// The largest |q'| in 1/s: the acceleration that is left for it over the largest speed on the path.
    pub slope: T,
    /// The largest |q''| in 1/s^2: the jerk that is left for it over the largest speed on the path.
    pub bend: T,
    /// The largest q, 1..=2: higher overrides stop there.
    pub most: T,
}

impl PaceLimits<f32> {
    /// For a path of which nothing is known: to a stop in 0.35 s, overrides up to 200 %.
    pub const USUAL: Self = Self { slope: 4.0, bend: 40.0, most: 2.0 };

    /// Slower ones would make stops too long for [`Pacer::activate`].
    pub const SLOWEST: Self = Self { slope: 0.6, bend: 6.0, most: 1.0 };

    /// The same for the f64 twin.
    pub fn exact<T: Real>(&self) -> PaceLimits<T> {
        let [slope, bend, most] = [self.slope, self.bend, self.most].map(|x| T::lit(f64::from(x)));
        PaceLimits { slope, bend, most }
    }
}

/// The longest stop, in ticks: 4 s at 1024 Hz.
const LONGEST_STOP: i32 = 4096;

/// The part of a way that a stop relies on. A way is known within some per cent of itself only, and at order 1 a tick takes by half its
/// change of the rate another path time than it is made for. What is kept back leaves a stop an eighth of its slope for corrections
/// and nearly a quarter of its bend, and makes it 8/7 as long at most; nothing is left over, since it shrinks with the way.
const RELIED_ON: f64 = 7.0 / 8.0;

/// The fewest steps of a pace of 1, so that every per cent of an override is one of its own.
const FEWEST_STEPS: f64 = 128.0;

/// The fewest ticks in which q' may go from 0 to its limit: with fewer there is no shape to it.
const FEWEST_BENDING_TICKS: f64 = 8.0;

/// The most steps of a pace of 1: twice as many are exact in an f32, and every way is one in an i32.
const MOST_STEPS: f64 = 1_048_576.0;

/// The pace as it stands after a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pace {
    level: i32,
    slope: i32,
}

impl Pace {
    /// At rest.
    pub const REST: Self = Self { level: 0, slope: 0 };

    /// Whether nothing moves.
    #[inline(always)]
    pub fn is_rest(&self) -> bool {
        self.level == 0
    }
}

/// A pace that is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target<T> {
    level: i32,
    ample: T,
}

impl<T: Real> Target<T> {
    /// To rest: that needs no way.
    pub const REST: Self = Self { level: 0, ample: T::ZERO };

    /// A way in s of path time from which on a stop from this pace need not be looked at.
    #[inline(always)]
    pub fn ample(&self) -> T {
        self.ample
    }
}

/// What one tick does to the pace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stride {
    /// The path time of the tick in half steps of the pace: [`Pacer::time`].
    pub steps: i32,
    /// Whether the way that is left made the pace lower than it would have been.
    pub short: bool,
}

/// Limits of the pace that the tick may use: made by [`Pacer::activate`], so that every stop is possible and bounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pacer<T> {
    /// Steps of a pace of 1, N.
    whole: i32,
    /// The largest slope.
    steepest: i32,
    /// The level of the largest pace.
    most: i32,
    /// A way in s of path time that leaves room for any stop.
    ample: T,
    /// The way in s below which no motion is worth while: one step up and one down are four half steps, and a way is rounded
    /// down to whole ones.
    least: T,
    tick: T,
    /// Path time of a half step.
    half_step: T,
    /// Half steps in a second of path time.
    per_second: T,
}

impl<T: Real> Pacer<T> {
    /// A pace of 1 for ever: a path without starts, stops and overrides, as the published runs.
    pub const fn fixed(tick: T) -> Self {
        Self {
            whole: 1,
            steepest: 0,
            most: 1,
            ample: T::ZERO,
            least: T::ZERO,
            tick,
            half_step: T::ZERO,
            per_second: T::ZERO,
        }
    }

    /// Checks limits and prepares them for a tick of `tick` s. Load time.
    ///
    /// The steps are made as fine as `bend` asks for, and a little finer where that is needed for a slope of 8 and for single
    /// per cents: what the tick does is within the limits. Errors: limits that are no positive numbers, a largest pace
    /// outside 1..=2, stops that would take more than 4096 ticks.
    pub fn activate(limits: &PaceLimits<T>, tick: T) -> Result<Self, PathError> {
        let PaceLimits { slope, bend, most } = *limits;
        let is_limit = |x: T| x > T::ZERO && x.is_finite();
        if !(is_limit(slope) && is_limit(bend) && most >= T::ONE && most <= T::TWO) {
            let [slope, bend, most] = [slope, bend, most].map(T::to_f32);
            return Err(PathError::Pace { slope, bend, most });
        }
        let per_tick = slope * tick;
        let steps = (T::ONE / (bend * tick * tick)).most(T::lit(FEWEST_BENDING_TICKS) / per_tick);
        let slow = PathError::SlowStop { slope: slope.to_f32(), bend: bend.to_f32() };
        if steps > T::lit(MOST_STEPS) {
            return Err(slow);
        }
        // The next whole number, where a roundoff above one is that one.
        let up = |x: T| (x * (T::ONE - T::lit(4.0) * T::ROUNDOFF) + T::HALF).to_int();
        let down = |x: T| (x * (T::ONE + T::lit(4.0) * T::ROUNDOFF) - T::HALF).to_int();
        let whole = up(steps.most(T::lit(FEWEST_STEPS)));
        let steps = T::from_int(whole);
        let most = down(most * steps);
        // No ramp between 0 and the largest pace is steeper than its root.
        let root = most.unsigned_abs().isqrt() as i32;
        let steepest = down(per_tick * steps).min(root).max(2);
        // The mean of a stop is half its level, in two half steps; three ticks for what does not divide. A slope upwards first comes
        // down to 0, and the tick at hand ends before anything does. An eighth of the way is kept back.
        let ticks = most.checked_div(steepest).unwrap_or(most) + steepest + 3;
        let ample = (i64::from(ticks) + 2 * i64::from(steepest + 2)) * i64::from(most) * 8 / 7 + 8;
        let (Ok(ample), true) = (i32::try_from(ample), ticks <= LONGEST_STOP) else { return Err(slow) };
        let half_step = tick / T::from_int(2 * whole);
        Ok(Self {
            whole,
            steepest,
            most,
            ample: T::from_int(ample) * half_step,
            least: T::lit(5.0) * half_step,
            tick,
            half_step,
            per_second: T::ONE / half_step,
        })
    }

    /// Whether the pace is 1 for ever.
    pub fn is_fixed(&self) -> bool {
        self.steepest == 0
    }

    /// The pace of 1.
    pub const fn unity(&self) -> Pace {
        Pace { level: self.whole, slope: 0 }
    }

    /// The pace of 1, of a fixed pace.
    pub const fn unity_as_target(&self) -> Target<T> {
        Target { level: self.whole, ample: T::ZERO }
    }

    /// The pace of an override in per cent, at most the largest and at least one step.
    pub fn target(&self, percent: u8) -> Target<T> {
        // 255 times 2^20 is below 2^28.
        let level = ((i32::from(percent) * self.whole + 50) / 100).min(self.most).max(1);
        // The tick at hand ends before the stop begins; a way in s may be a roundoff of itself wrong.
        let ample = lattice::stopping_way(level, 0, self.steepest) + 4 * level + 8;
        Target { level, ample: T::from_int(ample) * self.half_step * T::lit(1.001 / RELIED_ON) }
    }

    /// q: the pace as a number. Not for the tick: it divides.
    pub fn value(&self, pace: &Pace) -> T {
        T::from_int(pace.level) / T::from_int(self.whole)
    }

    /// Whether a way of `way` s of path time is too short to begin a motion for: less than five half steps.
    #[inline(always)]
    pub fn is_nothing(&self, way: T) -> bool {
        way < self.least
    }

    /// Whether the pace may end within one tick: no larger change than any other tick may make.
    pub fn may_end(&self, pace: &Pace) -> bool {
        pace.level <= self.steepest
    }

    /// The path time of a stride, in s; exactly a tick at a pace of 1.
    #[inline(always)]
    pub fn time(&self, stride: Stride) -> T {
        if stride.steps == 2 * self.whole { self.tick } else { T::from_int(stride.steps) * self.half_step }
    }

    /// Whether another tick would change nothing, as long as the way is ample.
    #[inline(always)]
    pub fn is_steady(&self, pace: &Pace, target: &Target<T>) -> bool {
        pace.slope == 0 && pace.level == target.level
    }

    /// One tick: moves the pace towards `target`, but so that it can always rest within the way that is left. That is at least
    /// `least_way` s of path time; where it matters, `way` is asked how much it is.
    ///
    /// |q'|, |q''| and 0 <= q <= most hold whatever the targets and ways were before. A way that turns out shorter than it was
    /// said to be is met as closely as a stop at the limits can.
    #[inline(always)]
    pub fn step(&self, pace: &mut Pace, target: &Target<T>, least_way: T, way: impl FnOnce() -> T) -> Stride {
        let steady = self.is_steady(pace, target);
        if steady && least_way >= target.ample {
            return Stride { steps: 2 * pace.level, short: false };
        }
        let way = if least_way < self.ample { way() } else { self.ample };
        self.change(pace, target.level, way)
    }

    #[inline(never)]
    fn change(&self, pace: &mut Pace, target: i32, way: T) -> Stride {
        let Pace { level, slope } = *pace;
        let wanted = self.towards(level, slope, target);
        let (mut next, mut short) = (wanted, false);
        if way < self.ample {
            // Rounded down: half a half step less, and to the nearest.
            let relied_on = way * self.per_second * T::lit(RELIED_ON) - T::HALF;
            next = self.within(level, slope, wanted, relied_on.to_int());
            // The last ticks of a stop bend upwards as if towards the target.
            short = next < wanted || (next < 0 && level < target);
        }
        let after = level + next;
        *pace = Pace { level: after, slope: next };
        Stride { steps: level + after, short }
    }

    /// The slope that leads to `target` soonest: the largest towards it from which the sum 1 + 2 + .. of the slopes down to 0
    /// does not lead beyond it.
    fn towards(&self, level: i32, slope: i32, target: i32) -> i32 {
        let (sign, distance) = if target >= level { (1, target - level) } else { (-1, level - target) };
        let closing = sign * slope;
        let mut next = (closing + 1).min(self.steepest);
        for _ in 0..2 {
            if next >= closing && next > 0 && next * (next + 1) / 2 > distance {
                next -= 1;
            }
        }
        sign * next
    }

    /// The largest slope up to `wanted` from which a stop within `way` half steps is possible; where there is none, the one
    /// that stops soonest.
    fn within(&self, level: i32, slope: i32, wanted: i32, way: i32) -> i32 {
        let mut next = wanted;
        for _ in 0..2 {
            let after = level + next;
            if level + after + lattice::stopping_way(after, next, self.steepest) <= way {
                return next;
            }
            let lower = next - 1;
            let reaches_zero = lower < 0 && lower * (lower - 1) / 2 > level;
            if lower < slope - 1 || lower < -self.steepest || reaches_zero {
                return next;
            }
            next = lower;
        }
        next
    }
}

#[cfg(test)]
mod tests;

//! Homing: the search for the switches that tell where the axes are.
//!
//! Each axis goes fast to its switch, backs off, goes slowly to the switch again, and pulls off to home:
//!
//! ```text
//! (leave the switch) -> fast -> back off -> slow -> pull off -> at home
//! ```
//!
//! The first tick in which the switch was seen to act is kept while the debouncing makes sure of it, so that neither bouncing nor its
//! debouncing moves home: it is found to the way of one tick of the slow approach. A delay between setpoint and motion shifts
//! it by as many of these ways, always the same.
//!
//! | fault | when |
//! | --- | --- |
//! | not found, fast | farther than the axis is long, and what overrun, back-off and pull-off take |
//! | not found, slow | farther than twice the back-off |
//! | stuck | the switch still acts after backing off or pulling off; or, pressed at the start, after a back-off, a pull-off and an overrun |
//!
//! Every phase moves or ends, so that these bounds are bounds of the time too. Axes that search count from 0 where they begin; the
//! tick in which one is [`Step::homed`] gives its setpoint in machine coordinates, and the axis is told to stand there, not to go.
//!
//! Cost in a tick: no float, two divisions an axis at most while it searches.

mod mover;

#[cfg(test)]
mod tests;

use crate::fixed::{Fixed, UNITS_PER_MM};
use crate::machine::{AxisSettings, End, HomeSwitch};
use crate::safety::{HomingFault, Levels};
use crate::steps::MOST_AXES;
use mover::Mover;

/// How one axis finds home, in units of 2^-18 mm and ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisPlan {
    /// 1 towards the high end, -1 towards the low one.
    toward: i32,
    fast: i32,
    slow: i32,
    acceleration: i32,
    back_off: i32,
    pull_off: i32,
    /// The farthest fast approach.
    seek: u32,
    /// The farthest way off a switch that is pressed at the start.
    leave: u32,
    home: Fixed,
    order: u8,
}

/// How the axes find home; made by [`crate::machine::MachineSettings::activate`]. Bit k of a set of axes is axis k.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HomingPlan {
    axes: [Option<AxisPlan>; MOST_AXES],
    /// Ticks for which a switch must act.
    debounce: u8,
    by_home: u8,
    by_low: u8,
    by_high: u8,
}

impl HomingPlan {
    /// No axis yet; switches act after `debounce` ticks.
    pub(crate) fn new(debounce: u8) -> Self {
        Self { debounce, ..Self::default() }
    }

    /// Adds an axis whose settings are checked. Load time.
    pub(crate) fn add(&mut self, axis: u8, settings: &AxisSettings) {
        let (Some(homing), Some(slot)) = (settings.homing, self.axes.get_mut(usize::from(axis))) else { return };
        let units = |mm: f64| Fixed::from_mm(mm).0;
        let tick = f64::from(crate::TICK);
        let overrun = homing.fast * homing.fast / (2.0 * settings.acceleration) + homing.fast * tick;
        let [low, high] = settings.travel;
        let off = homing.back_off + homing.pull_off + overrun;
        *slot = Some(AxisPlan {
            toward: if homing.toward == End::Low { -1 } else { 1 },
            fast: units(homing.fast * tick).max(1),
            slow: units(homing.slow * tick).max(1),
            // Rounded down; at least 1, since the acceleration is at least 4 mm/s^2.
            acceleration: ((settings.acceleration * tick * tick * UNITS_PER_MM) as i32).max(1),
            back_off: units(homing.back_off),
            pull_off: units(homing.pull_off),
            // A coordinate's range is 8.19 m.
            seek: units((high - low + off).min(8_100.0)).unsigned_abs(),
            leave: units(off.min(8_100.0)).unsigned_abs(),
            home: Fixed::from_mm(homing.position),
            order: homing.order,
        });
        let bit = 1_u8.wrapping_shl(u32::from(axis));
        match (homing.switch, homing.toward) {
            (HomeSwitch::Home, _) => self.by_home |= bit,
            (HomeSwitch::Limit, End::Low) => self.by_low |= bit,
            (HomeSwitch::Limit, End::High) => self.by_high |= bit,
        }
    }

    /// For each axis the switch by which it finds home.
    #[inline]
    pub fn switches(&self, levels: &Levels) -> u8 {
        levels.home & self.by_home | levels.low & self.by_low | levels.high & self.by_high
    }

    /// The axes that can find home.
    pub fn axes(&self) -> u8 {
        self.by_home | self.by_low | self.by_high
    }
}

/// What an axis is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// Waits for its turn, or was not asked.
    Waiting,
    /// Leaves the switch on which it stood.
    Leaving,
    Fast,
    BackOff(i32),
    Slow,
    PullOff(i32),
    Done,
}

#[derive(Clone, Copy, Debug)]
struct AxisSearch {
    mover: Mover,
    phase: Phase,
    /// Where the phase began.
    from: i32,
    /// Where the switch was first seen to act, unless that was a glitch.
    edge: Option<i32>,
    /// Whether the switch acts, debounced.
    acts: bool,
    /// Ticks in a row that show otherwise.
    count: u8,
    /// Ticks in a row that show a switch that does not act.
    quiet: u8,
}

/// A search for home.
#[derive(Clone, Copy, Debug)]
pub struct Homing {
    axes: [AxisSearch; MOST_AXES],
    /// The axes that have not found home yet.
    searching: u8,
}

/// What a tick of a search comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// Where the axes shall be at the next tick.
    pub setpoint: [Fixed; MOST_AXES],
    /// The axes that have come home in this tick: they stand where the setpoint says.
    pub homed: u8,
    /// All axes have found home.
    pub done: bool,
    /// Nothing moves.
    pub at_rest: bool,
    /// The axis that cannot find home, and why. The search is over.
    pub fault: Option<(u8, HomingFault)>,
}

impl Homing {
    /// A search by `axes`, those of them that have a plan. They count from 0 from now on; the others stay at `position`.
    pub fn begin(plan: &HomingPlan, axes: u8, position: [Fixed; MOST_AXES], switches: u8) -> Self {
        let searching = axes & plan.axes();
        let mut bit = 1_u8;
        let axes = position.map(|position| {
            let (searches, acts) = (searching & bit != 0, switches & bit != 0);
            bit = bit.wrapping_shl(1);
            let position = if searches { 0 } else { position.0 };
            let mover = Mover { position, velocity: 0 };
            AxisSearch { mover, phase: Phase::Waiting, from: position, edge: None, acts, count: 0, quiet: 0 }
        });
        Self { axes, searching }
    }

    /// One tick. `switches` are those of [`HomingPlan::switches`]; with `stop` all axes come to rest instead, and the search is over
    /// when they do.
    pub fn step(&mut self, plan: &HomingPlan, switches: u8, stop: bool) -> Step {
        let turn = self.turn(plan);
        let mut step = Step { setpoint: [Fixed(0); MOST_AXES], homed: 0, done: false, at_rest: true, fault: None };
        let axes = (0_u8..).zip(&mut self.axes).zip(&plan.axes).zip(&mut step.setpoint);
        for (((number, axis), plan_of), setpoint) in axes {
            let bit = 1_u8.wrapping_shl(u32::from(number));
            if let Some(one) = plan_of
                && self.searching & bit != 0
            {
                axis.look(switches & bit != 0, plan.debounce);
                if stop {
                    axis.mover.toward_velocity(0, one.acceleration);
                } else if one.order == turn {
                    match axis.search(one) {
                        Ok(()) if axis.phase == Phase::Done => {
                            axis.mover.position = one.home.0;
                            self.searching &= !bit;
                            step.homed |= bit;
                        }
                        Ok(()) => {}
                        Err(fault) => step.fault = step.fault.or(Some((number, fault))),
                    }
                }
            }
            step.at_rest &= axis.mover.velocity == 0;
            *setpoint = Fixed(axis.mover.position);
        }
        step.done = self.searching == 0;
        step
    }

    /// The lowest order among the axes that search.
    fn turn(&self, plan: &HomingPlan) -> u8 {
        let mut bit = 1_u8;
        plan.axes.iter().fold(u8::MAX, |turn, axis| {
            let searches = self.searching & bit != 0;
            bit = bit.wrapping_shl(1);
            axis.as_ref().map_or(turn, |axis| if searches { turn.min(axis.order) } else { turn })
        })
    }
}

impl AxisSearch {
    /// Debounces the switch, and keeps where it was first seen to act.
    fn look(&mut self, raw: bool, debounce: u8) {
        if raw && self.edge.is_none() {
            self.edge = Some(self.mover.position);
        }
        if raw == self.acts {
            self.count = 0;
        } else {
            self.count = self.count.saturating_add(1);
            if self.count >= debounce {
                (self.acts, self.count) = (raw, 0);
            }
        }
        self.quiet = if raw { 0 } else { self.quiet.saturating_add(1) };
        if !self.acts && self.quiet >= debounce {
            // What was seen before was a glitch, or the switch has let go.
            self.edge = None;
        }
    }

    fn enter(&mut self, phase: Phase) {
        (self.phase, self.from) = (phase, self.mover.position);
    }

    /// One tick of the search: what follows from where it is, then the motion that belongs to it.
    fn search(&mut self, plan: &AxisPlan) -> Result<(), HomingFault> {
        let gone = self.mover.position.wrapping_sub(self.from).unsigned_abs();
        // Where the switch was first seen to act, now that it is sure.
        let edge = if self.acts { self.edge } else { None };
        match (self.phase, edge) {
            (Phase::Waiting, _) => self.enter(if self.acts { Phase::Leaving } else { Phase::Fast }),
            (Phase::Leaving, _) if !self.acts => self.enter(Phase::Fast),
            (Phase::Leaving, _) if gone > plan.leave => return Err(HomingFault::Stuck),
            (Phase::Fast, Some(edge)) => self.enter(Phase::BackOff(plan.off(edge, plan.back_off))),
            (Phase::Slow, Some(edge)) => self.enter(Phase::PullOff(plan.off(edge, plan.pull_off))),
            (Phase::Fast, None) if gone > plan.seek => return Err(HomingFault::NotFound),
            (Phase::Slow, None) if gone > plan.back_off.unsigned_abs().saturating_mul(2) => {
                return Err(HomingFault::NotFound);
            }
            // Once it rests there, and the switch is no longer in question.
            (Phase::BackOff(point) | Phase::PullOff(point), _) if self.mover.rests_at(point) && self.count == 0 => {
                match self.phase {
                    _ if self.acts => return Err(HomingFault::Stuck),
                    Phase::BackOff(_) => self.enter(Phase::Slow),
                    _ => self.enter(Phase::Done),
                }
            }
            _ => {}
        }
        let (toward, a) = (plan.toward, plan.acceleration);
        match self.phase {
            Phase::Leaving => self.mover.toward_velocity(-toward * plan.slow, a),
            Phase::Fast => self.mover.toward_velocity(toward * plan.fast, a),
            Phase::Slow => self.mover.toward_velocity(toward * plan.slow, a),
            Phase::BackOff(point) | Phase::PullOff(point) => self.mover.toward_point(point, plan.fast, a),
            Phase::Waiting | Phase::Done => {}
        }
        Ok(())
    }
}

impl AxisPlan {
    /// The point so far off a switch.
    fn off(&self, edge: i32, distance: i32) -> i32 {
        edge.wrapping_sub(self.toward * distance)
    }
}

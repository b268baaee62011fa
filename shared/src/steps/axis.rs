//! One step axis, one tick: from setpoints to pulses in slots.
//!
//! A coordinate times steps per unit is a 96-bit product: 32 bits of whole steps, and a fraction of 64 bits that says when the next
//! step is due. Steps are counted by the whole part alone. Only the instants within a tick are computed in f32, from the distance to
//! the first crossing and one division; they are worth 2^-8 slot, and the next tick begins anew.

use core::cell::Cell;

use super::settings::{Pin, StepSettings};
use super::{MOST_SLOTS, StepFault};
use crate::fixed::{Fixed, UNITS_PER_MM};

/// Binary places of an instant, in slots: 13 bits before the point make room for [`MOST_SLOTS`] and a distance that is no longer.
const PLACES: u32 = 19;

/// Added to every instant, in 2^-[`PLACES`] slots: 2^-7 slot, above the error of an instant, so that a step is never a whole slot
/// early. Five roundoffs of at most 4096 slots are 2^-9.7 slot, and 2047 steps times half a unit of their distance 2^-9.
const LEAD: f32 = 4_096.0;

/// How far beyond the tick's end an instant may be by rounding, in 2^-[`PLACES`] slots: twice the lead.
const MARGIN: u32 = 8_192;

/// A slot that is past by more than any hold.
const FAR: i32 = -(MOST_SLOTS as i32);

/// One axis as the tick uses it.
#[derive(Clone, Copy, Debug, Default)]
pub struct StepAxis {
    /// Steps per unit of a coordinate, times 2^64; at most 2^63.
    ratio: u64,
    /// The distance of two steps in 2^-[`PLACES`] slots, at one unit a tick.
    pace: f32,
    step_port: u8,
    direction_port: u8,
    /// The words that begin and end a pulse.
    rise: u32,
    fall: u32,
    /// The words for both directions.
    positive: u32,
    negative: u32,
    /// In slots; the period is pulse and gap.
    pulse: i32,
    period: i32,
    setup: i32,
    hold: i32,
    /// Whether no axis before this one writes to the port of its pulses.
    alone: bool,
    /// The most steps that a tick can hold.
    most: u32,
    /// The most steps that may be owed at its end.
    allowance: u32,
}

/// What one axis remembers between two ticks. Slots count from the start of the next tick.
#[derive(Clone, Copy, Debug)]
pub struct AxisState {
    /// The setpoint that was reached, and the step next to it, with the 64-bit fraction of a step beyond the middle before.
    setpoint: i32,
    nearest: i32,
    fraction: u64,
    /// The step where all pulses so far lead to.
    position: i32,
    /// The slot in which the last pulse ends; below 0 where that is past.
    end: i32,
    /// The slot from which on a pulse may begin.
    ready: i32,
    backward: bool,
}

/// What a tick did to an axis.
#[derive(Clone, Copy, Debug)]
pub struct Done {
    /// Whether something was written.
    pub wrote: bool,
    /// What is wrong, if anything is.
    pub excess: Option<Excess>,
}

/// An axis that cannot keep up.
#[derive(Clone, Copy, Debug)]
pub enum Excess {
    /// Steps asked for in one tick.
    TooFast(u32),
    /// Steps owed.
    Late(u32),
}

impl Excess {
    /// As a fault of axis `axis`.
    pub fn fault(self, axis: u8) -> StepFault {
        match self {
            Self::TooFast(steps) => StepFault::TooFast { axis, steps },
            Self::Late(steps) => StepFault::Late { axis, steps },
        }
    }
}

/// When the steps of a tick are due: so many at once, then one at an instant and one every period from there.
#[derive(Clone, Copy)]
struct Due {
    /// Steps that were due before this tick.
    late: u32,
    /// In 2^-[`PLACES`] slots.
    at: u32,
    period: u32,
}

impl AxisState {
    pub(super) const fn new() -> Self {
        Self { setpoint: 0, nearest: 0, fraction: 0, position: 0, end: FAR, ready: 0, backward: false }
    }

    pub(super) fn position(&self) -> i32 {
        self.position
    }

    pub(super) fn owed(&self) -> i32 {
        self.nearest.wrapping_sub(self.position)
    }
}

impl StepAxis {
    /// Of settings that have been checked. Load time.
    pub(super) fn new<const SLOTS: usize>(settings: &StepSettings, alone: bool) -> Self {
        let word = |pin: Pin, active: bool| {
            let bit = 1_u32 << (pin.bit & 15);
            if active != pin.inverted { bit } else { bit << 16 }
        };
        let period = i32::from(settings.pulse) + i32::from(settings.gap);
        let turn = period + i32::from(settings.setup) + i32::from(settings.hold);
        let steps_per_unit = settings.steps_per_mm / UNITS_PER_MM;
        Self {
            ratio: libm::round(steps_per_unit * 18_446_744_073_709_551_616.0) as u64,
            pace: (SLOTS as f64 * f64::from(1_u32 << PLACES) / steps_per_unit) as f32,
            step_port: settings.step.port,
            direction_port: settings.direction.port,
            rise: word(settings.step, true),
            fall: word(settings.step, false),
            positive: word(settings.direction, true),
            negative: word(settings.direction, false),
            pulse: settings.pulse.into(),
            period,
            setup: settings.setup.into(),
            hold: settings.hold.into(),
            alone,
            most: (SLOTS as u32).div_ceil(period as u32),
            allowance: (turn / period) as u32 + 2,
        }
    }

    pub(super) fn period(&self) -> u32 {
        self.period as u32
    }

    /// The ports that are written, one bit a port.
    pub(super) fn ports(&self) -> u8 {
        1 << (self.step_port & 7) | 1 << (self.direction_port & 7)
    }

    /// Port and word of both pins at rest.
    pub(super) fn idle(&self) -> [(usize, u32); 2] {
        [(self.step_port.into(), self.fall), (self.direction_port.into(), self.positive)]
    }

    pub(super) fn stand_at(&self, state: &mut AxisState, position: Fixed) {
        state.setpoint = position.0;
        (state.nearest, state.fraction) = self.nearest(position);
        state.position = state.nearest;
    }

    /// The step that is nearest to `position`, halves upwards, and how far `position` is beyond the middle before it, in 2^-64 steps.
    #[inline(always)]
    fn nearest(&self, position: Fixed) -> (i32, u64) {
        let position = i64::from(position.0);
        // |position| <= 2^31 and the factors are below 2^32 and at most 2^31: neither product, nor their sum, can overflow.
        let low = position.wrapping_mul(i64::from(self.ratio as u32));
        let high = position.wrapping_mul((self.ratio >> 32) as i64);
        let sum = high.wrapping_add(low >> 32).wrapping_add(1 << 31);
        ((sum >> 32) as i32, (sum as u64) << 32 | u64::from(low as u32))
    }

    /// One tick.
    #[inline(always)]
    pub(super) fn tick<const SLOTS: usize>(
        &self,
        state: &mut AxisState,
        target: Fixed,
        ports: &[&[Cell<u32>]],
    ) -> Done {
        let (nearest, fraction) = self.nearest(target);
        let way = nearest.wrapping_sub(state.position);
        let wrote = way != 0 || state.end >= 0;
        let mut excess = None;
        if wrote {
            let owed = self.write::<SLOTS>(state, target, way, ports);
            let asked = nearest.wrapping_sub(state.nearest).unsigned_abs();
            if asked > self.most {
                excess = Some(Excess::TooFast(asked));
            } else if owed > self.allowance {
                excess = Some(Excess::Late(owed));
            }
        }
        state.setpoint = target.0;
        (state.nearest, state.fraction) = (nearest, fraction);
        state.end = state.end.wrapping_sub(SLOTS as i32).max(FAR);
        state.ready = state.ready.wrapping_sub(SLOTS as i32).max(0);
        Done { wrote, excess }
    }

    /// Ends the pulse that is pending and plays `way` steps; returns how many are owed.
    #[inline(never)]
    fn write<const SLOTS: usize>(&self, state: &mut AxisState, target: Fixed, way: i32, ports: &[&[Cell<u32>]]) -> u32 {
        let (Some(step), Some(direction)) =
            (ports.get(usize::from(self.step_port)), ports.get(usize::from(self.direction_port)))
        else {
            return way.unsigned_abs();
        };
        mark(step, state.end, self.fall);
        if way == 0 {
            return 0;
        }
        let backward = way < 0;
        let due = self.due::<SLOTS>(state, target, way);
        if backward != state.backward {
            // The last pulse ended before this tick, or a quarter of a tick after its start; then comes the hold, another quarter.
            let turn = state.end.wrapping_add(self.hold).max(0);
            mark(direction, turn, if backward { self.negative } else { self.positive });
            state.backward = backward;
            state.ready = state.ready.max(turn.wrapping_add(self.setup));
        }
        let owed = way.unsigned_abs().wrapping_sub(self.play::<SLOTS>(state, due, way.unsigned_abs(), step));
        let played = way.unsigned_abs().wrapping_sub(owed) as i32;
        state.position = state.position.wrapping_add(if backward { played.wrapping_neg() } else { played });
        owed
    }

    /// When `way` steps, which are not 0, are due on the straight line to `target`.
    #[inline(always)]
    fn due<const SLOTS: usize>(&self, state: &AxisState, target: Fixed, way: i32) -> Due {
        let stride = target.0.wrapping_sub(state.setpoint);
        let least = (self.period as u32) << PLACES;
        if stride == 0 || (stride ^ way) < 0 {
            // The axis does not move that way: all of it is from before.
            return Due { late: way.unsigned_abs(), at: 0, period: least };
        }
        let period = self.pace / stride.unsigned_abs() as f32;
        let (owed, rest) = if way < 0 {
            (state.position.wrapping_sub(state.nearest), state.fraction)
        } else {
            (state.nearest.wrapping_sub(state.position), !state.fraction)
        };
        // Where the axis is ahead, since it owes steps the other way, it waits for its setpoint.
        let ahead = owed.wrapping_neg().max(0);
        let first =
            ahead as f32 + ((rest >> 32) as u32 as f32 * TWO_TO_MINUS_32 + rest as u32 as f32 * TWO_TO_MINUS_64);
        Due {
            late: owed.max(0) as u32,
            at: (first * period + LEAD) as u32,
            period: ((period + 0.5) as u32).min((SLOTS as u32) << PLACES).max(least),
        }
    }

    /// Plays up to `count` steps when they are `due`, or as soon as the drive allows, and returns how many it played.
    #[inline(always)]
    fn play<const SLOTS: usize>(&self, state: &mut AxisState, due: Due, count: u32, step: &[Cell<u32>]) -> u32 {
        let least = (self.period as u32) << PLACES;
        let mut played = 0;
        if due.late > 0 {
            played = self.train::<SLOTS>(state, (state.ready as u32) << PLACES, least, due.late.min(count), step);
            if played < due.late {
                return played;
            }
        }
        let (mut at, ready) = (due.at, (state.ready as u32) << PLACES);
        if at >> PLACES < state.ready as u32 {
            // Each step at the highest rate catches up by the difference of the distances.
            let gain = due.period.wrapping_sub(least);
            let behind = ready.wrapping_sub(at).checked_div(gain).map_or(u32::MAX, |steps| steps.wrapping_add(1));
            let behind = behind.min(count.wrapping_sub(played));
            let caught = self.train::<SLOTS>(state, ready, least, behind, step);
            played = played.wrapping_add(caught);
            if caught < behind {
                return played;
            }
            at = at.saturating_add(due.period.saturating_mul(behind));
        }
        played.wrapping_add(self.train::<SLOTS>(state, at, due.period, count.wrapping_sub(played), step))
    }

    /// Plays up to `count` steps, the first at the instant `at`, where the axis is ready, and one every `period` from there, which is at
    /// least the drive's own; both in 2^-[`PLACES`] slots. Returns how many it played.
    #[inline(never)]
    fn train<const SLOTS: usize>(
        &self,
        state: &mut AxisState,
        at: u32,
        period: u32,
        count: u32,
        step: &[Cell<u32>],
    ) -> u32 {
        let end = ((SLOTS as u32) << PLACES) + MARGIN;
        if count == 0 || at >= end {
            return 0;
        }
        let mut before = count.wrapping_sub(1);
        let mut last = u64::from(period) * u64::from(before) + u64::from(at);
        if last >= u64::from(end) {
            before = end.wrapping_sub(at).wrapping_sub(1).checked_div(period).unwrap_or(0);
            last = u64::from(period.wrapping_mul(before).wrapping_add(at));
        }
        let last = last as u32;
        if before > 0 {
            let slot = last.wrapping_sub(period) >> PLACES;
            if self.alone {
                run::<true>(step, self, at, period, slot);
            } else {
                run::<false>(step, self, at, period, slot);
            }
            state.end = (slot as i32).wrapping_add(self.pulse);
            state.ready = (slot as i32).wrapping_add(self.period);
        }
        // The last one may be rounded beyond the end, and its pulse may end in the next tick.
        let slot = ((last >> PLACES) as i32).min(SLOTS as i32 - 1).max(state.ready);
        if slot >= SLOTS as i32 {
            return before;
        }
        self.pulse(state, slot, step);
        before.wrapping_add(1)
    }

    /// One pulse that begins in `slot`, which is in this tick; its end may be in the next one.
    #[inline(always)]
    fn pulse(&self, state: &mut AxisState, slot: i32, step: &[Cell<u32>]) {
        state.end = slot.wrapping_add(self.pulse);
        state.ready = slot.wrapping_add(self.period);
        mark(step, slot, self.rise);
        mark(step, state.end, self.fall);
    }
}

const TWO_TO_MINUS_32: f32 = 1.0 / 4_294_967_296.0;
const TWO_TO_MINUS_64: f32 = TWO_TO_MINUS_32 * TWO_TO_MINUS_32;

/// Adds `bits` to the word of a slot; a slot beyond the tick is left alone.
#[inline(always)]
fn mark(words: &[Cell<u32>], slot: i32, bits: u32) {
    if let Some(word) = words.get(slot as usize) {
        word.set(word.get() | bits);
    }
}

/// The pulses of `axis` at `at` and every `period` after it, in 2^-[`PLACES`] slots, up to the slot `last`; all of them end in this
/// tick. Ten instructions a pulse, and six where `ALONE` says that these slots' words are still 0.
///
/// A function of its own, so that all that the loop needs stays in registers.
#[inline(never)]
fn run<const ALONE: bool>(step: &[Cell<u32>], axis: &StepAxis, at: u32, period: u32, last: u32) {
    let (begin, end) = (axis.rise, axis.fall);
    let (count, pulse) = ((last as usize).wrapping_add(1), axis.pulse as usize);
    let (Some(begins), Some(ends)) = (step.get(..count), step.get(pulse..pulse.wrapping_add(count))) else { return };
    // A double word, because its sum with carry leaves the slot in a register of its own.
    let (mut at, period) = (u64::from(at) << (32 - PLACES), u64::from(period) << (32 - PLACES));
    // At most a round a slot: the period is one slot at least.
    while let (Some(first), Some(second)) = (begins.get((at >> 32) as usize), ends.get((at >> 32) as usize)) {
        first.set(if ALONE { begin } else { first.get() | begin });
        second.set(if ALONE { end } else { second.get() | end });
        at = at.wrapping_add(period);
    }
}

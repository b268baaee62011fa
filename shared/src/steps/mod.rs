//! Step axes: the pulses of the next tick as words that hardware plays.
//!
//! A tick is divided into `SLOTS` equal slots. For each port with step or direction pins there is a ring of two halves, each one
//! word a slot. A word is what a port's set/reset register takes: the low half sets pins, the high half resets them, and 0
//! changes nothing (STM32 BSRR, RM0433 rev 9 section 11.4.7). While a timer-paced DMA plays one half, [`StepAxes::fill`] writes the
//! other one: no interrupt for a step, and no jitter by what the processor does.
//!
//! Where steps fall. The axis stands on the step nearest to its setpoint, in integers, whatever came before: nothing is ever summed up
//! that could drift. Between two setpoints the motion is taken as a straight line, and a step begins with the slot in which that
//! line crosses the middle between two steps: at most one slot early, and 2^-6 slot late by rounding. It moves later only where its
//! pulse would follow too closely on the one before, by less than a slot at any speed that can be played, or on a change of
//! direction; then also into the next tick, and what is owed is part of the state. More than can be played is a [`StepFault`], and the
//! words hold as many whole pulses as fit.
//!
//! | module | what |
//! | --- | --- |
//! | [`settings`] | what a person writes, and what is wrong with it |
//! | `axis` | one axis, one tick |
//! | [`receiver`] | what a drive makes of its two inputs |
//! | [`decoder`] | words back to steps; for tests and simulators, nothing shared with the encoder |
//!
//! | part, of one tick | instructions, counted on the virtual board's Cortex-M7 when this was written |
//! | --- | --- |
//! | a pulse | 10; 6 on the first axis of a port |
//! | an axis that moves, or rests | about 230, or 70, besides; one division |
//! | clearing a half that was written | 0.57 a word; nothing at rest |
//! | three axes at 900 000 steps/s each, 1875 or 3750 slots | 25 000 or 26 000 |
//! | three axes at 100 000 steps/s each, 1875 or 3750 slots | 4 700 or 5 600 |
//!
//! No loop runs longer than once a pulse, of which a tick holds at most half as many as slots: three axes that are all asked for too much
//! take 26 000 or 52 000. No panic path, no `f64`, no call but its own. A ring takes 8 bytes a slot.

mod axis;
pub mod decoder;
pub mod receiver;
pub mod settings;

#[cfg(test)]
mod tests;

use core::cell::Cell;

use crate::fixed::Fixed;
use axis::{AxisState, StepAxis};
pub use settings::{Pin, StepError, StepSettings, StepTime, slots_in};

/// The most step axes.
pub const MOST_AXES: usize = 6;

/// The most slots in a tick: times within a tick have 12 bits before the point.
pub const MOST_SLOTS: usize = 4_095;

/// Which half of the rings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Half {
    /// The lower addresses.
    First,
    /// The upper addresses.
    Second,
}

/// Steps that could not be played as asked. Only whole pulses are in the words, and the state knows what is owed: the next ticks
/// play it as fast as the drive allows, unless [`StepAxes::stand_at`] gives it up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StepFault {
    /// The setpoint moved by more steps than a tick can hold.
    TooFast {
        /// Which axis, from 0.
        axis: u8,
        /// How many steps were asked for.
        steps: u32,
    },
    /// More steps are owed than changes of direction account for.
    Late {
        /// Which axis, from 0.
        axis: u8,
        /// How many steps are owed.
        steps: u32,
    },
}

/// Step axes as the tick uses them; made only by [`StepSettings::activate`], so every value is in range.
#[derive(Clone, Copy, Debug)]
pub struct StepAxes<const AXES: usize, const PORTS: usize, const SLOTS: usize> {
    axes: [StepAxis; AXES],
    /// The word that changes nothing: 0. A variable, because the compiler makes a call to a slow `memset` of a constant.
    nothing: u32,
}

/// What step axes remember between two ticks.
#[derive(Clone, Copy, Debug)]
pub struct StepState<const AXES: usize> {
    axes: [AxisState; AXES],
    /// For each half, the ports in which something may be written; one bit a port.
    written: [u8; 2],
}

impl<const AXES: usize> StepState<AXES> {
    /// Where an axis stands when the words are played, in steps from coordinate zero.
    pub fn position(&self, axis: usize) -> Option<i32> {
        self.axes.get(axis).map(AxisState::position)
    }

    /// How many steps an axis still owes to its setpoint.
    pub fn owed(&self, axis: usize) -> Option<i32> {
        self.axes.get(axis).map(AxisState::owed)
    }
}

impl<const AXES: usize, const PORTS: usize, const SLOTS: usize> StepAxes<AXES, PORTS, SLOTS> {
    fn new(axes: [StepAxis; AXES]) -> Self {
        Self { axes, nothing: 0 }
    }

    /// The state of axes that rest at `position`, with all pins as [`StepAxes::idle`] makes them. Whatever the rings hold is cleared by
    /// the first [`StepAxes::fill`] of each half; what is played before that must be 0.
    pub fn at_rest(&self, position: [Fixed; AXES]) -> StepState<AXES> {
        let mut state = StepState { axes: [AxisState::new(); AXES], written: [u8::MAX; 2] };
        self.stand_at(&mut state, position);
        state
    }

    /// Takes the axes to stand at `position` from now on, without a pulse: the end of homing, or of what is owed after a fault.
    pub fn stand_at(&self, state: &mut StepState<AXES>, position: [Fixed; AXES]) {
        for ((axis, state), position) in self.axes.iter().zip(&mut state.axes).zip(position) {
            axis.stand_at(state, position);
        }
    }

    /// For each port the word that gives the pins their levels at rest: no pulse, positive direction. To be written once, before
    /// the pins become outputs.
    pub fn idle(&self) -> [u32; PORTS] {
        let mut words = [0; PORTS];
        for axis in &self.axes {
            for (port, word) in axis.idle() {
                if let Some(idle) = words.get_mut(port) {
                    *idle |= word;
                }
            }
        }
        words
    }

    /// The most steps an axis can make in a tick, for a planner; 0 for an axis that there is not.
    pub fn most_steps(&self, axis: usize) -> u32 {
        self.axes.get(axis).map_or(0, |axis| SLOTS as u32 / axis.period())
    }

    /// One tick: writes into `words`, which are this `half` of each port's ring, the steps that lead to `target`, where the axes
    /// shall stand when the half has been played.
    ///
    /// The half holds what was written into it two ticks ago, or nothing; it is cleared first. An axis plays at most one pulse in two
    /// slots, so the time is bounded whatever is asked for. Errors: the first axis that cannot keep up; the words are good all the same.
    #[inline]
    pub fn fill(
        &self,
        state: &mut StepState<AXES>,
        target: [Fixed; AXES],
        half: Half,
        words: [&mut [u32; SLOTS]; PORTS],
    ) -> Result<(), StepFault> {
        let ports = words.map(|words| Cell::from_mut(&mut words[..]).as_slice_of_cells());
        let written = match half {
            Half::First => &mut state.written[0],
            Half::Second => &mut state.written[1],
        };
        for (bit, words) in ports.iter().enumerate() {
            if *written >> bit & 1 != 0 {
                clear(words, self.nothing);
            }
        }
        *written = 0;
        let mut fault = Ok(());
        for number in 0..AXES {
            let (Some(axis), Some(state), Some(target)) =
                (self.axes.get(number), state.axes.get_mut(number), target.get(number))
            else {
                continue;
            };
            let done = axis.tick::<SLOTS>(state, *target, &ports);
            if done.wrote {
                *written |= axis.ports();
            }
            if let Some(excess) = done.excess {
                fault = fault.and(Err(excess.fault(number as u8)));
            }
        }
        fault
    }
}

/// Writes `nothing` everywhere, in blocks that become stores of two words each.
#[inline]
fn clear(words: &[Cell<u32>], nothing: u32) {
    let (blocks, rest) = words.as_chunks::<16>();
    for block in blocks {
        for word in block {
            word.set(nothing);
        }
    }
    for word in rest {
        word.set(nothing);
    }
}

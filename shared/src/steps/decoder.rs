//! Words back to steps: the ports that take them, and a [`Receiver`] at the pins of each axis.
//!
//! For tests and for simulators. Nothing here is shared with the encoder but the wiring that both are told.

use super::receiver::Receiver;
use super::settings::{Pin, StepSettings};

/// One step, as a drive sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// Which axis, from 0.
    pub axis: usize,
    /// When its pulse began, in slots since the start.
    pub instant: u64,
    /// Whether it goes in the positive direction.
    pub forward: bool,
}

/// Ports whose outputs are set and reset by words, and the drives at their pins.
#[derive(Clone, Copy, Debug)]
pub struct Decoder<const AXES: usize, const PORTS: usize> {
    wires: [[Pin; 2]; AXES],
    drives: [Receiver; AXES],
    outputs: [u16; PORTS],
    now: u64,
    clashes: u32,
}

impl<const AXES: usize, const PORTS: usize> Decoder<AXES, PORTS> {
    /// All pins at rest, all drives at position 0.
    pub fn new(settings: &[StepSettings; AXES]) -> Self {
        let wires = settings.map(|one| [one.step, one.direction]);
        let mut outputs = [0; PORTS];
        for [step, direction] in wires {
            // A pulse that is not there is high where pulses are low; the positive direction is high where it is not inverted.
            for (pin, high) in [(step, step.inverted), (direction, !direction.inverted)] {
                if let Some(output) = outputs.get_mut(usize::from(pin.port))
                    && high
                {
                    *output |= 1_u16.wrapping_shl(pin.bit.into());
                }
            }
        }
        Self { wires, drives: [Receiver::new(); AXES], outputs, now: 0, clashes: 0 }
    }

    /// Plays one half of the rings and shows every step to `look`, in the order of their instants.
    pub fn play<const SLOTS: usize>(&mut self, words: [&[u32; SLOTS]; PORTS], mut look: impl FnMut(Step)) {
        for slot in 0..SLOTS {
            let mut changed = false;
            for (output, words) in self.outputs.iter_mut().zip(words) {
                let word = words.get(slot).copied().unwrap_or(0);
                let (set, reset) = (word as u16, (word >> 16) as u16);
                self.clashes = self.clashes.saturating_add(u32::from(set & reset != 0));
                // Where a word does both, setting has priority: RM0433 rev 9 section 11.4.7.
                let new = *output & !reset | set;
                changed |= new != *output;
                *output = new;
            }
            if changed {
                self.see(self.now.saturating_add(slot as u64), &mut look);
            }
        }
        self.now = self.now.saturating_add(SLOTS as u64);
    }

    fn see(&mut self, instant: u64, look: &mut impl FnMut(Step)) {
        for (axis, (drive, [step, direction])) in self.drives.iter_mut().zip(&self.wires).enumerate() {
            let active = |pin: &Pin| {
                let output = self.outputs.get(usize::from(pin.port)).copied().unwrap_or(0);
                (output.wrapping_shr(pin.bit.into()) & 1 != 0) != pin.inverted
            };
            if let Some(forward) = drive.see(instant, active(step), active(direction)) {
                look(Step { axis, instant, forward });
            }
        }
    }

    /// The drive at the pins of an axis.
    pub fn drive(&self, axis: usize) -> Option<&Receiver> {
        self.drives.get(axis)
    }

    /// The outputs of all ports.
    pub fn outputs(&self) -> [u16; PORTS] {
        self.outputs
    }

    /// Slots since the start.
    pub fn now(&self) -> u64 {
        self.now
    }

    /// How many words asked to set and to reset the same pin.
    pub fn clashes(&self) -> u32 {
        self.clashes
    }
}

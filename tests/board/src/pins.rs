//! The step drives at the pins of port D: every slot they are looked at, instant by instant.
//!
//! The wiring is told here once more, so that a firmware that uses other pins moves nothing.

use crate::mounting::{ENABLES, is_high};
use rigless::machine::stm32h743_bench::Stm32h743Bench;
use rigless::time::VirtualNanos;
use shared::steps::receiver::{Least, Receiver};

/// Number of port D among the ports.
const PORT_D: usize = 3;

/// Step and direction of x, y and z.
const PINS: [[u8; 2]; 3] = [[3, 4], [5, 6], [7, 0]];

/// Slots in a tick.
pub const SLOTS: u64 = 1_875;

/// A step as a drive saw it: the axis, the slot since the clock of the slots was started, and whether forward.
pub type Step = (usize, u64, bool);

/// Three drives, looked at in the middle of every slot.
#[derive(Clone, Debug, Default)]
pub struct Pins {
    /// When the slots' timer was started, in ns.
    started: Option<u64>,
    slot: u64,
    drives: [Receiver; 3],
    /// Every step.
    pub steps: Vec<Step>,
    /// Every look at which the enable output of x was another than at the one before: the slot and the level.
    pub enabled: Vec<(u64, bool)>,
}

impl Pins {
    /// The slots begin now; the first word is played half a slot later. Returns the first instant to look.
    pub fn start(&mut self, now: VirtualNanos) -> VirtualNanos {
        (self.started, self.slot) = (Some(now.0), 0);
        self.next()
    }

    /// When to look next: words are played at the halves of slots, so at the whole ones nothing changes.
    fn next(&self) -> VirtualNanos {
        // A slot is 10^9/(1024 * 1875) ns = 15625/30 ns.
        VirtualNanos(self.started.unwrap_or(0) + (self.slot + 1) * 15_625 / 30)
    }

    /// Looks at all pins, if it is time to. Returns the next instant to look.
    pub fn look(&mut self, board: &mut Stm32h743Bench, now: VirtualNanos) -> Option<VirtualNanos> {
        self.started?;
        if now < self.next() {
            return Some(self.next());
        }
        let mut is_high = |port: usize, bit: u8| is_high(board, now, (port, bit));
        for (axis, (drive, [step, direction])) in self.drives.iter_mut().zip(PINS).enumerate() {
            if let Some(forward) = drive.see(self.slot, is_high(PORT_D, step), is_high(PORT_D, direction)) {
                self.steps.push((axis, self.slot, forward));
            }
        }
        let enabled = is_high(ENABLES[0].0, ENABLES[0].1);
        if self.enabled.last().is_none_or(|(_, before)| *before != enabled) {
            self.enabled.push((self.slot, enabled));
        }
        self.slot += 1;
        Some(self.next())
    }

    /// The least times at the inputs of a drive, in slots.
    pub fn least(&self, axis: usize) -> Least {
        self.drives[axis].least()
    }
}

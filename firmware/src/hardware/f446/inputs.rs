//! The levels at the inputs: two ports, read once a tick.

use shared::safety::Levels;
use stm32f4xx_hal::pac;

use super::pins::{DRIVE_FAULTS, HIGH_LIMITS, HOMES, LOW_LIMITS, STOP};

/// Ports B and C, as far as they are inputs.
pub struct InputPins(());

impl InputPins {
    /// The pins are inputs by then.
    pub(super) fn new() -> Self {
        Self(())
    }

    /// What the pins are at; polarity is the machine's.
    #[inline(always)]
    pub fn read(&self) -> Levels {
        // SAFETY: reading a port's input register has no effect, RM0390 rev 6 section 7.4.5. It shows a pin of a timer too.
        let (b, c) = unsafe { ((*pac::GPIOB::ptr()).idr().read().bits(), (*pac::GPIOC::ptr()).idr().read().bits()) };
        let three = |port: u32, from: u32| (port >> from & 7) as u8;
        let [x, y, z] = DRIVE_FAULTS.map(|bit| (b >> bit & 1) as u8);
        Levels {
            estop: b >> STOP & 1 != 0,
            low: three(b, LOW_LIMITS),
            high: three(b, HIGH_LIMITS),
            home: three(c, HOMES),
            drive_fault: x | y << 1 | z << 2,
        }
    }
}

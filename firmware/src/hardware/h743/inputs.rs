//! The levels at the inputs: two ports, read once a tick.

use shared::safety::Levels;
use stm32h7xx_hal::pac;

use super::pins::{DRIVE_FAULTS, HIGH_LIMITS, HOMES, LOW_LIMITS, STOP};

/// Ports E and F, as far as they are inputs.
pub struct InputPins(());

impl InputPins {
    /// The pins are inputs by then.
    pub(super) fn new() -> Self {
        Self(())
    }

    /// What the pins are at; polarity is the machine's.
    #[inline(always)]
    pub fn read(&self) -> Levels {
        // SAFETY: reading a port's input register has no effect, RM0433 rev 9 section 11.4.5.
        let (e, f) = unsafe { ((*pac::GPIOE::ptr()).idr.read().bits(), (*pac::GPIOF::ptr()).idr.read().bits()) };
        let three = |from: u32| (f >> from & 7) as u8;
        let [x, y, z] = DRIVE_FAULTS.map(|bit| (e >> bit & 1) as u8);
        Levels {
            estop: e >> STOP & 1 != 0,
            low: three(LOW_LIMITS),
            high: three(HIGH_LIMITS),
            home: three(HOMES),
            drive_fault: x | y << 1 | z << 2,
        }
    }
}

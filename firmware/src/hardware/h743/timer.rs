//! The timer of the tick.

use stm32h7xx_hal::pac;
use stm32h7xx_hal::rcc::{ResetEnable, rec};

/// The timers' clock, in Hz: twice the APB clock of 96 MHz, RM0433 rev 9 section 8.5.
pub const TIMER_HZ: u32 = 192_000_000;

/// The timers' clocks in a tick.
pub const PERIOD: u32 = TIMER_HZ / 1024;

// 2^-10 s has to be a whole number of clocks, or the paper's times would drift.
const _: () = assert!(PERIOD * 1024 == TIMER_HZ && 1.0 / 1024.0 == shared::TICK);

/// TIM2, whose update is the tick.
pub struct TickTimer {
    timer: pac::TIM2,
}

impl TickTimer {
    /// Starts the ticks.
    pub(super) fn new(timer: pac::TIM2, rec: rec::Tim2) -> Self {
        let _ = rec.enable().reset();
        timer.arr.write(|w| w.arr().bits(PERIOD - 1));
        timer.dier.write(|w| w.uie().set_bit());
        timer.cr1.write(|w| w.cen().set_bit());
        Self { timer }
    }

    /// Takes the interrupt back.
    #[inline(always)]
    pub fn acknowledge(&mut self) {
        // SAFETY: the flags are cleared by zeros, and ones change nothing, RM0433 rev 9 section 40.4.5: no flag but the update is lost.
        self.timer.sr.write(|w| unsafe { w.bits(!1) });
    }
}

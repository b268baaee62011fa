//! The timer of the tick.

use stm32f4xx_hal::pac;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

/// The clock of the timers on APB1, in Hz: twice the bus's 40 MHz, RM0390 rev 6 section 6.2.
pub const TIMER_HZ: u32 = 80_000_000;

/// The timer's clocks in a tick.
const PERIOD: u32 = TIMER_HZ / 1024;

// 2^-10 s has to be a whole number of clocks, or the paper's times would drift.
const _: () = assert!(PERIOD * 1024 == TIMER_HZ && 1.0 / 1024.0 == shared::TICK);

/// TIM2, whose update is the tick.
pub struct TickTimer {
    timer: pac::TIM2,
}

impl TickTimer {
    /// Starts the ticks.
    pub(super) fn new(timer: pac::TIM2, rcc: &mut Rcc) -> Self {
        pac::TIM2::enable(rcc);
        pac::TIM2::reset(rcc);
        // SAFETY: TIM2 has 32 bits, and any number of clocks is a period, RM0390 rev 6 section 17.4.12.
        timer.arr().write(|w| unsafe { w.bits(PERIOD - 1) });
        timer.dier().write(|w| w.uie().set_bit());
        timer.cr1().write(|w| w.cen().set_bit());
        Self { timer }
    }

    /// Takes the interrupt back.
    #[inline(always)]
    pub fn acknowledge(&mut self) {
        // SAFETY: the flags are cleared by zeros, and ones change nothing, RM0390 rev 6 section 17.4.5: no flag but the update is lost.
        self.timer.sr().write(|w| unsafe { w.bits(!1) });
    }
}

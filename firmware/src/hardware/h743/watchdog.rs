//! The independent watchdog: resets the controller where the tick does not come any more, and with it every output.
//!
//! It runs from an oscillator of its own, so it also sees a clock that has stopped. A reset leaves all pins floating, which a drive's
//! enable input has to read as off.

use stm32h7xx_hal::pac;

/// Counts of the oscillator's 32 kHz over 4: 4 ms, four ticks.
const RELOAD: u16 = 31;

/// IWDG1.
pub struct Watchdog(pac::IWDG);

impl Watchdog {
    /// Starts it, for good.
    pub(super) fn start(watchdog: pac::IWDG) -> Self {
        // SAFETY: the keys and values of RM0433 rev 9 section 46.4: start, unlock, prescaler 4, reload.
        unsafe {
            watchdog.kr.write(|w| w.bits(0xcccc));
            watchdog.kr.write(|w| w.bits(0x5555));
            watchdog.pr.write(|w| w.bits(0));
            watchdog.rlr.write(|w| w.bits(RELOAD.into()));
        }
        let mut watchdog = Self(watchdog);
        watchdog.feed();
        watchdog
    }

    /// Another 4 ms.
    #[inline(always)]
    pub fn feed(&mut self) {
        // SAFETY: the key of RM0433 rev 9 section 46.4.1 that reloads the counter.
        self.0.kr.write(|w| unsafe { w.bits(0xaaaa) });
    }
}

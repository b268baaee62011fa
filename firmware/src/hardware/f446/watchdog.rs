//! The independent watchdog: resets the controller where the tick does not come any more, and with it every output.
//!
//! It runs from an oscillator of its own, so it also sees a clock that has stopped. A reset leaves all pins floating, which a drive's
//! enable input has to read as off.

use stm32f4xx_hal::pac;

/// Counts of the oscillator's 32 kHz over 4: 4 ms, four ticks. The oscillator may run at 17 to 47 kHz (DS10693 rev 10 section 6.3.9):
/// it takes 2.7 ms at least and 7.5 ms at most.
const RELOAD: u16 = 31;

/// IWDG.
pub struct Watchdog(pac::IWDG);

impl Watchdog {
    /// Starts it, for good.
    pub(super) fn start(watchdog: pac::IWDG) -> Self {
        // SAFETY: the keys and values of RM0390 rev 6 section 20.4: start, unlock, prescaler 4, reload.
        unsafe {
            watchdog.kr().write(|w| w.bits(0xcccc));
            watchdog.kr().write(|w| w.bits(0x5555));
            watchdog.pr().write(|w| w.bits(0));
            watchdog.rlr().write(|w| w.bits(RELOAD));
        }
        let mut watchdog = Self(watchdog);
        watchdog.feed();
        watchdog
    }

    /// Another 4 ms.
    #[inline(always)]
    pub fn feed(&mut self) {
        // SAFETY: the key of RM0390 rev 6 section 20.4.1 that reloads the counter.
        self.0.kr().write(|w| unsafe { w.bits(0xaaaa) });
    }
}

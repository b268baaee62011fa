//! The flash, where the machine is kept. It has one bank: the core stands still while it is written, so that is done before the ticks
//! start.
//!
//! An erasure leaves the cache of the flash's data as it was, and the HAL does not look after that, RM0390 rev 6 section 3.5: the cache
//! is off until [`Flash::close`] empties it.

use stm32f4xx_hal::flash::{FlashExt, LockedFlash, UnlockedFlash};
use stm32f4xx_hal::pac;

/// Every error flag, RM0390 rev 6 section 3.8.4.
const ERRORS: u32 = 0x1f2;

/// See the module.
pub struct Flash(LockedFlash);

impl Flash {
    /// The clocks are set by then, and with them the caches.
    pub(super) fn new(flash: pac::FLASH) -> Self {
        flash.acr().modify(|_, w| w.dcen().clear_bit());
        // A flag that a debugger has left would look like an error of the first write.
        // SAFETY: ones clear the flags.
        flash.sr().write(|w| unsafe { w.bits(ERRORS) });
        Self(LockedFlash::new(flash))
    }

    /// The flash to be erased and written, until the result is dropped.
    pub fn unlocked(&mut self) -> UnlockedFlash<'_> {
        self.0.unlocked()
    }

    /// Nothing is written from here on.
    pub(super) fn close(self) {
        // SAFETY: the only owner of the registers is `self`.
        let acr = unsafe { &*pac::FLASH::ptr() }.acr();
        acr.modify(|_, w| w.dcrst().set_bit());
        acr.modify(|_, w| w.dcrst().clear_bit());
        acr.modify(|_, w| w.dcen().set_bit());
    }
}

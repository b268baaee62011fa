//! Why the processor started.

use shared::safety::ResetCause;
use stm32f4xx_hal::pac;

/// What the reset flags say, which are cleared; RM0390 rev 6 section 6.3.21.
pub fn reset_cause(rcc: &pac::RCC) -> ResetCause {
    let flags = rcc.csr().read();
    rcc.csr().modify(|_, w| w.rmvf().set_bit());
    if flags.wdgrstf().bit_is_set() || flags.wwdgrstf().bit_is_set() {
        ResetCause::Watchdog
    } else if flags.borrstf().bit_is_set() && flags.porrstf().bit_is_clear() {
        // Power that comes sets both.
        ResetCause::BrownOut
    } else {
        ResetCause::Ordinary
    }
}

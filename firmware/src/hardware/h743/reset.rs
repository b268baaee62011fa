//! Why the processor started.

use shared::safety::ResetCause;
use stm32h7xx_hal::pac;

/// What the reset flags say, which are cleared; RM0433 rev 9 section 8.7.39.
pub fn reset_cause(rcc: &pac::RCC) -> ResetCause {
    let flags = rcc.rsr.read();
    rcc.rsr.modify(|_, w| w.rmvf().set_bit());
    if flags.iwdg1rstf().bit_is_set() || flags.wwdg1rstf().bit_is_set() {
        ResetCause::Watchdog
    } else if flags.borrstf().bit_is_set() && flags.porrstf().bit_is_clear() {
        // Power that comes sets both.
        ResetCause::BrownOut
    } else {
        ResetCause::Ordinary
    }
}

//! The drives' enable output.

use stm32h7xx_hal::pac;

use crate::mailbox::MAILBOX;

/// Bit number of the output on port E.
const ENABLE: u32 = 2;

/// Switches the drives on, unless the machine is stopped. The pin is an output by then.
pub fn enable() {
    // A stop between the question and the store would be undone by it.
    cortex_m::interrupt::free(|_| {
        if !MAILBOX.is_stopped() {
            // SAFETY: port E's set/reset register is written in single stores that change this one pin only.
            unsafe { (*pac::GPIOE::ptr()).bsrr.write(|w| w.bits(1 << ENABLE)) };
        }
    });
}

/// Makes the outputs safe, from wherever: the drives off and, with step axes, no pulse any more. A store each, to registers that
/// nobody reads and modifies.
#[inline(always)]
pub fn off() {
    // SAFETY: as in `enable`.
    unsafe { (*pac::GPIOE::ptr()).bsrr.write(|w| w.bits(1 << (ENABLE + 16))) };
    #[cfg(feature = "steps")]
    super::StepRing::off();
}

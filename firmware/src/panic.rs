//! What is left to do when the program finds itself wrong: outputs safe, and a restart that knows why. No message is formatted, so no
//! formatting code is linked; the tick has no way here at all (`cargo xtask budget` follows every call from it).

use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, exception};

use crate::hardware::off;
use crate::restart;

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    off();
    restart::as_failed()
}

/// An instruction or an address that the processor cannot use.
#[exception]
unsafe fn HardFault(_: &ExceptionFrame) -> ! {
    off();
    restart::as_failed()
}

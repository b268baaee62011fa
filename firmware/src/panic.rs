//! What is left to do when the program finds itself wrong: outputs safe, and rest. No message is formatted, so no formatting code is
//! linked; the tick has no way here at all (`cargo xtask budget` follows every call from it).

use core::panic::PanicInfo;

use crate::hardware::off;

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    cortex_m::interrupt::disable();
    off();
    loop {
        cortex_m::asm::bkpt();
    }
}

//! How deep the stack has been: it is painted before `main`, and what is no longer painted has been used.

use core::ops::Range;

unsafe extern "C" {
    static mut _stack_start: u32;
    static mut _stack_end: u32;
}

/// What cortex-m-rt paints the stack with (its feature `paint-stack`).
const PAINT: u32 = cortex_m_rt::STACK_PAINT_VALUE;

/// The most stack in use since the start, in bytes. It reads the whole unused stack: for a reporter, not for the tick.
pub fn high_water() -> u32 {
    let Range { start, end } = &raw const _stack_end..&raw const _stack_start;
    let mut word = start;
    // SAFETY: both symbols come from the linker script and bound the stack, whose words stay readable all along; volatile, because
    // interrupts write there.
    while word < end && unsafe { word.read_volatile() } == PAINT {
        word = word.wrapping_add(1);
    }
    (end as u32).saturating_sub(word as u32)
}

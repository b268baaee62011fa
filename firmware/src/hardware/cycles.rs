//! The core's cycle counter.

use cortex_m::peripheral::{DCB, DWT};

/// A measurement in progress.
#[derive(Clone, Copy, Debug)]
pub struct Cycles(u32);

impl Cycles {
    /// Switches the counter on. Once, at the start.
    pub fn enable(dcb: &mut DCB, dwt: &mut DWT) {
        dcb.enable_trace();
        // A Cortex-M7 keeps its DWT locked until it is told the word.
        DWT::unlock();
        dwt.enable_cycle_counter();
    }

    /// Begins to measure.
    #[inline(always)]
    pub fn start() -> Self {
        Self(DWT::cycle_count())
    }

    /// Cycles since the beginning.
    #[inline(always)]
    pub fn elapsed(self) -> u32 {
        DWT::cycle_count().wrapping_sub(self.0)
    }
}

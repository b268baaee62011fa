//! Incremental encoders on two timers, four counts a line.

use stm32h7xx_hal::pac;
use stm32h7xx_hal::rcc::{ResetEnable, rec};

use crate::axes::AXES;

/// Both encoders. The timers count 16 bits; what they do between two ticks is added up here, so an axis may turn by up to 32 767
/// counts in a tick.
pub struct Encoders {
    x: pac::TIM3,
    y: pac::TIM4,
    counts: [i32; AXES],
    before: [u16; AXES],
}

impl Encoders {
    /// Counts from here. The pins are inputs of their timers by then.
    pub fn new(x: pac::TIM3, x_rec: rec::Tim3, y: pac::TIM4, y_rec: rec::Tim4) -> Self {
        let _ = x_rec.enable().reset();
        let _ = y_rec.enable().reset();
        // Both timers have the same registers, though not the same type.
        macro_rules! count_edges {
            ($timer:ident) => {
                // SAFETY: the values are those of RM0433 rev 9 section 40.3.15: both inputs on their own pins, filtered over eight
                // samples, every edge counted, all of 16 bits.
                unsafe {
                    $timer.ccmr1_input().write(|w| w.cc1s().bits(1).cc2s().bits(1).ic1f().bits(3).ic2f().bits(3));
                    $timer.smcr.write(|w| w.sms().bits(3));
                    $timer.arr.write(|w| w.bits(0xffff));
                }
                $timer.cr1.write(|w| w.cen().set_bit());
            };
        }
        count_edges!(x);
        count_edges!(y);
        Self { x, y, counts: [0; AXES], before: [0; AXES] }
    }

    /// The counts of x and y since the start.
    #[inline(always)]
    pub fn read(&mut self) -> [i32; AXES] {
        let now = [self.x.cnt.read().bits() as u16, self.y.cnt.read().bits() as u16];
        for ((count, before), now) in self.counts.iter_mut().zip(&mut self.before).zip(now) {
            *count = count.wrapping_add(i32::from(now.wrapping_sub(*before) as i16));
            *before = now;
        }
        self.counts
    }
}

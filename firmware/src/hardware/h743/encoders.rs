//! Incremental encoders on three timers, four counts a line.

use stm32h7xx_hal::pac;
use stm32h7xx_hal::rcc::{ResetEnable, rec};

use super::pins::AXES;

/// The encoders. The timers count 16 bits; what they do between two ticks is added up here, so an axis may turn by up to 32 767
/// counts in a tick.
pub struct Encoders {
    x: pac::TIM3,
    y: pac::TIM4,
    z: pac::TIM1,
    counts: [i32; AXES],
    before: [u16; AXES],
}

impl Encoders {
    /// Counts from here. The pins are inputs of their timers by then.
    pub(super) fn new(
        (x, x_rec): (pac::TIM3, rec::Tim3),
        (y, y_rec): (pac::TIM4, rec::Tim4),
        (z, z_rec): (pac::TIM1, rec::Tim1),
    ) -> Self {
        let _ = x_rec.enable().reset();
        let _ = y_rec.enable().reset();
        let _ = z_rec.enable().reset();
        // The timers have the same registers, though not the same type.
        macro_rules! count_edges {
            ($timer:ident) => {
                // SAFETY: the values are those of RM0433 rev 9 section 38.3.24: both inputs on their own pins, filtered over eight
                // samples, every edge counted, all of 16 bits.
                unsafe {
                    $timer.ccmr1_input().write(|w| w.bits(3 << 12 | 1 << 8 | 3 << 4 | 1));
                    $timer.smcr.write(|w| w.bits(3));
                    $timer.arr.write(|w| w.bits(0xffff));
                }
                $timer.cr1.write(|w| w.cen().set_bit());
            };
        }
        count_edges!(x);
        count_edges!(y);
        count_edges!(z);
        Self { x, y, z, counts: [0; AXES], before: [0; AXES] }
    }

    /// The counts of all axes since the start.
    #[inline(always)]
    pub fn read(&mut self) -> [i32; AXES] {
        let now =
            [self.x.cnt.read().bits(), self.y.cnt.read().bits(), self.z.cnt.read().bits()].map(|bits| bits as u16);
        for ((count, before), now) in self.counts.iter_mut().zip(&mut self.before).zip(now) {
            *count = count.wrapping_add(i32::from(now.wrapping_sub(*before) as i16));
            *before = now;
        }
        self.counts
    }
}

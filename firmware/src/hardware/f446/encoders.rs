//! Incremental encoders on three timers, four counts a line.

use stm32f4xx_hal::pac;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use super::pins::AXES;

/// The encoders. The timers count 16 bits, TIM5 too, which could do more; what they do between two ticks is added up here, so an axis
/// may turn by up to 32 767 counts in a tick.
pub struct Encoders {
    x: pac::TIM3,
    y: pac::TIM4,
    z: pac::TIM5,
    counts: [i32; AXES],
    before: [u16; AXES],
}

impl Encoders {
    /// Counts from here. The pins are inputs of their timers by then.
    pub(super) fn new(x: pac::TIM3, y: pac::TIM4, z: pac::TIM5, rcc: &mut Rcc) -> Self {
        // The timers have the same registers, though not the same type.
        macro_rules! count_edges {
            ($timer:ident: $type:ident) => {
                pac::$type::enable(rcc);
                pac::$type::reset(rcc);
                // SAFETY: the values are those of RM0390 rev 6 sections 17.3.12, 17.4.3 and 17.4.7: both inputs on their own pins,
                // filtered over eight samples of 12.5 ns, every edge counted, all of 16 bits.
                unsafe {
                    $timer.ccmr1_input().write(|w| w.bits(3 << 12 | 1 << 8 | 3 << 4 | 1));
                    $timer.smcr().write(|w| w.bits(3));
                    $timer.arr().write(|w| w.bits(0xffff));
                }
                $timer.cr1().write(|w| w.cen().set_bit());
            };
        }
        count_edges!(x: TIM3);
        count_edges!(y: TIM4);
        count_edges!(z: TIM5);
        Self { x, y, z, counts: [0; AXES], before: [0; AXES] }
    }

    /// The counts of all axes since the start.
    #[inline(always)]
    pub fn read(&mut self) -> [i32; AXES] {
        let now = [self.x.cnt().read().bits(), self.y.cnt().read().bits(), self.z.cnt().read().bits()];
        for ((count, before), now) in self.counts.iter_mut().zip(&mut self.before).zip(now.map(|bits| bits as u16)) {
            *count = count.wrapping_add(i32::from(now.wrapping_sub(*before) as i16));
            *before = now;
        }
        self.counts
    }
}

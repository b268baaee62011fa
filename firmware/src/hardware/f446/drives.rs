//! The drives' commands: analog for x and y, pulse width and direction for z.

use shared::real::Real;
use stm32f4xx_hal::pac;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

use super::pins::AXES;
use super::timer::TIMER_HZ;

/// The code for no voltage at the drive, whose amplifier takes half scale off.
const ZERO: i32 = 2048;
/// Codes for a full command.
const FULL: f32 = 2047.0;

/// The timer's clocks in a period of the pulse width: 20 kHz.
const PERIOD: u32 = TIMER_HZ / 20_000;

/// z's direction: a bit of port A, low in the positive direction.
const DIRECTION: u32 = 6;

/// The drives of all axes.
pub struct Drives {
    dac: pac::DAC,
    pwm: pac::TIM14,
}

impl Drives {
    /// Commands of zero. The pins are analog, the timer's, and an output by then.
    pub(super) fn new(dac: pac::DAC, pwm: pac::TIM14, rcc: &mut Rcc) -> Self {
        pac::DAC::enable(rcc);
        pac::DAC::reset(rcc);
        pac::TIM14::enable(rcc);
        pac::TIM14::reset(rcc);
        // SAFETY: RM0390 rev 6 section 18.5: high below the compare value, which is preloaded; the output on.
        unsafe {
            pwm.arr().write(|w| w.bits(PERIOD - 1));
            pwm.ccmr1_output().write(|w| w.bits(0b110 << 4 | 1 << 3));
            pwm.ccer().write(|w| w.bits(1));
        }
        pwm.cr1().write(|w| w.cen().set_bit());
        let mut drives = Self { dac, pwm };
        drives.write([0.0; AXES]);
        drives.dac.cr().modify(|_, w| w.en1().set_bit().en2().set_bit());
        drives
    }

    /// Commands as parts of the full range, -1..=1; x and y change with the same store.
    #[inline(always)]
    pub fn write(&mut self, [x, y, z]: [f32; AXES]) {
        let code = |level: f32| ZERO.wrapping_add((level * FULL).to_int()) as u32 & 0xfff;
        // SAFETY: both codes have 12 bits and stand where the register wants them, RM0390 rev 6 section 14.5.9.
        self.dac.dhr12rd().write(|w| unsafe { w.bits(code(x) | code(y) << 16) });
        let width = (z * PERIOD as f32).to_int();
        // SAFETY: any width is one; port A's set/reset register changes one pin.
        unsafe {
            self.pwm.ccr1().write(|w| w.bits(width.unsigned_abs().min(PERIOD)));
            let place = if width < 0 { DIRECTION } else { DIRECTION + 16 };
            (*pac::GPIOA::ptr()).bsrr().write(|w| w.bits(1 << place));
        }
    }
}

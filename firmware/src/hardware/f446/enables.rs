//! Power for the drives: outputs of a timer that does not count, because of its break input.
//!
//! TIM1 holds its three outputs at the level that gives power, and lets go of them when its break input, the emergency stop, acts: then
//! they are at the level that takes power, by hardware, whatever the program is about. They come back by [`Enables::set`] only.
//!
//! The break input of this part has no filter, RM0390 rev 6 section 16.3.12: a spike is a stop, so its wire wants one of resistor and
//! capacitor.

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use shared::machine::Machine;
use stm32f4xx_hal::pac;
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};

/// Break and dead-time register, RM0390 rev 6 section 16.4.18: the off levels are driven while the outputs are off, and a break acts.
const OFF: u32 = 1 << 12 | 1 << 10;
/// The break acts while high.
const BREAK_HIGH: u32 = 1 << 13;
/// The outputs are on.
const ON: u32 = 1 << 15;

/// What switches the outputs off, for whoever does so.
static OFF_WORD: AtomicU32 = AtomicU32::new(OFF | BREAK_HIGH);

/// See the module.
pub struct Enables {
    timer: pac::TIM1,
}

impl Enables {
    /// The outputs of a machine's drives, off. The pins are the timer's after that.
    pub(super) fn new(timer: pac::TIM1, machine: &Machine, rcc: &mut Rcc) -> Self {
        pac::TIM1::enable(rcc);
        pac::TIM1::reset(rcc);
        // All three channels are forced active, so an output is high unless its polarity turns it around; a channel's two bits in CCER
        // are four bits apart from the next one's, its off level in CR2 two bits, RM0390 rev 6 sections 16.4.9 and 16.4.2.
        let (mut enable, mut off_levels) = (0, 0);
        for axis in 0..3_u32 {
            let has = u32::from(machine.enables >> axis & 1);
            let low = u32::from(machine.enables_low >> axis & 1);
            enable |= (has | low << 1) << (4 * axis);
            off_levels |= low << (8 + 2 * axis);
        }
        let acts_low = machine.wiring.active_low.estop;
        let off = OFF | if acts_low { 0 } else { BREAK_HIGH };
        // SAFETY: the registers of RM0390 rev 6 section 16.4, every bit of which is accounted for above and here: all channels forced
        // active.
        unsafe {
            timer.ccmr1_output().write(|w| w.bits(0b101 << 4 | 0b101 << 12));
            timer.ccmr2_output().write(|w| w.bits(0b101 << 4));
            timer.cr2().write(|w| w.bits(off_levels));
            timer.ccer().write(|w| w.bits(enable));
            timer.bdtr().write(|w| w.bits(off));
        }
        OFF_WORD.store(off, Relaxed);
        let mut enables = Self { timer };
        // Connecting the input may have looked like a stop.
        let _ = enables.take_stop();
        enables
    }

    /// Gives or takes power. Without effect while the stop acts: the hardware does not let it.
    #[inline(always)]
    pub fn set(&mut self, on: bool) {
        let word = OFF_WORD.load(Relaxed) | if on { ON } else { 0 };
        // SAFETY: a value that `new` has made, and the switch.
        self.timer.bdtr().write(|w| unsafe { w.bits(word) });
    }

    /// Whether the stop has acted since the last call, or acts now.
    #[inline(always)]
    pub fn take_stop(&mut self) -> bool {
        const BREAK: u32 = 1 << 7;
        let acted = self.timer.sr().read().bits() & BREAK != 0;
        // SAFETY: a zero clears the flag, unless the input still acts; ones change nothing, RM0390 rev 6 section 16.4.5.
        self.timer.sr().write(|w| unsafe { w.bits(!BREAK) });
        acted
    }
}

/// Makes the outputs safe, from wherever: no power for the drives, no pulse any more. Two stores to registers that nobody modifies.
#[inline(always)]
pub fn off() {
    // SAFETY: as in `Enables::set`; a timer without a clock takes no notice.
    unsafe { (*pac::TIM1::ptr()).bdtr().write(|w| w.bits(OFF_WORD.load(Relaxed))) };
    super::StepRing::off();
}

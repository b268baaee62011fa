//! Power for the drives: outputs of a timer that does not count, because of its break input.
//!
//! TIM15 holds its three outputs at the level that gives power, and lets go of them when its break input, the emergency stop, acts:
//! then they are at the level that takes power, by hardware, whatever the program is about. They come back by [`Enables::set`] only.

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use shared::machine::Machine;
use stm32h7xx_hal::pac;
use stm32h7xx_hal::rcc::{ResetEnable, rec};

/// Break and dead-time register, RM0433 rev 9 section 41.5.18: the off levels are driven while the outputs are off, a break acts after
/// eight samples at the timer's clock, 42 ns.
const OFF: u32 = 3 << 16 | 1 << 12 | 1 << 10;
/// The break acts while high.
const BREAK_HIGH: u32 = 1 << 13;
/// The outputs are on.
const ON: u32 = 1 << 15;

/// What switches the outputs off, for whoever does so.
static OFF_WORD: AtomicU32 = AtomicU32::new(OFF | BREAK_HIGH);

/// See the module.
pub struct Enables {
    timer: pac::TIM15,
}

impl Enables {
    /// The outputs of a machine's drives, off. The pins are the timer's after that.
    pub(super) fn new(timer: pac::TIM15, rec: rec::Tim15, machine: &Machine) -> Self {
        let _ = rec.enable().reset();
        let has = |axis: u32| machine.enables >> axis & 1 != 0;
        let low = |axis: u32| machine.enables_low >> axis & 1 != 0;
        let bit = |is: bool, place: u32| u32::from(is) << place;
        // Both channels are forced active, so an output is high unless its polarity turns it around. z is on the complement of the first
        // channel: with the channel itself in use that is low unless turned, RM0433 rev 9 table 352.
        let [x, y, z] = [0, 1, 2];
        let z_turned = if has(x) { !low(z) } else { low(z) };
        let enable =
            bit(has(x), 0) | bit(low(x), 1) | bit(has(z), 2) | bit(z_turned, 3) | bit(has(y), 4) | bit(low(y), 5);
        let off_levels = bit(low(x), 8) | bit(low(z), 9) | bit(low(y), 10);
        let acts_low = machine.wiring.active_low.estop;
        let off = OFF | if acts_low { 0 } else { BREAK_HIGH };
        // SAFETY: the registers of RM0433 rev 9 section 41.5, every bit of which is accounted for above and here: both channels
        // forced active.
        unsafe {
            timer.ccmr1_output().write(|w| w.bits(0b101 << 4 | 0b101 << 12));
            timer.cr2.write(|w| w.bits(off_levels));
            timer.ccer.write(|w| w.bits(enable));
            timer.bdtr.write(|w| w.bits(off));
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
        self.timer.bdtr.write(|w| unsafe { w.bits(word) });
    }

    /// Whether the stop has acted since the last call, or acts now.
    #[inline(always)]
    pub fn take_stop(&mut self) -> bool {
        const BREAK: u32 = 1 << 7;
        let acted = self.timer.sr.read().bits() & BREAK != 0;
        // SAFETY: a zero clears the flag, unless the input still acts; ones change nothing, RM0433 rev 9 section 41.5.5.
        self.timer.sr.write(|w| unsafe { w.bits(!BREAK) });
        acted
    }
}

/// Makes the outputs safe, from wherever: no power for the drives, no pulse any more. Two stores to registers that nobody modifies.
#[inline(always)]
pub fn off() {
    // SAFETY: as in `Enables::set`; a timer without a clock takes no notice.
    unsafe { (*pac::TIM15::ptr()).bdtr.write(|w| w.bits(OFF_WORD.load(Relaxed))) };
    super::StepRing::off();
}

//! The drives' analog commands: both channels of the converter, written at once.

use shared::real::Real;
use stm32h7xx_hal::pac;
use stm32h7xx_hal::rcc::{ResetEnable, rec};

use crate::axes::{AXES, FULL_COMMAND};

/// The code for no voltage at the drive, whose amplifier takes half scale off.
const ZERO: i32 = 2048;

/// Codes per mm/s.
const SCALE: f32 = (2047.0 / FULL_COMMAND) as f32;

/// The drives of both axes.
pub struct Drives {
    dac: pac::DAC,
}

impl Drives {
    /// Switches the converters on at zero. The pins are analog by then.
    pub fn new(dac: pac::DAC, rec: rec::Dac12) -> Self {
        let _ = rec.enable().reset();
        let mut drives = Self { dac };
        drives.write([0.0; AXES]);
        drives.dac.cr.modify(|_, w| w.en1().set_bit().en2().set_bit());
        drives
    }

    /// Commands in mm/s, within +-[`FULL_COMMAND`] as the servos see to; x and y change with the same store.
    #[inline(always)]
    pub fn write(&mut self, [x, y]: [f32; AXES]) {
        let code = |command: f32| ZERO.wrapping_add((command * SCALE).to_int()) as u32 & 0xfff;
        // SAFETY: both codes have 12 bits and stand where the register wants them, RM0433 rev 9 section 26.7.11.
        self.dac.dhr12rd.write(|w| unsafe { w.bits(code(x) | code(y) << 16) });
    }
}

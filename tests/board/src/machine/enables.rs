//! The outputs that give the drives power, as they stand at the pins: TIM15's, which lets go of them by itself when its break acts.
//!
//! The part's models leave the way from a pin to its timer to the board, so the emergency stop's level is told to the timer here, and the
//! timer's outputs are read where the pins are its own.

use rigless::device::Level;
use rigless::emulator::{Access, AccessKind};
use rigless::machine::stm32h743_bench::Stm32h743Bench;
use rigless::mcu::Mcu;
use rigless::soc::stm32h743::peripherals::tim::{BreakInput, BreakSource, Channel, TIMER_15, Tim, Tim15};
use rigless::time::VirtualNanos;

use super::wiring::{ENABLE_FUNCTION, ENABLE_TIMER, ENABLES, ESTOP};

/// The timer's name.
const TIMER: &str = "TIM15";

/// After the emergency stop the outputs are looked at again, in ns: the break's filter takes eight samples at 192 MHz, the first of them
/// up to a clock later.
pub const FILTER: u64 = 50;

/// See the module.
pub struct Enables {
    /// The drives that take a low level for power.
    on_low: [bool; 3],
    /// The spare stands in the part while the timer itself is driven.
    spare: Tim<Tim15>,
    /// When to look.
    look: Option<u64>,
    /// Which drives have power.
    pub on: [bool; 3],
    /// Every change: when in ns, and which drives have power since.
    pub changes: Vec<(u64, [bool; 3])>,
}

impl Enables {
    /// Outputs to drives, of which these take a low level for power.
    pub fn new(on_low: [bool; 3]) -> Self {
        Self { on_low, spare: Tim::new(TIMER_15), look: None, on: [false; 3], changes: Vec::new() }
    }

    /// When the drives lost power for the last time, in ns, if they have none.
    pub fn off_since(&self) -> Option<u64> {
        let &(at, on) = self.changes.last()?;
        (on == [false; 3]).then_some(at)
    }

    /// Takes note of an access of the core.
    pub fn see(&mut self, board: &mut Stm32h743Bench, access: &Access) {
        if access.kind == AccessKind::Write && ENABLE_TIMER.contains(&access.address) {
            // A reset of the timer has made it forget the level at its input.
            self.stop_line(board, access.virtual_time);
            self.look_now(board, access.virtual_time);
        }
    }

    /// The emergency stop's contact has changed.
    pub fn stop_changed(&mut self, board: &mut Stm32h743Bench, now: VirtualNanos) {
        self.stop_line(board, now);
        self.look = Some(now.0 + FILTER);
    }

    /// When to look next.
    pub fn next(&self) -> Option<u64> {
        self.look
    }

    /// Looks, if it is time to.
    pub fn act(&mut self, board: &mut Stm32h743Bench, now: VirtualNanos) {
        if self.look.is_some_and(|at| at <= now.0) {
            self.look = None;
            // The same level again: the timer's time passes up to now.
            self.stop_line(board, now);
            self.look_now(board, now);
        }
    }

    fn stop_line(&mut self, board: &mut Stm32h743Bench, now: VirtualNanos) {
        if ESTOP.function(board, now) != Some(ENABLE_FUNCTION) {
            return;
        }
        let level = Level::from(ESTOP.is_high(board, now));
        let Some(slot) = board.mcu.bus().slot_of(TIMER) else { return };
        // Model and registers are both the part's, and only one of them can be borrowed from it.
        std::mem::swap(&mut board.mcu.tim15, &mut self.spare);
        let (registers, mut context) = board.mcu.bus_mut().drive(now, slot);
        self.spare.drive_break_source(BreakInput::First, BreakSource::Pin, level, registers, &mut context);
        std::mem::swap(&mut board.mcu.tim15, &mut self.spare);
    }

    fn look_now(&mut self, board: &mut Stm32h743Bench, now: VirtualNanos) {
        let [first, second] = [1, 2].map(Channel::new);
        let (Some(first), Some(second)) = (first, second) else { return };
        let Some(registers) = board.mcu.bus().registers(TIMER) else { return };
        let timer = &board.mcu.tim15;
        let outputs = [
            timer.output(first, registers),
            timer.output(second, registers),
            timer.complementary_output(first, registers),
        ];
        let mut on = [false; 3];
        for (((on, pad), output), on_low) in on.iter_mut().zip(ENABLES).zip(outputs).zip(self.on_low) {
            let is_driven = pad.function(board, now) == Some(ENABLE_FUNCTION);
            // An output that floats is off: the drive's own resistor sees to that.
            *on = is_driven && output == Some(Level::from(!on_low));
        }
        if on != self.on {
            self.on = on;
            self.changes.push((now.0, on));
        }
    }
}

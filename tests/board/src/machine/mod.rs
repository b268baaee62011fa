//! The machine at the board's pins: what the controller moves, and what it is told by.
//!
//! | module | what |
//! | --- | --- |
//! | [`wiring`] | which pin is what |
//! | [`step_drivers`] | step drivers, slot by slot |
//! | [`servo_axes`] | servo drives, motors, tables and encoders |
//! | [`switches`] | limit and home switches, the emergency stop, faults of drives, at exact instants |
//!
//! A part of the machine sees every access of the core once the chip has settled after it, says when it wants control next, and gets
//! it then between two instructions.

pub mod servo_axes;
pub mod step_drivers;
pub mod switches;
pub mod wiring;

use rigless::emulator::{Access, AccessKind};
use rigless::machine::stm32h743_bench::Stm32h743Bench;
use rigless::time::VirtualNanos;

use servo_axes::ServoAxes;
use step_drivers::StepDrivers;
use switches::Switches;
use wiring::{ENABLE, set_reset};

/// See the module. By default nothing but its switches is there.
#[derive(Default)]
pub struct Machine {
    /// Step drivers, where they are looked at; the run is slow then.
    pub step_drivers: Option<StepDrivers>,
    /// Servo axes, where there are any.
    pub servo_axes: Option<ServoAxes>,
    /// All contacts.
    pub switches: Switches,
    /// When the drives' enable output was last switched off by the program, in ns.
    pub disabled: Option<u64>,
}

impl Machine {
    /// Takes note of an access, with the value that was read or written.
    pub fn see(&mut self, access: &Access, value: u64) {
        if let Some(drivers) = &mut self.step_drivers {
            drivers.see(access);
        }
        if let Some(axes) = &mut self.servo_axes {
            axes.see(access, value);
        }
        let disables = access.value == 1 << (ENABLE.bit + 16);
        if disables && access.kind == AccessKind::Write && access.address == set_reset(ENABLE) {
            self.disabled = Some(access.virtual_time.0);
        }
    }

    /// The next instant at which it wants control, in ns.
    pub fn next(&self) -> Option<u64> {
        let drivers = self.step_drivers.as_ref().and_then(StepDrivers::next);
        let axes = self.servo_axes.as_ref().and_then(ServoAxes::next);
        [drivers, axes, self.switches.next()].into_iter().flatten().min()
    }

    /// Does what is due.
    pub fn act(&mut self, board: &mut Stm32h743Bench, now: VirtualNanos) {
        self.switches.act(board, now);
        if let Some(axes) = &mut self.servo_axes {
            axes.act(board, now);
        }
        if let Some(drivers) = &mut self.step_drivers {
            drivers.act(board, now);
        }
    }
}

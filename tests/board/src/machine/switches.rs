//! Contacts at the inputs, and what happens to them at exact instants.

use std::collections::BTreeMap;

use rigless::device::Level;
use rigless::machine::stm32h743_bench::Stm32h743Bench;
use rigless::soc::stm32h743::peripherals::gpio::Pin;
use rigless::time::VirtualNanos;

use super::wiring::Fault;

/// All contacts of the machine.
#[derive(Clone, Debug, Default)]
pub struct Switches {
    /// What is still to happen, by the instant in ns.
    waiting: BTreeMap<u64, Vec<(Fault, bool)>>,
    /// What has happened: when in ns, what, and whether it began or ended.
    pub happened: Vec<(u64, Fault, bool)>,
}

impl Switches {
    /// Everything in peace, before the controller starts.
    pub fn rest(board: &mut Stm32h743Bench) {
        for fault in Fault::all() {
            set(board, VirtualNanos(0), fault, false);
        }
    }

    /// `fault` begins at the instant `at`, in ns since power-up.
    pub fn inject(&mut self, at: u64, fault: Fault) {
        self.waiting.entry(at).or_default().push((fault, true));
    }

    /// `fault` ends at the instant `at`, in ns since power-up.
    pub fn release(&mut self, at: u64, fault: Fault) {
        self.waiting.entry(at).or_default().push((fault, false));
    }

    /// The next instant at which something happens.
    pub fn next(&self) -> Option<u64> {
        self.waiting.first_key_value().map(|(&at, _)| at)
    }

    /// Lets happen what is due.
    pub fn act(&mut self, board: &mut Stm32h743Bench, now: VirtualNanos) {
        while let Some(due) = self.waiting.first_entry()
            && *due.key() <= now.0
        {
            for (fault, begins) in due.remove() {
                set(board, now, fault, begins);
                self.happened.push((now.0, fault, begins));
            }
        }
    }
}

fn set(board: &mut Stm32h743Bench, now: VirtualNanos, fault: Fault, active: bool) {
    let Some(pad) = fault.pad() else { return };
    board.mcu.drive_port(now, pad.port, |gpio, registers, context| {
        if let Some(pin) = Pin::new(pad.bit) {
            gpio.drive(pin, Some(Level::from(active)), registers, context);
        }
    });
}

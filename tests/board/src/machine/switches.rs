//! Contacts at the inputs, and what happens to them at exact instants.

use std::collections::BTreeMap;

use rigless::machine::stm32h743_bench::Stm32h743Bench;
use rigless::time::VirtualNanos;
use shared::safety::Levels;

use super::wiring::{ENCODERS, Fault, IDLE_ENCODER};

/// All contacts of the machine. A contact that rests pulls its input low; one that the machine takes to act while low rests high.
#[derive(Clone, Debug, Default)]
pub struct Switches {
    /// The levels of contacts that rest.
    rest: Levels,
    /// What is still to happen, by the instant in ns.
    waiting: BTreeMap<u64, Vec<(Fault, bool)>>,
    /// What has happened: when in ns, what, and whether it began or ended.
    pub happened: Vec<(u64, Fault, bool)>,
}

impl Switches {
    /// Contacts of a machine whose inputs act while low where these are set.
    pub fn new(active_low: Levels) -> Self {
        Self { rest: active_low, ..Self::default() }
    }

    /// Everything in peace, before the controller starts; the encoders' lines are low then.
    pub fn power_up(&self, board: &mut Stm32h743Bench) {
        let now = VirtualNanos(0);
        for fault in Fault::contacts() {
            self.set(board, now, fault, false);
        }
        for pad in ENCODERS.iter().flat_map(|encoder| encoder.pads).chain(IDLE_ENCODER) {
            pad.drive(board, now, false);
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

    /// Lets happen what is due, and returns it.
    pub fn act(&mut self, board: &mut Stm32h743Bench, now: VirtualNanos) -> Vec<(Fault, bool)> {
        let mut all = Vec::new();
        while let Some(due) = self.waiting.first_entry()
            && *due.key() <= now.0
        {
            for (fault, begins) in due.remove() {
                self.set(board, now, fault, begins);
                self.happened.push((now.0, fault, begins));
                all.push((fault, begins));
            }
        }
        all
    }

    fn set(&self, board: &mut Stm32h743Bench, now: VirtualNanos, fault: Fault, active: bool) {
        if let Some(pad) = fault.pad() {
            pad.drive(board, now, active != self.rests_high(fault));
        }
    }

    fn rests_high(&self, fault: Fault) -> bool {
        let rest = &self.rest;
        match fault {
            Fault::EmergencyStop => rest.estop,
            Fault::LowLimit(axis) => rest.low >> axis & 1 != 0,
            Fault::HighLimit(axis) => rest.high >> axis & 1 != 0,
            Fault::Home(axis) => rest.home >> axis & 1 != 0,
            Fault::Drive(axis) => rest.drive_fault >> axis & 1 != 0,
            // The board's button closes to the supply.
            Fault::Button | Fault::Blocked(_) => false,
        }
    }
}

//! Limit switches at places of step axes: they act where the pulses at the pins have led, whatever the controller takes its place to be.

use rigless::time::VirtualNanos;

use super::step_drivers::StepDrivers;
use super::switches::Switches;
use super::wiring::Fault;

/// A switch: it acts below a place, or above one, in steps from where the axis stood at power-up.
#[derive(Clone, Copy, Debug)]
struct End {
    axis: usize,
    at: i64,
    is_low: bool,
    acts: bool,
}

/// See the module.
#[derive(Clone, Debug, Default)]
pub struct Ends {
    all: Vec<End>,
}

impl Ends {
    /// The switch at the low end of `axis` acts at `at` steps and below.
    pub fn low(&mut self, axis: usize, at: i64) {
        self.all.push(End { axis, at, is_low: true, acts: false });
    }

    /// The switch at the high end of `axis` acts at `at` steps and above.
    pub fn high(&mut self, axis: usize, at: i64) {
        self.all.push(End { axis, at, is_low: false, acts: false });
    }

    /// Moves the contacts whose axes have reached or left them.
    pub fn watch(&mut self, drivers: &StepDrivers, now: VirtualNanos, switches: &mut Switches) {
        for end in &mut self.all {
            let Some(driver) = drivers.drivers.get(end.axis) else { continue };
            let place = driver.position();
            let acts = if end.is_low { place <= end.at } else { place >= end.at };
            if acts == end.acts {
                continue;
            }
            end.acts = acts;
            let fault = if end.is_low { Fault::LowLimit(end.axis) } else { Fault::HighLimit(end.axis) };
            // The contact itself moves at the next instant.
            if acts {
                switches.inject(now.0 + 1, fault);
            } else {
                switches.release(now.0 + 1, fault);
            }
        }
    }
}

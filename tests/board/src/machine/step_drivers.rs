//! Step drivers at their pins: every slot they are looked at, instant by instant, and held against their data sheet.
//!
//! Behind each may stand a motor of [`host_sim::plant`]: pulse by pulse, at the instant of its slot, its field goes on by a microstep.
//! What the pulses ask for and where the table is are two things then.

use host_sim::plant::Plant;
use host_sim::plant::axis::{Axis, Command, Reading};
use rigless::emulator::{Access, AccessKind};
use rigless::machine::stm32h743_bench::Stm32h743Bench;
use rigless::time::VirtualNanos;
use shared::steps::receiver::{Least, Receiver};

use super::wiring::{SLOT_TIMER, STEPS};
use crate::Error;

/// Slots in a tick.
pub const SLOTS: u64 = 1_875;

/// A step as a driver saw it: the axis, the slot since the clock of the slots was started, and whether forward.
pub type Step = (usize, u64, bool);

/// What the drivers' data sheet asks for at least, in slots; `examples/mill-steps.toml` is told the same.
pub const ASKED: Least = Least { pulse: 1, gap: 1, setup: 10, hold: 10 };

/// One driver.
#[derive(Clone, Copy, Debug, Default)]
pub struct StepDriver {
    receiver: Receiver,
    /// Both inputs as they were seen last.
    levels: [bool; 2],
    /// Edges of the step input and of the direction input, both ways.
    pub edges: [u64; 2],
}

impl StepDriver {
    fn see(&mut self, slot: u64, levels: [bool; 2]) -> Option<bool> {
        for (edges, (before, now)) in self.edges.iter_mut().zip(self.levels.into_iter().zip(levels)) {
            *edges += u64::from(before != now);
        }
        self.levels = levels;
        let [step, direction] = levels;
        self.receiver.see(slot, step, direction)
    }

    /// Where the steps have led.
    pub fn position(&self) -> i64 {
        self.receiver.position()
    }

    /// The least times at its inputs, in slots.
    pub fn least(&self) -> Least {
        self.receiver.least()
    }

    /// What it was not given the time for, of [`ASKED`]; nothing where all is well.
    pub fn violations(&self) -> Vec<String> {
        let (seen, asked) = (self.least(), ASKED);
        let times = [
            ("pulse", seen.pulse, asked.pulse),
            ("gap", seen.gap, asked.gap),
            ("setup", seen.setup, asked.setup),
            ("hold", seen.hold, asked.hold),
        ];
        let short = times.into_iter().filter(|(_, seen, asked)| seen < asked);
        short.map(|(name, seen, asked)| format!("{name} of {seen} slots, {asked} asked for")).collect()
    }
}

/// Stepping motors for `examples/mill-steps.toml`.
pub const ROUTER: &str = include_str!("router-plant.toml");

/// The length of a slot in s.
const SLOT: f64 = 1.0 / (1_024.0 * SLOTS as f64);

/// What a driver turns.
struct Motor {
    axis: Box<dyn Axis + Send>,
    /// Up to which slot its time has passed.
    slot: u64,
    reading: Reading,
}

impl Motor {
    fn pass(&mut self, slot: u64, steps: i32) {
        self.axis.advance(Command::Steps(0), (slot - self.slot) as f64 * SLOT);
        self.reading = self.axis.advance(Command::Steps(steps), 0.0);
        self.slot = slot;
    }
}

/// Three drivers, looked at in the middle of every slot.
#[derive(Default)]
pub struct StepDrivers {
    /// When the slots' timer was started, in ns.
    started: Option<u64>,
    slot: u64,
    /// Each driver.
    pub drivers: [StepDriver; 3],
    /// Every step.
    pub steps: Vec<Step>,
    /// Every look at which x had power and had not at the one before, or the other way round: the slot, and whether.
    pub enabled: Vec<(u64, bool)>,
    /// Motors of x, y and z; fewer, or none, where nobody asks where they are.
    motors: Vec<Motor>,
}

impl StepDrivers {
    /// Drivers with the motors of a machine in TOML, at rest at 0.
    pub fn with_motors(plant: &str) -> Result<Self, Error> {
        let plant = Plant::from_toml(plant, f64::from(shared::TICK)).map_err(|error| Error::new(error.to_string()))?;
        let motor = |mut axis: Box<dyn Axis + Send>| {
            let reading = axis.rest_at(0.0);
            Motor { axis, slot: 0, reading }
        };
        Ok(Self { motors: plant.axes().iter().map(|driven| motor(driven.detached())).collect(), ..Self::default() })
    }

    /// Where a motor's table stands now, and how many full steps the motor has fallen away.
    pub fn reading(&mut self, axis: usize) -> Option<Reading> {
        let motor = self.motors.get_mut(axis)?;
        motor.pass(self.slot.max(motor.slot), 0);
        Some(motor.reading)
    }

    /// Takes note of an access of the core: where it starts the slots' timer, the slots begin now. The first word is played half a
    /// slot later.
    pub fn see(&mut self, access: &Access) {
        if access.kind == AccessKind::Write && access.address == SLOT_TIMER && access.value & 1 != 0 {
            (self.started, self.slot) = (Some(access.virtual_time.0), 0);
            for motor in &mut self.motors {
                motor.slot = 0;
            }
        }
    }

    /// When to look next: words are played at the halves of slots, so at the whole ones nothing changes.
    pub fn next(&self) -> Option<u64> {
        // A slot is 10^9/(1024 * 1875) ns = 15625/30 ns.
        self.started.map(|started| started + (self.slot + 1) * 15_625 / 30)
    }

    /// Looks at all pins, if it is time to; the drives of `on` have power.
    pub fn act(&mut self, board: &mut Stm32h743Bench, now: VirtualNanos, on: [bool; 3]) {
        if self.next().is_none_or(|next| now.0 < next) {
            return;
        }
        for (axis, (driver, pads)) in self.drivers.iter_mut().zip(STEPS).enumerate() {
            if let Some(forward) = driver.see(self.slot, pads.map(|pad| pad.is_high(board, now))) {
                self.steps.push((axis, self.slot, forward));
                if let Some(motor) = self.motors.get_mut(axis) {
                    motor.pass(self.slot, if forward { 1 } else { -1 });
                }
            }
        }
        let [enabled, ..] = on;
        if self.enabled.last().is_none_or(|(_, before)| *before != enabled) {
            self.enabled.push((self.slot, enabled));
        }
        self.slot += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drawn diagram: a good pulse, then one in the other direction after nine slots of hold and with five of setup.
    #[test]
    fn a_driver_says_what_it_was_not_given() {
        let mut driver = StepDriver::default();
        for (slot, levels) in [(0, [false, true]), (20, [true, true]), (21, [false, true])] {
            driver.see(slot, levels);
        }
        assert_eq!(driver.violations(), [""; 0]);
        for (slot, levels) in [(30, [false, false]), (35, [true, false]), (36, [false, false])] {
            driver.see(slot, levels);
        }
        assert_eq!(driver.violations(), ["setup of 5 slots, 10 asked for", "hold of 9 slots, 10 asked for"]);
        // Two pulses; the direction rose once before the first and fell once.
        assert_eq!((driver.position(), driver.edges), (0, [4, 2]));
    }
}

//! The machine at the board's pins: what the controller is told of it, what it moves, and what it is told by.
//!
//! | module | what |
//! | --- | --- |
//! | [`wiring`] | which pin is what |
//! | [`enables`] | the drives' power |
//! | [`step_drivers`] | step drivers, slot by slot |
//! | [`servo_axes`] | servo drives, motors, tables and encoders |
//! | [`switches`] | limit and home switches, the emergency stop, faults of drives, at exact instants |
//! | [`ends`] | limit switches at places that step axes reach |
//!
//! A part of the machine sees every access of the core once the chip has settled after it, says when it wants control next, and gets
//! it then between two instructions.

pub mod enables;
pub mod ends;
pub mod servo_axes;
pub mod step_drivers;
pub mod switches;
pub mod wiring;

use rigless::emulator::Access;
use rigless::machine::stm32h743_bench::Stm32h743Bench;
use rigless::time::VirtualNanos;
use shared::machine::image::encode;
use shared::machine::{AxisDrive, MachineSettings};

use crate::Error;
use enables::Enables;
use ends::Ends;
use servo_axes::{MILL, ServoAxes};
use step_drivers::StepDrivers;
use switches::Switches;
use wiring::Fault;

/// What a board is mounted in: the machine that it is told, whose wiring the contacts follow.
#[derive(Clone, Debug, Default)]
pub struct Mounting {
    /// The machine, as the controller keeps it; empty where it is told none.
    pub image: Vec<u8>,
    settings: Option<MachineSettings>,
}

impl Mounting {
    /// A board that is told this machine, and stands in it.
    pub fn new(settings: &MachineSettings) -> Result<Self, Error> {
        let image = encode(settings).map_err(|error| Error::new(error.to_string()))?;
        Ok(Self { image: image.to_vec(), settings: Some(settings.clone()) })
    }

    /// A board that stands in no machine and has never been told one.
    pub fn unknown() -> Self {
        Self::default()
    }

    /// The same, where nobody tells the board its machine.
    pub fn untold(self) -> Self {
        Self { image: Vec::new(), ..self }
    }

    /// The machine with all of its switches at rest. Servo axes stand in closed loops with the mill behind them.
    pub fn machine(&self) -> Result<Machine, Error> {
        let Some(settings) = &self.settings else { return Ok(Machine::default()) };
        let active = settings.activate().map_err(|error| Error::new(error.to_string()))?;
        let mut machine = Machine {
            switches: Switches::new(active.wiring.active_low),
            enables: Enables::new([0, 1, 2].map(|axis| active.enables_low >> axis & 1 != 0)),
            ..Machine::default()
        };
        if settings.axes.iter().any(|axis| matches!(axis.drive, AxisDrive::Servo(_))) {
            machine.servo_axes = Some(ServoAxes::new(MILL)?);
        }
        Ok(machine)
    }
}

/// See the module. By default nothing but its switches is there.
pub struct Machine {
    /// Step drivers, where they are looked at; the run is slow then.
    pub step_drivers: Option<StepDrivers>,
    /// Servo axes, where there are any.
    pub servo_axes: Option<ServoAxes>,
    /// All contacts.
    pub switches: Switches,
    /// Limit switches that step axes reach.
    pub ends: Ends,
    /// The drives' power.
    pub enables: Enables,
}

impl Default for Machine {
    fn default() -> Self {
        Self {
            step_drivers: None,
            servo_axes: None,
            switches: Switches::default(),
            ends: Ends::default(),
            enables: Enables::new([false; 3]),
        }
    }
}

impl Machine {
    /// Takes note of an access, with the value that was read or written.
    pub fn see(&mut self, board: &mut Stm32h743Bench, access: &Access, value: u64) {
        self.enables.see(board, access);
        if let Some(drivers) = &mut self.step_drivers {
            drivers.see(access);
        }
        if let Some(axes) = &mut self.servo_axes {
            axes.see(access, value, self.enables.on);
        }
    }

    /// The next instant at which it wants control, in ns.
    pub fn next(&self) -> Option<u64> {
        let drivers = self.step_drivers.as_ref().and_then(StepDrivers::next);
        let axes = self.servo_axes.as_ref().and_then(ServoAxes::next);
        [drivers, axes, self.switches.next(), self.enables.next()].into_iter().flatten().min()
    }

    /// Does what is due.
    pub fn act(&mut self, board: &mut Stm32h743Bench, now: VirtualNanos) {
        for (fault, begins) in self.switches.act(board, now) {
            match (fault, &mut self.servo_axes) {
                (Fault::EmergencyStop, _) => self.enables.stop_changed(board, now),
                (Fault::Blocked(axis), Some(axes)) => axes.block(axis, begins),
                _ => {}
            }
        }
        self.enables.act(board, now);
        if let Some(axes) = &mut self.servo_axes {
            axes.act(board, now);
        }
        if let Some(drivers) = &mut self.step_drivers {
            drivers.act(board, now, self.enables.on);
            self.ends.watch(drivers, now, &mut self.switches);
        }
    }
}

//! What the board is mounted in: the machine that it is told, and the switches at its inputs.
//!
//! The wiring is told here once more, so that a firmware that uses other pins finds every switch open. All switches are normally closed to
//! ground, as a machine's are: an input is low until its switch acts.

use rigless::device::Level;
use rigless::machine::stm32h743_bench::Stm32h743Bench;
use rigless::soc::stm32h743::peripherals::gpio::Pin;
use rigless::time::VirtualNanos;
use shared::machine::image::encode;
use shared::machine::{AxisDrive, MachineSettings};

use crate::Error;

/// A pin: the number of its port, and its bit.
pub type Place = (usize, u8);

const PORT_C: usize = 2;
const PORT_D: usize = 3;
const PORT_E: usize = 4;
const PORT_F: usize = 5;

/// The inputs of x, y and z.
pub const LOW_LIMITS: [Place; 3] = [(PORT_F, 0), (PORT_F, 1), (PORT_F, 2)];
/// See [`LOW_LIMITS`].
pub const HIGH_LIMITS: [Place; 3] = [(PORT_F, 3), (PORT_F, 4), (PORT_F, 5)];
/// See [`LOW_LIMITS`].
pub const HOMES: [Place; 3] = [(PORT_F, 6), (PORT_F, 7), (PORT_F, 8)];
/// See [`LOW_LIMITS`].
pub const DRIVE_FAULTS: [Place; 3] = [(PORT_E, 7), (PORT_E, 8), (PORT_E, 10)];
/// A and B of the encoders of x, y and z.
pub const ENCODERS: [[Place; 2]; 3] =
    [[(PORT_C, 6), (PORT_C, 7)], [(PORT_D, 12), (PORT_D, 13)], [(PORT_E, 9), (PORT_E, 11)]];
/// The emergency stop's input.
pub const ESTOP: Place = (PORT_E, 3);
/// The board's button.
pub const BUTTON: Place = (PORT_C, 13);

/// The outputs that enable the drives of x, y and z.
pub const ENABLES: [Place; 3] = [(PORT_E, 5), (PORT_E, 6), (PORT_E, 4)];

/// See the module.
#[derive(Clone, Debug)]
pub struct Mounting {
    /// The machine, as the controller keeps it; empty for a controller that knows none.
    pub machine: Vec<u8>,
    /// The counts per mm of the axes with an encoder, whose drives do at once as they are told.
    pub encoders: [Option<f64>; 3],
    /// The inputs that act from the start.
    pub acting: Vec<Place>,
}

impl Mounting {
    /// A machine with all of its switches at rest.
    pub fn new(settings: &MachineSettings) -> Result<Self, Error> {
        let image = encode(settings).map_err(|error| Error::new(error.to_string()))?;
        Ok(Self { machine: image.to_vec(), encoders: encoders(settings), acting: Vec::new() })
    }

    /// A board that has never been told its machine.
    pub fn unknown() -> Self {
        Self { machine: Vec::new(), encoders: [None; 3], acting: Vec::new() }
    }

    /// Brings every input to its level, before the processor starts.
    pub fn power_up(&self, board: &mut Stm32h743Bench) {
        let all = LOW_LIMITS.iter().chain(&HIGH_LIMITS).chain(&HOMES).chain(&DRIVE_FAULTS).chain([&ESTOP, &BUTTON]);
        for &place in all {
            drive(board, VirtualNanos(0), place, self.acting.contains(&place));
        }
        for &place in ENCODERS.as_flattened() {
            drive(board, VirtualNanos(0), place, false);
        }
    }
}

/// Drives an input from now on.
pub fn drive(board: &mut Stm32h743Bench, now: VirtualNanos, (port, bit): Place, is_high: bool) {
    board.mcu.drive_port(now, port, |gpio, registers, context| {
        if let Some(pin) = Pin::new(bit) {
            gpio.drive(pin, Some(if is_high { Level::High } else { Level::Low }), registers, context);
        }
    });
}

/// Whether a pin is high.
pub fn is_high(board: &mut Stm32h743Bench, now: VirtualNanos, (port, bit): Place) -> bool {
    board.mcu.drive_port(now, port, |gpio, registers, _| {
        Pin::new(bit).is_some_and(|pin| gpio.level(pin, registers) == Level::High)
    })
}

/// The counts per mm of the axes that have an encoder, in the order of the connectors.
fn encoders(settings: &MachineSettings) -> [Option<f64>; 3] {
    let mut counts = [None; 3];
    for (counts, axis) in counts.iter_mut().zip(&settings.axes) {
        if let AxisDrive::Servo(drive) = axis.drive {
            *counts = Some(drive.control.counts_per_mm);
        }
    }
    counts
}

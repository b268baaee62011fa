//! What hangs on which pin: the wiring of `docs/wiring.md`, told here once more, so that a firmware that uses other pins moves nothing.

use rigless::device::Level;
use rigless::machine::stm32h743_bench::Stm32h743Bench;
use rigless::soc::stm32h743::peripherals::gpio::{Gpio, Pin};
use rigless::time::VirtualNanos;

/// A pin of the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pad {
    /// The port: 0 is A.
    pub port: usize,
    /// The bit.
    pub bit: u8,
}

impl Pad {
    /// Drives an input from now on, and says which alternate function it has, if it has one.
    pub fn drive(self, board: &mut Stm32h743Bench, now: VirtualNanos, is_high: bool) -> Option<u8> {
        let pin = Pin::new(self.bit)?;
        board.mcu.drive_port(now, self.port, |gpio, registers, context| {
            gpio.drive(pin, Some(Level::from(is_high)), registers, context);
            Gpio::function(pin, registers)
        })
    }

    /// Whether an input or output of the port is high.
    pub fn is_high(self, board: &mut Stm32h743Bench, now: VirtualNanos) -> bool {
        board.mcu.drive_port(now, self.port, |gpio, registers, _| {
            Pin::new(self.bit).is_some_and(|pin| gpio.level(pin, registers) == Level::High)
        })
    }

    /// Its alternate function, if it has one.
    pub fn function(self, board: &mut Stm32h743Bench, now: VirtualNanos) -> Option<u8> {
        board.mcu.drive_port(now, self.port, |_, registers, _| Gpio::function(Pin::new(self.bit)?, registers))
    }
}

const fn pad(port: u8, bit: u8) -> Pad {
    Pad { port: (port - b'A') as usize, bit }
}

/// The outputs that enable the drives of x, y and z: TIM15's channels 1 and 2, and the complement of the first; DS12110 rev 11 table 13.
pub const ENABLES: [Pad; 3] = [pad(b'E', 5), pad(b'E', 6), pad(b'E', 4)];

/// The emergency stop: TIM15's break.
pub const ESTOP: Pad = pad(b'E', 3);

/// The alternate function that connects these to TIM15.
pub const ENABLE_FUNCTION: u8 = 4;

/// TIM15's registers, and where its break and dead-time register is among them; RM0433 rev 9 section 41.5.18.
pub const ENABLE_TIMER: std::ops::Range<u64> = 0x4001_4000..0x4001_4400;

/// Step and direction of x, y and z.
pub const STEPS: [[Pad; 2]; 3] =
    [[pad(b'D', 3), pad(b'D', 4)], [pad(b'D', 5), pad(b'D', 6)], [pad(b'D', 7), pad(b'D', 0)]];

/// An encoder's two lines, and the timer that counts them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Encoder {
    /// Lines A and B, which are the timer's channels 1 and 2.
    pub pads: [Pad; 2],
    /// The alternate function that connects both to the timer; DS12110 rev 11 tables 9 to 20.
    pub function: u8,
    /// The timer.
    pub timer: &'static str,
    /// The address of its counter.
    pub counter: u64,
}

/// The encoders of x and y. That of z is TIM1's, PE9 and PE11: its lines rest, since neither example is a machine with a servo on z.
pub const ENCODERS: [Encoder; 2] = [
    Encoder { pads: [pad(b'C', 6), pad(b'C', 7)], function: 2, timer: "TIM3", counter: 0x4000_0424 },
    Encoder { pads: [pad(b'D', 12), pad(b'D', 13)], function: 2, timer: "TIM4", counter: 0x4000_0824 },
];

/// See [`ENCODERS`].
pub const IDLE_ENCODER: [Pad; 2] = [pad(b'E', 9), pad(b'E', 11)];

/// The data register of both converters, x below y, 12 bits each; RM0433 rev 9 section 26.7.11. The emulator has no model of
/// the converter: what is stored there is what stands at the pins.
pub const COMMANDS: u64 = 0x4000_7420;

/// The first control register of TIM8, whose update plays a word; RM0433 rev 9 section 2.3.
pub const SLOT_TIMER: u64 = 0x4001_0400;

/// What may be wrong with a machine, or be reached by it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fault {
    /// The emergency stop is pressed.
    EmergencyStop,
    /// The board's button is pressed.
    Button,
    /// The limit switch at the low end of an axis is reached.
    LowLimit(usize),
    /// The one at the high end.
    HighLimit(usize),
    /// The home switch of an axis is reached.
    Home(usize),
    /// The drive of an axis reports a fault.
    Drive(usize),
    /// The screw of a servo axis is blocked: its encoder shows no edge any more.
    Blocked(usize),
}

impl Fault {
    /// All that close or open a contact.
    pub fn contacts() -> impl Iterator<Item = Self> {
        let of_axis = |axis| [Self::LowLimit(axis), Self::HighLimit(axis), Self::Home(axis), Self::Drive(axis)];
        [Self::EmergencyStop, Self::Button].into_iter().chain((0..3).flat_map(of_axis))
    }

    /// Where it is seen; nowhere if it is no contact, or of an axis that there is not.
    pub fn pad(self) -> Option<Pad> {
        const DRIVES: [u8; 3] = [7, 8, 10];
        let of = |axis: usize, port, first: u8| (axis < 3).then(|| pad(port, first + axis as u8));
        match self {
            Self::EmergencyStop => Some(ESTOP),
            Self::Button => Some(pad(b'C', 13)),
            Self::LowLimit(axis) => of(axis, b'F', 0),
            Self::HighLimit(axis) => of(axis, b'F', 3),
            Self::Home(axis) => of(axis, b'F', 6),
            Self::Drive(axis) => DRIVES.get(axis).map(|&bit| pad(b'E', bit)),
            Self::Blocked(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    /// One pin, one wire.
    #[test]
    fn no_pin_is_wired_twice() {
        let mut pads: Vec<Pad> = ENABLES.to_vec();
        pads.extend(STEPS.into_iter().flatten());
        pads.extend(ENCODERS.into_iter().flat_map(|encoder| encoder.pads));
        pads.extend(IDLE_ENCODER);
        pads.extend(Fault::contacts().filter_map(Fault::pad));
        let distinct: BTreeSet<_> = pads.iter().map(|pad| (pad.port, pad.bit)).collect();
        assert_eq!(pads.len(), 3 + 6 + 6 + 14);
        assert_eq!(distinct.len(), pads.len());
    }
}

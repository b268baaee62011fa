//! What hangs on which pin: the wiring of `docs/wiring.md`, told here once more, so that a firmware that uses other pins moves nothing.

/// A pin of the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pad {
    /// The port: 0 is A.
    pub port: usize,
    /// The bit.
    pub bit: u8,
}

const fn pad(port: u8, bit: u8) -> Pad {
    Pad { port: (port - b'A') as usize, bit }
}

/// The drives' enable output: high is on.
pub const ENABLE: Pad = pad(b'E', 2);

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

/// The encoders of x and y.
pub const ENCODERS: [Encoder; 2] = [
    Encoder { pads: [pad(b'C', 6), pad(b'C', 7)], function: 2, timer: "TIM3", counter: 0x4000_0424 },
    Encoder { pads: [pad(b'D', 12), pad(b'D', 13)], function: 2, timer: "TIM4", counter: 0x4000_0824 },
];

/// The data register of both converters, x below y, 12 bits each; RM0433 rev 9 section 26.7.11. The emulator has no model of
/// the converter: what is stored there is what stands at the pins.
pub const COMMANDS: u64 = 0x4000_7420;

/// The first control register of TIM8, whose update plays a word; RM0433 rev 9 section 2.3.
pub const SLOT_TIMER: u64 = 0x4001_0400;

/// The set/reset register of a port; RM0433 rev 9 sections 2.3 and 11.4.7.
pub const fn set_reset(pad: Pad) -> u64 {
    0x5802_0018 + 0x400 * pad.port as u64
}

/// What may be wrong with a machine, or be reached by it: something that closes or opens a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fault {
    /// The emergency stop is pressed.
    EmergencyStop,
    /// The limit switch at the low end of an axis is reached.
    LowLimit(usize),
    /// The one at the high end.
    HighLimit(usize),
    /// The home switch of an axis is reached.
    Home(usize),
    /// The drive of an axis reports a fault.
    Drive(usize),
}

impl Fault {
    /// All there can be.
    pub fn all() -> impl Iterator<Item = Self> {
        let of_axis = |axis| [Self::LowLimit(axis), Self::HighLimit(axis), Self::Home(axis), Self::Drive(axis)];
        std::iter::once(Self::EmergencyStop).chain((0..3).flat_map(of_axis))
    }

    /// Where it is seen. All of these are low in peace and high otherwise: a contact to ground that opens, but for the stop, which is
    /// the board's button and closes to the supply. None for an axis that there is not.
    pub fn pad(self) -> Option<Pad> {
        let of = |axis: usize, port, first: u8| (axis < 3).then(|| pad(port, first + axis as u8));
        match self {
            Self::EmergencyStop => Some(pad(b'C', 13)),
            Self::LowLimit(axis) => of(axis, b'F', 0),
            Self::HighLimit(axis) => of(axis, b'F', 3),
            Self::Home(axis) => of(axis, b'F', 6),
            Self::Drive(axis) => of(axis, b'E', 7),
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
        let mut pads: Vec<Pad> = vec![ENABLE];
        pads.extend(STEPS.into_iter().flatten());
        pads.extend(ENCODERS.into_iter().flat_map(|encoder| encoder.pads));
        pads.extend(Fault::all().filter_map(Fault::pad));
        let distinct: BTreeSet<_> = pads.iter().map(|pad| (pad.port, pad.bit)).collect();
        assert_eq!(pads.len(), 1 + 6 + 4 + 13);
        assert_eq!(distinct.len(), pads.len());
    }
}

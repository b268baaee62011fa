//! Coordinate systems, shifts and the tool's length, brought into the one frame of the program.
//!
//! With P the tip in the program's frame, W its coordinates as the active system counts them, and M the machine's:
//! M = P + origin + length, and W = P + origin - system - shift. The origin is the system that was active at the beginning
//! and never changes, so that P is one coherent path whatever the program does to its coordinates.

use crate::program::rs274::Settings;

/// X Y Z A B C U V W.
pub const AXIS_LETTERS: [u8; 9] = *b"XYZABCUVW";
/// A value for each axis, in mm or degrees.
pub type Axes = [f64; 9];
/// The number of coordinate systems, G54 to G59.3.
pub const SYSTEMS: usize = 9;

/// Whether an axis counts degrees, which no unit of length changes.
pub fn turns(axis: usize) -> bool {
    (3..6).contains(&axis)
}

/// Where everything is.
#[derive(Clone, Debug)]
pub struct Frames {
    /// The tip in the program's frame.
    pub tip: Axes,
    origin: Axes,
    /// The machine's coordinates of the zero of each system.
    pub systems: [Axes; SYSTEMS],
    /// Which one is active.
    pub active: usize,
    /// The shift by G92 that is in force.
    pub shift: Axes,
    /// The shift that G92.3 brings back.
    pub kept_shift: Axes,
    /// The length of the tool.
    pub length: Axes,
    /// The machine's coordinates of the places of G28 and G30.
    pub homes: [Axes; 2],
}

impl Frames {
    /// At the start of a program.
    pub fn new(settings: &Settings) -> Self {
        let wide = |[x, y, z]: [f64; 3]| [x, y, z, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let systems = settings.systems.map(wide);
        Self {
            tip: wide(settings.start),
            origin: systems[0],
            systems,
            active: 0,
            shift: [0.0; 9],
            kept_shift: [0.0; 9],
            length: [0.0; 9],
            homes: settings.homes.map(wide),
        }
    }

    /// The tip's place in space.
    pub fn place(&self) -> [f64; 3] {
        let [x, y, z, ..] = self.tip;
        [x, y, z]
    }

    /// Where the zero of the active system, with its shift, is in the program's frame.
    pub fn zero(&self, axis: usize) -> f64 {
        self.system(self.active)[axis] + self.shift[axis] - self.origin[axis]
    }

    /// What is to be added to a coordinate of the machine.
    pub fn machine_zero(&self, axis: usize) -> f64 {
        -self.origin[axis] - self.length[axis]
    }

    /// The tip as the active system counts it.
    pub fn counted(&self, axis: usize) -> f64 {
        self.tip[axis] - self.zero(axis)
    }

    /// The zero of a system in the machine's coordinates.
    pub fn system(&self, number: usize) -> &Axes {
        self.systems.get(number).unwrap_or(&self.origin)
    }

    /// Lets the active system count the tip as `value`, by a shift (G92).
    pub fn shift_to(&mut self, axis: usize, value: f64) {
        self.shift[axis] += self.counted(axis) - value;
    }

    /// Lets a system count the tip as `value`, by moving its zero (G10 L20).
    pub fn move_system_to(&mut self, number: usize, axis: usize, value: f64) {
        let zero = self.tip[axis] + self.origin[axis] - self.shift[axis] - value;
        if let Some(system) = self.systems.get_mut(number) {
            system[axis] = zero;
        }
    }

    /// Takes another length of the tool into account: the machine stands, so the tip is elsewhere.
    pub fn set_length(&mut self, length: [f64; 3]) {
        for (axis, length) in length.into_iter().enumerate() {
            self.tip[axis] += self.length[axis] - length;
            self.length[axis] = length;
        }
    }

    /// Makes the machine's present place one to which G28 (0) or G30 (1) goes.
    pub fn set_home(&mut self, which: usize) {
        let here: Axes = std::array::from_fn(|axis| self.tip[axis] - self.machine_zero(axis));
        if let Some(home) = self.homes.get_mut(which) {
            *home = here;
        }
    }
}

//! Step axes.
//!
//! A bench-top mill: ball screws of 5 mm lead, and digital drives that take 40 000 steps a turn. All pins are on port D, so that one
//! word a slot moves every axis.

use shared::fixed::{Fixed, Position};
use shared::steps::{Half, Pin, StepAxes, StepSettings, StepState};

use super::Fault;
use crate::hardware::{Actuators, SLOTS, StepRing, enable};

/// Step axes: x, y and z.
pub const AXES: usize = 3;

/// Ports with pins of step axes: port D alone.
pub const PORTS: usize = 1;

/// The coordinate that each axis follows. With the feature `tandem` the third one is a second motor on x, as on a gantry.
const COORDINATES: [usize; AXES] = [0, 1, if cfg!(feature = "tandem") { 0 } else { 2 }];

/// Bits of port D: step and direction of each axis.
const PINS: [[u8; 2]; AXES] = [[3, 4], [5, 6], [7, 0]];

/// See the module.
pub struct Axes {
    axes: StepAxes<AXES, PORTS, SLOTS>,
    state: StepState<AXES>,
    ring: StepRing,
    next: Result<Half, Fault>,
}

/// Pulses and pauses of a slot, 0.52 us; the direction stands for ten slots before a pulse and after one.
fn settings([step, direction]: [u8; 2]) -> StepSettings {
    let pin = |bit| Pin { port: 0, bit, inverted: false };
    StepSettings {
        steps_per_mm: 8_000.0,
        step: pin(step),
        direction: pin(direction),
        pulse: 1,
        gap: 1,
        setup: 10,
        hold: 10,
    }
}

/// The coordinates that the axes follow.
#[inline(always)]
fn targets([x, y, z]: Position) -> [Fixed; AXES] {
    COORDINATES.map(|coordinate| match coordinate {
        0 => x,
        1 => y,
        _ => z,
    })
}

impl Axes {
    /// At rest at the origin, wherever the machine stands; the ring is played from here. Load time.
    pub fn new(Actuators { mut ring }: Actuators) -> Self {
        let Ok(axes) = StepSettings::activate(&PINS.map(settings)) else {
            // The settings are constants above: the first start of an image with faulty ones ends here, with the drives off.
            cortex_m::asm::udf()
        };
        let state = axes.at_rest([Fixed(0); AXES]);
        let [idle] = axes.idle();
        ring.connect(idle);
        ring.arm();
        Self { axes, state, ring, next: Ok(Half::Second) }
    }

    /// Looks which half of the ring is to be filled: first in the tick, since the hardware plays on.
    #[inline(always)]
    pub fn sense(&mut self) {
        self.next = self.ring.next_half();
    }

    /// Takes the axes to stand at `position`, and switches the drives on. A ring that was stopped begins anew with the next tick, which
    /// is a period from here.
    pub fn start(&mut self, position: Position) {
        self.axes.stand_at(&mut self.state, targets(position));
        if !self.ring.is_armed() {
            self.state = self.axes.at_rest(targets(position));
            self.ring.connect(self.axes.idle()[0]);
            self.ring.arm();
            self.next = Ok(Half::Second);
        }
        enable();
    }

    /// Motion is given up: no pulse comes after this. Where the axes stand is not known to the step any more.
    #[inline(always)]
    pub fn halt(&mut self) {
        self.ring.disarm();
    }

    /// One tick: fills the half of the ring that is played during the next one with the steps to `setpoint`.
    #[inline(always)]
    pub fn follow(&mut self, setpoint: Position) -> Result<(), Fault> {
        if !self.ring.is_armed() {
            return Ok(());
        }
        let half = self.next?;
        let filled = self.axes.fill(&mut self.state, targets(setpoint), half, [self.ring.words(half)]);
        self.ring.filled(half);
        filled.map_err(|_| Fault::Steps)
    }

    /// What was put out: where the axes stand when all words are played, in steps.
    #[inline(always)]
    pub fn outputs(&self) -> [u32; AXES] {
        [0, 1, 2].map(|axis| self.state.position(axis).unwrap_or(0) as u32)
    }
}

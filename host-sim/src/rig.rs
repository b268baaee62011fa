//! A machine at the inputs and outputs of `shared`'s tick, without an instruction set: drives that count pulses or follow commands at
//! once, encoders, switches.
//!
//! Nothing of it asks the controller where it takes its axes to be: step axes are where the pulses at their pins have led them, servo axes
//! where their commands have, and without power both can be turned by hand.

use std::collections::VecDeque;
use std::fmt;

use shared::TICK;
use shared::active::ActivePiece;
use shared::control::{
    AxesError, Commands, Control, Directive, DirectiveError, Inputs, Late, Outputs, Ring, Status, StepPins,
    step_settings,
};
use shared::executor::Pieces;
use shared::fixed::Fixed;
use shared::machine::{AxisDrive, Machine, MachineError, MachineSettings};
use shared::safety::{Levels, ResetCause};
use shared::steps::decoder::Decoder;
use shared::steps::{Half, StepSettings};
use shared::supply::PathTime;

/// Why a machine cannot be driven.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RigError {
    /// Its settings will not do.
    Machine(MachineError),
    /// The controller cannot drive it.
    Axes(AxesError),
}

impl fmt::Display for RigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Machine(error) => error.fmt(f),
            Self::Axes(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for RigError {}

/// Connectors of the rig.
pub const AXES: usize = 3;
/// Slots of a tick: those of the default board.
pub const SLOTS: usize = 1_875;

/// Its pins, all on one port.
pub const PINS: [StepPins; AXES] = [
    StepPins { step: (0, 3), direction: (0, 4) },
    StepPins { step: (0, 5), direction: (0, 6) },
    StepPins { step: (0, 7), direction: (0, 0) },
];

/// A ring of words, and where its player is.
struct List {
    words: Box<[[u32; SLOTS]; 2]>,
    played: bool,
    playing: Half,
    late: bool,
}

fn other(half: Half) -> Half {
    match half {
        Half::First => Half::Second,
        Half::Second => Half::First,
    }
}

impl Ring<1, SLOTS> for List {
    fn is_played(&self) -> bool {
        self.played
    }

    fn play(&mut self, _: [u32; 1]) {
        *self.words = [[0; SLOTS]; 2];
        (self.played, self.playing) = (true, Half::First);
    }

    fn stop(&mut self) {
        self.played = false;
    }

    fn next_half(&self) -> Result<Half, Late> {
        if self.late { Err(Late) } else { Ok(other(self.playing)) }
    }

    fn words(&mut self, half: Half) -> [&mut [u32; SLOTS]; 1] {
        let [first, second] = &mut *self.words;
        [if half == Half::First { first } else { second }]
    }

    fn filled(&mut self, _: Half) {}
}

/// Pieces that have passed the loader, in the order in which they came.
#[derive(Debug, Default)]
pub struct Queue {
    pieces: VecDeque<ActivePiece<f32>>,
    reach: PathTime,
}

impl Queue {
    /// Adds a piece.
    pub fn push(&mut self, piece: ActivePiece<f32>) {
        self.reach = piece.reach();
        self.pieces.push_back(piece);
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.pieces.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }
}

impl Pieces<f32> for Queue {
    fn next_piece(&mut self, place: &mut Option<ActivePiece<f32>>) -> bool {
        let next = self.pieces.pop_front();
        *place = next.or(*place);
        next.is_some()
    }

    fn horizon(&self) -> Option<PathTime> {
        Some(self.reach)
    }

    fn discard(&mut self) {
        self.pieces.clear();
    }
}

/// One axis as it is.
#[derive(Clone, Copy, Debug)]
pub enum Axis {
    /// Where its pulses have led it, in steps from where it stood at power-up, and steps per mm.
    Step {
        /// Steps.
        steps: i64,
        /// Steps per mm.
        per_mm: f64,
    },
    /// Where its encoder is, in counts from where it stood at power-up, and counts per mm.
    Servo {
        /// Counts.
        counts: f64,
        /// Counts per mm.
        per_mm: f64,
    },
}

impl Axis {
    /// Where it is, in mm from where it stood at power-up.
    pub fn place(&self) -> f64 {
        match *self {
            Self::Step { steps, per_mm } => steps as f64 / per_mm,
            Self::Servo { counts, per_mm } => counts / per_mm,
        }
    }

    /// Is turned by hand, or by what hangs on it.
    pub fn turn(&mut self, mm: f64) {
        match self {
            Self::Step { steps, per_mm } => *steps += (mm * *per_mm).round() as i64,
            Self::Servo { counts, per_mm } => *counts += mm * *per_mm,
        }
    }
}

/// See the module.
pub struct Rig {
    /// The controller.
    pub control: Control<AXES, 1, SLOTS>,
    /// What the controller makes of its settings.
    pub machine: Machine,
    drives: [StepSettings; AXES],
    ring: List,
    decoder: Decoder<AXES, 1>,
    /// The axes as they are.
    pub axes: [Axis; AXES],
    /// What the pins are at.
    pub pins: Levels,
    /// Whether the stop has acted shortly since the last tick.
    pub stopped: bool,
    /// Axes whose tables are blocked; bit k is axis k.
    pub blocked: u8,
    /// The queue of pieces.
    pub queue: Queue,
    /// What is asked of the next tick that takes it.
    pub asked: Option<Directive>,
    /// What came of the last one.
    pub answer: Option<Result<(), DirectiveError>>,
    /// Pulses that were seen in the last tick.
    pub pulses: usize,
    /// How the machine stands after the last tick.
    pub status: Status<AXES>,
}

impl Rig {
    /// A machine that was switched on, with all switches at rest; or a controller that knows none. Errors: what it cannot drive.
    pub fn new(settings: Option<&MachineSettings>) -> Result<Self, RigError> {
        let machine = match settings {
            Some(settings) => settings.activate().map_err(RigError::Machine)?,
            None => Machine::none(),
        };
        let control = Control::new(&machine, &PINS, ResetCause::Ordinary).map_err(RigError::Axes)?;
        let mut axes = [Axis::Step { steps: 0, per_mm: 1.0 }; AXES];
        for (axis, one) in axes.iter_mut().zip(settings.iter().flat_map(|settings| &settings.axes)) {
            *axis = match &one.drive {
                AxisDrive::Step(drive) => Axis::Step { steps: 0, per_mm: drive.steps_per_mm },
                AxisDrive::Servo(drive) => Axis::Servo { counts: 0.0, per_mm: drive.control.counts_per_mm },
            };
        }
        let at_rest = machine.wiring.active_low;
        let drives = step_drives(settings);
        let status = control.status(&Outputs { drives: false, enables: 0, commands: Commands::ZERO, answer: None });
        Ok(Self {
            control,
            machine,
            ring: List { words: Box::new([[0; SLOTS]; 2]), played: false, playing: Half::First, late: false },
            decoder: Decoder::new(&drives),
            drives,
            axes,
            pins: at_rest,
            stopped: false,
            blocked: 0,
            queue: Queue::default(),
            asked: None,
            answer: None,
            pulses: 0,
            status,
        })
    }

    /// One tick, and what the machine does until the next.
    pub fn tick(&mut self) -> Outputs<AXES> {
        if self.ring.played {
            self.ring.playing = other(self.ring.playing);
        }
        let was_played = self.ring.played;
        let counts = self.axes.map(|axis| match axis {
            Axis::Servo { counts, .. } => counts.floor() as i64 as i32,
            Axis::Step { .. } => 0,
        });
        let inputs = Inputs { pins: self.pins, stopped: std::mem::take(&mut self.stopped), counts };
        let outputs = self.control.tick(&inputs, || self.asked.take(), &mut self.queue, &mut self.ring);
        self.answer = outputs.answer.or(self.answer);
        self.status = self.control.status(&outputs);
        self.pulses = 0;
        if self.ring.played {
            if !was_played {
                self.decoder = Decoder::new(&self.drives);
            }
            let (axes, pulses, blocked) = (&mut self.axes, &mut self.pulses, self.blocked);
            let [first, second] = &*self.ring.words;
            let words = if self.ring.playing == Half::First { first } else { second };
            self.decoder.play([words], |step| {
                *pulses += 1;
                if let Axis::Step { steps, .. } =
                    &mut axes.get_mut(step.axis).unwrap_or(&mut Axis::Step { steps: 0, per_mm: 1.0 })
                    && blocked >> step.axis & 1 == 0
                {
                    *steps += if step.forward { 1 } else { -1 };
                }
            });
        }
        for (number, (axis, velocity)) in self.axes.iter_mut().zip(outputs.commands.commands).enumerate() {
            if let Axis::Servo { counts, per_mm } = axis
                && outputs.drives
                && self.blocked >> number & 1 == 0
            {
                *counts += f64::from(velocity) * f64::from(TICK) * *per_mm;
            }
        }
        outputs
    }

    /// The tick comes too late from now on, or in time again.
    pub fn be_late(&mut self, late: bool) {
        self.ring.late = late;
    }

    /// Whether step words are played.
    pub fn is_played(&self) -> bool {
        self.ring.played
    }

    /// Where an axis takes itself to be, in mm; machine coordinates.
    pub fn believed(&self, axis: usize) -> f64 {
        self.status.actual.get(axis).copied().unwrap_or(Fixed(0)).to_mm()
    }
}

/// The step drives of a machine; those of connectors without one see no pulse.
fn step_drives(settings: Option<&MachineSettings>) -> [StepSettings; AXES] {
    let axes = settings.map_or(&[][..], |settings| &settings.axes);
    step_settings(axes, &PINS, SLOTS)
}

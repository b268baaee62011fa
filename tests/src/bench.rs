//! A machine at the inputs and outputs of `shared`'s tick: drives that count pulses or follow commands, encoders, switches.
//!
//! Nothing of it asks the controller where it takes its axes to be: step axes are where the pulses at their pins have led them, servo axes
//! where their commands have, and without power both can be turned by hand.

use std::collections::VecDeque;

use shared::TICK;
use shared::active::ActivePiece;
use shared::control::{
    Control, Directive, DirectiveError, Inputs, Late, Outputs, Ring, Start, Status, StepPins, step_settings,
};
use shared::executor::Pieces;
use shared::fixed::Fixed;
use shared::loader::{Loader, Motion};
use shared::machine::{AxisDrive, MachineSettings};
use shared::piece::{Header, Piece};
use shared::safety::{Coordinates, Levels, ResetCause};
use shared::steps::Half;
use shared::steps::decoder::Decoder;
use shared::supply::PathTime;

/// Connectors of the bench.
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

fn place(half: Half) -> usize {
    match half {
        Half::First => 0,
        Half::Second => 1,
    }
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
        [&mut self.words[place(half)]]
    }

    fn filled(&mut self, _: Half) {}
}

/// Pieces that have passed the loader, in the order in which they came.
#[derive(Default)]
pub struct Queue {
    pieces: VecDeque<ActivePiece<f32>>,
    reach: PathTime,
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
pub struct Bench {
    /// The controller.
    pub control: Control<AXES, 1, SLOTS>,
    settings: MachineSettings,
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
    /// The status after the last tick.
    pub status: Option<Status<AXES>>,
}

impl Bench {
    /// A machine that was switched on, with all switches at rest.
    pub fn new(settings: &MachineSettings) -> Self {
        let machine = settings.activate().expect("a machine that the test has chosen");
        let control = Control::new(&machine, &PINS, ResetCause::Ordinary).expect("three axes at most");
        let mut axes = [Axis::Step { steps: 0, per_mm: 1.0 }; AXES];
        for (axis, one) in axes.iter_mut().zip(&settings.axes) {
            *axis = match &one.drive {
                AxisDrive::Step(drive) => Axis::Step { steps: 0, per_mm: drive.steps_per_mm },
                AxisDrive::Servo(drive) => Axis::Servo { counts: 0.0, per_mm: drive.control.counts_per_mm },
            };
        }
        let at_rest = machine.wiring.active_low;
        Self {
            control,
            ring: List { words: Box::new([[0; SLOTS]; 2]), played: false, playing: Half::First, late: false },
            decoder: Decoder::new(&step_settings(settings, &PINS, SLOTS)),
            settings: settings.clone(),
            axes,
            pins: at_rest,
            stopped: false,
            blocked: 0,
            queue: Queue::default(),
            asked: None,
            answer: None,
            pulses: 0,
            status: None,
        }
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
        self.status = Some(self.control.status(&outputs));
        self.pulses = 0;
        if self.ring.played {
            if !was_played {
                self.decoder = Decoder::new(&step_settings(&self.settings, &PINS, SLOTS));
            }
            let (axes, pulses, blocked) = (&mut self.axes, &mut self.pulses, self.blocked);
            self.decoder.play([&self.ring.words[place(self.ring.playing)]], |step| {
                *pulses += 1;
                if let Axis::Step { steps, .. } = &mut axes[step.axis]
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

    /// Asks and ticks until there is an answer.
    pub fn ask(&mut self, directive: Directive) -> Result<(), DirectiveError> {
        (self.asked, self.answer) = (Some(directive), None);
        for _ in 0..8 {
            self.tick();
            if let Some(answer) = self.answer {
                return answer;
            }
        }
        panic!("no answer to {directive:?}");
    }

    /// Puts a whole path into the queue, and returns what starts it. It has passed the loader.
    pub fn load(&mut self, header: &Header<f32>, pieces: &[Piece<f32>], coordinates: Coordinates) -> Start {
        let mut loader = Loader::new(header, TICK).expect("a header that the test has made");
        self.queue = Queue::default();
        for piece in pieces {
            let active = loader.load(piece).expect("a piece that the test has made");
            self.queue.reach = active.reach();
            self.queue.pieces.push_back(active);
        }
        let motion: Motion<f32> = loader.motion();
        let further = pieces[0].further.map(|travel| travel.from);
        Start { motion, coordinates, at: loader.start().expect("one piece at least"), further }
    }

    /// Where an axis takes itself to be, in mm; machine coordinates.
    pub fn believed(&self, axis: usize) -> f64 {
        self.status.map_or(Fixed(0), |status| status.actual[axis]).to_mm()
    }
}

//! What the tick leaves for others to read: telemetry, a debugger, and the virtual board.
//!
//! A static of atomics that the tick alone writes. Its layout is part of the contract with `tests/board`, which finds it by the symbol
//! `HODOGRAPH_MAILBOX` and reads it in RAM at the end of each tick: words of 32 bits in the order of the fields.

use core::sync::atomic::{AtomicBool, AtomicI32, AtomicU32, Ordering::Relaxed};

use shared::control::{DirectiveError, PathEnd, Status, answer_of, answer_word};
use shared::fixed::{Fixed, Position};
use shared::safety::Fault;
use shared::{motion, safety};

use crate::hardware::AXES;

/// The mailbox.
#[unsafe(no_mangle)]
pub static HODOGRAPH_MAILBOX: Mailbox = Mailbox::new();

/// The mailbox, by the name the code uses.
pub use self::HODOGRAPH_MAILBOX as MAILBOX;

/// See the module.
#[repr(C)]
pub struct Mailbox {
    /// Ticks since the controller started.
    uptime: AtomicU32,
    /// What the motion is about: the number of `shared::motion::State`.
    motion: AtomicU32,
    /// Ticks of this path.
    ticks: AtomicU32,
    /// Pieces of this path that were entered.
    pieces: AtomicU32,
    /// The setpoint in the path's coordinates, in units of `shared::fixed`.
    setpoint: [AtomicI32; 3],
    /// The hash of all setpoints of this path, lower word first.
    hash: [AtomicU32; 2],
    /// Time left in the last tick, in s, as the bits of an f32.
    residual: AtomicU32,
    /// What each axis was told: a drive's command as the bits of an f32, or a position in steps.
    told: [AtomicU32; AXES],
    /// Cycles of the core that this tick took up to here.
    cycles: AtomicU32,
    /// The most of these since the controller started.
    worst_cycles: AtomicU32,
    /// What the machine is about: the number of `shared::safety::State`.
    machine: AtomicU32,
    /// What became of the path, `PathEnd::word`.
    path: AtomicU32,
    /// What is wrong, `Fault::word`, or 0.
    fault: AtomicU32,
    /// The axes whose position is known, and the override in per cent above: bits 0..8 and 8..16.
    known: AtomicU32,
    /// Where the axes shall be, in machine coordinates.
    position: [AtomicI32; 3],
    /// Where they were when the tick began.
    actual: [AtomicI32; 3],
    /// What came of the last directive, `answer_word`, until the link has taken it; or 0.
    answer: AtomicU32,
    /// The most cycles of each stage of a tick since the controller started: reading inputs, deciding and moving, putting out.
    stages: [AtomicU32; 3],
    /// Whether the button was pressed since the last tick.
    button: AtomicBool,
    /// Whether it is pressed now.
    pressed: AtomicBool,
}

impl Mailbox {
    const fn new() -> Self {
        Self {
            uptime: AtomicU32::new(0),
            motion: AtomicU32::new(0),
            ticks: AtomicU32::new(0),
            pieces: AtomicU32::new(0),
            setpoint: [const { AtomicI32::new(0) }; 3],
            hash: [const { AtomicU32::new(0) }; 2],
            residual: AtomicU32::new(0),
            told: [const { AtomicU32::new(0) }; AXES],
            cycles: AtomicU32::new(0),
            worst_cycles: AtomicU32::new(0),
            machine: AtomicU32::new(0),
            path: AtomicU32::new(0),
            fault: AtomicU32::new(0),
            known: AtomicU32::new(0),
            position: [const { AtomicI32::new(0) }; 3],
            actual: [const { AtomicI32::new(0) }; 3],
            answer: AtomicU32::new(0),
            stages: [const { AtomicU32::new(0) }; 3],
            button: AtomicBool::new(false),
            pressed: AtomicBool::new(false),
        }
    }

    /// Leaves how the machine stands. The tick alone calls this, and then [`Mailbox::close`].
    #[inline(always)]
    pub fn publish(&self, status: &Status<AXES>) {
        self.motion.store(status.motion as u32, Relaxed);
        self.ticks.store(status.ticks, Relaxed);
        self.pieces.store(status.pieces, Relaxed);
        write(&self.setpoint, status.setpoint);
        let [low, high] = &self.hash;
        low.store(status.hash as u32, Relaxed);
        high.store((status.hash >> 32) as u32, Relaxed);
        self.residual.store(status.residual.to_bits(), Relaxed);
        for (word, told) in self.told.iter().zip(status.told) {
            word.store(told, Relaxed);
        }
        self.machine.store(status.machine as u32, Relaxed);
        self.path.store(status.path.word(), Relaxed);
        self.fault.store(status.fault.map_or(0, Fault::word), Relaxed);
        self.known.store(u32::from(status.known) | u32::from(status.percent) << 8, Relaxed);
        write(&self.position, status.position);
        write(&self.actual, status.actual);
    }

    /// The end of a tick that took so many cycles up to the end of each stage.
    #[inline(always)]
    pub fn close(&self, [sensed, decided, cycles]: [u32; 3]) {
        let stages = [sensed, decided.wrapping_sub(sensed), cycles.wrapping_sub(decided)];
        for (most, stage) in self.stages.iter().zip(stages) {
            if stage > most.load(Relaxed) {
                most.store(stage, Relaxed);
            }
        }
        self.cycles.store(cycles, Relaxed);
        if cycles > self.worst_cycles.load(Relaxed) {
            self.worst_cycles.store(cycles, Relaxed);
        }
        self.uptime.store(self.uptime.load(Relaxed).wrapping_add(1), Relaxed);
    }

    /// Ticks since the controller started.
    pub fn uptime(&self) -> u32 {
        self.uptime.load(Relaxed)
    }

    /// The last tick and the longest since the controller started, in cycles of the core.
    pub fn cycles(&self) -> [u32; 2] {
        [self.cycles.load(Relaxed), self.worst_cycles.load(Relaxed)]
    }

    /// The most cycles of each stage of a tick since the controller started: reading inputs, deciding and moving, putting out.
    pub fn stages(&self) -> [u32; 3] {
        self.stages.each_ref().map(|most| most.load(Relaxed))
    }

    /// How the machine stood after the last tick, all of it of the same tick. For tasks below the tick.
    pub fn read(&self) -> Status<AXES> {
        loop {
            let before = self.uptime();
            let [low, high] = &self.hash;
            let known = self.known.load(Relaxed);
            let status = Status {
                machine: safety::State::from_number(self.machine.load(Relaxed) as u8).unwrap_or(safety::State::Fault),
                motion: motion::State::from_number(self.motion.load(Relaxed) as u8).unwrap_or(motion::State::Idle),
                path: PathEnd::from_word(self.path.load(Relaxed)),
                fault: Fault::from_word(self.fault.load(Relaxed)),
                known: known as u8,
                percent: (known >> 8) as u8,
                ticks: self.ticks.load(Relaxed),
                pieces: self.pieces.load(Relaxed),
                setpoint: read(&self.setpoint),
                position: read(&self.position),
                actual: read(&self.actual),
                hash: u64::from(low.load(Relaxed)) | u64::from(high.load(Relaxed)) << 32,
                residual: f32::from_bits(self.residual.load(Relaxed)),
                told: self.told.each_ref().map(|word| word.load(Relaxed)),
            };
            // A tick came in between once at most, unless this task were slower than a period.
            if before == self.uptime() {
                return status;
            }
        }
    }

    /// Leaves what came of a directive. The tick alone calls this.
    #[inline(always)]
    pub fn answer(&self, answer: &Result<(), DirectiveError>) {
        self.answer.store(answer_word(answer), Relaxed);
    }

    /// Takes what came of the directive that the link has given; none as long as the tick has not taken that. The link alone calls this,
    /// and has one directive under way at most.
    pub fn take_answer(&self) -> Option<Result<(), DirectiveError>> {
        let answer = answer_of(self.answer.load(Relaxed))?;
        self.answer.store(0, Relaxed);
        Some(answer)
    }

    /// The button changed.
    pub fn set_button(&self, pressed: bool) {
        self.pressed.store(pressed, Relaxed);
        if pressed {
            self.button.store(true, Relaxed);
        }
    }

    /// Whether the button is pressed.
    #[inline(always)]
    pub fn is_pressed(&self) -> bool {
        self.pressed.load(Relaxed)
    }

    /// Whether the button was pressed since the last call, or is now. The tick alone calls this.
    #[inline(always)]
    pub fn take_button(&self) -> bool {
        let was = self.button.load(Relaxed);
        if was {
            self.button.store(false, Relaxed);
        }
        was | self.is_pressed()
    }
}

#[inline(always)]
fn write(words: &[AtomicI32; 3], position: Position) {
    for (word, coordinate) in words.iter().zip(position) {
        word.store(coordinate.0, Relaxed);
    }
}

fn read(words: &[AtomicI32; 3]) -> Position {
    words.each_ref().map(|word| Fixed(word.load(Relaxed)))
}

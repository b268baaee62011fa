//! What the tick leaves for others to read: telemetry, a debugger, and the virtual board.
//!
//! A static of atomics that the tick alone writes. Its layout is part of the contract with `tests/board`, which finds it by the symbol
//! `HODOGRAPH_MAILBOX` and reads it in RAM at the end of each tick: words of 32 bits in the order of the fields.

use core::sync::atomic::{AtomicBool, AtomicI32, AtomicU32, Ordering::Relaxed};

use shared::fixed::{Fixed, Position};

use crate::axes::{AXES, Fault};

/// The mailbox.
#[unsafe(no_mangle)]
pub static HODOGRAPH_MAILBOX: Mailbox = Mailbox::new();

/// The mailbox, by the name the code uses.
pub use self::HODOGRAPH_MAILBOX as MAILBOX;

/// See the module.
#[repr(C)]
pub struct Mailbox {
    /// Ticks since the controller started; the first and the last word that a tick writes differ only while it writes.
    uptime: AtomicU32,
    /// What the executor is about: the number of `shared::executor::State`.
    state: AtomicU32,
    /// Ticks of this job.
    ticks: AtomicU32,
    /// Pieces of this job that were entered.
    pieces: AtomicU32,
    /// The setpoint, in units of `shared::fixed`.
    setpoint: [AtomicI32; 3],
    /// The hash of all setpoints of this job, lower word first.
    hash: [AtomicU32; 2],
    /// Time left in the last tick, in s, as the bits of an f32.
    residual: AtomicU32,
    /// What each axis was told: a drive's command in mm/s as the bits of an f32, or a position in steps.
    outputs: [AtomicU32; AXES],
    /// Cycles of the core that this tick took up to here.
    cycles: AtomicU32,
    /// The most of these since the controller started.
    worst_cycles: AtomicU32,
    /// Whether the stop input was pressed since the last `release`.
    stopped: AtomicBool,
    /// Whether the stop input is pressed now.
    pressed: AtomicBool,
    /// What stopped the axes since the last `release`: the number of a `crate::axes::Fault`, or 0.
    fault: AtomicU32,
}

/// What one tick leaves.
#[derive(Clone, Copy, Debug)]
pub struct Snapshot {
    /// The number of `shared::executor::State`.
    pub state: u32,
    /// Ticks of this job.
    pub ticks: u32,
    /// Pieces of this job that were entered.
    pub pieces: u32,
    /// The setpoint.
    pub setpoint: Position,
    /// The hash of all setpoints of this job.
    pub hash: u64,
    /// Time left in the last tick, in s.
    pub residual: f32,
    /// What each axis was told, as the mailbox keeps it.
    pub outputs: [u32; AXES],
    /// Cycles of the core that the tick took.
    pub cycles: u32,
}

impl Mailbox {
    const fn new() -> Self {
        Self {
            uptime: AtomicU32::new(0),
            state: AtomicU32::new(0),
            ticks: AtomicU32::new(0),
            pieces: AtomicU32::new(0),
            setpoint: [const { AtomicI32::new(0) }; 3],
            hash: [const { AtomicU32::new(0) }; 2],
            residual: AtomicU32::new(0),
            outputs: [const { AtomicU32::new(0) }; AXES],
            cycles: AtomicU32::new(0),
            worst_cycles: AtomicU32::new(0),
            stopped: AtomicBool::new(false),
            pressed: AtomicBool::new(false),
            fault: AtomicU32::new(0),
        }
    }

    /// Leaves a snapshot. The tick alone calls this.
    #[inline(always)]
    pub fn publish(&self, snapshot: &Snapshot) {
        self.state.store(snapshot.state, Relaxed);
        self.ticks.store(snapshot.ticks, Relaxed);
        self.pieces.store(snapshot.pieces, Relaxed);
        for (word, coordinate) in self.setpoint.iter().zip(snapshot.setpoint) {
            word.store(coordinate.0, Relaxed);
        }
        let [low, high] = &self.hash;
        low.store(snapshot.hash as u32, Relaxed);
        high.store((snapshot.hash >> 32) as u32, Relaxed);
        self.residual.store(snapshot.residual.to_bits(), Relaxed);
        for (word, output) in self.outputs.iter().zip(snapshot.outputs) {
            word.store(output, Relaxed);
        }
        self.cycles.store(snapshot.cycles, Relaxed);
        if snapshot.cycles > self.worst_cycles.load(Relaxed) {
            self.worst_cycles.store(snapshot.cycles, Relaxed);
        }
        self.uptime.store(self.uptime.load(Relaxed).wrapping_add(1), Relaxed);
    }

    /// Ticks since the controller started.
    pub fn uptime(&self) -> u32 {
        self.uptime.load(Relaxed)
    }

    /// The longest tick since the controller started, in cycles of the core.
    pub fn worst_cycles(&self) -> u32 {
        self.worst_cycles.load(Relaxed)
    }

    /// What the last tick left, all of it of the same tick. For tasks below the tick.
    pub fn read(&self) -> Snapshot {
        loop {
            let before = self.uptime();
            let [x, y, z] = &self.setpoint;
            let [low, high] = &self.hash;
            let snapshot = Snapshot {
                state: self.state.load(Relaxed),
                ticks: self.ticks.load(Relaxed),
                pieces: self.pieces.load(Relaxed),
                setpoint: [x, y, z].map(|word| Fixed(word.load(Relaxed))),
                hash: u64::from(low.load(Relaxed)) | u64::from(high.load(Relaxed)) << 32,
                residual: f32::from_bits(self.residual.load(Relaxed)),
                outputs: self.outputs.each_ref().map(|word| word.load(Relaxed)),
                cycles: self.cycles.load(Relaxed),
            };
            // A tick came in between once at most, unless this task were slower than a period.
            if before == self.uptime() {
                return snapshot;
            }
        }
    }

    /// The stop input changed. The stop holds after it is released, until [`Mailbox::release`].
    pub fn set_stop(&self, pressed: bool) {
        self.pressed.store(pressed, Relaxed);
        if pressed {
            self.stopped.store(true, Relaxed);
        }
    }

    /// The axes cannot go on. It holds like a stop.
    #[cold]
    pub fn set_fault(&self, fault: Fault) {
        self.fault.store(fault as u32, Relaxed);
        self.stopped.store(true, Relaxed);
    }

    /// Whether every motion is to be given up.
    #[inline(always)]
    pub fn is_stopped(&self) -> bool {
        self.stopped.load(Relaxed)
    }

    /// Ends the stop, unless the input is still pressed.
    pub fn release(&self) {
        self.fault.store(0, Relaxed);
        self.stopped.store(false, Relaxed);
        // The input may have been pressed since: its task is more urgent than any that calls this.
        if self.pressed.load(Relaxed) {
            self.stopped.store(true, Relaxed);
        }
    }
}

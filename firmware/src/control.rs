//! What a tick does: directives, the path's executor, and the axes that follow it.

use heapless::spsc::{Consumer, Queue};
use shared::active::ActivePiece;
use shared::executor::{Executor, Pieces, State};
use shared::fixed::Fixed;
use shared::hash::SetpointHash;
use shared::loader::Motion;
use shared::motion::MotionCommand;
use shared::supply::Source;

use crate::axes::{Axes, Fault};
use crate::mailbox::{Mailbox, Snapshot};

/// Length of the queue of pieces; it holds one less. A power of two.
pub const PIECES: usize = 64;

/// Length of the queue of directives; it holds one less.
pub const DIRECTIVES: usize = 4;

/// Validated pieces on their way from the link to the tick.
pub type PieceQueue = Queue<ActivePiece<f32>, PIECES>;

/// Directives on their way from the link to the tick.
pub type Directives = Queue<Directive, DIRECTIVES>;

/// What the link asks of the tick.
#[derive(Clone, Copy, Debug)]
pub enum Directive {
    /// Begin the path whose pieces stand in the queue, at its first point.
    ///
    /// There is no homing yet: the machine is taken to stand at that point, wherever it is, and nothing jumps.
    Start(Motion<f32>, [Fixed; 2]),
    /// Change the motion that there is; without effect where it does not allow that.
    Command(MotionCommand),
    /// Stay where you are, and forget the pieces in the queue.
    Stop,
}

/// The state of everything that moves.
pub struct Control {
    pieces: Source<'static, f32>,
    directives: Consumer<'static, Directive>,
    executor: Executor<f32>,
    axes: Axes,
    hash: SetpointHash,
    ticks: u32,
}

impl Control {
    /// At rest at the origin, with these axes.
    pub fn new(pieces: Source<'static, f32>, directives: Consumer<'static, Directive>, axes: Axes) -> Self {
        Self {
            pieces,
            directives,
            executor: Executor::new(shared::TICK, [Fixed(0); 3]),
            axes,
            hash: SetpointHash::new(),
            ticks: 0,
        }
    }

    /// One tick: from where the axes are to what they do next. `stopped` gives up every motion.
    ///
    /// A start or a stop takes a tick of its own, so that none does both: the path's first tick is the one after.
    #[inline(always)]
    pub fn tick(&mut self, stopped: bool) -> Result<(), Fault> {
        self.axes.sense();
        match self.directives.dequeue() {
            None if !stopped => self.walk(),
            Some(Directive::Start(motion, point)) if !stopped => self.start(&motion, point),
            Some(Directive::Command(command)) if !stopped => self.change(command),
            _ => self.stop(stopped),
        }
        self.axes.follow(self.executor.setpoint())
    }

    #[inline(always)]
    fn walk(&mut self) {
        if self.executor.state().is_moving() || self.executor.state() == State::Held {
            self.hash.add(self.executor.tick(&mut self.pieces));
            self.ticks = self.ticks.wrapping_add(1);
        }
    }

    /// The motion goes on in the same tick: a command must not cost it one.
    #[inline(always)]
    fn change(&mut self, command: MotionCommand) {
        // What a motion does not allow changes nothing; the link reports the state that there is.
        let _ = self.executor.command(command);
        self.walk();
    }

    #[cold]
    #[inline(never)]
    fn start(&mut self, motion: &Motion<f32>, [x, y]: [Fixed; 2]) {
        let position = [x, y, Fixed(0)];
        self.executor.stand_at(position);
        self.executor.begin(motion);
        self.axes.start(position);
        self.hash = SetpointHash::new();
        self.ticks = 0;
    }

    #[cold]
    #[inline(never)]
    fn stop(&mut self, halt: bool) {
        self.executor.abort();
        if halt {
            self.axes.halt();
        }
        self.pieces.discard();
    }

    /// Leaves what a reporter wants to know; `cycles` is how long the tick took.
    #[inline(always)]
    pub fn publish(&self, mailbox: &Mailbox, cycles: u32) {
        mailbox.publish(&Snapshot {
            state: self.executor.state() as u32,
            ticks: self.ticks,
            pieces: self.executor.place().map_or(0, |place| place.piece.wrapping_add(1)),
            setpoint: self.executor.setpoint(),
            hash: self.hash.value(),
            residual: self.executor.spare_time(),
            outputs: self.axes.outputs(),
            cycles,
        });
    }
}

//! What a tick does: directives, the path's executor, and the axes that follow it.

use heapless::spsc::{Consumer, Queue};
use shared::active::ActivePiece;
use shared::executor::{Executor, State};
use shared::fixed::Fixed;
use shared::hash::SetpointHash;
use shared::piece::Order;

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
    Start(Order, [Fixed; 2]),
    /// Stay where you are, and forget the pieces in the queue.
    Stop,
}

/// The state of everything that moves.
pub struct Control {
    pieces: Consumer<'static, ActivePiece<f32>>,
    directives: Consumer<'static, Directive>,
    executor: Executor<f32>,
    axes: Axes,
    hash: SetpointHash,
    ticks: u32,
}

impl Control {
    /// At rest at the origin, with these axes.
    pub fn new(
        pieces: Consumer<'static, ActivePiece<f32>>,
        directives: Consumer<'static, Directive>,
        axes: Axes,
    ) -> Self {
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
    /// A directive takes a tick of its own, so that none does both: the path's first tick is the one after.
    #[inline(always)]
    pub fn tick(&mut self, stopped: bool) -> Result<(), Fault> {
        self.axes.sense();
        match self.directives.dequeue() {
            None if !stopped => self.walk(),
            Some(Directive::Start(order, point)) if !stopped => self.start(order, point),
            _ => self.stop(stopped),
        }
        self.axes.follow(self.executor.setpoint())
    }

    #[inline(always)]
    fn walk(&mut self) {
        if matches!(self.executor.state(), State::Run | State::Starved) {
            self.hash.add(self.executor.tick(&mut self.pieces));
            self.ticks = self.ticks.wrapping_add(1);
        }
    }

    #[cold]
    #[inline(never)]
    fn start(&mut self, order: Order, [x, y]: [Fixed; 2]) {
        let position = [x, y, Fixed(0)];
        self.executor.stand_at(position);
        self.executor.start(order);
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
        for _ in 0..PIECES {
            if self.pieces.dequeue().is_none() {
                break;
            }
        }
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

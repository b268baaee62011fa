//! The tick's hands: what is on the board for `shared`'s tick, and what it is fed with.

use heapless::spsc::{Consumer, Queue};
use shared::active::ActivePiece;
use shared::control::{Commands, Control, Directive, Inputs};
use shared::machine::Machine;
use shared::safety::ResetCause;
use shared::supply::Source;

use crate::hardware::{AXES, Cycles, Drives, Enables, Encoders, InputPins, PINS, PORTS, SLOTS, StepRing};
use crate::mailbox::Mailbox;

/// Length of the queue of pieces; it holds one less. A power of two.
pub const PIECES: usize = 64;

/// Length of the queue of directives; it holds one less.
pub const DIRECTIVES: usize = 4;

/// Validated pieces on their way from the link to the tick.
pub type PieceQueue = Queue<ActivePiece<f32>, PIECES>;

/// Directives on their way from the link to the tick.
pub type Directives = Queue<Directive, DIRECTIVES>;

/// What the tick reads and writes on the board.
pub struct Hands {
    /// Switches and faults.
    pub inputs: InputPins,
    /// Where servo axes are.
    pub encoders: Encoders,
    /// Where they are told to go.
    pub drives: Drives,
    /// The steps of the next tick.
    pub ring: StepRing,
    /// Power for the drives.
    pub enables: Enables,
}

/// The state of everything that moves.
pub struct Tick {
    control: Control<AXES, PORTS, SLOTS>,
    hands: Hands,
    pieces: Source<'static, f32>,
    directives: Consumer<'static, Directive>,
    powered: bool,
}

impl Tick {
    /// At rest, wherever the machine stands.
    pub fn new(
        machine: &Machine,
        cause: ResetCause,
        hands: Hands,
        pieces: Source<'static, f32>,
        directives: Consumer<'static, Directive>,
    ) -> Self {
        let control = match Control::new(machine, &PINS, cause) {
            Ok(control) => control,
            // `kept` takes machines that this board can drive only.
            Err(_) => cortex_m::asm::udf(),
        };
        Self { control, hands, pieces, directives, powered: false }
    }

    /// One tick, from the levels at the pins to what the drives get. `cycles` began with it; returns what was past at the end of its first
    /// two stages, reading and deciding.
    #[inline(always)]
    pub fn tick(&mut self, mailbox: &Mailbox, cycles: Cycles) -> [u32; 2] {
        let Self { control, hands, pieces, directives, powered } = self;
        let inputs = Inputs {
            pins: hands.inputs.read(),
            stopped: hands.enables.take_stop() | mailbox.take_button(),
            counts: hands.encoders.read(),
        };
        let sensed = cycles.elapsed();
        let outputs = control.tick(&inputs, || directives.dequeue(), pieces, &mut hands.ring);
        let decided = cycles.elapsed();
        if outputs.drives != *powered {
            *powered = outputs.drives;
            // The button may have been pressed since; its interrupt comes after this store, or its power stays off.
            cortex_m::interrupt::free(|_| hands.enables.set(outputs.drives && !mailbox.is_pressed()));
        }
        hands.drives.write(if outputs.drives { outputs.commands.levels } else { Commands::<AXES>::ZERO.levels });
        if let Some(answer) = outputs.answer {
            mailbox.answer(&answer);
        }
        mailbox.publish(&control.status(&outputs));
        [sensed, decided]
    }
}

//! The tick's hands: what is on the board for `shared`'s tick, and what it is fed with.

use heapless::spsc::{Consumer, Producer, Queue};
use shared::active::ActivePiece;
use shared::control::{Commands, Control, Directive, DirectiveError, Inputs};
use shared::machine::Machine;
use shared::safety::ResetCause;
use shared::supply::Source;

use crate::hardware::{AXES, Drives, Enables, Encoders, InputPins, PINS, PORTS, SLOTS, StepRing};
use crate::mailbox::Mailbox;

/// Length of the queue of pieces; it holds one less. A power of two.
pub const PIECES: usize = 64;

/// Length of the queue of directives; it holds one less.
pub const DIRECTIVES: usize = 4;

/// Length of the queue of answers; it holds one less, which is one for each directive and one more.
pub const ANSWERS: usize = 8;

/// Validated pieces on their way from the link to the tick.
pub type PieceQueue = Queue<ActivePiece<f32>, PIECES>;

/// Directives on their way from the link to the tick.
pub type Directives = Queue<Directive, DIRECTIVES>;

/// What came of a directive.
pub type Answer = Result<(), DirectiveError>;

/// Answers on their way back.
pub type Answers = Queue<Answer, ANSWERS>;

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
    answers: Producer<'static, Answer>,
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
        answers: Producer<'static, Answer>,
    ) -> Self {
        let control = match Control::new(machine, &PINS, cause) {
            Ok(control) => control,
            // `kept` takes machines that this board can drive only.
            Err(_) => cortex_m::asm::udf(),
        };
        Self { control, hands, pieces, directives, answers, powered: false }
    }

    /// One tick, from the levels at the pins to what the drives get.
    #[inline(always)]
    pub fn tick(&mut self, mailbox: &Mailbox) {
        let Self { control, hands, pieces, directives, answers, powered } = self;
        let inputs = Inputs {
            pins: hands.inputs.read(),
            stopped: hands.enables.take_stop() | mailbox.take_button(),
            counts: hands.encoders.read(),
        };
        let outputs = control.tick(&inputs, || directives.dequeue(), pieces, &mut hands.ring);
        if outputs.drives != *powered {
            *powered = outputs.drives;
            // The button may have been pressed since; its interrupt comes after this store, or its power stays off.
            cortex_m::interrupt::free(|_| hands.enables.set(outputs.drives && !mailbox.is_pressed()));
        }
        hands.drives.write(if outputs.drives { outputs.commands.levels } else { Commands::<AXES>::ZERO.levels });
        // The queue divides by its length, which the compiler does not know here: asked for, it leaves no panic behind.
        if let Some(answer) = outputs.answer
            && answers.capacity() < ANSWERS
        {
            // There is room: the link waits for each.
            let _ = answers.enqueue(answer);
        }
        mailbox.publish(&control.status(&outputs));
    }
}

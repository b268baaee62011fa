//! What tests do with a controller on [`host_sim::rig`]: ask it, and load a path that has passed the loader.

use host_sim::rig::{Queue, Rig};
use shared::TICK;
use shared::control::{Directive, DirectiveError, Start};
use shared::loader::Loader;
use shared::machine::MachineSettings;
use shared::piece::{Header, Piece};
use shared::safety::Coordinates;

/// A machine that the test has chosen, switched on.
pub fn rig(settings: &MachineSettings) -> Rig {
    Rig::new(Some(settings)).expect("a machine that the test has chosen")
}

/// Asks and ticks until there is an answer.
pub fn ask(rig: &mut Rig, directive: Directive) -> Result<(), DirectiveError> {
    (rig.asked, rig.answer) = (Some(directive), None);
    for _ in 0..8 {
        rig.tick();
        if let Some(answer) = rig.answer {
            return answer;
        }
    }
    panic!("no answer to {directive:?}");
}

/// Puts a whole path into the queue, and returns what starts it. It has passed the loader.
pub fn load(rig: &mut Rig, header: &Header<f32>, pieces: &[Piece<f32>], coordinates: Coordinates) -> Start {
    let mut loader = Loader::new(header, TICK).expect("a header that the test has made");
    rig.queue = Queue::default();
    for piece in pieces {
        rig.queue.push(loader.load(piece).expect("a piece that the test has made"));
    }
    let at = loader.start().expect("one piece at least");
    Start { motion: loader.motion(), coordinates, at, further: loader.further_start() }
}

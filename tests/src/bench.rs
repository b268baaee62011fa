//! Controllers without hardware for tests: one on [`host_sim::rig`] that is asked, and loaded with a path that has passed the loader; and
//! one behind a line.
#![allow(clippy::expect_used, reason = "a failed test says where")]

use host_sim::controller::{Controller, Settings as ControllerSettings};
use host_sim::rig::{Queue, Rig};
use shared::TICK;
use shared::control::{Directive, DirectiveError, Start};
use shared::loader::Loader;
use shared::machine::{AxisName, HostLost, MachineSettings};
use shared::piece::{Header, Piece};
use shared::safety::Coordinates;

/// A machine that the test has chosen, switched on.
pub fn rig(settings: &MachineSettings) -> Rig {
    Rig::new(Some(settings)).expect("a machine that the test has chosen")
}

/// The settings of the mill with servos among the examples, and what it does with a motion whose host has vanished. Step axes would
/// spend most of a test's time on pulses that nobody looks at.
pub fn mill(host_lost: HostLost) -> MachineSettings {
    let text = include_str!("../../examples/mill-servos.toml");
    let settings = host_sim::machine::from_toml("mill-servos.toml", text).expect("an example");
    MachineSettings { host_lost, ..settings }
}

/// A controller that moves nothing but a z that rests: for jobs in the plane that no axis could follow.
pub fn bystander(capacity: u16) -> Controller {
    let mut machine = mill(HostLost::Finish);
    machine.axes.truncate(1);
    machine.axes.iter_mut().for_each(|axis| axis.name = AxisName::Z);
    Controller::new(ControllerSettings { capacity, machine: Some(machine) }).expect("an example")
}

/// A controller of this mill, with so long a queue.
pub fn controller(capacity: u16, host_lost: HostLost) -> Controller {
    let settings = ControllerSettings { capacity, machine: Some(mill(host_lost)) };
    Controller::new(settings).expect("an example")
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

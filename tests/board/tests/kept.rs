//! The machine that a board is told over the link, and keeps in its flash.

mod common;

use board::jobs::{Kind, job};
use board::line::{JobTalker, Visitors, lock, share};
use board::machine::Mounting;
use board::run::run;
use common::{image, servos};
use shared::link::action::CHUNK_SIZE;
use shared::link::frame::checksum;
use shared::link::{Action, Answer, Chunk, Refusal, SenderError};
use shared::piece::Order;
use shared::safety::Refused;

/// What writes an image.
fn write(image: &[u8]) -> Vec<Action> {
    let parts = (0..).step_by(CHUNK_SIZE).zip(image.chunks(CHUNK_SIZE));
    let mut all: Vec<_> =
        parts.map(|(offset, part)| Action::WriteImage { offset, chunk: Chunk::new(part).unwrap() }).collect();
    all.push(Action::CommitImage { length: image.len() as u16, crc: checksum(image) });
    all
}

/// What reads an image of this length.
fn read(length: usize) -> Vec<Action> {
    (0..length as u16).step_by(CHUNK_SIZE).map(|offset| Action::ReadImage { offset }).collect()
}

/// The bytes that were read.
fn bytes(outcomes: &[(Action, Result<Answer, Refusal>)]) -> Vec<u8> {
    let part = |(_, outcome): &(Action, Result<Answer, Refusal>)| match outcome {
        Ok(Answer::Image { chunk, .. }) => chunk.bytes().unwrap().to_vec(),
        other => panic!("{other:?}"),
    };
    outcomes.iter().flat_map(part).collect()
}

/// Written over the link, a machine restarts the controller, which runs it then; and after the next restart, with nobody telling it
/// anything, it has it from its flash.
#[test]
fn a_machine_is_kept() {
    let told = servos();
    let machine = told.image.clone();
    let visits = [(15_000, write(&machine)), (300_000, read(machine.len())), (600_000, read(machine.len()))];
    let visitors = share(Visitors::new(visits, 800_000));
    let (seen, pins) =
        run(&image(), &told.untold(), visitors.clone(), 1.0, |probe| probe.restart_at(500_000_000)).unwrap();
    let causes: Vec<_> = seen.restarts.iter().map(|(_, cause)| cause.as_str()).collect();
    assert_eq!(causes, ["Core", "Pin"], "{:?}", seen.restarts);
    let visitors = lock(&visitors);
    let [(before, written), (after, first), (again, second)] = &*visitors.visits else {
        panic!("{:?}", visitors.visits)
    };
    assert!(written.iter().all(|(_, outcome)| *outcome == Ok(Answer::Done)), "{written:?}");
    assert_eq!(written.len(), machine.len().div_ceil(CHUNK_SIZE) + 1);
    assert_eq!([before, after, again].map(|identity| identity.unwrap().axes), [0, 2, 2]);
    assert_eq!((bytes(first), bytes(second)), (machine.clone(), machine));
    // Its drives have power after each restart.
    assert_eq!(pins.enables.on, [true, true, false]);
}

/// A controller reads back what it has been told, before it restarts with it: a host makes sure with its next question.
#[test]
fn what_was_written_can_be_read_at_once() {
    let told = servos();
    let machine = told.image.clone();
    let all = write(&machine).into_iter().chain(read(machine.len())).collect();
    let visitors = share(Visitors::new([(15_000, all)], 200_000));
    let (seen, _) = run(&image(), &told.untold(), visitors.clone(), 1.0, |_| {}).unwrap();
    let (_, outcomes) = &lock(&visitors).visits[0];
    assert_eq!(bytes(&outcomes[machine.len().div_ceil(CHUNK_SIZE) + 1..]), machine);
    assert_eq!(seen.restarts.len(), 1);
}

/// A damaged image changes nothing: it is refused, and nobody restarts.
#[test]
fn a_damaged_machine_is_refused() {
    let told = servos();
    let mut all = write(&told.image);
    if let Some(Action::CommitImage { crc, .. }) = all.last_mut() {
        *crc ^= 1;
    }
    let visitors = share(Visitors::new([(15_000, all)], 200_000));
    let (seen, _) = run(&image(), &told.untold(), visitors.clone(), 1.0, |_| {}).unwrap();
    let (_, outcomes) = &lock(&visitors).visits[0];
    assert_eq!(outcomes.last().unwrap().1, Err(Refusal::Image));
    assert!(seen.restarts.is_empty(), "{:?}", seen.restarts);
}

/// A board that was never told a machine moves nothing.
#[test]
fn a_board_without_a_machine_refuses_a_job() {
    let (header, pieces) = job(Kind::Line, Order::First);
    let talker = share(JobTalker::new(header, pieces));
    let (seen, machine) = run(&image(), &Mounting::unknown(), talker.clone(), 2.0, |_| {}).unwrap();
    let error = lock(&talker).error();
    let no_machine = Refusal::Machine(Refused::NoMachine);
    assert!(matches!(error, Some(SenderError::Refused { reason, .. }) if reason == no_machine), "{error:?}");
    assert!(!seen.moved && seen.ticks.is_empty() && machine.enables.changes.is_empty());
}

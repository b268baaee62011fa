//! A controller's end of the link against bytes of any kind, against actions, and against a host that vanishes.
#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use host_sim::controller::{Controller, checksum};
use proptest::prelude::*;
use shared::complex::Complex;
use shared::error::PathError;
use shared::executor::State;
use shared::fixed::Fixed;
use shared::link::{
    Action, Answer, Chunk, Command, Decoder, Endpoint, NO_SESSION, Received, Refusal, Report, Sender, SenderError,
    Telemetry, VERSION, encode,
};
use shared::machine::HostLost;
use shared::motion::MotionCommand;
use shared::pace::PaceLimits;
use shared::piece::{Header, Order, Piece, Shape};
use shared::safety::{Coordinates, Refused};
use tests::bench::{controller, mill};
use tests::link_script::{commands, play, wrap};
use tests::strict_machine::StrictMachine;

const SESSION: u32 = 0x0051_0e55;

const HEADER: Header<f32> =
    Header { weight: 0.0, order: Order::First, closed: false, tolerance: 1e-3, rest: true, pace: PaceLimits::USUAL };

/// A line of 20 mm at 10 mm/s: two seconds.
fn line() -> Piece<f32> {
    let end = Fixed::from_mm(20.0_f32);
    Piece {
        origin: [Fixed(end.0 / 2), Fixed(0)],
        shape: Shape::Line { chord: Complex::new(20.0, 0.0) },
        interval: [0.0, 1.0],
        feed: 10.0,
        start: None,
        end: None,
        profile: None,
        further: None,
        last: Some([end, Fixed(0), Fixed(0)]),
    }
}

fn say(controller: &mut Controller, sequence: u16, command: &Command) -> Vec<Report> {
    let session = if matches!(command, Command::Hello { .. }) { NO_SESSION } else { SESSION };
    // Telemetry of ticks before is no answer.
    controller.take_output();
    controller.receive(&encode(session, sequence, command).unwrap());
    let mut decoder = Decoder::new();
    decoder.enter(SESSION);
    let said = |found: Result<Received<Report>, _>| found.unwrap().message;
    controller.take_output().into_iter().filter_map(|byte| decoder.push(byte)).map(said).collect()
}

fn open(host_lost: HostLost) -> Controller {
    let mut controller = controller(63, host_lost);
    let answer = say(&mut controller, 0, &Command::Hello { version: VERSION, session: SESSION });
    assert!(matches!(answer[..], [Report::Hello { session: SESSION, .. }]), "{answer:?}");
    controller
}

fn running(host_lost: HostLost) -> Controller {
    let mut controller = open(host_lost);
    say(&mut controller, 1, &Command::Begin(HEADER, Coordinates::Relative));
    say(&mut controller, 2, &Command::Piece(line()));
    assert!(matches!(say(&mut controller, 3, &Command::Run)[..], [Report::Ack { next: 4, .. }]));
    controller
}

fn act(controller: &mut Controller, number: u16, action: Action) -> Result<Answer, Refusal> {
    match say(controller, number, &Command::Act(action))[..] {
        [Report::Done { number: found, outcome }] if found == number => outcome,
        ref other => panic!("{other:?}"),
    }
}

fn pass(controller: &mut Controller, ticks: u32) {
    for _ in 0..ticks {
        controller.tick();
    }
}

/// A host that falls silent leaves what was configured: the end of the job, or rest on the path before it.
#[test]
fn a_host_that_vanishes_leaves_what_was_configured() {
    for (host_lost, state) in [(HostLost::Finish, State::Finished), (HostLost::Brake, State::Held)] {
        let mut controller = running(host_lost);
        pass(&mut controller, 8_000);
        assert_eq!(controller.state(), state, "{host_lost:?}");
    }
}

/// A job in the machine's coordinates is refused by a machine that does not know where it is, and nothing starts; the same job from
/// where it stands does.
#[test]
fn coordinates_reach_the_machine() {
    for (known, coordinates, starts) in [
        (false, Coordinates::Machine, false),
        (false, Coordinates::Relative, true),
        (true, Coordinates::Machine, true),
        (true, Coordinates::Relative, true),
    ] {
        let mut machine = StrictMachine::default();
        machine.known = known;
        let (header, pieces) = (HEADER, [line()]);
        let mut sender = Sender::new(SESSION, &header, &pieces).in_coordinates(coordinates);
        let mut endpoint = Endpoint::new();
        for now_us in (0..1_000_000).step_by(1_000) {
            while let Some(frame) = sender.poll(now_us) {
                frame.iter().for_each(|&byte| endpoint.receive(&mut machine, 0, byte));
            }
            for byte in std::mem::take(&mut machine.said) {
                sender.receive(now_us, byte);
            }
        }
        assert_eq!(machine.started, u32::from(starts), "{coordinates:?}, known: {known}");
        let reason = Refusal::Machine(Refused::PositionUnknown { axis: 0 });
        let refused = SenderError::Refused { piece: None, reason };
        assert_eq!(sender.error(), (!starts).then_some(refused));
    }
}

/// A refusal may be lost on its way like anything else, while telemetry says that all was taken. So it is said again to a host that asks,
/// for as long as its session lasts.
#[test]
fn a_refusal_is_said_again() {
    let mut controller = open(HostLost::Finish);
    say(&mut controller, 1, &Command::Begin(HEADER, Coordinates::Relative));
    let faulty = Command::Piece(Piece { feed: -1.0, ..line() });
    let refused = Report::Refused { sequence: 2, reason: Refusal::Path(PathError::Feed { feed: -1.0 }) };
    assert_eq!(say(&mut controller, 2, &faulty), [refused]);
    let run = say(&mut controller, 3, &Command::Run);
    assert_eq!(run, [Report::Refused { sequence: 3, reason: Refusal::NoJob }]);
    let said = say(&mut controller, 4, &Command::Status);
    assert!(matches!(said[..], [Report::Telemetry(Telemetry { next: 4, .. }), again] if again == refused), "{said:?}");
    say(&mut controller, 0, &Command::Hello { version: VERSION, session: SESSION - 1 });
    controller.take_output();
    controller.receive(&encode(SESSION - 1, 1, &Command::Status).unwrap());
    let frames = controller.take_output().into_iter().filter(|&byte| byte == 0).count();
    assert_eq!(frames, 1, "telemetry alone: the next session has nothing to do with it");
}

/// A host that is heard keeps its job to itself. One that has vanished leaves it to the next, which may go on with it, and begins a job
/// of its own only then.
#[test]
fn a_motion_without_a_host_is_left_to_the_next_one() {
    let mut controller = running(HostLost::Brake);
    let ask = |controller: &mut Controller, session: u32, sequence: u16, command: &Command| {
        controller.take_output();
        let session_of = if matches!(command, Command::Hello { .. }) { NO_SESSION } else { session };
        controller.receive(&encode(session_of, sequence, command).unwrap());
        let mut decoder = Decoder::new();
        decoder.enter(session);
        let said = |found: Result<Received<Report>, _>| found.unwrap().message;
        controller.take_output().into_iter().filter_map(|byte| decoder.push(byte)).map(said).last()
    };
    let hello = Command::Hello { version: VERSION, session: SESSION + 1 };
    pass(&mut controller, 100);
    let refused = Some(Report::Refused { sequence: 0, reason: Refusal::Busy });
    assert_eq!(ask(&mut controller, SESSION + 1, 0, &hello), refused);
    pass(&mut controller, 2_500);
    assert_eq!(controller.state(), State::Held);
    assert!(matches!(ask(&mut controller, SESSION + 1, 0, &hello), Some(Report::Hello { .. })));
    assert_eq!(controller.state(), State::Held);
    let begin = Command::Begin(HEADER, Coordinates::Relative);
    let busy = Some(Report::Refused { sequence: 1, reason: Refusal::Busy });
    assert_eq!(ask(&mut controller, SESSION + 1, 1, &begin), busy);
    let resume = Command::Act(Action::Motion(MotionCommand::Resume));
    let done = Some(Report::Done { number: 0, outcome: Ok(Answer::Done) });
    assert_eq!(ask(&mut controller, SESSION + 1, 0, &resume), done);
    for _ in 0..10 {
        pass(&mut controller, 200);
        ask(&mut controller, SESSION + 1, 2, &Command::Status);
    }
    assert_eq!(controller.state(), State::Finished);
    assert!(matches!(ask(&mut controller, SESSION + 1, 2, &begin), Some(Report::Ack { next: 3, .. })));
}

/// A late copy of a hold, a resume or the hello itself changes nothing.
#[test]
fn nothing_is_done_twice() {
    let mut controller = running(HostLost::Finish);
    pass(&mut controller, 100);
    let [hold, resume] = [MotionCommand::Hold, MotionCommand::Resume].map(Action::Motion);
    assert_eq!(act(&mut controller, 0, hold), Ok(Answer::Done));
    pass(&mut controller, 600);
    assert_eq!(controller.state(), State::Held);
    assert_eq!(act(&mut controller, 1, resume), Ok(Answer::Done));
    assert_eq!(say(&mut controller, 0, &Command::Act(hold)), []);
    say(&mut controller, 0, &Command::Hello { version: VERSION, session: SESSION });
    pass(&mut controller, 4_000);
    assert_eq!(controller.state(), State::Finished);
}

#[test]
fn another_version_is_refused() {
    let mut controller = controller(63, HostLost::Finish);
    let answer = say(&mut controller, 0, &Command::Hello { version: VERSION + 1, session: SESSION });
    assert_eq!(answer, [Report::Refused { sequence: 0, reason: Refusal::Version { version: VERSION } }]);
}

/// A configuration image goes there in chunks and comes back the same; one that is not whole is not kept.
#[test]
fn a_configuration_image_goes_there_and_back() {
    let image = shared::machine::image::encode(&mill(HostLost::Finish)).unwrap();
    let length = image.len() as u16;
    let mut controller = open(HostLost::Finish);
    let mut number = 0..;
    let mut ask = |action| act(&mut controller, number.next().unwrap(), action);
    for (k, part) in image.chunks(64).enumerate() {
        let chunk = Chunk::new(part).unwrap();
        assert_eq!(ask(Action::WriteImage { offset: 64 * k as u16, chunk }), Ok(Answer::Done));
    }
    assert_eq!(ask(Action::CommitImage { length, crc: 1 }), Err(Refusal::Image));
    assert_eq!(ask(Action::CommitImage { length, crc: checksum(&image) }), Ok(Answer::Done));
    let mut back = Vec::new();
    while let Ok(Answer::Image { length: found, chunk, .. }) = ask(Action::ReadImage { offset: back.len() as u16 }) {
        assert_eq!(found, length);
        match chunk.bytes().unwrap() {
            [] => break,
            bytes => back.extend_from_slice(bytes),
        }
    }
    assert_eq!(back, image.as_slice());
    // What is no machine is not kept, whole or not.
    let noise = Chunk::new(&[7; 64]).unwrap();
    assert_eq!(ask(Action::WriteImage { offset: 0, chunk: noise }), Ok(Answer::Done));
    assert_eq!(ask(Action::CommitImage { length: 64, crc: checksum(&[7; 64]) }), Err(Refusal::Image));
    let chunk = Chunk::new(&[1; 64]).unwrap();
    assert_eq!(ask(Action::WriteImage { offset: 4_090, chunk }), Err(Refusal::Range));
}

#[test]
fn an_override_outside_its_range_is_refused() {
    let mut controller = running(HostLost::Finish);
    for (number, percent) in [0, 201, 255].into_iter().enumerate() {
        let action = Action::Motion(MotionCommand::Override { percent });
        assert_eq!(act(&mut controller, number as u16, action), Err(Refusal::Range));
    }
}

/// What the property below says would be easy to keep if nothing ever reached the machine: good commands do.
#[test]
fn good_commands_of_a_script_reach_the_machine() {
    // As they are, in their turn: begin, two pieces, run, an override; some ticks, and a piece that lacks its end.
    let machine = play(&[0, 0, 0, 0, 1, 0, 0, 2, 0, 0, 5, 0, 0, 13, 0, 7, 1, 0, 3, 0]);
    assert_eq!((machine.taken, machine.started, machine.acted), (3, 1, 1));
    assert!(machine.state().is_moving());
    // The same with pieces that have profiles: they are the last two commands.
    let [timed, arc] = [2, 1].map(|back| (commands().len() - back) as u8);
    let machine = play(&[0, 0, 0, 0, 1, 0, 0, timed, 0, 0, arc, 0, 0, 5, 0, 7, 1]);
    assert_eq!((machine.taken, machine.started), (3, 1));
    assert!(machine.state().is_moving());
}

proptest! {
    /// Any bytes at all: no panic, and nothing moves.
    #[test]
    fn noise_moves_nothing(bytes in proptest::collection::vec(0_u8.., 0..3_000)) {
        let mut controller = open(HostLost::Finish);
        controller.receive(&bytes);
        pass(&mut controller, 50);
        prop_assert_eq!(controller.state(), State::Idle);
        prop_assert_eq!(controller.loaded(), 0);
    }

    /// Whole frames with any content under them, which the CRC does not stop: no panic, and what the decoder lets through keeps to
    /// its range or is refused.
    #[test]
    fn whole_frames_of_anything_are_taken_in_range_or_refused(
        content in proptest::collection::vec((0_u8..6, proptest::collection::vec(0_u8.., 0..100)), 0..20),
    ) {
        let mut controller = open(HostLost::Finish);
        let mut next = 1_u16;
        for (kind, bytes) in content {
            // A tuple of bytes has no length in front, as a message has none; the first one says which command it is.
            let mut body = vec![kind];
            body.extend(bytes);
            controller.receive(&wrap(SESSION, next, &body).unwrap());
            next += u16::from(controller.take_output().len() > 100);
            controller.tick();
        }
        prop_assert!(controller.queued() <= 63);
        let setpoint = controller.setpoint();
        prop_assert!(setpoint.iter().all(|coordinate| coordinate.is_in_reach()));
    }

    /// Conversations of whole, damaged and misplaced commands, in any order: nothing out of range ever reaches the machine, which
    /// panics where it does. The same as `cargo fuzz run endpoint`.
    #[test]
    fn nothing_out_of_range_reaches_the_machine(script in proptest::collection::vec(0_u8.., 0..600)) {
        play(&script);
    }
}

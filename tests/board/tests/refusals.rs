//! Faulty frames and faulty jobs are refused by the image that is flashed, and nothing moves.

mod common;

use board::image::Image;
use board::jobs::{Kind, job};
use board::line::{SESSION, Script, lock, share};
use board::probe::Seen;
use board::run::run;
use common::{image, servos};
use shared::complex::Complex;
use shared::error::PathError;
use shared::feed::Ramp;
use shared::fixed::Fixed;
use shared::link::{Command, FRAME_SIZE, FrameError, LinkError, NO_SESSION, Refusal, Report, VERSION, encode};
use shared::piece::{Header, Order, Piece, Shape, SplineShape};
use shared::safety::Coordinates;

/// Long enough for the answer to come back and for many ticks to show what they do.
const GAP_US: u64 = 20_000;

/// Says `lines` to the controller and returns what it answered and what it did.
fn say(image: &Image, lines: Vec<Vec<u8>>) -> (Vec<Report>, Seen) {
    let script = share(Script::new(lines, GAP_US));
    let (seen, _) = run(image, &servos(), script.clone(), 5.0, |_| {}).unwrap();
    let reports = lock(&script).reports.clone();
    (reports, seen)
}

fn frame(sequence: u16, command: &Command) -> Vec<u8> {
    let session = if matches!(command, Command::Hello { .. }) { NO_SESSION } else { SESSION };
    encode(session, sequence, command).unwrap().to_vec()
}

fn hello() -> Vec<u8> {
    frame(0, &Command::Hello { version: VERSION, session: SESSION })
}

/// The refusals among some reports.
fn refusals(reports: &[Report]) -> Vec<Refusal> {
    let reason = |report: &Report| match report {
        Report::Refused { reason, .. } => Some(*reason),
        _ => None,
    };
    reports.iter().filter_map(reason).collect()
}

/// Loads a job as a sender that does not look at the answers, starts it, and returns the first refusal. Nothing may have moved.
fn refusal_of(image: &Image, header: Header<f32>, pieces: &[Piece<f32>]) -> Refusal {
    let mut commands = vec![Command::Begin(header, Coordinates::Relative)];
    commands.extend(pieces.iter().copied().map(Command::Piece));
    commands.push(Command::Run);
    let mut lines = vec![hello()];
    lines.extend(commands.iter().zip(1..).map(|(command, sequence)| frame(sequence, command)));
    let (reports, seen) = say(image, lines);
    assert!(!seen.moved && seen.ticks.is_empty(), "something moved");
    assert!(seen.interrupts > 20, "the tick goes on");
    assert!(!reports.iter().any(|report| matches!(report, Report::Finished { .. })));
    *refusals(&reports).first().unwrap()
}

fn good(kind: Kind) -> (Header<f32>, Vec<Piece<f32>>) {
    job(kind, Order::First)
}

/// The job with its first piece changed.
fn changed(kind: Kind, change: impl FnOnce(&mut Piece<f32>)) -> (Header<f32>, Vec<Piece<f32>>) {
    let (header, mut pieces) = good(kind);
    change(&mut pieces[0]);
    (header, pieces)
}

#[test]
fn a_good_job_moves() {
    let (header, pieces) = good(Kind::Line);
    let mut lines = vec![hello(), frame(1, &Command::Begin(header, Coordinates::Relative))];
    lines.extend(pieces.iter().zip(2..).map(|(piece, sequence)| frame(sequence, &Command::Piece(*piece))));
    lines.push(frame(4, &Command::Run));
    let (reports, seen) = say(&image(), lines);
    assert_eq!(refusals(&reports), []);
    assert!(seen.moved && seen.ticks.len() > 10);
}

#[test]
fn faulty_headers_are_refused() {
    let (image, (header, pieces)) = (image(), good(Kind::Line));
    for weight in [-0.1, 1.5, f32::NAN] {
        let reason = refusal_of(&image, Header { weight, ..header }, &pieces);
        assert!(matches!(reason, Refusal::Path(PathError::Weight { .. })), "{reason}");
    }
    for tolerance in [0.0, f32::INFINITY] {
        let reason = refusal_of(&image, Header { tolerance, ..header }, &pieces);
        assert!(matches!(reason, Refusal::Path(PathError::Tolerance { .. })), "{reason}");
    }
    // The line is some 20 mm long, so its end is not its start.
    let reason = refusal_of(&image, Header { closed: true, ..header }, &pieces);
    assert!(matches!(reason, Refusal::Path(PathError::Open { width }) if width > 19.0), "{reason}");
    assert_eq!(refusal_of(&image, header, &[]), Refusal::Path(PathError::Empty));
}

#[test]
fn faulty_feeds_and_ramps_are_refused() {
    let image = image();
    for feed in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let (header, pieces) = changed(Kind::Ph, |piece| piece.feed = feed);
        let reason = refusal_of(&image, header, &pieces);
        assert!(matches!(reason, Refusal::Path(PathError::Feed { .. })), "{feed}: {reason}");
    }
    for factor in [0.0, -0.5, 1.1, f32::NAN] {
        let (header, pieces) = changed(Kind::Ph, |piece| piece.start = Some(Ramp { length: 0.25, factor }));
        let reason = refusal_of(&image, header, &pieces);
        assert!(matches!(reason, Refusal::Path(PathError::Reduction { .. })), "{factor}: {reason}");
    }
    let (header, pieces) = changed(Kind::Ph, |piece| {
        piece.start = Some(Ramp { length: 0.75, factor: 0.5 });
        piece.end = Some(Ramp { length: 0.5, factor: 0.5 });
    });
    let reason = refusal_of(&image, header, &pieces);
    assert!(matches!(reason, Refusal::Path(PathError::Ramps { sum }) if sum == 1.25), "{reason}");
}

#[test]
fn faulty_pieces_are_refused() {
    let image = image();
    for interval in [[0.5, 0.5], [0.7, 0.3], [-0.1, 0.5], [0.5, 1.1], [f32::NAN, 1.0]] {
        let (header, pieces) = changed(Kind::Ph, |piece| piece.interval = interval);
        let reason = refusal_of(&image, header, &pieces);
        assert!(matches!(reason, Refusal::Path(PathError::Interval { .. })), "{interval:?}: {reason}");
    }
    let (header, pieces) = changed(Kind::Line, |piece| piece.shape = Shape::Line { chord: Complex::new(0.0, 0.0) });
    let reason = refusal_of(&image, header, &pieces);
    assert!(matches!(reason, Refusal::Path(PathError::Length { .. })), "{reason}");

    // The second piece begins 0.5 mm beside the end of the first.
    let (header, mut pieces) = good(Kind::Arc);
    pieces[1].origin[0] = Fixed(pieces[1].origin[0].0 + 131_072);
    let reason = refusal_of(&image, header, &pieces);
    assert!(matches!(reason, Refusal::Path(PathError::Gap { width }) if (width - 0.5).abs() < 1e-3), "{reason}");

    // w = 1 + i tau: sigma = 1 and kappa = 2 in the middle, so that 1 + kappa d vanishes there at d = -1/2.
    let cusp =
        Shape::Ph { preimage: [Complex::new(1.0, 0.0), Complex::new(0.0, 1.0), Complex::new(0.0, 0.0)], offset: -0.5 };
    let (header, pieces) = changed(Kind::Ph, |piece| piece.shape = cusp);
    assert_eq!(refusal_of(&image, header, &pieces), Refusal::Path(PathError::Cusp));
}

#[test]
fn faulty_splines_are_refused() {
    let image = image();
    let refusal = |change: &dyn Fn(&mut SplineShape<f32>)| {
        let (header, pieces) = changed(Kind::Spline, |piece| {
            let Shape::Spline(shape) = &mut piece.shape else { panic!("another shape") };
            change(shape);
        });
        refusal_of(&image, header, &pieces)
    };
    let plane = |coefficients: [(f32, f32); 3]| {
        let [a, b, c] = coefficients.map(|(x, y)| Complex::new(x, y));
        [a, b, c, Complex::ZERO, Complex::ZERO]
    };
    // (v^2, v^3) in units of 10 mm stands still at its cusp.
    let cusp = plane([(0.0, 0.0), (10.0, 0.0), (0.0, 10.0)]);
    assert_eq!(refusal(&|shape| shape.plane = cusp), Refusal::Path(PathError::Standstill));
    // 100 times as fast at its ends as in the middle, where it does not stand still.
    let uneven = plane([(0.1, 0.0), (0.0, 0.0), (13.2, 0.0)]);
    assert_eq!(refusal(&|shape| shape.plane = uneven), Refusal::Path(PathError::Uneven));
    for number in [f32::NAN, f32::INFINITY] {
        assert_eq!(refusal(&|shape| shape.plane[4].im = number), Refusal::Path(PathError::NotFinite));
    }
    // z bends, and nobody says between which ends.
    assert_eq!(refusal(&|shape| shape.bow[0] = 1.0), Refusal::Path(PathError::Bow));
}

/// A frame that did not arrive whole is answered with what is expected, and the same command is taken when it comes again.
#[test]
fn faulty_frames_are_refused_and_forgotten() {
    let image = image();
    let (header, _) = good(Kind::Line);
    let begin = frame(1, &Command::Begin(header, Coordinates::Relative));
    let mut corrupted = begin.clone();
    corrupted[3] ^= 0x40;
    let mut truncated = begin[..begin.len() - 6].to_vec();
    truncated.push(0);
    let mut oversized = vec![7; 4 * FRAME_SIZE];
    oversized.push(0);
    let unknown = encode(SESSION, 1, &(77_u8, [1_u8; 9])).unwrap().to_vec();
    let gap = frame(5, &Command::Run);

    let (reports, seen) = say(&image, vec![hello(), corrupted, truncated, oversized, unknown, gap, begin]);
    let link = |error| Refusal::Link(error);
    let is_damaged = |reason: &Refusal| {
        [FrameError::Corrupted, FrameError::Truncated].map(LinkError::Frame).map(Refusal::Link).contains(reason)
    };
    let found = refusals(&reports);
    let [first, second, rest @ ..] = &*found else { panic!("{found:?}") };
    assert!(is_damaged(first) && is_damaged(second), "{found:?}");
    assert_eq!(
        rest,
        [
            link(LinkError::Frame(FrameError::Oversized)),
            link(LinkError::Frame(FrameError::Unknown)),
            link(LinkError::Gap { found: 5 })
        ]
    );
    assert!(reports.iter().all(|report| !matches!(report, Report::Refused { sequence, .. } if *sequence != 1)));
    assert!(reports.iter().any(|report| matches!(report, Report::Ack { next: 2, .. })), "{reports:?}");
    assert!(!seen.moved && seen.ticks.is_empty());
}

#[test]
fn a_start_without_a_job_and_another_version_are_refused() {
    let image = image();
    let lines =
        vec![hello(), frame(1, &Command::Run), frame(0, &Command::Hello { version: VERSION + 1, session: SESSION })];
    let (reports, seen) = say(&image, lines);
    assert_eq!(refusals(&reports), [Refusal::NoJob, Refusal::Version { version: VERSION }]);
    assert!(!seen.moved);
}

/// What is heard twice is done once.
#[test]
fn a_repeated_piece_is_acknowledged_and_not_queued() {
    let (header, pieces) = good(Kind::Line);
    let piece = frame(2, &Command::Piece(pieces[0]));
    let (reports, _) =
        say(&image(), vec![hello(), frame(1, &Command::Begin(header, Coordinates::Relative)), piece.clone(), piece]);
    let rooms: Vec<u16> = reports
        .iter()
        .filter_map(|report| match report {
            Report::Ack { next: 3, room } => Some(*room),
            _ => None,
        })
        .collect();
    assert!(rooms.len() == 2 && rooms[0] == rooms[1], "{reports:?}");
}

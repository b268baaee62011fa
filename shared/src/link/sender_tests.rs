//! A sender against a model of the controller, over a line that loses, doubles and damages frames.

extern crate std;

use self::std::collections::VecDeque;
use self::std::vec::Vec;

use proptest::prelude::*;

use super::super::message::Identity;
use super::super::receiver::{Receiver, Turn};
use super::*;
use crate::complex::Complex;
use crate::error::PathError;
use crate::fixed::Fixed;
use crate::pace::PaceLimits;
use crate::piece::{Order, Shape};

const SESSION: u32 = 0x1234_5678;

const HEADER: Header<f32> =
    Header { weight: 0.0, order: Order::First, closed: false, tolerance: 1e-3, rest: false, pace: PaceLimits::USUAL };

fn pieces(count: usize) -> Vec<Piece<f32>> {
    let piece = |index| Piece {
        origin: [Fixed(index as i32); 2],
        shape: Shape::Line { chord: Complex::new(1.0, 0.0) },
        interval: [0.0, 1.0],
        feed: 1.0,
        start: None,
        end: None,
        profile: None,
        further: None,
        last: None,
    };
    (0..count).map(piece).collect()
}

/// A controller that keeps every piece it took, and executes one each time it is asked to.
struct Model {
    decoder: Decoder,
    receiver: Receiver,
    capacity: usize,
    queued: usize,
    taken: Vec<i32>,
    running: bool,
    /// Refuses the piece of this origin.
    faulty: Option<i32>,
}

impl Model {
    fn new(capacity: usize) -> Self {
        let (decoder, receiver) = (Decoder::new(), Receiver::new());
        Self { decoder, receiver, capacity, queued: 0, taken: Vec::new(), running: false, faulty: None }
    }

    fn hear(&mut self, byte: u8) -> Option<Report> {
        let found = self.decoder.push(byte)?;
        let ack =
            |model: &Self| Report::Ack { next: model.receiver.next(), room: (model.capacity - model.queued) as u16 };
        Some(match self.receiver.turn(found) {
            Turn::Take(_, Command::Hello { session, .. }) => {
                if session != self.receiver.session() {
                    self.receiver.open(session);
                    self.decoder.enter(session);
                }
                let identity = Identity { capacity: self.capacity as u16, ..Identity::default() };
                Report::Hello { version: VERSION, session, identity }
            }
            Turn::Take(sequence, Command::Piece(piece)) if self.faulty == Some(piece.origin[0].0) => {
                Report::Refused { sequence, reason: Refusal::Path(PathError::Cusp) }
            }
            Turn::Take(_, Command::Piece(piece)) => {
                assert!(self.queued < self.capacity, "more pieces than there was room for");
                self.queued += 1;
                self.taken.push(piece.origin[0].0);
                ack(self)
            }
            Turn::Take(_, command) => {
                self.running |= matches!(command, Command::Run);
                ack(self)
            }
            Turn::Repeated | Turn::RepeatedAction(_) | Turn::Ignore => ack(self),
            Turn::Refuse(reason) => Report::Refused { sequence: self.receiver.next(), reason: Refusal::Link(reason) },
        })
    }
}

/// Runs a job over a line that treats each frame as `fates` say, in turn: 0 loses it, 1 doubles it, 2 damages it, others pass.
fn converse(pieces: &[Piece<f32>], model: &mut Model, fates: &[u8]) -> (Option<SenderError>, u32) {
    let mut sender = Sender::new(SESSION, &HEADER, pieces);
    let mut fates = fates.iter().copied();
    let (mut down, mut up) = (VecDeque::new(), VecDeque::new());
    for step in 0..200_000_u64 {
        let now = step * 2_000;
        while let Some(frame) = sender.poll(now) {
            travel(&mut down, &frame, fates.next());
        }
        for byte in down.drain(..) {
            if let Some(report) = model.hear(byte) {
                travel(&mut up, &said(&report), fates.next());
            }
        }
        if model.running && model.queued > 0 {
            model.queued -= 1;
            let room = (model.capacity - model.queued) as u16;
            travel(&mut up, &said(&Report::Ack { next: model.receiver.next(), room }), fates.next());
        }
        for byte in up.drain(..) {
            sender.receive(now, byte);
        }
        let done = sender.acknowledged_pieces() == pieces.len() as u32 && model.queued == 0 && model.running;
        if done || sender.error().is_some() {
            break;
        }
    }
    (sender.error(), sender.resent())
}

fn said(report: &Report) -> Frame {
    let session = if matches!(report, Report::Hello { .. }) { NO_SESSION } else { SESSION };
    encode(session, 0, report).unwrap()
}

fn travel(line: &mut VecDeque<u8>, frame: &[u8], fate: Option<u8>) {
    match fate {
        Some(0) => {}
        Some(1) => line.extend(frame.iter().chain(frame)),
        Some(2) => line.extend(frame.iter().map(|&byte| if byte == 1 { 3 } else { byte })),
        _ => line.extend(frame),
    }
}

#[test]
fn over_a_good_line_nothing_is_sent_twice() {
    for (count, capacity) in [(1, 8), (8, 8), (9, 8), (500, 8), (70_000, 64)] {
        let mut model = Model::new(capacity);
        assert_eq!(converse(&pieces(count), &mut model, &[]), (None, 0));
        assert!(model.taken.iter().copied().eq(0..count as i32));
    }
}

#[test]
fn a_refused_piece_is_named_and_nothing_runs() {
    let mut model = Model::new(64);
    model.faulty = Some(17);
    let reason = Refusal::Path(PathError::Cusp);
    assert_eq!(converse(&pieces(40), &mut model, &[]).0, Some(SenderError::Refused { piece: Some(17), reason }));
    assert!(!model.running);
}

#[test]
fn a_dead_line_ends_in_an_error() {
    let mut sender = Sender::new(SESSION, &HEADER, &[]);
    let sent = (0..1_000).filter(|&step| sender.poll(step * 10_000).is_some()).count();
    assert_eq!((sent, sender.error()), (TRIES as usize, Some(SenderError::Lost { reason: None })));
}

proptest! {
    /// Whatever the line does to the first frames, every piece arrives once and in order; or, where chance loses them all for
    /// long enough, the sender says so and what has arrived is the start of the job.
    #[test]
    fn a_bad_line_changes_nothing(count in 1_usize..60, capacity in 1_usize..20, fates in proptest::collection::vec(0_u8..6, 0..80)) {
        let mut model = Model::new(capacity);
        let (error, _) = converse(&pieces(count), &mut model, &fates);
        prop_assert!(model.taken.iter().copied().eq(0..model.taken.len() as i32));
        match error {
            None => prop_assert_eq!(model.taken.len(), count),
            Some(error) => prop_assert!(matches!(error, SenderError::Lost { .. }), "{}", error),
        }
    }
}

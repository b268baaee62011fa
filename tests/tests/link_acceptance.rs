//! Ten thousand transfers over a line that loses, doubles, reorders, damages and cuts frames.
//!
//! Every job arrives whole and once, or the sender names what went wrong and the controller comes to rest on the path. What ran is
//! compared with what a controller does that got the same pieces without a line.
#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use host_sim::controller::Controller;
use shared::complex::Complex;
use shared::executor::State;
use shared::fixed::{Fixed, Position};
use shared::link::{Event, Refusal, Sender, SenderError};
use shared::machine::HostLost;
use shared::pace::PaceLimits;
use shared::piece::{Header, Order, Piece, Shape};
use shared::safety::Coordinates;
use tests::bench::controller;
use tests::noisy_line::{Faults, NoisyLine};
use tests::random::Random;

const HEADER: Header<f32> =
    Header { weight: 0.0, order: Order::First, closed: false, tolerance: 1e-3, rest: true, pace: PaceLimits::USUAL };

/// A queue that holds less than many of the jobs.
const CAPACITY: u16 = 16;

/// A tick in microseconds, rounded.
const TICK_US: u64 = 977;

/// A polyline of steps of a 32nd of a millimetre to random sides: no two jobs are the same way.
fn polyline(random: &mut Random, count: usize) -> (Vec<Piece<f32>>, Vec<[i32; 2]>) {
    const STEP: i32 = 8_192;
    let mut points = vec![[0, 0]];
    let mut pieces = Vec::new();
    for k in 0..count {
        let [x, y] = *points.last().unwrap();
        let step = |random: &mut Random| STEP * (random.whole(0, 4) as i32 - 2);
        let (dx, dy) = (STEP, step(random));
        points.push([x + dx, y + dy]);
        let mm = |units: i32| units as f32 / 262_144.0;
        pieces.push(Piece {
            origin: [Fixed(x + dx / 2), Fixed(y + dy / 2)],
            shape: Shape::Line { chord: Complex::new(mm(dx), mm(dy)) },
            interval: [0.0, 1.0],
            feed: 20.0,
            start: None,
            end: None,
            profile: None,
            further: None,
            last: (k + 1 == count).then_some([Fixed(x + dx), Fixed(y + dy), Fixed(0)]),
        });
    }
    (pieces, points)
}

/// Whether a setpoint is on the polyline, to a hundred units: 0.4 um.
fn is_on(points: &[[i32; 2]], [x, y, _]: Position) -> bool {
    let (x, y) = (f64::from(x.0), f64::from(y.0));
    points.windows(2).any(|ends| {
        let [[x0, y0], [x1, y1]] = [ends[0], ends[1]].map(|point| point.map(f64::from));
        let u = ((x - x0) / (x1 - x0)).clamp(0.0, 1.0);
        (x - x0 - u * (x1 - x0)).hypot(y - y0 - u * (y1 - y0)) < 100.0
    })
}

/// The hash of the job on a controller that has all of it in its queue: the same job over a line without a fault.
fn expected(pieces: &[Piece<f32>]) -> (u32, u64) {
    let mut clean = Rig::new(0);
    let outcome = clean.transfer(1, pieces, &[], 0);
    let Outcome::Finished { ticks, hash } = outcome else { panic!("{outcome:?}") };
    (ticks, hash)
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Outcome {
    Finished { ticks: u32, hash: u64 },
    Failed(SenderError),
}

/// A controller and the two directions of its line.
struct Rig {
    controller: Controller,
    down: NoisyLine,
    up: NoisyLine,
    now: u64,
    resent: u64,
}

impl Rig {
    fn new(seed: u64) -> Self {
        let controller = controller(CAPACITY, HostLost::Finish);
        let line = |seed| NoisyLine::new(Faults::default(), seed);
        Self { controller, down: line(2 * seed), up: line(2 * seed + 1), now: 0, resent: 0 }
    }

    /// One transfer. The setpoints are looked at from `from` on, which leaves out where the path before ended.
    fn transfer(&mut self, session: u32, pieces: &[Piece<f32>], points: &[[i32; 2]], seed: u32) -> Outcome {
        let mut sender = Sender::new(session, &HEADER, pieces).in_coordinates(Coordinates::Relative);
        let loaded = self.controller.loaded();
        let start = self.now;
        loop {
            let now_us = self.now * TICK_US;
            while let Some(frame) = sender.poll(now_us) {
                self.down.send(self.now, &frame);
            }
            self.tick(points, seed);
            for byte in self.up.receive(self.now) {
                if let Some(Event::Finished { ticks, hash, .. }) = sender.receive(now_us, byte) {
                    // Whole and once.
                    assert_eq!(self.controller.loaded() - loaded, pieces.len() as u64, "transfer {seed}");
                    self.resent += u64::from(sender.resent());
                    return Outcome::Finished { ticks, hash };
                }
            }
            if let Some(error) = sender.error() {
                assert!(self.controller.loaded() - loaded <= pieces.len() as u64);
                return Outcome::Failed(error);
            }
            assert!(self.now - start < 60_000, "transfer {seed} neither ends nor fails");
        }
    }

    fn tick(&mut self, points: &[[i32; 2]], seed: u32) {
        self.now += 1;
        self.controller.receive(&self.down.receive(self.now));
        let setpoint = self.controller.tick();
        if !points.is_empty() && self.controller.state().is_moving() {
            assert!(is_on(points, setpoint), "transfer {seed}: {setpoint:?} is not on the path");
        }
        self.up.send(self.now, &self.controller.take_output());
    }

    /// After a failure: the controller rests without its host, on the path.
    fn comes_to_rest(&mut self, points: &[[i32; 2]], seed: u32) {
        for _ in 0..4_000 {
            self.tick(points, seed);
        }
        let state = self.controller.state();
        assert!(
            matches!(state, State::Idle | State::Starved | State::Finished | State::Cancelled),
            "transfer {seed}: {state:?}"
        );
    }
}

#[test]
fn ten_thousand_transfers_arrive_whole_and_once_or_fail_by_name() {
    const TRANSFERS: u32 = 10_000;
    // How bad, and how late; the last ones are hardly a line any more.
    const LINES: [(f64, usize); 5] = [(0.005, 5), (0.02, 40), (0.05, 200), (0.15, 60), (0.35, 400)];
    let mut random = Random::new(4);
    let mut rig = Rig::new(1);
    let mut finished = [0_u32; LINES.len()];
    let (mut spoiled, mut resent) = (0, 0);
    for seed in 0..TRANSFERS {
        let kind = seed as usize % LINES.len();
        let (probability, latest) = LINES[kind];
        let count = random.whole(1, 40);
        let (pieces, points) = polyline(&mut random, count);
        let faults = Faults::each(probability, latest);
        rig.down.become_as(faults);
        rig.up.become_as(faults);
        // What a transfer leaves on the line arrives in the next one.
        match rig.transfer(seed + 100, &pieces, &points, seed) {
            Outcome::Finished { ticks, hash } => {
                finished[kind] += 1;
                assert_eq!(rig.controller.setpoint(), pieces[pieces.len() - 1].last.unwrap());
                // What fits into the queue is there before it starts, and runs as on a good line, bit by bit. Of a longer job the tick
                // sees less at a time, and may brake where a late piece comes just in time.
                if pieces.len() <= usize::from(CAPACITY) {
                    assert_eq!((ticks, hash), expected(&pieces), "transfer {seed}");
                }
            }
            Outcome::Failed(error) => {
                // Where nothing came through for 1.5 s, the controller has forgotten what it had loaded, and says so of the next piece.
                let named = match error {
                    SenderError::Lost { .. } | SenderError::Refused { piece: None, .. } => true,
                    SenderError::Refused { piece: Some(_), reason } => reason == Refusal::NoJob,
                };
                assert!(named, "{error}");
                rig.comes_to_rest(&points, seed);
                spoiled += rig.down.spoiled + rig.up.spoiled;
                resent += rig.resent;
                rig = Rig::new(u64::from(seed) + 1_000);
            }
        }
    }
    spoiled += rig.down.spoiled + rig.up.spoiled;
    resent += rig.resent;
    println!("finished of {} each: {finished:?}; {spoiled} frames spoiled, {resent} commands resent", TRANSFERS / 5);
    // Up to one fault in twenty of each kind, no transfer fails.
    let each = TRANSFERS / LINES.len() as u32;
    assert_eq!(finished[..3], [each; 3]);
    assert!(spoiled > 100_000 && resent > 10_000);
}

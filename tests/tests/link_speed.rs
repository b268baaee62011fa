//! What the link carries: bytes and times of the real frames, acknowledgements and telemetry included, at 8N1.
//!
//! `cargo test -p tests --test link_speed -- --nocapture` prints the figures that stand in `docs/link.md`.
#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use std::collections::VecDeque;

use host_sim::job::Job;
use host_sim::path::Path;
use shared::executor::State;
use shared::link::sender::RECEIVE_SIZE;
use shared::link::{Command, Event, Report, Sender, encode};
use shared::piece::{Header, Order, Piece, Shape};
use shared::safety::Coordinates;
use tests::bench::bystander;

const SESSION: u32 = 0x1234_5678;

/// What a USB adapter may keep bytes for, each way, in microseconds: the usual default of its latency timer.
const ADAPTER_US: f64 = 16_000.0;

/// One direction of a serial line: so many bytes a second, ten bits each, which arrive so much later.
struct Wire {
    byte_us: f64,
    latency_us: f64,
    free_at: f64,
    bytes: VecDeque<(f64, u8)>,
    carried: u64,
}

impl Wire {
    fn new(baud: u32, latency_us: f64) -> Self {
        Self { byte_us: 1e7 / f64::from(baud), latency_us, free_at: 0.0, bytes: VecDeque::new(), carried: 0 }
    }

    fn send(&mut self, now: f64, bytes: &[u8]) {
        for &byte in bytes {
            self.free_at = self.free_at.max(now) + self.byte_us;
            self.bytes.push_back((self.free_at + self.latency_us, byte));
        }
        self.carried += bytes.len() as u64;
    }

    fn receive(&mut self, now: f64) -> Option<u8> {
        let (due, _) = self.bytes.front()?;
        if *due <= now { self.bytes.pop_front().map(|(_, byte)| byte) } else { None }
    }
}

struct Seen {
    /// Time in s until all pieces were taken.
    loaded_s: f64,
    starved: bool,
    resent: u32,
    down: u64,
    up: u64,
}

/// Pieces that the firmware's queue holds.
const FIRMWARE: u16 = 63;

/// Sends a job over a line of `baud` and a latency each way to a controller with so long a queue, in virtual time.
fn send(
    baud: u32,
    latency_us: f64,
    capacity: u16,
    header: &Header<f32>,
    pieces: &[Piece<f32>],
    until_loaded: bool,
) -> Seen {
    const STEPS: u64 = 16;
    let mut controller = bystander(capacity);
    let mut sender = Sender::new(SESSION, header, pieces).in_coordinates(Coordinates::Relative).at_baud(baud);
    let (mut down, mut up) = (Wire::new(baud, latency_us), Wire::new(baud, latency_us));
    let mut seen = Seen { loaded_s: 0.0, starved: false, resent: 0, down: 0, up: 0 };
    for step in 0.. {
        let now = step as f64 * 1e6 / 1024.0 / STEPS as f64;
        // A port takes all that the sender wants to send.
        while let Some(frame) = sender.poll(now as u64) {
            down.send(now, &frame);
            assert!(down.bytes.len() <= RECEIVE_SIZE, "more than a controller can hold");
        }
        while let Some(byte) = down.receive(now) {
            controller.receive(&[byte]);
        }
        if step % STEPS == 0 {
            controller.tick();
            seen.starved |= matches!(controller.state(), State::Starved | State::Braking);
        }
        up.send(now, &controller.take_output());
        let mut finished = false;
        while let Some(byte) = up.receive(now) {
            finished |= matches!(sender.receive(now as u64, byte), Some(Event::Finished { .. }));
        }
        assert_eq!(sender.error(), None);
        let loaded = sender.acknowledged_pieces() as usize == pieces.len();
        if loaded && seen.loaded_s == 0.0 {
            seen.loaded_s = now / 1e6;
        }
        if finished || (until_loaded && loaded) {
            break;
        }
        assert!(now < 1e9, "the job does not end");
    }
    Seen { resent: sender.resent(), down: down.carried, up: up.carried, ..seen }
}

fn paper() -> (Header<f32>, Vec<Piece<f32>>) {
    let job = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/farouki2018.toml");
    let path = Path::new(&Job::read(job).unwrap(), Order::First).unwrap();
    let pieces = path.wire().collect();
    (path.header, pieces)
}

#[test]
fn the_link_is_fast_enough() {
    let (header, pieces) = paper();
    let ph: Vec<_> = pieces.iter().filter(|piece| matches!(piece.shape, Shape::Ph { .. })).collect();
    let bytes: Vec<usize> =
        ph.iter().map(|piece| encode(SESSION, 300, &Command::Piece(**piece)).unwrap().len()).collect();
    let (mean, most) = (bytes.iter().sum::<usize>() as f64 / bytes.len() as f64, *bytes.iter().max().unwrap());
    let ack = encode(SESSION, 300, &Report::Ack { next: 300, room: 60 }).unwrap().len();
    println!("a PH piece takes {mean:.1} bytes in the mean and {most} at most; its acknowledgement {ack}");

    // Long chains of PH pieces that run as fast as they come: one of the paper's again and again, without ramps and with both.
    let (_, longest) = bytes.iter().zip(&ph).max_by_key(|(bytes, _)| **bytes).unwrap();
    for (baud, latency_us, least) in
        [(115_200, 0.0, 100.0), (115_200, ADAPTER_US, 100.0), (1_000_000, 0.0, 600.0), (1_000_000, ADAPTER_US, 600.0)]
    {
        let plain = Piece { start: None, end: None, ..*ph[0] };
        // A queue that is longer than the job shows the line alone: no motion waits for pieces, and no piece for the motion.
        for (what, piece, capacity) in
            [("plain", plain, FIRMWARE), ("plain", plain, 1_000), ("the longest", **longest, 1_000)]
        {
            let (fast, chain) = chain(&header, &piece, 600);
            let size = encode(SESSION, 300, &Command::Piece(chain[0])).unwrap().len();
            let seen = send(baud, latency_us, capacity, &fast, &chain, true);
            let rate = chain.len() as f64 / seen.loaded_s;
            println!(
                "{baud} baud, {} ms each way: {rate:.0}/s of {what} PH pieces of {size} bytes into a queue of {capacity}; {} bytes down and {} up for {}; resent {}",
                latency_us / 1e3,
                seen.down,
                seen.up,
                chain.len(),
                seen.resent
            );
            assert!(rate >= least, "{rate} pieces/s at {baud} baud");
            assert_eq!(seen.resent, 0);
        }
    }
    for latency_us in [0.0, ADAPTER_US] {
        let seen = send(115_200, latency_us, FIRMWARE, &header, &pieces, false);
        assert!(!seen.starved, "the paper's path starves");
        assert_eq!(seen.resent, 0);
    }
}

/// `count` copies of a piece at a feed that no line keeps up with. They all lie on one another, which a tolerance for gaps of a
/// metre does not mind: it is the line that is measured.
fn chain(header: &Header<f32>, piece: &Piece<f32>, count: usize) -> (Header<f32>, Vec<Piece<f32>>) {
    let piece = Piece { feed: 200_000.0, last: None, ..*piece };
    (Header { closed: false, rest: false, tolerance: 1e3, ..*header }, vec![piece; count])
}

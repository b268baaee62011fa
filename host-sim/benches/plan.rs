//! What a plan costs.
//!
//! `cargo bench -p host-sim --bench plan` prints two things in one run: the pieces a second that one core plans of a chain of 100 000 short
//! lines, with the jerk of the router and without, as a whole and while it comes; and criterion's measurements of the examples, with the
//! pieces of their paths as elements.

#![allow(missing_docs, clippy::unwrap_used, reason = "benchmark code")]

use std::hint::black_box;
use std::time::Instant;

use criterion::{Criterion, Throughput, criterion_group};
use host_sim::job::Job;
use host_sim::machine;
use host_sim::path::{Path, PathPiece};
use host_sim::plan::{Limits, Manner, Streamed, plan};
use shared::complex::Complex;
use shared::curve::{Line, Segment};
use shared::piece::Order;

const MACHINE: &str = include_str!("../../examples/machine.toml");
const EXAMPLES: [(&str, &str); 4] = [
    ("bracket", include_str!("../../examples/bracket.toml")),
    ("fan", include_str!("../../examples/fan.toml")),
    ("farouki2018", include_str!("../../examples/farouki2018.toml")),
    ("pocket", include_str!("../../examples/pocket.toml")),
];

/// Lines of the chain, and the length of each in mm.
const LINES: usize = 100_000;
const LENGTH: f64 = 0.05;
/// Runs of which the fastest counts.
const RUNS: u32 = 5;

fn router() -> Limits {
    Limits::of(&machine::from_toml("machine.toml", MACHINE).unwrap(), &Default::default()).unwrap()
}

fn without_jerk(limits: Limits) -> Limits {
    Limits { jerk: [f64::INFINITY; 3], ..limits }
}

fn path(name: &str, text: &str) -> Path {
    Path::new(&Job::from_toml(name, text).unwrap(), Order::First).unwrap()
}

/// A meandering way of lines, as a program has them.
fn chain() -> Vec<PathPiece> {
    let text = "units = \"mm\"\nclosed = false\n[feed]\nrate = 3000.0\n\
        [[segment]]\nline = { start = [0.0, 0.0], to = [1.0, 0.0] }\n";
    let first = path("line.toml", text).pieces[0];
    let (mut at, mut heading) = (Complex::ZERO, 0.0_f64);
    let line = |k: usize| {
        heading += 0.02 * (k as f64 * 0.01).sin();
        let start = at;
        at = at + Complex::new(heading.cos(), heading.sin()) * LENGTH;
        PathPiece { segment: Segment::Line(Line { start, end: at }), ..first }
    };
    (0..LINES).map(line).collect()
}

/// The shortest of some runs in s, and what the last one gave.
fn fastest<T>(mut run: impl FnMut() -> T) -> (f64, T) {
    let mut once = || {
        let start = Instant::now();
        let found = black_box(run());
        (start.elapsed().as_secs_f64(), found)
    };
    let mut best = once();
    for _ in 1..RUNS {
        let (time, found) = once();
        best = (best.0.min(time), found);
    }
    best
}

fn chains() {
    println!("{LINES} lines of {LENGTH} mm            pieces/s   of planning     of motion   held at once");
    let lines = chain();
    let line = |what: &str, time: f64, motion: f64, held: usize| {
        let rate = LINES as f64 / time;
        println!("{what:34} {rate:10.0} {time:11.3} s {motion:11.3} s {held:14}");
    };
    for (name, limits) in [("without jerk", without_jerk(router())), ("with the router's jerk", router())] {
        let (time, motion) = fastest(|| plan(&lines, 0.0, &limits, &Manner::USUAL).unwrap().time);
        line(name, time, motion, LINES);
        let (time, (motion, held)) = fastest(|| {
            let mut streamed = Streamed::new(lines.iter().copied(), 0.0, &limits, &Manner::USUAL);
            let motion: f64 = streamed.by_ref().map(|piece| duration(&piece.unwrap())).sum();
            (motion, streamed.most_held())
        });
        line(&format!("{name}, streamed"), time, motion, held);
    }
    println!();
}

/// How long a planned piece takes, in s.
fn duration(piece: &PathPiece) -> f64 {
    piece.way() / (piece.feed * 0.25 * piece.profile.unwrap().factors.iter().sum::<f64>())
}

fn benchmark(criterion: &mut Criterion) {
    for (name, text) in EXAMPLES {
        let path = path(name, text);
        let mut group = criterion.benchmark_group(name);
        group.throughput(Throughput::Elements(path.pieces.len() as u64));
        for (how, limits) in [("with jerk", router()), ("without jerk", without_jerk(router()))] {
            group.bench_function(how, |b| {
                b.iter(|| plan(black_box(&path.pieces), path.weight, &limits, &Manner::USUAL).unwrap().time);
            });
        }
        group.finish();
    }
}

criterion_group!(benches, benchmark);

fn main() {
    chains();
    benches();
    Criterion::default().configure_from_args().final_summary();
}

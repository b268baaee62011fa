//! How many lines of a program are read in a second, on one core.
//!
//! `cargo bench -p host-sim --bench programs` prints lines/s for generated programs, each read to the end by a sink that adds
//! up the ends of all motions; then criterion's measurements. The bar is 1 000 000 lines/s.

#![allow(missing_docs, clippy::unwrap_used, reason = "benchmark code")]

use std::fmt::Write as _;
use std::hint::black_box;
use std::time::Instant;

use criterion::{Criterion, Throughput, criterion_group};
use host_sim::program::{Action, rs274};

/// Lines of a printed measurement.
const LINES: u32 = 1_000_000;
/// Lines of one of criterion's runs.
const FEW: u32 = 10_000;
/// Runs of which the fastest counts.
const RUNS: u32 = 7;

/// What a line of a generated program is, by its number.
type Line = fn(&mut String, u32);

/// Programs as CAM systems write them, and two that are harder to read.
const PROGRAMS: [(&str, Line); 5] = [
    ("G1 with X, Y and Z", |text, k| {
        let t = f64::from(k) * 1e-3;
        writeln!(text, "G1 X{:.4} Y{:.4} Z{:.4}", 50.0 * t.cos(), 50.0 * t.sin(), (7.0 * t).sin()).unwrap();
    }),
    ("bare X and Y", |text, k| {
        let t = f64::from(k) * 1e-3;
        writeln!(text, "X{:.3}Y{:.3}", 50.0 * t.cos(), 50.0 * t.sin()).unwrap();
    }),
    ("N, comment, lower case", |text, k| {
        writeln!(text, "n{k} g1 x{}.25 y-{}.5 (part {k})", k % 100, k % 7).unwrap();
    }),
    ("half circles", |text, k| {
        writeln!(text, "G{} X{} Y0 I{} J0", 2 + k % 2, k % 2 * 10, if k % 2 == 0 { -5 } else { 5 }).unwrap();
    }),
    ("expressions", |text, k| writeln!(text, "X[#1+{k}/100]Y[SIN[{k}]*#2]").unwrap()),
];

fn program(lines: u32, line: Line) -> String {
    let mut text = "G21 G90 #1=2 #2=10\nG0 X10 Y0\nG1 F600\n".to_string();
    (0..lines).for_each(|k| line(&mut text, k));
    text
}

/// Reads a program and adds up its ends, so that nothing of the work can be left out.
fn read(text: &str) -> (usize, f64) {
    let mut sum = 0.0;
    let lines = rs274::read("bench.ngc", text.as_bytes(), &rs274::Settings::default(), &mut |item| {
        if let Action::Motion(motion) = item.action {
            sum += motion.to().map_or(0.0, |[x, y, z]| x + y + z);
        }
        Ok(())
    });
    (lines.unwrap(), sum)
}

fn rates() {
    println!("program                       bytes/line       lines/s");
    for (name, line) in PROGRAMS {
        let text = program(LINES, line);
        let best = (0..RUNS).map(|_| {
            let start = Instant::now();
            let (lines, _) = black_box(read(black_box(&text)));
            lines as f64 / start.elapsed().as_secs_f64()
        });
        let best = best.fold(0.0, f64::max);
        println!("{name:30} {:9.1} {best:13.0}", text.len() as f64 / f64::from(LINES));
    }
    println!();
}

fn benchmark(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("reading");
    group.throughput(Throughput::Elements(u64::from(FEW)));
    for (name, line) in PROGRAMS {
        let text = program(FEW, line);
        group.bench_function(name, |b| b.iter(|| read(black_box(&text))));
    }
    group.finish();
}

criterion_group!(benches, benchmark);

fn main() {
    rates();
    benches();
    Criterion::default().configure_from_args().final_summary();
}

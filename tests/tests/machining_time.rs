//! What a fit is worth: the time of a program by its curves against that of its lines, rounded within the same tolerance, on the same machine
//! and by the same planner. `cargo test --release -p tests --test machining_time -- --nocapture` prints the table of docs/fitting.md.

#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path as FilePath, PathBuf};

use host_sim::fit::Kind;
use host_sim::job::Job;
use host_sim::machine;
use host_sim::path::Path;
use host_sim::plan::{Limits, Manner, plan};
use host_sim::program;
use host_sim::strokes::{self, Lines, Pace, Tooling};
use shared::piece::Order;

const TOLERANCE: f64 = 0.01;

/// The router of the examples; how fast it is asked to be: as fast as one of its axes can.
const MACHINE: &str = include_str!("../../examples/machine.toml");

/// Lines from which on a program is one of short lines.
const FEWEST: usize = 100;

/// The time of a program and its number of strokes. None where it cannot be a job.
fn time(file: &FilePath, lines: Lines, limits: &Limits) -> Option<(f64, usize)> {
    let name = file.to_str().unwrap();
    let (mut strokes, _) =
        strokes::read(name, BufReader::new(File::open(file).unwrap()), lines, &Tooling::default()).ok()?;
    for stroke in strokes.strokes.iter_mut().filter(|stroke| stroke.pace != Pace::Rapid) {
        stroke.pace = Pace::Feed(limits.velocity[0]);
    }
    let count = strokes.strokes.len();
    let job = Job::from_strokes(name, strokes).ok()?;
    let path = Path::new(&job, Order::First).unwrap_or_else(|error| panic!("{error}"));
    Some((plan(&path.pieces, path.weight, limits, &Manner::USUAL).unwrap().time, count))
}

/// Curves are never slower than the lines that they stand for, and on the whole take three quarters of the time at the most.
#[test]
fn curves_are_faster_than_rounded_lines() {
    let root = FilePath::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut files: Vec<PathBuf> = vec![root.join("examples/heart.ngc")];
    let folder = root.join("../shared/data/gcode");
    if folder.is_dir() {
        files.extend(fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()));
    } else {
        println!("SKIPPED: there is no ../shared/data/gcode with the programs of others; the example alone is run");
    }
    files.sort();
    let machine = machine::from_toml("machine.toml", MACHINE).unwrap();
    let limits = Limits::of(&machine, &Default::default()).unwrap();
    println!(
        "| program | lines | as lines, s | curves | as curves, s | ratio |\n| --- | --- | --- | --- | --- | --- |"
    );
    let mut ratios: Vec<f64> = Vec::new();
    for file in files.iter().filter(|file| program::is_one(file.to_str().unwrap())) {
        let Some((_, lines)) = time(file, Lines::Kept, &limits).filter(|&(_, count)| count >= FEWEST) else { continue };
        let (slow, _) = time(file, Lines::Rounded(TOLERANCE), &limits).unwrap();
        let (fast, curves) = time(file, Lines::Fitted(Kind::Drivable, TOLERANCE), &limits).unwrap();
        let name = file.file_name().unwrap().to_str().unwrap();
        println!("| `{name}` | {lines} | {slow:.2} | {curves} | {fast:.2} | {:.3} |", fast / slow);
        assert!(fast <= slow * 1.001, "{name}: {fast} s as curves, {slow} s as lines");
        ratios.push(fast / slow);
    }
    let mean = (ratios.iter().map(|ratio| ratio.ln()).sum::<f64>() / ratios.len() as f64).exp();
    println!("geometric mean of {} ratios: {mean:.3}", ratios.len());
    assert!(mean <= 0.75, "{mean}");
}

//! Plans of the examples beside the bound, a straight move beside ruckig, rests, budgets of contour error, and the growth of the work.

#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use std::process::{Command, Output};

use host_sim::job::Job;
use host_sim::machine;
use host_sim::path::Path;
use host_sim::plan::{Course, Limits, Manner, Plan, Recorder, Rests, bound, plan, planned, within_budget};
use host_sim::plant::Plant;
use host_sim::simulate::{SETTLING_TICKS, run, simulate};
use rsruckig::prelude::{InputParameter, Ruckig, ThrowErrorHandler, Trajectory};
use shared::complex::Complex;
use shared::curve::{Line, Segment};
use shared::machine::MachineSettings;
use shared::piece::Order;
use tests::stopwatch::Stopwatch;

const MACHINE: &str = include_str!("../../examples/machine.toml");
const EXAMPLES: [(&str, &str); 4] = [
    ("bracket", include_str!("../../examples/bracket.toml")),
    ("fan", include_str!("../../examples/fan.toml")),
    ("farouki2018", include_str!("../../examples/farouki2018.toml")),
    ("pocket", include_str!("../../examples/pocket.toml")),
];

fn router() -> MachineSettings {
    machine::from_toml("machine.toml", MACHINE).unwrap()
}

fn limits() -> Limits {
    Limits::of(&router(), &Default::default()).unwrap()
}

fn path(name: &str, text: &str) -> (Job, Path) {
    let job = Job::from_toml(name, text).unwrap();
    let path = Path::new(&job, Order::First).unwrap();
    (job, path)
}

/// The plan's time over that of the bound from rest to rest, with the peaks of its run within the bars.
fn ratio(name: &str, text: &str, limits: &Limits) -> f64 {
    let (job, path) = path(name, text);
    let course = Course { ends: [Some(0.0); 2], ..Course::new(&path, 0.02) };
    let least = bound(&course, limits).time;
    let (path, plan) = planned(&path, limits, &Manner::USUAL).unwrap();
    let mut machine = router();
    machine.axes.iter_mut().for_each(|axis| axis.jerk = limits.jerk[0].min(1e9));
    let mut recorder = Recorder::new(&path);
    let run = run(&path, |_, executor| {
        recorder.record(executor.setpoint(), executor.place().map_or(0, |place| place.piece as usize));
    })
    .unwrap();
    assert!((run.time - plan.time).abs() < 1e-4, "{name}: {} {}", run.time, plan.time);
    for axis in recorder.demand(&machine, job.units).unwrap().axes {
        for (asked, bar) in [(axis.velocity, 1.005), (axis.acceleration, 1.005), (axis.jerk, 1.02)] {
            assert!(asked.peak <= bar * asked.limit, "{name}: {asked:?} of {}", axis.axis);
        }
        let (step, limit) = (axis.corner_step, limits.corner_step[0] / job.units.mm());
        assert!(step <= limit * 1.02, "{name}: {step} of {limit}");
    }
    plan.time / least
}

/// Without jerk within 5 % of the bound on the paper's contour; with the jerk of the router, 8 m/s^3 for 0.4 m/s^2, within 15 % on the
/// geometric mean of the examples.
#[test]
fn the_examples_are_near_their_bound() {
    let free = Limits { jerk: [f64::INFINITY; 3], ..limits() };
    let (mut product, mut text) = (1.0, String::new());
    for (name, job) in EXAMPLES {
        let [without, with] = [ratio(name, job, &free), ratio(name, job, &limits())];
        text += &format!("{name}: {without:.4} without jerk, {with:.4} with; ");
        assert!(name != "farouki2018" || without < 1.05, "{text}");
        product *= with;
    }
    let mean = f64::powf(product, 0.25);
    println!("{text}mean {mean:.4}");
    assert!(mean < 1.15, "{text}");
}

fn straight(length: f64, feed: f64) -> Path {
    let text = format!(
        "units = \"mm\"\nclosed = false\n[feed]\nrate = {}\n[[segment]]\nline = {{ start = [0.0, 0.0], to = [{length}, 0.0] }}\n",
        feed * 60.0
    );
    path("line.toml", &text).1
}

/// A straight move takes what ruckig's time-optimal one takes, to a thousandth: one that comes to its feed, to its acceleration alone, and
/// to neither.
#[test]
fn a_straight_move_is_ruckigs() {
    for (length, feed) in
        [(100.0, 60.0), (300.0, 75.0), (30.0, 75.0), (10.0, 75.0), (5.0, 75.0), (2.0, 75.0), (0.3, 75.0)]
    {
        let limits = limits();
        let ours = plan(&straight(length, feed).pieces, 0.0, &limits, &Manner::USUAL).unwrap().time;
        // Ruckig bears what a plan uses of the limits, and no more: the rest is for what lies between a plan's places.
        let used = Plan::used(&limits);
        let mut otg = Ruckig::<1, ThrowErrorHandler>::new(None, 1.0 / 1024.0);
        let mut input = InputParameter::<1>::new(None);
        input.target_position[0] = length;
        input.max_velocity[0] = feed.min(used.velocity[0]);
        input.max_acceleration[0] = used.acceleration[0];
        input.max_jerk[0] = used.jerk[0];
        let mut trajectory = Trajectory::<1>::new(None);
        otg.calculate(&input, &mut trajectory).unwrap();
        let theirs = trajectory.get_duration();
        println!("{length} mm at {feed} mm/s: {ours:.5} s, ruckig {theirs:.5} s");
        assert!((ours / theirs - 1.0).abs() < 1e-3, "{length} mm: {ours} {theirs}");
    }
}

/// Without a jerk the fan's plan is not slower by more than a hundredth than `toppra`'s time within the same limits
/// (`tests/peers/toppra_fan.py`, which needs Python and toppra).
#[test]
fn a_spline_is_toppras() {
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/peers/toppra_fan.py");
    let is_there = |output: &Output| output.status.success();
    let Some(found) = Command::new("python3").arg(script).output().ok().filter(is_there) else {
        println!("SKIPPED: python3 with toppra, scipy and numpy is not here (pip install toppra scipy)");
        return;
    };
    let theirs: f64 = String::from_utf8(found.stdout).unwrap().trim().parse().unwrap();
    let free = Limits { jerk: [f64::INFINITY; 3], ..limits() };
    let ours = plan(&path("fan", EXAMPLES[1].1).1.pieces, 0.0, &free, &Manner::USUAL).unwrap().time;
    println!("fan: {ours:.4} s, toppra {theirs:.4} s");
    assert!(ours < 1.01 * theirs && ours > theirs * (1.0 - 1e-3), "{ours} {theirs}");
}

/// A square: through its corners, resting in each, and resting at a node that is none.
#[test]
fn modes_rest_where_they_should() {
    let square = "units = \"mm\"\nclosed = true\n[feed]\nrate = 3000.0\n\
        [[segment]]\nline = { start = [0.0, 0.0], to = [10.0, 0.0] }\n[[segment]]\nline = { to = [20.0, 0.0] }\n\
        [[segment]]\nline = { to = [20.0, 20.0] }\n[[segment]]\nline = { to = [0.0, 20.0] }\n\
        [[segment]]\nline = { to = [0.0, 0.0] }\n";
    let path = path("square.toml", square).1;
    let of = |rests: Rests| plan(&path.pieces, 0.0, &limits(), &Manner { rests, ..Manner::USUAL }).unwrap();
    let plans = [Rests::Never, Rests::InCorners, Rests::AtNodes].map(of);
    assert!(plans[0].time < plans[1].time && plans[1].time < plans[2].time);
    let rests = plans.map(|plan| {
        let ends = plan.course.places.iter().zip(&plan.speed).skip(1);
        ends.filter(|&(place, &speed)| place.step == 0.0 && speed == 0.0).count()
    });
    assert_eq!(rests, [0, 3, 4]);
}

/// 5 um on the default plant, kept within 20 % and not kept by crawling.
#[test]
fn a_budget_of_contour_error_is_kept() {
    const BUDGET: f64 = 0.005;
    let plant = Plant::default_mill(f64::from(shared::TICK)).unwrap();
    for (name, text) in EXAMPLES {
        let (job, path) = path(name, text);
        let found = within_budget(&path, &limits(), &Manner::USUAL, &plant, BUDGET).unwrap();
        let mut mill = plant.clone();
        mill.rest_at(found.path.start());
        let run = simulate(&found.path, job.units, SETTLING_TICKS, |at| mill.advance(at), |_| ()).unwrap();
        let error = run.max_contour_error * job.units.mm();
        let free = plan(&path.pieces, path.weight, &limits(), &Manner::USUAL).unwrap().time;
        println!("{name}: {error:.5} mm, {:.3} s instead of {free:.3} s", found.plan.time);
        assert!(error <= 1.2 * BUDGET && found.plan.time < 1.15 * free, "{name}: {error} {}", found.plan.time);
    }
}

/// Sixteen times the path, sixteen times the work: twice that at most, for caches that it outgrows. With a power of 1.25 it would fail.
#[test]
fn the_work_grows_with_the_path() {
    let piece = straight(1.0, 50.0).pieces[0];
    let lines = |count: usize| {
        let (mut at, mut heading) = (Complex::ZERO, 0.0_f64);
        let line = |k: usize| {
            heading += 0.02 * (k as f64 * 0.01).sin();
            let start = at;
            at = at + Complex::new(heading.cos(), heading.sin()) * 0.05;
            host_sim::path::PathPiece { segment: Segment::Line(Line { start, end: at }), ..piece }
        };
        (0..count).map(line).collect::<Vec<_>>()
    };
    // Many runs together: the system counts a thread's time in steps of some ms. Neither path is so long that its memory is new in every
    // run.
    const PIECES: usize = 128_000;
    let time = |count: usize| {
        let pieces = lines(count);
        let start = Stopwatch::start();
        for _ in 0..PIECES / count {
            plan(&pieces, 0.0, &limits(), &Manner::USUAL).unwrap();
        }
        start.seconds()
    };
    // The same number of pieces, sixteen times as long in one path.
    let growth = 16.0 * time(32_000) / time(2_000);
    assert!(growth < 32.0, "{growth}");
}

//! Two thousand random paths, planned within random limits, run through the f32 tick and differentiated by the verifier.

#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use host_sim::job::Job;
use host_sim::machine;
use host_sim::offset::trim;
use host_sim::path::Path;
use host_sim::plan::{Limits, Manner, Recorder, planned};
use host_sim::simulate::run;
use shared::complex::Complex;
use shared::machine::MachineSettings;
use shared::piece::Order;
use tests::chain::{Placing, size};
use tests::contours::case;
use tests::random::Random;

const MACHINE: &str = include_str!("../../examples/machine.toml");

/// Paths in each of the tests, and the seeds that they come from; some contours have no path.
const PATHS: usize = 1_000;
const SEEDS: [u64; 2] = [0, 1_250];

/// How far a peak may be above its limit.
const BARS: [f64; 3] = [1.005, 1.005, 1.02];

/// A contact length below which a piece cannot be cut, in mm, and the times that its centre's way may be longer: such a piece turns about
/// a point, and no cubic in time follows it.
const POINT: f64 = 1e-4;
const AROUND: f64 = 100.0;

/// The path of a seed: any loop of any contour's offset, at any size and feed.
fn path(seed: u64, random: &mut Random) -> Option<(Path, Job)> {
    let case = case(seed);
    let scale = random.scale(10.0, 300.0) / size(&case.contour);
    let [low, _] = case.contour.extent();
    let placing = Placing { factor: Complex::new(scale, 0.0), shift: low * -scale, mirror: false };
    let (contour, distance) = (placing.contour(&case.contour), placing.distance(case.distance));
    if trim(&contour, distance).ok()?.loops.is_empty() {
        return None;
    }
    let text = format!(
        "units = \"mm\"\nclosed = false\n[feed]\nrate = {}\nweight = {}\n\
         [[segment]]\nline = {{ start = [0.0, 0.0], to = [9.0, 0.0] }}\n",
        random.scale(100.0, 12_000.0),
        random.pick(&[0.0, 0.5, 1.0])
    );
    let mut job = Job::from_toml("job.toml", &text).unwrap();
    (job.contour, job.offset) = (contour, distance);
    let path = Path::new(&job.clone().with_loop(Some(0)), Order::First).ok()?;
    let is_point = |length: f64, way: f64| length < POINT && way > AROUND * length;
    let has_points = path.pieces.iter().any(|piece| is_point(piece.way(), piece.centre_length()));
    // A tool as large as a house makes no test of a router.
    (!has_points && path.centre_length() < 3_000.0).then_some((path, job))
}

fn machine(random: &mut Random, mut machine: MachineSettings) -> MachineSettings {
    for axis in &mut machine.axes {
        axis.velocity = random.scale(20.0, 200.0);
        axis.acceleration = random.scale(100.0, 4_000.0);
        axis.jerk = axis.acceleration * random.scale(8.0, 60.0);
    }
    machine
}

fn all_within(first: u64) {
    let router = machine::from_toml("machine.toml", MACHINE).unwrap();
    let mut count = 0;
    for seed in first.. {
        if count == PATHS {
            break;
        }
        let mut random = Random::new(seed ^ 0x706c_616e);
        let Some((path, job)) = path(seed, &mut random) else { continue };
        let mut machine = machine(&mut random, router.clone());
        let mut limits = Limits::of(&machine, &Default::default()).unwrap();
        if random.chance(0.3) {
            limits.jerk = [f64::INFINITY; 3];
            machine.axes.iter_mut().for_each(|axis| axis.jerk = 1e9);
        }
        let (path, plan) = planned(&path, &limits, &Manner::USUAL).unwrap();
        let mut recorder = Recorder::new(&path);
        let run = run(&path, |_, executor| {
            recorder.record(executor.setpoint(), executor.place().map_or(0, |place| place.piece as usize));
        });
        let run = run.unwrap_or_else(|| panic!("seed {seed} does not end"));
        assert!((run.time - plan.time).abs() < 1e-3, "seed {seed}: {} s planned, {} s run", plan.time, run.time);
        for axis in recorder.demand(&machine, job.units).unwrap().axes {
            for (asked, bar) in [axis.velocity, axis.acceleration, axis.jerk].iter().zip(BARS) {
                assert!(asked.peak <= bar * asked.limit, "seed {seed}: {asked:?} of {}", axis.axis);
            }
        }
        count += 1;
    }
}

#[test]
fn a_thousand_random_plans_keep_their_limits() {
    all_within(SEEDS[0]);
}

#[test]
fn another_thousand_do() {
    all_within(SEEDS[1]);
}

//! Every example job as step pulses: the words of each tick, decoded, lead to the setpoint's step.

#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use std::path::PathBuf;

use host_sim::job::Job;
use host_sim::path::Path;
use host_sim::plant::Measured;
use host_sim::simulate::{setpoints, simulate};
use shared::fixed::{Fixed, Position};
use shared::piece::Order;
use shared::steps::decoder::Decoder;
use shared::steps::{Half, Pin, StepAxes, StepSettings};

/// All files of the examples that hold a job.
fn jobs() -> Vec<(String, Job)> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let mut jobs = Vec::new();
    for file in files.iter().filter(|file| file.extension().is_some_and(|ending| ending == "toml")) {
        let (name, text) = (file.file_name().unwrap().to_string_lossy(), std::fs::read_to_string(file).unwrap());
        // The other examples are plants.
        if text.contains("[[segment]]") {
            jobs.push((name.to_string(), Job::from_toml(&name, &text).unwrap()));
        }
    }
    assert!(jobs.len() >= 2, "the examples are not where they were");
    jobs
}

/// Three axes on one port, each with other times and polarities.
fn settings(steps_per_mm: [f64; 3]) -> [StepSettings; 3] {
    let axis = |k: u8, pulse, gap, setup, hold| StepSettings {
        steps_per_mm: steps_per_mm[usize::from(k)],
        step: Pin { port: 0, bit: k, inverted: k == 1 },
        direction: Pin { port: 0, bit: 8 + k, inverted: k == 2 },
        pulse,
        gap,
        setup,
        hold,
    };
    [axis(0, 1, 1, 4, 2), axis(1, 1, 1, 10, 10), axis(2, 3, 2, 1, 0)]
}

/// The step next to a coordinate. Both factors are whole numbers of together 53 bits at most, so that the product is exact.
fn nearest(at: Fixed, steps_per_mm: f64) -> i64 {
    (f64::from(at.0) * steps_per_mm / 262_144.0 + 0.5).floor() as i64
}

/// Plays a job and returns how many steps it took.
fn play<const SLOTS: usize>(name: &str, job: &Job, path: &Path, steps_per_mm: [f64; 3]) -> u64 {
    let settings = settings(steps_per_mm);
    let axes: StepAxes<3, 1, SLOTS> = StepSettings::activate(&settings).unwrap();
    let start = path.start();
    let (mut state, mut decoder) = (axes.at_rest(start), Decoder::<3, 1>::new(&settings));
    let mut ring = Box::new([[0; SLOTS]; 2]);
    let (mut second, mut steps) = (false, 0);
    let mut tick = |setpoint: Position| {
        let half = if second { Half::Second } else { Half::First };
        let words = &mut ring[usize::from(second)];
        axes.fill(&mut state, setpoint, half, [&mut *words]).unwrap();
        decoder.play([&*words], |_| steps += 1);
        second = !second;
        core::array::from_fn(|k| {
            let is = nearest(start[k], steps_per_mm[k]) + decoder.drive(k).unwrap().position();
            is - nearest(setpoint[k], steps_per_mm[k])
        })
    };
    simulate(path, job.units, 0, Measured::ideal, |sample| {
        // A change of direction takes up to 1 + 10 + 10 slots, and a step two: so many may go into the next tick. Else there are none.
        let errors: [i64; 3] = tick(sample.commanded);
        assert!(errors.iter().all(|error| error.abs() <= 12), "{name}, tick {}: {errors:?}", sample.tick);
    })
    .unwrap();
    // What a last change of direction left over, and the last pulse's end.
    tick(path.end());
    assert_eq!(tick(path.end()), [0; 3], "{name}");
    assert_eq!(decoder.clashes(), 0);
    for (k, asked) in settings.iter().enumerate() {
        let least = decoder.drive(k).unwrap().least();
        assert!(least.pulse >= asked.pulse.into() && least.gap >= asked.gap.into(), "{name}, axis {k}: {least:?}");
        assert!(least.setup >= asked.setup.into() && least.hold >= asked.hold.into(), "{name}, axis {k}: {least:?}");
    }
    steps
}

/// A common screw, and steps so fine that the fastest tick of the job is all but full.
#[test]
fn every_example_ends_on_its_step() {
    for (name, job) in jobs() {
        let path = Path::new(&job, Order::Second).unwrap();
        let all = setpoints(&path).unwrap();
        let longest = |axis: usize| {
            let strides = all.windows(2).map(|pair| (pair[1][axis].0 - pair[0][axis].0).unsigned_abs());
            f64::from(strides.max().unwrap()) / 262_144.0
        };
        // 937 steps fit in a tick of 1875 slots.
        let full = (920.0 / longest(0).max(longest(1))).floor();
        let common = play::<1875>(&name, &job, &path, [640.0, 640.0, 400.0]);
        let fine = play::<1875>(&name, &job, &path, [full, full, 400.0]);
        let finer = play::<3750>(&name, &job, &path, [(2.0 * full).floor(), full, 400.0]);
        println!("{name}: {common} steps at 640 steps/mm, {fine} at {full}, {finer} at twice that in x");
        assert!(common > 1000 && fine > common && finer > fine);
    }
}

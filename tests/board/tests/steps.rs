//! Step axes: the pulses at the pins are the simulator's, slot by slot.

mod common;

use board::jobs::{all_ways, diagonal};
use board::machine::step_drivers::{ROUTER, SLOTS, Step, StepDrivers};
use board::run::run_job;
use common::{image, machine, start_of, steps};
use shared::control::{StepPins, step_settings};
use shared::fixed::{Fixed, UNITS_PER_MM};
use shared::piece::{Header, Piece};
use shared::steps::decoder::Decoder;
use shared::steps::{Half, StepSettings};

/// The axes as they are wired and set.
fn settings() -> [StepSettings; 3] {
    let pins =
        [[3, 4], [5, 6], [7, 0]].map(|[step, direction]| StepPins { step: (0, step), direction: (0, direction) });
    step_settings(&machine("mill-steps.toml").axes, &pins, SLOTS as usize)
}

/// The words of these setpoints, from a rest at the first one's job start, decoded.
fn host(start: [Fixed; 3], setpoints: &[[i32; 3]]) -> Vec<Step> {
    let axes = StepSettings::activate::<3, 1, { SLOTS as usize }>(&settings()).unwrap();
    let mut state = axes.at_rest(start);
    let mut decoder = Decoder::<3, 1>::new(&settings());
    let mut steps = Vec::new();
    // What does not fit into the last tick by its rounding is played in the one after.
    for (tick, setpoint) in setpoints.iter().chain(setpoints.last()).enumerate() {
        let half = if tick % 2 == 0 { Half::First } else { Half::Second };
        let mut words = [0; SLOTS as usize];
        axes.fill(&mut state, setpoint.map(Fixed), half, [&mut words]).unwrap();
        decoder.play([&words], |step| steps.push((step.axis, step.instant, step.forward)));
    }
    steps
}

/// Runs a job on the board and compares every pulse. Returns the drivers.
fn compare((header, pieces): (Header<f32>, Vec<Piece<f32>>), ticks: usize) -> StepDrivers {
    let run = run_job(&image(), &steps(), header, pieces.clone(), 1.0, |probe| {
        probe.machine.step_drivers = Some(StepDrivers::with_motors(ROUTER).unwrap());
    })
    .unwrap();
    // The machine stands at 0 after its start, and the path begins there, whatever its own coordinates are.
    let start = start_of(&header, &pieces);
    let moved = |setpoint: [i32; 3]| [0, 1, 2].map(|axis| setpoint[axis] - start[axis].0);
    let setpoints: Vec<_> = run.seen.ticks.iter().map(|tick| moved(tick.setpoint)).collect();
    assert!(setpoints.len() > ticks, "{}", setpoints.len());
    let host = host([Fixed(0); 3], &setpoints);
    let drivers = run.machine.step_drivers.unwrap();
    let pins = &drivers.steps;
    assert!(host.len() > ticks && !pins.is_empty(), "{} {}", host.len(), pins.len());
    // One shift for all of them, of whole ticks: when the job was started.
    let shift = pins[0].1 - host[0].1;
    assert_eq!(shift % SLOTS, 0, "{shift}");
    let differs = host.iter().zip(pins).position(|(&(axis, at, forward), &found)| (axis, at + shift, forward) != found);
    assert_eq!(differs, None, "the first step that differs");
    // The last tick's words may still be on their way when the host hears that the job has ended.
    assert_eq!(host.len(), pins.len());
    for (axis, driver) in drivers.drivers.iter().enumerate() {
        assert_eq!(driver.violations(), [""; 0], "axis {axis}: {:?}", driver.least());
        // A pulse has two edges.
        let count = pins.iter().filter(|&&(of, ..)| of == axis).count();
        assert_eq!(driver.edges[0], 2 * count as u64);
        // The steps lead from the step at the start to the one next to the end.
        let last = setpoints.last().unwrap()[axis];
        let nearest = (f64::from(last) / UNITS_PER_MM * 8_000.0 + 0.5).floor() as i64;
        assert_eq!(driver.position(), nearest, "axis {axis}");
    }
    drivers
}

/// All axes near 900 000 steps/s, for a quarter of a second: the pins, the words and the drives' times.
#[test]
fn pulses_at_full_speed_are_the_simulators() {
    let mut drivers = compare(diagonal(900_000.0), 200);
    // Every pulse is right, and no motor can follow: from rest to 112 mm/s at once is beyond any of this size, so each loses steps.
    for axis in 0..3 {
        assert!(drivers.reading(axis).unwrap().lost_steps.abs() >= 4, "axis {axis}");
    }
}

/// And slowly, where pulses are far apart.
#[test]
fn slow_pulses_are_the_simulators() {
    let mut drivers = compare(diagonal(20_000.0), 200);
    // 2.5 mm/s at once is nothing to a motor: its table is within a full step of what the pulses say, 1/40 mm.
    for axis in 0..3 {
        let reading = drivers.reading(axis).unwrap();
        let asked = drivers.drivers[axis].position() as f64 / 8_000.0;
        assert_eq!(reading.lost_steps, 0, "axis {axis}");
        assert!((reading.position - asked).abs() < 0.025, "axis {axis}: {} of {asked} mm", reading.position);
    }
}

/// A whole job with reversals: every axis turns around, slowly and at once, in all pairs of directions.
#[test]
fn a_job_in_all_directions_is_the_simulators() {
    let drivers = compare(all_ways(), 700);
    let both = |axis: usize| {
        [true, false].map(|way| drivers.steps.iter().filter(|step| (step.0, step.2) == (axis, way)).count())
    };
    for axis in 0..2 {
        let [forward, backward] = both(axis);
        assert!(forward > 10_000 && backward > 10_000, "axis {axis}: {forward} and {backward} steps");
        assert!(drivers.drivers[axis].edges[1] >= 4, "axis {axis} turned around");
    }
    assert_eq!(both(2), [0, 0]);
}

//! Step axes: the pulses at the pins are the simulator's, slot by slot.

mod common;

use board::jobs::diagonal;
use board::pins::{SLOTS, Step};
use board::run::run_job;
use common::{image, machine, steps};
use shared::control::{StepPins, step_settings};
use shared::fixed::Fixed;
use shared::piece::{Header, Piece};
use shared::steps::decoder::Decoder;
use shared::steps::{Half, StepSettings};

/// The axes as they are wired and set.
fn settings() -> [StepSettings; 3] {
    let pins =
        [[3, 4], [5, 6], [7, 0]].map(|[step, direction]| StepPins { step: (0, step), direction: (0, direction) });
    step_settings(&machine("mill-steps.toml"), &pins, SLOTS as usize)
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

fn compare((header, pieces): (Header<f32>, Vec<Piece<f32>>), ticks: usize) {
    let [x, y] = pieces[0].origin;
    let run = run_job(&image(), &steps(), header, pieces.clone(), 1.0, |probe| probe.look_at_pins()).unwrap();
    let setpoints: Vec<_> = run.seen.ticks.iter().map(|tick| tick.setpoint).collect();
    assert!(setpoints.len() > ticks, "{}", setpoints.len());
    // The machine stands at 0 after its start, and the path begins there, whatever its own coordinates are.
    let start = shared::loader::Loader::new(&header, shared::TICK).and_then(|mut loader| {
        loader.load(&pieces[0])?;
        Ok(loader.start())
    });
    let [first_x, first_y] = start.unwrap().unwrap_or([x, y]);
    let setpoints: Vec<_> = setpoints.iter().map(|[x, y, z]| [x - first_x.0, y - first_y.0, *z]).collect();
    let host = host([Fixed(0); 3], &setpoints);
    let pins = &run.seen.pins.steps;
    assert!(host.len() > ticks && !pins.is_empty(), "{} {}", host.len(), pins.len());
    // One shift for all of them, of whole ticks: when the job was started.
    let shift = pins[0].1 - host[0].1;
    assert_eq!(shift % SLOTS, 0, "{shift}");
    let differs = host.iter().zip(pins).position(|(&(axis, at, forward), &found)| (axis, at + shift, forward) != found);
    assert_eq!(differs, None, "the first step that differs");
    // The last tick's words may still be on their way when the host hears that the job has ended.
    assert_eq!(host.len(), pins.len());
    for axis in 0..3 {
        let least = run.seen.pins.least(axis);
        assert!(least.pulse >= 1 && least.gap >= 1 && least.setup >= 10 && least.hold >= 10, "{axis}: {least:?}");
    }
}

/// All axes near 900 000 steps/s, for a quarter of a second: the pins, the words and the drives' times.
#[test]
fn pulses_at_full_speed_are_the_simulators() {
    compare(diagonal(900_000.0), 200);
}

/// And slowly, where pulses are far apart.
#[test]
fn slow_pulses_are_the_simulators() {
    compare(diagonal(20_000.0), 200);
}

/// The stop input in the middle of a job, at instants that fall anywhere in a tick: the enable output is off and the last edge is past
/// within a tick; it is a few instructions in fact.
#[test]
fn a_stop_ends_the_pulses_within_a_tick() {
    for after in [3_141_592, 10_000_001, 27_182_818, 40_499_999] {
        let (header, pieces) = diagonal(900_000.0);
        let mut seen = None;
        let talker = board::line::share(board::line::JobTalker::new(header, pieces));
        let run = board::run::run(&image(), &steps(), talker, 0.12, |probe| {
            probe.look_at_pins();
            probe.press_stop_after(after);
        });
        let seen = seen.insert(run.unwrap());
        let (pressed, disabled) = (seen.pressed.unwrap(), seen.disabled.unwrap());
        assert!((pressed..pressed + 2_000).contains(&disabled), "{after}: off {} ns later", disabled - pressed);
        let &(off, false) = seen.pins.enabled.last().unwrap() else { panic!("{after}: still enabled") };
        let &(_, last, _) = seen.pins.steps.last().unwrap();
        assert!(last <= off && off - last <= SLOTS, "{after}: off in slot {off}, last step in {last}");
        assert!(seen.pins.steps.len() > 1_000, "{after}: in motion before");
    }
}

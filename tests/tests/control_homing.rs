//! Homing through the whole tick, against switches at places that the controller does not know; and what is known after it.
#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use host_sim::job::Job;
use host_sim::machine;
use host_sim::path::Path;
use host_sim::rig::{Axis, Rig};
use shared::control::{Directive, DirectiveError, PathEnd};
use shared::machine::MachineSettings;
use shared::motion::MotionCommand;
use shared::piece::Order;
use shared::safety::{Coordinates, Fault, HomingFault, Refused, State};
use tests::bench::{ask, load, rig};

const ROUTER: &str = include_str!("../../examples/machine.toml");
const SERVOS: &str = include_str!("../../examples/mill-servos.toml");

/// What the servo mill lacks in order to find home: limit switches at its low ends.
const SWITCHES: &str = "low_limit = {}\n\n[axis.homing]\nswitch = \"limit\"\ntoward = \"low\"\nfast = 40.0\nslow = 2.0\nback_off = 3.0\n\
pull_off = 2.0\nposition = 2.0\n";

fn settings(text: &str) -> MachineSettings {
    machine::from_toml("machine.toml", text).unwrap()
}

/// The servo mill with switches: each enable output is followed by them.
fn servos_with_switches() -> MachineSettings {
    // A table ends the keys of its parent, so the drive goes behind.
    let mut text = String::new();
    for (number, part) in SERVOS.split("[[axis]]").enumerate() {
        if number > 0 {
            text.push_str("[[axis]]");
        }
        match part.split_once("\n[axis.drive.servo]") {
            Some((keys, drive)) => {
                text.push_str(&format!("{keys}{SWITCHES}\n[axis.drive.servo]{drive}"));
            }
            None => text.push_str(part),
        }
    }
    settings(&text)
}

/// Where a switch stands, in mm from where its axis stood at power-up, and whether it is at the high end.
type Switch = (f64, bool);

/// The levels of the switches where the axes are; normally closed, so that high is pressed.
fn look(bench: &mut Rig, switches: &[Option<Switch>; 3]) {
    let (mut low, mut high) = (0, 0);
    for (axis, switch) in switches.iter().enumerate() {
        let place = bench.axes[axis].place();
        match switch {
            Some((at, false)) if place <= *at => low |= 1 << axis,
            Some((at, true)) if place >= *at => high |= 1 << axis,
            _ => {}
        }
    }
    (bench.pins.low, bench.pins.high) = (low, high);
}

/// Ticks until the machine is idle again, or has a fault.
fn search(bench: &mut Rig, switches: &[Option<Switch>; 3]) {
    for _ in 0..200_000 {
        look(bench, switches);
        bench.tick();
        if bench.status.machine != State::Homing {
            return;
        }
    }
    panic!("a search without an end: {:?}", bench.status);
}

/// A line from home, in machine coordinates.
fn line(from: [f64; 2], to: [f64; 2]) -> String {
    let ([x0, y0], [x1, y1]) = (from, to);
    format!(
        "units = \"mm\"\nclosed = false\nrest = true\n[feed]\nrate = 1200.0\n\
         [[segment]]\nline = {{ start = [{x0:.3}, {y0:.3}], to = [{x1:.3}, {y1:.3}] }}\n"
    )
}

fn start(bench: &mut Rig, text: &str) -> Result<(), DirectiveError> {
    let job = Job::from_toml("line.toml", text).unwrap();
    let path = Path::new(&job, Order::First).unwrap();
    let pieces: Vec<_> = path.wire().collect();
    let start = load(bench, &path.header, &pieces, Coordinates::Machine);
    ask(bench, Directive::Start(start))
}

fn resolution(axis: &Axis) -> f64 {
    let (Axis::Step { per_mm, .. } | Axis::Servo { per_mm, .. }) = *axis;
    1.0 / per_mm
}

/// Before: nothing is known, and a job in machine coordinates is refused. After: every axis is where it says, to the way of one slow tick
/// and a step; a job runs where the machine stands, and nowhere else.
fn finds_home(settings: &MachineSettings, switches: [Option<Switch>; 3], axes: usize, slow: f64) {
    let mut bench = rig(settings);
    look(&mut bench, &switches);
    bench.tick();
    let unknown = DirectiveError::Machine(Refused::PositionUnknown { axis: 0 });
    assert_eq!(start(&mut bench, &line([2.0, 2.0], [12.0, 2.0])), Err(unknown));
    assert_eq!(bench.status.known, 0);
    ask(&mut bench, Directive::Home { axes: 0 }).unwrap();
    search(&mut bench, &switches);
    let status = bench.status;
    assert_eq!((status.machine, status.fault, status.known), (State::Idle, None, (1 << axes) - 1));
    for _ in 0..500 {
        bench.tick();
    }
    // Where the switches stand is coordinate 0, as configured: the position of home is its way from the switch.
    let zero = |axis: usize| switches[axis].unwrap().0;
    let off = |bench: &Rig, axis: usize| bench.believed(axis) - (bench.axes[axis].place() - zero(axis));
    for axis in 0..axes {
        let found = off(&bench, axis);
        // A servo lags its setpoint, at this speed by a little more than the way of a tick; it is the same every time.
        let allowed = 2.0 * slow / 1024.0 + 1.5 * resolution(&bench.axes[axis]);
        assert!(found.abs() <= allowed, "axis {axis} is off by {found} mm of {allowed}");
    }
    let away = DirectiveError::Machine(Refused::Away { axis: 1 });
    assert_eq!(start(&mut bench, &line([2.0, 2.5], [12.0, 2.0])), Err(away));
    start(&mut bench, &line([2.0, 2.0], [12.0, 5.0])).unwrap();
    while bench.status.path == PathEnd::Running {
        look(&mut bench, &switches);
        bench.tick();
    }
    assert_eq!(bench.status.path, PathEnd::Finished);
    for _ in 0..1_000 {
        bench.tick();
    }
    for (axis, end) in [(0, 12.0), (1, 5.0)] {
        let place = bench.axes[axis].place() - zero(axis);
        assert!(
            (place - end).abs() < 2.0 * slow / 1024.0 + 1.5 * resolution(&bench.axes[axis]),
            "axis {axis}: {place}"
        );
    }

    // Without power a step axis loses its position, and an encoder counts on.
    bench.pins.estop = true;
    bench.tick();
    bench.axes[0].turn(-0.75);
    for _ in 0..10 {
        bench.tick();
    }
    let servos = (0..axes).filter(|&axis| matches!(bench.axes[axis], Axis::Servo { .. }));
    let known = servos.fold(0, |known, axis| known | 1 << axis);
    assert_eq!(bench.status.known, known);
    for axis in (0..axes).filter(|axis| known >> axis & 1 != 0) {
        let found = off(&bench, axis);
        assert!(found.abs() < 2.0 * slow / 1024.0 + 1.5 * resolution(&bench.axes[axis]), "axis {axis}: {found}");
    }
}

#[test]
fn step_axes_find_home() {
    finds_home(&settings(ROUTER), [Some((-17.3, false)), Some((-4.05, false)), Some((9.1, true))], 3, 1.0);
}

/// From on the switch, too: it is left first.
#[test]
fn step_axes_find_home_from_the_switch() {
    finds_home(&settings(ROUTER), [Some((0.4, false)), Some((-4.05, false)), Some((-0.2, true))], 3, 1.0);
}

#[test]
fn servo_axes_find_home() {
    finds_home(&servos_with_switches(), [Some((-12.2, false)), Some((-30.7, false)), None], 2, 2.0);
}

/// A switch that never acts: the search ends, with the axis named; nothing is known.
#[test]
fn a_missing_switch_is_told() {
    let mut bench = rig(&settings(ROUTER));
    bench.tick();
    ask(&mut bench, Directive::Home { axes: 0b100 }).unwrap();
    search(&mut bench, &[None; 3]);
    let status = bench.status;
    let fault = Fault::Homing { axis: 2, fault: HomingFault::NotFound };
    assert_eq!((status.machine, status.fault, status.known), (State::Fault, Some(fault), 0));
    // 120 mm of travel, and what overrun, back-off and pull-off take.
    assert!(bench.axes[2].place() > 119.0 && bench.axes[2].place() < 130.0, "{}", bench.axes[2].place());
}

/// A search that is cancelled comes to rest within its acceleration, and its axes stay unknown.
#[test]
fn a_search_can_be_cancelled() {
    let mut bench = rig(&settings(ROUTER));
    bench.tick();
    ask(&mut bench, Directive::Home { axes: 0b001 }).unwrap();
    for _ in 0..300 {
        bench.tick();
    }
    ask(&mut bench, Directive::Motion(MotionCommand::Cancel)).unwrap();
    let from = bench.axes[0].place();
    for _ in 0..300 {
        bench.tick();
    }
    assert_eq!((bench.status.machine, bench.status.known), (State::Idle, 0));
    // v^2/(2 a) of 25 mm/s and 400 mm/s^2 is 0.78 mm, and some ticks pass before and after.
    let way = from - bench.axes[0].place();
    assert!(way > 0.7 && way < 0.95, "{way}");
}

/// A limit switch at the other end, by which no axis looks for home, ends a search.
#[test]
fn a_foreign_limit_ends_a_search() {
    let mut bench = rig(&settings(ROUTER));
    bench.tick();
    ask(&mut bench, Directive::Home { axes: 0b001 }).unwrap();
    for _ in 0..300 {
        bench.tick();
    }
    bench.pins.high = 0b001;
    for _ in 0..6 {
        bench.tick();
    }
    assert_eq!(bench.status.machine, State::Fault);
    assert!(matches!(bench.status.fault, Some(Fault::Limit { axis: 0, .. })));
}

/// A path that was never held against the travel ends where an axis leaves it: the last line of defence.
#[test]
fn a_setpoint_beyond_the_travel_is_a_fault() {
    let switches = [Some((-17.3, false)), Some((-4.05, false)), Some((9.1, true))];
    let mut bench = rig(&settings(ROUTER));
    bench.tick();
    ask(&mut bench, Directive::Home { axes: 0 }).unwrap();
    search(&mut bench, &switches);
    // The travel of y ends at 0.
    start(&mut bench, &line([2.0, 2.0], [12.0, -3.0])).unwrap();
    while bench.status.path == PathEnd::Running {
        // The switch at the low end of y would act too.
        bench.tick();
    }
    assert_eq!(bench.status.path, PathEnd::Faulted(Fault::SoftLimit { axis: 1 }));
    let place = bench.axes[1].place() + 4.05;
    assert!(place < 0.002 && place > -0.1, "{place}");
}

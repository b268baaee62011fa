//! Homing against a switch with hysteresis that bounces: where home is found, in closed form, and every fault.

use super::*;
use crate::machine::{AxisDrive, AxisName, HomingSettings, HostLost, Input, MachineSettings, StepDrive};

const UNITS: f64 = UNITS_PER_MM;
const DEBOUNCE: u8 = 6;

fn settings(name: AxisName, toward: End, order: u8) -> AxisSettings {
    AxisSettings {
        name,
        travel: [-10.0, 90.0],
        velocity: 200.0,
        acceleration: 2_000.0,
        jerk: 1e5,
        drive: AxisDrive::Step(StepDrive {
            steps_per_mm: 100.0,
            pulse: 2e-6,
            gap: 2e-6,
            setup: 2e-6,
            hold: 0.0,
            step_inverted: false,
            direction_inverted: false,
        }),
        enable: None,
        drive_fault: None,
        low_limit: None,
        high_limit: None,
        home_switch: Some(Input::default()),
        homing: Some(HomingSettings {
            switch: HomeSwitch::Home,
            toward,
            fast: 50.0,
            slow: 2.0,
            back_off: 4.0,
            pull_off: 3.0,
            position: 7.0,
            order,
        }),
    }
}

fn plan(axes: &[AxisSettings]) -> HomingPlan {
    let settings = MachineSettings {
        name: "rig".try_into().unwrap(),
        host_lost: HostLost::Brake,
        estop: Input::default(),
        debounce: f64::from(DEBOUNCE) / 1024.0,
        release: 0.1,
        axes: axes.iter().copied().collect(),
    };
    settings.activate().unwrap().homing
}

/// A switch that acts from `at` on in the direction `toward`, lets go `hysteresis` before, and bounces for some ticks.
struct Switch {
    toward: i32,
    at: i32,
    hysteresis: i32,
    bounces: u32,
    acts: bool,
    since: u32,
    stuck: Option<bool>,
}

impl Switch {
    fn new(toward: End, at_mm: f64, hysteresis_mm: f64, bounces: u32) -> Self {
        let toward = if toward == End::Low { -1 } else { 1 };
        let (at, hysteresis) = ((at_mm * UNITS) as i32, (hysteresis_mm * UNITS) as i32);
        Self { toward, at, hysteresis, bounces, acts: false, since: u32::MAX, stuck: None }
    }

    fn read(&mut self, position: i32) -> bool {
        let beyond = (position - self.at) * self.toward;
        let acts = beyond >= if self.acts { -self.hysteresis } else { 0 };
        self.since = if acts == self.acts { self.since.saturating_add(1) } else { 0 };
        self.acts = acts;
        let bouncing = self.since < self.bounces && self.since % 2 == 1;
        self.stuck.unwrap_or(acts ^ bouncing)
    }
}

/// One axis until it is done or at fault: the last step, and where the machine really stands, counted from where it began.
fn run(plan: &HomingPlan, switch: &mut Switch) -> (Step, i32, u32) {
    let raw = u8::from(switch.read(0));
    let mut homing = Homing::begin(plan, 1, [Fixed(0); MOST_AXES], raw);
    let (mut position, mut velocity) = (0, 0);
    let most = 2_000.0 / 1024.0 / 1024.0 * UNITS;
    for tick in 0..200_000 {
        let step = homing.step(plan, u8::from(switch.read(position)), false);
        if step.done || step.fault.is_some() {
            return (step, position, tick);
        }
        let moved = step.setpoint[0].0 - position;
        assert!(f64::from(moved - velocity).abs() <= most, "tick {tick}: {velocity} to {moved}");
        assert!(f64::from(moved).abs() <= 50.0 / 1024.0 * UNITS);
        (position, velocity) = (step.setpoint[0].0, moved);
    }
    panic!("homing does not end");
}

/// Home is the switch less the pull-off: to one tick's way of the slow approach, whatever hysteresis, bouncing and start there are.
#[test]
fn home_is_found_to_one_ticks_slow_way() {
    let slow = (2.0 / 1024.0 * UNITS) as i32;
    for (toward, sign) in [(End::Low, -1), (End::High, 1)] {
        let plan = plan(&[settings(AxisName::X, toward, 0)]);
        for distance in [0.0, 0.001, 0.3, 5.0, 33.337, 99.9] {
            for (hysteresis, bounces) in [(0.0, 0), (0.2, 5), (1.5, 5)] {
                let mut switch = Switch::new(toward, f64::from(sign) * distance, hysteresis, bounces);
                let (step, position, _) = run(&plan, &mut switch);
                assert_eq!(step.fault, None, "{toward:?} {distance} {hysteresis}");
                assert_eq!((step.homed, step.done, step.setpoint[0]), (1, true, Fixed::from_mm(7.0_f64)));
                let late = (position - switch.at) * sign + (3.0 * UNITS) as i32;
                assert!((0..slow).contains(&late), "{toward:?} {distance} {hysteresis} {bounces}: {late} of {slow}");
            }
        }
    }
}

#[test]
fn a_glitch_on_the_way_is_not_home() {
    let plan = plan(&[settings(AxisName::X, End::High, 0)]);
    let mut homing = Homing::begin(&plan, 1, [Fixed(0); MOST_AXES], 0);
    let mut switch = Switch::new(End::High, 40.0, 0.1, 0);
    let mut position = 0;
    for tick in 0..100_000_u32 {
        let glitch = tick % 50 < u32::from(DEBOUNCE) - 1 && switch.at - position > (6.0 * UNITS) as i32;
        let step = homing.step(&plan, u8::from(switch.read(position) | glitch), false);
        if step.done {
            assert!(((position - switch.at) - (-3.0 * UNITS) as i32).unsigned_abs() < 512 + 1);
            return;
        }
        assert_eq!(step.fault, None);
        position = step.setpoint[0].0;
    }
    panic!("homing does not end");
}

#[test]
fn a_switch_that_is_not_there_is_not_found_within_the_travel() {
    let plan = plan(&[settings(AxisName::X, End::Low, 0)]);
    let (step, position, ticks) = run(&plan, &mut Switch::new(End::Low, -120.0, 0.1, 0));
    assert_eq!(step.fault, Some((0, HomingFault::NotFound)));
    assert!(f64::from(-position) < 109.0 * UNITS);
    assert!(ticks < 2_400, "108 mm at 50 mm/s take 2.2 s");
}

#[test]
fn a_switch_that_is_lost_before_the_slow_approach_is_not_found() {
    let plan = plan(&[settings(AxisName::X, End::Low, 0)]);
    let mut homing = Homing::begin(&plan, 1, [Fixed(0); MOST_AXES], 0);
    let mut position = 0;
    for tick in 0..100_000 {
        // It acts at the first approach alone.
        let raw = tick < 600 && position < (-20.0 * UNITS) as i32;
        let step = homing.step(&plan, u8::from(raw), false);
        if let Some(fault) = step.fault {
            assert_eq!(fault, (0, HomingFault::NotFound));
            return;
        }
        position = step.setpoint[0].0;
    }
    panic!("homing does not end");
}

#[test]
fn a_switch_that_does_not_let_go_is_stuck() {
    let plan = plan(&[settings(AxisName::X, End::Low, 0)]);
    // From the start, behind a hysteresis wider than the back-off, and for the pull-off alone.
    let mut from_start = Switch::new(End::Low, 0.0, 0.0, 0);
    from_start.stuck = Some(true);
    for mut switch in [from_start, Switch::new(End::Low, -20.0, 4.5, 0)] {
        assert_eq!(run(&plan, &mut switch).0.fault, Some((0, HomingFault::Stuck)));
    }
    let short = HomingSettings { pull_off: 1.0, ..settings(AxisName::X, End::Low, 0).homing.unwrap() };
    let plan = self::plan(&[AxisSettings { homing: Some(short), ..settings(AxisName::X, End::Low, 0) }]);
    assert_eq!(run(&plan, &mut Switch::new(End::Low, -20.0, 1.5, 0)).0.fault, Some((0, HomingFault::Stuck)));
}

/// z first, then x and y together; b, which was not asked, stays.
#[test]
fn axes_go_in_their_order() {
    use AxisName::{B, X, Y, Z};
    let plan = plan(&[
        settings(X, End::Low, 1),
        settings(Y, End::Low, 1),
        settings(Z, End::High, 0),
        settings(B, End::Low, 0),
    ]);
    let mut switches =
        [-10.0, -25.0, 15.0].map(|at| Switch::new(if at < 0.0 { End::Low } else { End::High }, at, 0.1, 2));
    let mut homing = Homing::begin(&plan, 0b111, [Fixed(77); MOST_AXES], 0);
    let mut position = [0_i32; 3];
    let mut homed = 0;
    for _ in 0..100_000 {
        let raw = (0..3).fold(0, |raw, k| raw | u8::from(switches[k].read(position[k])) << k);
        let step = homing.step(&plan, raw, false);
        assert_eq!((step.fault, step.setpoint[3]), (None, Fixed(77)));
        if homed & 0b100 == 0 {
            assert_eq!(step.setpoint[0], Fixed(0));
            assert_eq!(step.setpoint[1], Fixed(0));
        }
        homed |= step.homed;
        if step.done {
            assert_eq!(homed, 0b111);
            return;
        }
        for (k, position) in position.iter_mut().enumerate() {
            *position = if homed >> k & 1 == 0 { step.setpoint[k].0 } else { *position };
        }
    }
    panic!("homing does not end");
}

/// Asked to stop at any tick, the axis rests within the time that its acceleration takes.
#[test]
fn a_search_can_be_stopped_at_any_tick() {
    let plan = plan(&[settings(AxisName::X, End::Low, 0)]);
    for at in (0..2_000).step_by(7) {
        let mut switch = Switch::new(End::Low, -20.0, 0.1, 3);
        let mut homing = Homing::begin(&plan, 1, [Fixed(0); MOST_AXES], 0);
        let mut position = 0;
        let mut rest = false;
        for tick in 0..at + 30 {
            let step = homing.step(&plan, u8::from(switch.read(position)), tick >= at);
            position = step.setpoint[0].0;
            rest = step.at_rest;
            if step.done {
                break;
            }
        }
        assert!(rest, "50 mm/s at 2000 mm/s2 take 26 ticks; stopped at {at}");
    }
}

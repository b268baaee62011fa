//! What a machine owes whatever happens to it, and the cases that have names.

use super::*;

const RELEASE: u8 = 4;
const CONFIG: SafetyConfig = SafetyConfig {
    axes: 0b111,
    encoders: 0b010,
    homing: 0b111,
    home_low: 0b001,
    home_high: 0,
    debounce: 3,
    release: RELEASE,
};
const CLEAR: Levels = Levels { estop: false, low: 0, high: 0, home: 0, drive_fault: 0 };
const PRESSED: Levels = Levels { estop: true, ..CLEAR };

/// A machine that is homed and idle.
fn homed() -> Safety {
    let mut safety = Safety::after_reset(ResetCause::Ordinary);
    for event in [Event::Home { axes: 0b111 }, Event::AxisHomed { axes: 0b111 }, Event::Homed] {
        assert_eq!(safety.step(&CONFIG, CLEAR, Some(event)).refused, None);
    }
    safety
}

fn running() -> Safety {
    let mut safety = homed();
    let out = safety.step(&CONFIG, CLEAR, Some(Event::Start(Coordinates::Machine)));
    assert_eq!((out.state, out.known), (State::Run, 0b111));
    safety
}

#[test]
fn a_job_in_machine_coordinates_needs_a_known_position() {
    let mut safety = Safety::after_reset(ResetCause::Ordinary);
    let out = safety.step(&CONFIG, CLEAR, Some(Event::Start(Coordinates::Machine)));
    assert_eq!(out.refused, Some(Refused::PositionUnknown { axis: 0 }));
    assert!(out.state == State::Idle);
    assert_eq!(safety.step(&CONFIG, CLEAR, Some(Event::Start(Coordinates::Relative))).state, State::Run);
    assert!(homed().is_ready(&CONFIG));
}

#[test]
fn an_emergency_stop_acts_at_once_and_ends_with_release_and_acknowledgement() {
    let mut safety = running();
    let out = safety.step(&CONFIG, PRESSED, Some(Event::Resume));
    assert_eq!((out.state, out.drives, out.advance, out.known), (State::EStop, false, false, 0b010));
    assert_eq!(out.refused, Some(Refused::State { state: State::EStop }));
    for _ in 1..RELEASE {
        let out = safety.step(&CONFIG, CLEAR, Some(Event::Acknowledge));
        assert_eq!((out.state, out.refused), (State::EStop, Some(Refused::EStopPressed)));
    }
    let out = safety.step(&CONFIG, CLEAR, None);
    assert_eq!((out.state, out.drives), (State::EStop, false));
    let out = safety.step(&CONFIG, CLEAR, Some(Event::Acknowledge));
    assert_eq!((out.state, out.drives, out.resume_from_encoders, out.known), (State::Idle, true, true, 0b010));
    assert!(!safety.step(&CONFIG, CLEAR, None).resume_from_encoders);
}

#[test]
fn a_drive_fault_acts_at_once_and_takes_the_position_of_its_servo_too() {
    let mut safety = running();
    let out = safety.step(&CONFIG, Levels { drive_fault: 0b010, ..CLEAR }, None);
    assert_eq!((out.state, out.fault, out.known), (State::Fault, Some(Fault::Drive { axis: 1 }), 0));
    let out = safety.step(&CONFIG, Levels { drive_fault: 0b010, ..CLEAR }, Some(Event::Acknowledge));
    assert_eq!(out.refused, Some(Refused::DriveFault { axis: 1 }));
}

#[test]
fn a_following_error_takes_the_position_of_its_axis() {
    let mut safety = running();
    let out = safety.step(&CONFIG, CLEAR, Some(Event::Trip(Fault::FollowingError { axis: 1 })));
    assert_eq!((out.state, out.known), (State::Fault, 0));
}

#[test]
fn limit_switches_are_debounced_and_the_first_fault_stays() {
    let mut safety = running();
    let limit = Levels { high: 0b100, ..CLEAR };
    for _ in 1..CONFIG.debounce {
        assert_eq!(safety.step(&CONFIG, limit, None).state, State::Run);
    }
    let fault = Some(Fault::Limit { axis: 2, end: End::High });
    assert_eq!(safety.step(&CONFIG, limit, None).fault, fault);
    assert_eq!(safety.step(&CONFIG, limit, Some(Event::Trip(Fault::Steps { axis: 0 }))).fault, fault);
    let out = safety.step(&CONFIG, limit, Some(Event::Acknowledge));
    assert_eq!((out.state, out.fault), (State::Idle, None));
    let out = safety.step(&CONFIG, limit, Some(Event::Start(Coordinates::Relative)));
    assert_eq!(out.refused, Some(Refused::OnLimit { axis: 2 }));
    // It may home from there, since the switch acted before.
    assert_eq!(safety.step(&CONFIG, limit, Some(Event::Home { axes: 0b111 })).state, State::Homing);
    assert_eq!(safety.step(&CONFIG, limit, None).state, State::Homing);
}

#[test]
fn a_home_switch_at_a_limit_trips_outside_of_homing_only() {
    let mut safety = homed();
    safety.step(&CONFIG, CLEAR, Some(Event::Home { axes: 0b001 }));
    for _ in 0..10 {
        assert_eq!(safety.step(&CONFIG, Levels { low: 0b001, ..CLEAR }, None).state, State::Homing);
    }
    for _ in 0..CONFIG.debounce {
        safety.step(&CONFIG, Levels { low: 0b010, ..CLEAR }, None);
    }
    assert_eq!(safety.step(&CONFIG, CLEAR, None).fault, Some(Fault::Limit { axis: 1, end: End::Low }));
}

#[test]
fn starvation_is_no_fault_and_a_cancelled_homing_leaves_the_position_unknown() {
    let mut safety = running();
    assert_eq!(safety.step(&CONFIG, CLEAR, Some(Event::AtRest)).state, State::Run);
    assert_eq!(safety.step(&CONFIG, CLEAR, Some(Event::Cancel)).state, State::Braking);
    assert_eq!(safety.step(&CONFIG, CLEAR, Some(Event::AtRest)).known, 0b111);
    safety.step(&CONFIG, CLEAR, Some(Event::Home { axes: 0b001 }));
    safety.step(&CONFIG, CLEAR, Some(Event::Cancel));
    let out = safety.step(&CONFIG, CLEAR, Some(Event::AtRest));
    assert_eq!((out.state, out.known), (State::Idle, 0b110));
    for axes in [0, 0b1000] {
        assert_eq!(safety.step(&CONFIG, CLEAR, Some(Event::Home { axes })).refused, Some(Refused::NoHome));
    }
}

#[test]
fn a_bad_reset_is_a_fault_until_it_is_acknowledged() {
    for cause in [ResetCause::Watchdog, ResetCause::BrownOut, ResetCause::HardFault] {
        let mut safety = Safety::after_reset(cause);
        let out = safety.step(&CONFIG, CLEAR, None);
        assert_eq!((out.state, out.fault, out.known), (State::Fault, Some(Fault::Reset { cause }), 0));
        assert_eq!(safety.step(&CONFIG, CLEAR, Some(Event::Acknowledge)).state, State::Idle);
    }
}

#[test]
fn polarity_is_applied_to_what_is_connected() {
    let all = Levels { estop: true, low: 0b11, high: 0b11, home: 0b11, drive_fault: 0b11 };
    let wiring = Wiring { connected: all, active_low: Levels { low: 0b01, ..CLEAR } };
    assert_eq!(wiring.levels(CLEAR), Levels { low: 0b01, ..CLEAR });
    assert_eq!(wiring.levels(all), Levels { low: 0b10, ..all });
    assert_eq!(Wiring::default().levels(all), CLEAR);
}

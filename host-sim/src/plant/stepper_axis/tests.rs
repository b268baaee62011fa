//! Closed forms of the stepping axis, and steps that it loses where a real one would.

use std::f64::consts::TAU;

use super::*;

const TICK: f64 = 1.0 / 1024.0;

/// 200 full steps of 0.025 mm, 16 microsteps; 23 m/s^2 of holding push; rings at 191 Hz.
fn model() -> StepperAxisModel {
    StepperAxisModel {
        microstep: 0.025 / 16.0,
        turn: 64,
        holding: 23_000.0,
        corner_speed: 60.0,
        friction: Friction { viscous: 40.0, ..Friction::default() },
        load: 0.0,
        play: 0.0,
        encoder: None,
        step: TICK / 8.0,
    }
}

fn settle(axis: &mut StepperAxis) -> Reading {
    (0..2048).map(|_| axis.advance(Command::Steps(0), TICK)).last().unwrap()
}

/// Speeds up by `acceleration` to `speed` in mm/s, runs on for half a second, and gives the last reading under way.
fn race(axis: &mut StepperAxis, speed: f64, acceleration: f64) -> Reading {
    let ramp = (speed / acceleration / TICK) as i32;
    let mut reading = Reading::default();
    for k in 0..ramp + 512 {
        let way = TICK * TICK * acceleration * f64::from(k.min(ramp)).powi(2) / 2.0
            + f64::from((k - ramp).max(0)) * speed * TICK;
        let pulses = axis.nearest_microstep(way) - axis.field();
        reading = axis.advance(Command::Steps(pulses as i32), TICK);
    }
    reading
}

/// At rest under a load the rotor lags by asin(load/holding) of the electrical turn, whatever the load below the holding torque.
#[test]
fn the_static_lag_is_the_arc_sine() {
    for part in [-0.95_f64, -0.3, 0.0, 0.5, 0.9] {
        let mut axis = StepperAxis::new(StepperAxisModel { load: part * 23_000.0, ..model() });
        axis.rest_at(3.0);
        // The load comes at once and the rotor swings to twice the lag, which a real one would survive up to 0.72 only.
        axis.body.position += part.asin() / TAU * 0.1 * 0.9;
        let reading = settle(&mut axis);
        assert!((reading.position - 3.0 - part.asin() / TAU * 0.1).abs() < 1e-9, "{part} {reading:?}");
        assert_eq!(reading.lost_steps, 0);
    }
}

/// A small swing about a full step: w = sqrt(holding 2 pi/turn), dying out as e^(-Bt/2).
#[test]
fn the_rotor_rings_at_its_frequency() {
    let step = TICK / 64.0;
    let mut axis = StepperAxis::new(StepperAxisModel { step, ..model() });
    axis.body.position = 1e-4;
    let w = (23_000.0 * TAU / 0.1_f64).sqrt();
    let (half, root) = (20.0, (w * w - 400.0).sqrt());
    for k in 1..=4096 {
        axis.advance(Command::Steps(0), step);
        let t = f64::from(k) * step;
        let exact = 1e-4 * (-half * t).exp() * ((root * t).cos() + half / root * (root * t).sin());
        // The lattice shifts the phase by (w h)^2/24 of it, 1e-4 rad after 0.06 s; a sine is shallower than its tangent.
        assert!((axis.rotor().position - exact).abs() < 2e-7, "{k} {} {exact}", axis.rotor().position);
    }
}

/// Friction holds up to the torque that is left at a speed, and not beyond: holding/sqrt(1 + (v/vc)^2), less viscous friction.
#[test]
fn pull_out_is_where_the_torque_ends() {
    for speed in [5.0, 60.0, 120.0] {
        let slip = speed / 60.0_f64;
        let left = 23_000.0 / (1.0 + slip * slip).sqrt() - 40.0 * speed;
        for (part, holds) in [(0.93, true), (1.03, false)] {
            let coulomb = part * left;
            let friction = Friction { viscous: 40.0, coulomb, breakaway: coulomb };
            let mut axis = StepperAxis::new(StepperAxisModel { friction, ..model() });
            let reading = race(&mut axis, speed, 20.0);
            assert_eq!(reading.lost_steps == 0, holds, "{speed} {part} {reading:?}");
        }
    }
}

/// A start that is too fast loses steps; at rest again, the rotor stands off its field by whole electrical turns, four full steps
/// each, and the reading says how many.
#[test]
fn lost_steps_are_multiples_of_four() {
    let mut losses = Vec::new();
    for pulses in [4, 80, 160, 320, -320] {
        let mut axis = StepperAxis::new(model());
        for _ in 0..300 {
            axis.advance(Command::Steps(pulses), TICK);
        }
        let reading = settle(&mut axis);
        let off = reading.position - axis.field() as f64 * 0.025 / 16.0;
        assert_eq!(reading.lost_steps % 4, 0);
        assert!((off - f64::from(reading.lost_steps) * 0.025).abs() < 1e-9, "{pulses} {reading:?} {off}");
        losses.push(reading.lost_steps);
    }
    assert!(losses[0] == 0 && losses[3] < -1000 && losses[4] == -losses[3], "{losses:?}");
}

/// Pulses one by one at their instants, as a pin gives them, move the rotor as one call that spreads them.
#[test]
fn pulses_at_a_pin_are_the_same_motion() {
    let fine = StepperAxisModel { step: TICK / 256.0, ..model() };
    let (mut spread, mut pin) = (StepperAxis::new(fine), StepperAxis::new(fine));
    for _ in 0..100 {
        let one = spread.advance(Command::Steps(-16), TICK);
        let mut two = Reading::default();
        for k in 0..16 {
            pin.advance(Command::Steps(0), TICK / 32.0);
            pin.advance(Command::Steps(-1), 0.0);
            two = pin.advance(Command::Steps(0), TICK / 32.0);
            assert_eq!(two.lost_steps, 0, "{k}");
        }
        assert!((one.position - two.position).abs() < 1e-8, "{one:?} {two:?}");
        assert_eq!(spread.field(), pin.field());
    }
}

/// The same with all instants in one call; and a pulse is seen from the first middle of an integration step after it.
#[test]
fn pulses_at_their_instants_are_the_same_motion() {
    let fine = StepperAxisModel { step: TICK / 256.0, ..model() };
    let (mut spread, mut timed) = (StepperAxis::new(fine), StepperAxis::new(fine));
    let pulses: Vec<Pulse> =
        (0..16).map(|k| Pulse { instant: (f64::from(k) + 0.5) / 16.0 * TICK, forward: false }).collect();
    for _ in 0..100 {
        let one = spread.advance(Command::Steps(-16), TICK);
        let two = timed.advance_through(&pulses, TICK);
        assert!((one.position - two.position).abs() < 1e-12, "{one:?} {two:?}");
        assert_eq!(spread.field(), timed.field());
    }
    let rests = |instant: f64| {
        let mut axis = StepperAxis::new(StepperAxisModel { step: TICK, ..model() });
        axis.advance_through(&[Pulse { instant, forward: true }], TICK);
        assert_eq!(axis.field(), 1);
        axis.rotor().velocity == 0.0
    };
    assert!(!rests(0.49 * TICK) && rests(0.51 * TICK));
}

/// Second order: halving the step quarters the largest difference from a run with very fine steps.
#[test]
fn halving_the_step_quarters_the_error() {
    let run = |cuts: f64| -> Vec<f64> {
        // A load instead of pulses, so that nothing but the motion itself is cut.
        let mut axis = StepperAxis::new(StepperAxisModel { step: TICK / cuts, load: 9_000.0, ..model() });
        (0..60).map(|_| axis.advance(Command::Steps(0), TICK).position).collect()
    };
    let exact = run(2048.0);
    let errors = [16.0, 32.0, 64.0]
        .map(|cuts| run(cuts).iter().zip(&exact).map(|(found, exact)| (found - exact).abs()).fold(0.0, f64::max));
    // Of an electrical turn of 0.1 mm.
    assert!(errors[0] < 2e-4, "{errors:?}");
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1] / 4.0 - 1.0).abs() < 0.05, "{errors:?}");
    }
}

/// Without an encoder the counter shows whole microsteps; a reversal costs the play. The rotor is damped beyond swinging.
#[test]
fn play_and_counts() {
    let friction = Friction { viscous: 3_000.0, ..Friction::default() };
    let mut axis = StepperAxis::new(StepperAxisModel { play: 0.03, friction, ..model() });
    for (pulse, table) in [(1, 0.1 - 0.015), (-1, 0.015)] {
        for _ in 0..64 {
            axis.advance(Command::Steps(pulse), TICK);
        }
        let reading = settle(&mut axis);
        assert!((reading.position - table).abs() < 1e-9, "{reading:?}");
        assert_eq!(i64::from(reading.counts), axis.field());
    }
}

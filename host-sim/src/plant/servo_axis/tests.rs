//! Closed forms of the servo drive with one body and with two.

use std::f64::consts::TAU;

use super::*;

const TICK: f64 = 1.0 / 1024.0;

fn rigid(law: DriveLaw) -> ServoAxisModel {
    ServoAxisModel {
        law,
        limit: 10_000.0,
        sample_time: 0.0,
        friction: Friction { viscous: 30.0, ..Friction::default() },
        spring: None,
        play: 0.0,
        load: 0.0,
        encoder: Encoder { counts_per_mm: 1000.0, on_table: false },
        step: TICK / 4.0,
    }
}

/// 20 kg and 30 kg on a spring of 4740 N/mm: 100 Hz.
fn sprung(damping: f64, step: f64) -> ServoAxisModel {
    let spring = Spring { stiffness: 4_737.410_112_522_9, damping, backlash: 0.0, masses: [20.0, 30.0] };
    ServoAxisModel {
        friction: Friction::default(),
        spring: Some((spring, Friction::default())),
        step,
        limit: 1e9,
        ..rigid(DriveLaw::Torque(1.0))
    }
}

/// The spring's stretch after the two bodies have been pulled 1 mm apart and let go, for each of `steps` integration steps.
fn ring(model: ServoAxisModel, steps: usize) -> Vec<f64> {
    let mut axis = ServoAxis::new(model);
    axis.body.position = 1.0;
    (0..steps)
        .map(|_| {
            axis.advance(Command::Acceleration(0.0), model.step);
            axis.body.position - axis.table()
        })
        .collect()
}

/// At the limit u: v = u/B (1 - e^(-Bt)), and the reading says that it was cut off; half of the limit is not.
#[test]
fn a_drive_at_its_limit_accelerates_as_the_limit_says() {
    let mut axis = ServoAxis::new(rigid(DriveLaw::Torque(1.0)));
    for k in 1..=200 {
        assert!(axis.advance(Command::Acceleration(25_000.0), TICK).saturated);
        let exact = 10_000.0 / 30.0 * -(-30.0 * TICK * f64::from(k)).exp_m1();
        assert!((axis.motor().velocity / exact - 1.0).abs() < 1e-12, "{k}");
    }
    assert!(!axis.advance(Command::Acceleration(-5_000.0), TICK).saturated);
}

/// Braked by Coulomb friction alone from v, through the axis: v^2/(2C), and then at rest for good.
#[test]
fn an_axis_coasts_to_its_exact_stop() {
    let friction = Friction { viscous: 0.0, coulomb: 700.0, breakaway: 900.0 };
    let mut axis = ServoAxis::new(ServoAxisModel { friction, ..rigid(DriveLaw::Torque(1.0)) });
    axis.body.velocity = -80.0;
    let mut reading = Reading::default();
    for _ in 0..1024 {
        reading = axis.advance(Command::Acceleration(0.0), TICK);
    }
    assert!((reading.position + 80.0 * 80.0 / 1400.0).abs() < 1e-11);
    assert_eq!((axis.motor().velocity, reading.counts), (0.0, -4572));
    assert_eq!(axis.advance(Command::Acceleration(899.0), 1.0).position, reading.position);
}

/// A velocity loop of gain g that looks once a sample: v' = v e^(-Bh) + g (c - v) (1 - e^(-Bh))/B, a geometric approach.
#[test]
fn a_sampled_velocity_loop_approaches_geometrically() {
    let (gain, viscous, asked) = (211.0, 30.0_f64, 20.0);
    let mut axis = ServoAxis::new(ServoAxisModel { sample_time: TICK, ..rigid(DriveLaw::Velocity(gain)) });
    let part = -(-viscous * TICK).exp_m1() / viscous;
    let ratio = (-viscous * TICK).exp() - gain * part;
    let end = gain * part * asked / (1.0 - ratio);
    for k in 1..60 {
        axis.advance(Command::Velocity(asked), TICK);
        assert!((axis.motor().velocity - end * (1.0 - ratio.powi(k))).abs() < 1e-11, "{k}");
    }
}

/// The drive's clock is its own: calls that cut its sample into pieces change nothing but rounding.
#[test]
fn cutting_a_call_changes_nothing() {
    for model in [
        ServoAxisModel { sample_time: TICK, ..rigid(DriveLaw::Velocity(211.0)) },
        ServoAxisModel { play: 0.01, ..rigid(DriveLaw::Torque(1.0)) },
        sprung(3.0, TICK / 16.0),
    ] {
        let (mut whole, mut cut) = (ServoAxis::new(model), ServoAxis::new(model));
        for k in 0..500 {
            let command = match model.law {
                DriveLaw::Velocity(_) => Command::Velocity(f64::from(k % 37) - 18.0),
                DriveLaw::Torque(_) => Command::Acceleration(f64::from(k % 37) * 50.0 - 900.0),
            };
            let one = whole.advance(command, TICK);
            cut.advance(command, TICK / 4.0);
            cut.advance(command, TICK / 2.0);
            let two = cut.advance(command, TICK / 4.0);
            assert!((one.position - two.position).abs() < 1e-9, "{k} {one:?} {two:?}");
        }
    }
}

/// Two bodies on a spring: w = sqrt(k (1/m1 + 1/m2)); the leapfrog's own error of the frequency is (w h)^2/24.
#[test]
fn the_free_resonance_has_its_frequency() {
    let step = TICK / 16.0;
    let stretch = ring(sprung(0.0, step), 16_384 * 2);
    let crossings: Vec<f64> = (1..stretch.len())
        .filter(|&k| stretch[k - 1] > 0.0 && stretch[k] <= 0.0)
        .map(|k| k as f64 + stretch[k - 1] / (stretch[k - 1] - stretch[k]))
        .collect();
    let periods = (crossings.len() - 1) as f64;
    let frequency = periods / ((crossings[crossings.len() - 1] - crossings[0]) * step);
    let lattice = (TAU * 100.0 * step).powi(2) / 24.0;
    assert!((frequency / 100.0 - 1.0 - lattice).abs() < 1e-6, "{frequency}");
}

/// With a damper: the stretch is e^(-zeta w t) (cos wd t + zeta/sqrt(1 - zeta^2) sin wd t), zeta = c (1/m1 + 1/m2)/(2 w).
/// Within 1.5e-3 of the amplitude over 20 periods at 16 steps a tick, and four times closer for each halving of the step.
#[test]
fn halving_the_step_quarters_the_error() {
    let (w, zeta) = (TAU * 100.0, 0.02_f64);
    // c in N s/mm is 1e-3 of N s/m.
    let damping = 2e-3 * zeta * w / (1.0 / 20.0 + 1.0 / 30.0);
    let root = (1.0 - zeta * zeta).sqrt();
    let errors = [16.0, 32.0, 64.0].map(|cuts: f64| {
        let step = TICK / cuts;
        let stretch = ring(sprung(damping, step), (0.2 / step) as usize);
        let error = |(k, found): (usize, &f64)| {
            let t = (k + 1) as f64 * step;
            let phase = w * root * t;
            (found - (-zeta * w * t).exp() * (phase.cos() + zeta / root * phase.sin())).abs()
        };
        stretch.iter().enumerate().map(error).fold(0.0, f64::max)
    });
    assert!(errors[0] < 1.5e-3, "{errors:?}");
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1] / 4.0 - 1.0).abs() < 0.03, "{errors:?}");
    }
}

/// No damper: after a hundred seconds and ten thousand periods the amplitude is still 1 mm.
#[test]
fn two_bodies_keep_their_energy() {
    let stretch = ring(sprung(0.0, TICK / 8.0), 8 * 1024 * 100);
    let last = &stretch[stretch.len() - 1000..];
    let highest = last.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    // Samples may miss the peak by half a step, 1 - cos(w h/2).
    assert!((highest - 1.0).abs() < 2e-3, "{highest}");
}

/// Moved forth and back by the same way, the table comes back short by the play, and the encoder on the motor does not see it.
#[test]
fn a_reversal_costs_the_play() {
    let law = DriveLaw::Velocity(500.0);
    let mut axis = ServoAxis::new(ServoAxisModel { play: 0.04, ..rigid(law) });
    let mut drive = |speed: f64| {
        (0..1024).map(|_| axis.advance(Command::Velocity(speed), TICK)).last().map(|reading| (reading, axis.motor()))
    };
    let (there, motor) = drive(10.0).unwrap();
    assert!((motor.position - there.position - 0.02).abs() < 1e-12);
    let (back, motor) = drive(-10.0).unwrap();
    assert!((back.position - motor.position - 0.02).abs() < 1e-12);
    assert_eq!(back.counts, (motor.position * 1000.0).floor() as i32);
}

/// The same with a spring: at rest the table stays where the flank left it, within the dead zone, and the widest difference of the
/// two ends is the dead zone.
#[test]
fn a_spring_with_a_dead_zone_has_its_width() {
    let mut model = sprung(5.0, TICK / 16.0);
    model.law = DriveLaw::Velocity(200.0);
    model.encoder.on_table = true;
    let heavy = Friction { viscous: 50.0, coulomb: 500.0, breakaway: 500.0 };
    model.spring = model.spring.map(|(spring, _)| (Spring { backlash: 0.05, ..spring }, heavy));
    let mut axis = ServoAxis::new(model);
    let mut gap = [0.0; 2];
    for (turn, speed) in [5.0, -5.0].into_iter().enumerate() {
        let mut reading = Reading::default();
        for _ in 0..2048 {
            reading = axis.advance(Command::Velocity(speed), TICK);
        }
        gap[turn] = axis.motor().position - reading.position;
        assert_eq!(reading.counts, (reading.position * 1000.0).floor() as i32);
    }
    // At steady speed the flank also carries the table's friction, 30 kg (500 + 50 * 4.9) mm/s^2 = 22.5 N: 0.005 mm a side.
    let speed = axis.motor().velocity.abs();
    let stretch = 30.0 * (500.0 + 50.0 * speed) * 1e-3 / 4_737.41;
    assert!((gap[0] - gap[1] - 0.05 - 2.0 * stretch).abs() < 1e-6, "{gap:?} {stretch}");
}

/// Two equal runs give equal bits, also after other durations in between have changed what is prepared.
#[test]
fn equal_runs_are_equal_bits() {
    let mut axis = ServoAxis::new(sprung(1.0, TICK / 16.0));
    let mut run = || -> Vec<Reading> {
        axis.rest_at(12.345);
        axis.advance(Command::Acceleration(1.0), 0.77 * TICK);
        axis.rest_at(12.345);
        (0..300).map(|k| axis.advance(Command::Acceleration(f64::from(k * 7 % 100) - 30.0), TICK)).collect()
    };
    assert_eq!(run(), run());
}

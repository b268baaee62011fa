//! Closed forms of the servo, its f64 twin, and what it refuses.

use proptest::prelude::*;

use super::*;

const TICK: f64 = 1.0 / 1024.0;

fn velocity_drive() -> ServoSettings {
    ServoSettings {
        counts_per_mm: MOST_COUNTS_PER_MM,
        position_gain: 170.0,
        integral_gain: 0.0,
        velocity_feedforward: 1.0,
        acceleration_feedforward: 0.0,
        drive: DriveSettings::Velocity { lag: 0.0, limit: 1e4 },
    }
}

fn count(x: f64, settings: &ServoSettings) -> i32 {
    libm::floor(x * settings.counts_per_mm) as i32
}

/// Runs a servo on an axis that `motion` moves by one tick of `period` under a held command; gives x at every tick.
fn run(
    settings: &ServoSettings,
    period: f64,
    ticks: usize,
    setpoint: impl Fn(f64) -> f64,
    mut motion: impl FnMut(f64, f64) -> f64,
    mut see: impl FnMut(f64, f64, &ServoState<f64>),
) {
    let servo: Servo<f64> = settings.activate(period).unwrap();
    let mut state = servo.at_rest(Fixed(0), 0);
    let mut x = 0.0;
    for k in 0..ticks {
        let next = Fixed::from_mm(setpoint((k + 1) as f64 * period));
        let command = servo.step(&mut state, next, count(x, settings));
        see(k as f64 * period, x, &state);
        x = motion(x, command);
    }
}

/// The textbook step response 1 - e^(-zeta wn t) (cos wd t + zeta/sqrt(1 - zeta^2) sin wd t), with wn^2 = kp kd and
/// 2 zeta wn = kd. The hold, the difference and the first tick's setpoint delay it by 2 ticks of 10 us: 0.3 % of the height
/// at wn = 100/s.
#[test]
fn a_step_follows_the_second_order_response() {
    let (wn, period, height) = (100.0_f64, 1e-5, 100.0);
    for zeta in [0.4_f64, 0.7, 0.9] {
        let drive = DriveSettings::Acceleration { velocity_gain: 2.0 * zeta * wn, limit: 1e8 };
        let settings =
            ServoSettings { position_gain: wn / (2.0 * zeta), velocity_feedforward: 0.0, drive, ..velocity_drive() };
        let root = libm::sqrt(1.0 - zeta * zeta);
        let mut v = 0.0;
        run(
            &settings,
            period,
            10_000,
            |_| height,
            |x, a| {
                let moved = x + v * period + a * period * period / 2.0;
                v += a * period;
                moved
            },
            |t, x, _| {
                let phase = wn * root * t;
                let fade = libm::exp(-zeta * wn * t);
                let exact = 1.0 - fade * (libm::cos(phase) + zeta / root * libm::sin(phase));
                assert!((x / height - exact).abs() < 0.003, "{zeta} {t} {x} {exact}");
            },
        );
    }
}

/// At steady speed V the velocity asked for is V: the lag is (1 - kv) V / kp, whatever the drive, and none at kv = 1.
#[test]
fn the_lag_at_steady_speed_is_what_feedforward_leaves() {
    for (feedforward, integral_gain) in [(1.0, 0.0), (0.8074, 0.0), (0.0, 0.0), (0.8074, 20.0)] {
        let settings = ServoSettings { velocity_feedforward: feedforward, integral_gain, ..velocity_drive() };
        let speed = 84.667;
        let mut lag = 0.0;
        run(&settings, TICK, 2048, |t| speed * t, |x, v| x + v * TICK, |_, _, state| lag = state.position_error());
        let exact = (1.0 - feedforward) * speed / settings.position_gain;
        // Half the encoder's count and the setpoint's unit, through the differences of one tick.
        assert!((lag - exact).abs() < 3e-5, "{feedforward} {lag} {exact}");
    }
}

/// A drive that follows its command with the time constant T, held over ticks, lags a constant acceleration a by
/// a (T + tick/2) / kp; acceleration feedforward with that lag takes it away.
#[test]
fn acceleration_feedforward_makes_up_for_the_drive() {
    let (time, a) = (0.005, 300.0);
    for part in [0.0, 0.5, 1.0] {
        let drive = DriveSettings::Velocity { lag: time + TICK / 2.0, limit: 1e4 };
        let settings = ServoSettings { acceleration_feedforward: part, drive, position_gain: 60.0, ..velocity_drive() };
        let (mut v, mut lag) = (0.0, 0.0);
        let fade = libm::exp(-TICK / time);
        let motion = |x: f64, command: f64| {
            let moved = x + command * TICK + (v - command) * time * (1.0 - fade);
            v = command + (v - command) * fade;
            moved
        };
        run(&settings, TICK, 1024, |t| a * t * t / 2.0, motion, |_, _, state| lag = state.position_error());
        let exact = (1.0 - part) * a * (time + TICK / 2.0) / settings.position_gain;
        assert!((lag - exact).abs() < 5e-5, "{part} {lag} {exact}");
    }
}

/// Two seconds at the limit leave nothing in the integral: the axis arrives without overshoot. While it wound up it would pass
/// by 30 mm and more.
#[test]
fn the_integral_does_not_wind_up() {
    let drive = DriveSettings::Velocity { lag: 0.0, limit: 50.0 };
    let settings = ServoSettings {
        integral_gain: 20.0,
        velocity_feedforward: 0.0,
        drive,
        position_gain: 40.0,
        ..velocity_drive()
    };
    let (mut highest, mut limited, mut last) = (0.0_f64, 0, 0.0);
    run(
        &settings,
        TICK,
        4096,
        |_| 100.0,
        |x, v| x + v * TICK,
        |_, x, state| {
            highest = highest.max(x);
            limited += i32::from(state.is_saturated());
            last = x;
        },
    );
    assert!(limited > 1900 && highest < 100.0 + 2e-5 && (last - 100.0).abs() < 2e-5, "{limited} {highest} {last}");
}

/// A constant load takes speed off the drive; the integral of the velocity error gives it back.
#[test]
fn the_integral_carries_a_load() {
    for (integral_gain, lag) in [(0.0, 5.0 / 170.0), (10.0, 0.0)] {
        let settings = ServoSettings { integral_gain, ..velocity_drive() };
        let mut error = 0.0;
        run(&settings, TICK, 4096, |_| 0.0, |x, v| x + (v - 5.0) * TICK, |_, _, s| error = s.position_error());
        assert!((error - lag).abs() < 2e-5, "{integral_gain} {error}");
    }
}

/// The counter may stand anywhere and wrap: the commands are the same bits.
#[test]
fn a_counter_that_wraps_changes_nothing() {
    for counts_per_mm in [0.3, 800.0, 787.401_574_803_149_6, 131_072.0] {
        let settings = ServoSettings { counts_per_mm, integral_gain: 5.0, ..velocity_drive() };
        let servo: Servo<f32> = settings.activate(TICK).unwrap();
        let start = Fixed::from_mm(-2_000.0);
        let home = count(-2_000.0, &settings);
        let mut plain = servo.at_rest(start, home);
        let offset = i32::MAX.wrapping_sub(home).wrapping_sub(40);
        let mut wrapped = servo.at_rest(start, home.wrapping_add(offset));
        for k in 0..200 {
            let setpoint = Fixed(start.0 + k * k * 10);
            let counts = home + k;
            let command = servo.step(&mut plain, setpoint, counts);
            assert_eq!(command, servo.step(&mut wrapped, setpoint, counts.wrapping_add(offset)), "{counts_per_mm} {k}");
        }
    }
}

/// Near home and 4 m away the error is that of exact arithmetic, within the documented unit and 2^-31 of the coordinate.
#[test]
fn the_position_error_is_exact_far_from_home() {
    for counts_per_mm in [0.01, 1.0, 787.401_574_803_149_6, 1000.0, 99_999.9, 131_072.0] {
        let settings = ServoSettings { counts_per_mm, ..velocity_drive() };
        let servo: Servo<f32> = settings.activate(TICK).unwrap();
        for mm in [0.0, 0.3, -17.77, 1_999.9, -2_000.0, 4_000.0] {
            for lag in [0.0, 1e-4, -0.003, 0.25, -20.0, 3_999.0] {
                let position = Fixed::from_mm(mm);
                let counts = libm::round((mm - lag) * counts_per_mm) as i32;
                let exact = position.to_mm() - f64::from(counts) / counts_per_mm;
                let found = f64::from(servo.position_error(position, counts));
                let bound = 1.0 / UNITS_PER_MM + mm.abs() / 2_147_483_648.0 + exact.abs() * f64::from(f32::EPSILON);
                assert!((found - exact).abs() <= bound, "{counts_per_mm} {mm} {lag}: {found} {exact}");
            }
        }
    }
}

/// The f32 tick beside its f64 twin on the same inputs: each command within 8 roundoffs of the largest term in it. The
/// integral is left out, because it is a sum over all ticks before.
#[test]
fn f32_twin() {
    let mut seed = 7_u32;
    let mut random = |range: i32| {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as i32 % range - range / 2
    };
    for drive in [
        DriveSettings::Velocity { lag: 0.004, limit: 5_000.0 },
        DriveSettings::Acceleration { velocity_gain: 211.0, limit: 1e6 },
    ] {
        let settings = ServoSettings {
            counts_per_mm: 787.401_574_803_149_6,
            velocity_feedforward: 0.8,
            acceleration_feedforward: 1.0,
            drive,
            ..velocity_drive()
        };
        let (single, double) = (settings.activate::<f32>(TICK).unwrap(), settings.activate::<f64>(TICK).unwrap());
        let (mut s, mut d) = (single.at_rest(Fixed(0), 0), double.at_rest(Fixed(0), 0));
        let (mut at, mut counts) = (0_i32, 0_i32);
        for _ in 0..20_000 {
            at += random(100_000);
            counts += random(300);
            let before = (d.target, d.stride, d.encoder);
            let exact = double.step(&mut d, Fixed(at), counts);
            let found = f64::from(single.step(&mut s, Fixed(at), counts));
            let ahead = d.stride.abs() + before.1.abs();
            let terms = double.velocity_gain
                * (d.error.abs() * double.position_gain
                    + ahead * double.velocity_feedforward
                    + f64::from(counts - before.2).abs() * double.speed_per_count)
                + ahead * double.acceleration_feedforward;
            assert!((found - exact).abs() <= 8.0 * f64::from(f32::ROUNDOFF) * terms, "{found} {exact} {terms}");
        }
    }
}

#[test]
fn each_bad_setting_is_named() {
    let good = velocity_drive();
    assert!(good.activate::<f32>(TICK).is_ok());
    let accelerating = |velocity_gain, limit| DriveSettings::Acceleration { velocity_gain, limit };
    for (settings, period, key) in [
        (good, 0.0, "period"),
        (good, f64::NAN, "period"),
        (ServoSettings { counts_per_mm: 0.0, ..good }, TICK, "counts_per_mm"),
        (ServoSettings { counts_per_mm: 131_073.0, ..good }, TICK, "counts_per_mm"),
        (ServoSettings { position_gain: -1.0, ..good }, TICK, "position_gain"),
        (ServoSettings { position_gain: 1024.0, ..good }, TICK, "position_gain"),
        (ServoSettings { integral_gain: f64::NAN, ..good }, TICK, "integral_gain"),
        (ServoSettings { velocity_feedforward: 2.1, ..good }, TICK, "velocity_feedforward"),
        (ServoSettings { acceleration_feedforward: -0.1, ..good }, TICK, "acceleration_feedforward"),
        (ServoSettings { drive: DriveSettings::Velocity { lag: -1.0, limit: 1.0 }, ..good }, TICK, "lag"),
        (ServoSettings { drive: accelerating(0.0, 1.0), ..good }, TICK, "velocity_gain"),
        (ServoSettings { drive: accelerating(1.0, f64::INFINITY), ..good }, TICK, "limit"),
    ] {
        assert_eq!(settings.activate::<f32>(period).unwrap_err().key(), key);
    }
}

proptest! {
    /// Whatever the counter shows and the path does, the command is a number within the limit.
    #[test]
    fn the_command_stays_within_its_limit(
        counts_per_mm in LEAST_COUNTS_PER_MM..MOST_COUNTS_PER_MM,
        gains in [0.1..1000.0, 0.1..1000.0, 0.0..1000.0, 0.0..2.0, 0.0..2.0],
        limit in 1.0..1e9,
        inputs in prop::collection::vec((any::<i32>(), any::<i32>()), 1..50),
        takes_velocity in any::<bool>(),
    ) {
        let drive = if takes_velocity {
            DriveSettings::Velocity { lag: gains[3] / 2.0, limit }
        } else {
            DriveSettings::Acceleration { velocity_gain: gains[1], limit }
        };
        let settings = ServoSettings {
            counts_per_mm,
            position_gain: gains[0],
            integral_gain: gains[2],
            velocity_feedforward: gains[3],
            acceleration_feedforward: gains[4],
            drive,
        };
        let servo: Servo<f32> = settings.activate(TICK).unwrap();
        let mut state = servo.at_rest(Fixed(inputs[0].0), inputs[0].1);
        for (setpoint, encoder) in inputs {
            prop_assert!(servo.step(&mut state, Fixed(setpoint), encoder).abs() <= limit as f32);
        }
    }
}

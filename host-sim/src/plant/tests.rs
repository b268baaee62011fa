//! The whole plant: the fitted mill's figures, what it says about faulty files, and its servo in the loop.

use super::validate::{Block, Checked, read};
use super::*;

const TICK: f64 = 1.0 / 1024.0;

const ROUTER: &str = include_str!("../../../examples/router-plant.toml");

/// A torque drive, a resonance with play, a vertical axis: what the examples leave out.
const SPRUNG: &str = r#"
name = "test"
source = "none"
[[axis]]
names = ["z"]
lead = 10.0
play = 0.01
motor = { motor_inertia = 0.0004, viscous = 0.001, coulomb = 0.05 }
table = { mass = 40.0, viscous = 0.5, coulomb = 20.0, breakaway = 25.0, load = -392.0 }
coupling = { stiffness = 40000.0, damping = 12.0 }
encoder = { counts_per_mm = 1000.0 }
drive = { torque = { peak_torque = 6.0 } }
servo = { position_gain = 40.0, velocity_gain = 150.0, integral_gain = 20.0, velocity_feedforward = 1.0, limit = 20000.0 }
"#;

fn fixed(x: f64, y: f64, z: f64) -> Position {
    [x, y, z].map(Fixed::from_mm)
}

/// The ratios that were fitted, from the physical values of the file.
#[test]
fn the_mill_is_the_fitted_drive() {
    let parameters = read(MILL).unwrap();
    let block = Block { text: MILL, index: 0, step: parameters.step, axis: &parameters.axes[0] };
    let Checked::Servo(settings, model) = block.check().unwrap() else { panic!("a servo drive") };
    let near = |found: f64, fitted: f64| assert!((found / fitted - 1.0).abs() < 1e-12, "{found} {fitted}");
    let (wn, zeta) = (189.4193, 0.5574);
    near(model.friction.viscous, 31.8344);
    near(model.limit, 667.8935 * 25.4);
    let servo_axis::DriveLaw::Velocity(gain) = model.law else { panic!("a velocity drive") };
    near(gain, 2.0 * zeta * wn);
    near(settings.position_gain, wn / (2.0 * zeta));
    near(settings.velocity_feedforward, 0.8074);
    near(settings.counts_per_mm, 20_000.0 / 25.4);
    assert_eq!(model.sample_time, TICK);
}

/// At steady speed V the drive pushes against B V, so the error is (1 - kv) V/kp + B V/wn^2; the encoder, which
/// rounds down, takes half a count off.
#[test]
fn the_mill_lags_as_its_formula_says() {
    let mut plant = Plant::default_mill(TICK).unwrap();
    plant.rest_at(fixed(-50.0, 20.0, 0.0));
    let speed = 84.667;
    let mut lag = 0.0;
    for k in 1..=1024 {
        let x = -50.0 + speed * TICK * f64::from(k);
        let measured = plant.advance(fixed(x, 20.0, 7.0));
        lag = x - measured.position[0];
        assert!((measured.position[1] - 20.0).abs() < 2e-3 && measured.position[2] == 7.0);
    }
    let (kp, wn, count) = (169.913_258, 189.4193, 25.4 / 20_000.0);
    let exact = 0.1926 * speed / kp + 31.8344 * speed / (wn * wn);
    assert!((lag - exact + count / 2.0).abs() < count / 2.0, "{lag} {exact}");
}

/// The reference jumps by 5 mm: wn^2 times that is ten times the drive's limit.
#[test]
fn the_mill_says_when_it_is_at_its_limit() {
    let mut plant = Plant::default_mill(TICK).unwrap();
    plant.rest_at(fixed(0.0, 0.0, 0.0));
    plant.advance(fixed(5.0, 0.0, 0.0));
    let measured = plant.advance(fixed(5.0, 0.0, 0.0));
    assert_eq!((measured.saturated, measured.lost_steps), ([true, false, false], [0; 3]));
    for _ in 0..2048 {
        plant.advance(fixed(5.0, 0.0, 0.0));
    }
    let measured = plant.advance(fixed(5.0, 0.0, 0.0));
    assert!((measured.encoder[0] - 5.0).abs() < 0.003 && !measured.saturated[0], "{measured:?}");
}

/// A vertical axis with play behind a spring, held by the integral against its weight and its stick.
#[test]
fn a_sprung_axis_holds_its_weight() {
    let mut plant = Plant::from_toml(SPRUNG, TICK).unwrap();
    assert_eq!(plant.axes().iter().map(|axis| (axis.name(), axis.is_stepper())).collect::<Vec<_>>(), [("z", false)]);
    plant.rest_at(fixed(0.0, 0.0, 2000.0));
    let mut measured = Measured::default();
    for k in 0..8192 {
        let z = 2000.0 - 0.02 * f64::from(k.min(2048));
        measured = plant.advance(fixed(0.0, 0.0, z));
    }
    let end = 2000.0 - 40.96;
    assert!((measured.encoder[2] - end).abs() < 0.02, "{measured:?}");
    // The table hangs lower by half of the play, and by its weight less what its friction may carry.
    let hang = measured.encoder[2] - measured.position[2];
    assert!(hang > 0.005 && hang < 0.005 + (392.0 + 25.0) / 40_000.0 + 0.001, "{hang}");
}

/// A job that the router can do loses nothing; the table stays within play, a step's swing and the lag. Three times as fast it fails.
#[test]
fn the_router_follows_or_says_what_it_lost() {
    for (rate, keeps) in [(1.0, true), (6.0, false)] {
        let mut plant = Plant::from_toml(ROUTER, TICK).unwrap();
        plant.rest_at(fixed(30.0, 0.0, 0.0));
        let (mut widest, mut lost) = (0.0_f64, [0; 3]);
        for k in 0..4096 {
            // From rest into a circle of 30 mm, at most 60 mm/s times `rate`.
            let t = f64::from(k) * TICK;
            let angle = rate * 2.0 * (t - (3.0 * t).sin() / 3.0 * (-t).exp());
            let (x, y) = (30.0 * angle.cos(), 30.0 * angle.sin());
            let measured = plant.advance(fixed(x, y, 0.0));
            widest = widest.max((measured.position[0] - x).abs()).max((measured.position[1] - y).abs());
            lost = measured.lost_steps;
        }
        assert_eq!(lost == [0; 3], keeps, "{rate} {lost:?}");
        assert_eq!(widest < 0.05, keeps, "{rate} {widest}");
    }
}

/// The field stands on the microstep nearest to each setpoint, by whatever way it came there, and says so when it cannot.
#[test]
fn pulses_lead_to_the_nearest_microstep() {
    let mut plant = Plant::from_toml(ROUTER, TICK).unwrap();
    plant.rest_at(fixed(-1000.0, 500.0, 0.3));
    let mut at = [-1000.0, 500.0, 0.3];
    for k in 0..3000_u32 {
        for (axis, x) in at.iter_mut().enumerate() {
            // 640 microsteps/mm and 10 slots a pulse: at most 0.29 mm a tick.
            *x += 0.28 * (f64::from(k) * [0.9, 1.7, 3.1][axis]).sin();
        }
        let measured = plant.advance(fixed(at[0], at[1], at[2]));
        assert_eq!(measured.overrun, [false; 3]);
        for (driven, x) in plant.axes().iter().zip(at) {
            let Drive::Stepper { pulses, axis, .. } = &driven.drive else { panic!("a router has steppers") };
            // A reversal may take its last steps into the next tick.
            assert!((axis.field() - axis.nearest_microstep(Fixed::from_mm(x).to_mm())).abs() <= 3, "{k}");
            assert_eq!(axis.field(), i64::from(pulses.position()));
        }
    }
    for _ in 0..2 {
        plant.advance(fixed(at[0], at[1], at[2]));
    }
    for (driven, x) in plant.axes().iter().zip(at) {
        let Drive::Stepper { axis, .. } = &driven.drive else { panic!("a router has steppers") };
        assert_eq!(axis.field(), axis.nearest_microstep(Fixed::from_mm(x).to_mm()));
    }
    assert_eq!(plant.advance(fixed(at[0], at[1] + 0.4, at[2])).overrun, [false, true, false]);
}

/// The same setpoints give the same bits, on a plant that has moved before and on a new one.
#[test]
fn equal_runs_are_equal_bits() {
    for text in [MILL, ROUTER, SPRUNG] {
        let run = |plant: &mut Plant| -> Vec<Measured> {
            plant.rest_at(fixed(1.0, 2.0, 3.0));
            let way = |k: i32| f64::from(k * k % 1000) * 1e-3;
            (0..500).map(|k| plant.advance(fixed(1.0 + way(k), 2.0 - way(k), 3.0 + way(k)))).collect()
        };
        let mut plant = Plant::from_toml(text, TICK).unwrap();
        let first = run(&mut plant);
        assert_eq!(first, run(&mut plant));
        assert_eq!(first, run(&mut Plant::from_toml(text, TICK).unwrap()));
    }
}

/// Axes without their controller, on somebody else's pins: a step pulse is a microstep, a velocity moves the encoder.
#[test]
fn an_axis_hangs_on_other_pins() {
    let mut stepper = Plant::from_toml(ROUTER, TICK).unwrap().axes()[2].detached();
    let mut servo = Plant::default_mill(TICK).unwrap().axes()[0].detached();
    assert_eq!(stepper.rest_at(10.0).lost_steps, 0);
    let (mut height, mut counts) = (0.0, 0);
    for _ in 0..3200 {
        stepper.advance(Command::Steps(-1), 0.0);
        height = stepper.advance(Command::Steps(0), 2e-4).position;
        counts = servo.advance(Command::Velocity(25.4), 2e-4).counts;
    }
    // One turn of 5 mm, less what the weight makes the rotor lag; its friction may hold up what is left.
    assert!((height - 5.0).abs() < 0.01, "{height}");
    // 0.64 s at 25.4 mm/s, less the start and the viscous friction's part of the velocity.
    assert!((f64::from(counts) / (20_000.0 * 0.64) - 0.869).abs() < 0.02, "{counts}");
}

/// Each fault is one sentence with its place, its key, what was found and what would do.
#[test]
fn each_fault_is_named_with_its_place() {
    for (text, from, to, said) in [
        (SPRUNG, "lead = 10.0", "lead = -1", "6:8: axis z: lead is -1; it must be 0.01 to 10000 mm per turn"),
        (SPRUNG, "mass = 40.0", "mass = nan", "9:18: axis z: table.mass is NaN; it must be 0 to 1000000 kg"),
        (SPRUNG, "mass = 40.0", "mass = 0", "9:18: axis z: table.mass is 0; it must be above 0, because"),
        (SPRUNG, "breakaway = 25.0", "breakaway = 2", "9:67: axis z: table.breakaway is 2; it must be 20 to 1000000 N"),
        (SPRUNG, "[\"z\"]", "[\"z\", \"w\"]", "5:9: axis z, w: names is \"w\"; it must be some of"),
        (SPRUNG, "[\"z\"]", "[\"z\", \"z\"]", "5:9: axis z, z: names is \"z\"; it must be some of"),
        (SPRUNG, "[\"z\"]", "[]", "5:9: axis : names is an empty list"),
        (
            SPRUNG,
            "velocity_gain = 150.0, ",
            "",
            "13:1: axis z: servo.velocity_gain is missing; it must be given for a torque",
        ),
        (
            SPRUNG,
            "position_gain = 40.0",
            "position_gain = 1e9",
            "axis z: servo.position_gain is 1000000000; it must be above 0",
        ),
        (SPRUNG, "stiffness = 40000.0", "stiffness = 1e8", "it must be lower, or step at most"),
        (
            SPRUNG,
            "counts_per_mm = 1000.0",
            "counts_per_mm = 0",
            "encoder.counts_per_mm is 0; it must be 0.01 to 131072",
        ),
        (SPRUNG, "encoder = { counts_per_mm = 1000.0 }", "", "encoder is missing; it must be given for a servo drive"),
        (SPRUNG, "mass = 40.0, ", "", "9:9: missing field `mass`"),
        (SPRUNG, "play = 0.01", "plan = 0.01", "7:1: unknown field `plan`"),
        (SPRUNG, "lead = 10.0", "lead = \"fine\"", "6:8: invalid type: string \"fine\", expected f64"),
        (SPRUNG, "lead = 10.0", "lead = = 1", "6:8: "),
        (MILL, "step = 0.000244140625", "step = 0.1", ":8: step is 0.1; it must be 1e-7 to 0.01 s"),
        (
            MILL,
            "loop_gain = 0.084465854256",
            "loop_gain = 2.0",
            "drive.velocity.loop_gain is 2; it must be 1e-12 to 0.41 N m",
        ),
        (
            MILL,
            "velocity_feedforward = 0.8074",
            "velocity_gain = 3.0",
            "servo.velocity_gain is 3; it must be left out with",
        ),
        (ROUTER, "full_steps = 200", "full_steps = 202", "drive.stepper.full_steps is 202; it must be a multiple of 4"),
        (
            ROUTER,
            "microsteps = 16",
            "pulse = 0.001\nmicrosteps = 16",
            "drive.stepper.pulse is 0.001; it must be 0 to 1e-4 s",
        ),
        (ROUTER, "lead = 5.0", "lead = 0.02", "microsteps is 16; it must be such that a mm has 0.01 to 131072 of them"),
        (ROUTER, "[\"z\"]", "[\"y\"]", "names is \"y\"; it must be some of"),
    ] {
        assert!(text.contains(from), "{from}");
        let error = Plant::from_toml(&text.replacen(from, to, 1), TICK).unwrap_err();
        assert!(error.to_string().contains(said), "{to}: {error}");
    }
}

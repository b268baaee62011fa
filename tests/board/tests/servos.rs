//! Servo axes: the loop that is closed through the encoder inputs is the simulator's, tick by tick and bit by bit.

mod common;

use board::machine::servo_axes::{Exchange, MILL, ServoAxes, velocity};
use board::run::run_job;
use common::{image, root, servos, start_of};
use host_sim::job::Job;
use host_sim::path::Path;
use host_sim::plant::Plant;
use host_sim::plant::axis::{Axis, Command};
use host_sim::simulate;
use shared::fixed::Fixed;
use shared::piece::Order;
use shared::servo::{DriveSettings, Servo, ServoSettings, ServoState};

/// The axes as they are set; `examples/mill-servos.toml` says the same.
const AXIS: ServoSettings = ServoSettings {
    counts_per_mm: 800.0,
    position_gain: 50.0,
    integral_gain: 0.0,
    velocity_feedforward: 1.0,
    acceleration_feedforward: 0.0,
    drive: DriveSettings::Velocity { lag: 0.0, limit: 800.0 },
};

/// One axis without the board: the same servo, the same plant, and a converter of 12 bits between them.
struct Twin {
    servo: Servo<f32>,
    state: ServoState<f32>,
    axis: Box<dyn Axis + Send>,
    datum: i32,
    counts: i32,
}

impl Twin {
    fn new(mut axis: Box<dyn Axis + Send>) -> Self {
        let servo = AXIS.activate(f64::from(shared::TICK)).unwrap();
        let datum = axis.rest_at(0.0).counts;
        Self { servo, state: servo.at_rest(Fixed(0), 0), axis, datum, counts: 0 }
    }

    /// One tick: what the controller reads, what it gives out as a code, and the command in mm/s itself.
    fn tick(&mut self, setpoint: Fixed) -> (Exchange, u32) {
        let counter = self.counts as u16;
        let command = self.servo.step(&mut self.state, setpoint, self.counts);
        // The part of the full command that it is, in codes, each as an f32.
        let level = command * (1.0 / 800.0_f32);
        let code = (2_048 + (level * 2_047.0).round() as i32) as u16;
        let reading = self.axis.advance(Command::Velocity(velocity(code)), f64::from(shared::TICK));
        self.counts = reading.counts.wrapping_sub(self.datum);
        (Exchange { counter, code }, command.to_bits())
    }
}

/// A whole job, both axes, with the mill behind the pins.
fn compare(name: &str) {
    let file = root().join("examples").join(name);
    let job = Job::read(file.to_str().unwrap()).unwrap();
    let path = Path::new(&job, Order::First).unwrap();
    let setpoints = simulate::setpoints(&path).unwrap();
    let time = setpoints.len() as f64 * f64::from(shared::TICK);
    let pieces: Vec<_> = path.wire().collect();
    let start = start_of(&path.header, &pieces);
    let run = run_job(&image(), &servos(), path.header, pieces, time, |probe| {
        probe.machine.servo_axes = Some(ServoAxes::new(MILL).unwrap().recording());
    })
    .unwrap();

    let plant = Plant::from_toml(MILL, f64::from(shared::TICK)).unwrap();
    let mut twins = [0, 1].map(|axis| Twin::new(plant.axes()[axis].detached()));
    let exchanges = run.machine.servo_axes.unwrap().exchanges.unwrap();
    // The tick that takes the start is the one before the first of the job.
    let first = run.seen.idle as usize - 1;
    assert!(
        exchanges[..first].iter().flatten().all(|rest| *rest == Exchange { counter: 0, code: 2_048 }),
        "at rest before"
    );
    assert_eq!(run.seen.ticks.len(), setpoints.len());
    let mut farthest = 0;
    for (tick, setpoint) in std::iter::once(&start).chain(&setpoints).enumerate() {
        let expected = [0, 1].map(|axis| twins[axis].tick(Fixed(setpoint[axis].0 - start[axis].0)));
        let found = exchanges[first + tick];
        assert_eq!(found, expected.map(|(exchange, _)| exchange), "{name}, tick {tick}: counter and code of x and y");
        if let Some(job_tick) = tick.checked_sub(1) {
            assert_eq!(
                run.seen.ticks[job_tick].outputs[..2],
                expected.map(|(_, command)| command),
                "{name}, tick {tick}: commands"
            );
        }
        farthest = farthest.max(twins[0].counts.abs());
    }
    // The table was where it was told to be: some 10 mm and more of travel, and within 4 mm of the setpoint at the end, which it
    // passes at its feed.
    assert!(farthest > 8_000, "{farthest} counts");
    for (axis, twin) in twins.iter().enumerate() {
        let way = setpoints.last().unwrap()[axis].to_mm() - start[axis].to_mm();
        assert!((f64::from(twin.counts) / 800.0 - way).abs() < 4.0, "axis {axis}: {} counts, {way} mm", twin.counts);
    }
}

#[test]
fn the_loop_over_the_published_path_is_the_simulators() {
    compare("farouki2018.toml");
}

#[test]
fn the_loop_over_lines_and_arcs_is_the_simulators() {
    compare("bracket.toml");
}

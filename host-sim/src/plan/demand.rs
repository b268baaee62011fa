//! What a simulated run asks of a machine, beside what the machine bears.

use serde::Serialize;
use shared::fixed::Position;
use shared::machine::MachineSettings;

use super::{Course, Limits, bound};
use crate::job::Units;
use crate::machine::PathSettings;
use crate::measure::peaks::{self, Peak, Standard, Verdict, peaks};
use crate::path::Path;

/// Collects a run, tick by tick.
#[derive(Clone, Debug)]
pub struct Recorder<'a> {
    path: &'a Path,
    setpoints: Vec<Position>,
    corners: Vec<usize>,
    piece: usize,
}

/// One quantity of one axis, in the job's units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Asked {
    /// The largest magnitude, from differences of setpoints.
    pub peak: f64,
    /// When, in s from the start.
    pub at_s: f64,
    /// What the machine bears.
    pub limit: f64,
    /// How the one stands to the other; rounding is accounted for.
    pub verdict: Verdict,
}

/// One axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AxisDemand {
    /// Its name.
    pub axis: char,
    /// In units a second.
    pub velocity: Asked,
    /// In units a second squared.
    pub acceleration: Asked,
    /// In units a second cubed.
    pub jerk: Asked,
    /// The largest step of its velocity at a corner, in units a second. It is not in the peaks.
    pub corner_step: f64,
}

/// What a run asks of a machine.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Demand {
    /// x and y, and z where the path speaks of it.
    pub axes: Vec<AxisDemand>,
    /// The least time in s in which the path could be run at no more than the job's feed, within the velocities and accelerations of the
    /// machine and with the corner steps of this run; without a limit of jerk.
    pub least_time_s: f64,
}

impl<'a> Recorder<'a> {
    /// Begins at the start of `path`.
    pub fn new(path: &'a Path) -> Self {
        Self { path, setpoints: vec![path.start()], corners: Vec::new(), piece: 0 }
    }

    /// Takes the setpoint of a tick that ends on the piece of this number.
    pub fn record(&mut self, setpoint: Position, piece: usize) {
        let left = self.path.pieces.get(self.piece..piece).unwrap_or_default();
        if left.iter().any(|piece| piece.end_corner.is_some()) {
            self.corners.push(self.setpoints.len());
        }
        self.piece = piece;
        self.setpoints.push(setpoint);
    }

    /// What the run asks of the axes of `machine`. None where it has no two axes.
    pub fn demand(mut self, machine: &MachineSettings, units: Units) -> Option<Demand> {
        // The path ends within the last tick.
        self.corners.push(self.setpoints.len() - 1);
        machine.axes.get(1)?;
        let count = if self.path.pieces.iter().any(|piece| piece.height.is_some()) { 3 } else { 2 };
        let named = machine.axes.iter().take(count);
        let of = |k: usize| match machine.axes.get(k) {
            Some(axis) => peaks::Limits { velocity: axis.velocity, acceleration: axis.acceleration, jerk: axis.jerk },
            None => peaks::Limits { velocity: f64::INFINITY, acceleration: f64::INFINITY, jerk: f64::INFINITY },
        };
        let standard = Standard { rounding: ERROR_MM, jerk_ticks: JERK_TICKS, ..Standard::new([of(0), of(1), of(2)]) };
        let found = peaks(&self.setpoints, &self.corners, &standard);
        let mm = units.mm();
        let asked = |peak: &Peak| Asked {
            peak: peak.measured / mm,
            at_s: peak.tick as f64 * f64::from(shared::TICK),
            limit: peak.limit / mm,
            verdict: peak.verdict,
        };
        let steps = found.steps.axes;
        let axes = named.zip(&found.axes).zip(steps);
        let axes = axes.map(|((axis, peaks), step)| AxisDemand {
            axis: axis.name.letter(),
            velocity: asked(&peaks.velocity),
            acceleration: asked(&peaks.acceleration),
            jerk: asked(&peaks.jerk),
            corner_step: step.velocity / mm,
        });
        let axes = axes.collect();
        let corner_step = steps.map(|step| step.velocity);
        let limits = Limits { corner_step, ..Limits::of(machine, &PathSettings::default())? };
        let least_time_s = bound(&Course::new(self.path, STEP_MM), &limits).time;
        Some(Demand { axes, least_time_s })
    }
}

/// What a setpoint of the f32 tick may be off by in mm, so that no verdict hangs on it: four units. Between 32 and 64 mm from the
/// middle of a piece a roundoff of f32 is half a unit, and a point is the sum of some.
const ERROR_MM: f64 = 8.0 * peaks::ROUNDING;

/// The ticks over which a jerk is a mean, as the planner promises it ([`super::limits::JERK_WINDOW`]).
const JERK_TICKS: usize = 8;

/// The step of the grid on which the least time is found, in mm.
const STEP_MM: f64 = 0.02;

#[cfg(test)]
mod tests {
    use shared::piece::Order;

    use super::*;
    use crate::job::Job;
    use crate::simulate::run;

    fn demand(job: &str, machine: &str) -> Demand {
        let job = Job::from_toml("job.toml", job).unwrap();
        let path = Path::new(&job, Order::First).unwrap();
        let machine = crate::machine::from_toml("machine.toml", machine).unwrap();
        let mut recorder = Recorder::new(&path);
        run(&path, |_, executor| {
            recorder.record(executor.setpoint(), executor.place().map_or(0, |place| place.piece as usize));
        })
        .unwrap();
        recorder.demand(&machine, job.units).unwrap()
    }

    /// A square at 50 mm/s without any reduction: its corners step by 50 mm/s in both axes, and nothing else asks for anything.
    #[test]
    fn a_square_asks_for_its_steps_alone() {
        let square = "units = \"mm\"\nclosed = true\n[feed]\nrate = 3000.0\n\
            [[segment]]\nline = { start = [0.0, 0.0], to = [20.0, 0.0] }\n[[segment]]\nline = { to = [20.0, 20.0] }\n\
            [[segment]]\nline = { to = [0.0, 20.0] }\n[[segment]]\nline = { to = [0.0, 0.0] }\n";
        let machine = include_str!("../../../examples/machine.toml");
        let Demand { axes, least_time_s } = demand(square, machine);
        for axis in &axes {
            assert!((axis.velocity.peak - 50.0).abs() < 0.1 && axis.velocity.limit == 80.0);
            assert!((axis.corner_step - 50.0).abs() < 0.2, "{axis:?}");
            assert!(axis.acceleration.peak < 2.0 && axis.acceleration.verdict == Verdict::Kept, "{axis:?}");
        }
        assert!((least_time_s - 80.0 / 50.0).abs() < 0.02, "{least_time_s}");
    }

    /// A circle of 10 mm at 100 mm/s asks for 1000 mm/s2 where the router bears 400, and for 25 % more than its velocity: it could be
    /// run at about sqrt(400 10) mm/s.
    #[test]
    fn a_fast_circle_asks_for_too_much() {
        let circle = "units = \"mm\"\nclosed = true\n[feed]\nrate = 6000.0\n\
            [[segment]]\narc = { start = [10.0, 0.0], to = [10.0, 0.0], centre = [0.0, 0.0], ccw = true }\n";
        let Demand { axes, least_time_s } = demand(circle, include_str!("../../../examples/machine.toml"));
        for axis in &axes {
            assert!((axis.velocity.peak / 100.0 - 1.0).abs() < 5e-3 && axis.velocity.verdict == Verdict::Exceeded);
            assert!(
                (axis.acceleration.peak / 1000.0 - 1.0).abs() < 5e-3 && axis.acceleration.verdict == Verdict::Exceeded
            );
        }
        let even = std::f64::consts::TAU * 10.0 / f64::sqrt(4000.0);
        assert!(least_time_s < even && least_time_s > 0.8 * even, "{least_time_s} {even}");
    }
}

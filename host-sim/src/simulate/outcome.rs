//! What a simulation finds, sample by sample and in sum.

use std::collections::VecDeque;

use serde::Serialize;
use shared::complex::Complex;
use shared::executor::{Executor, Place, State};
use shared::fixed::Position;

use crate::job::Units;
use crate::measure::ContourError;
use crate::path::Path;
use crate::plant::Measured;
use crate::simulate::script::Carried;

/// How many ticks at the start of a run with a plant are left out of the maxima: the drives start at rest while the path moves
/// at once. The published runs entered the path at speed.
pub const SETTLING_TICKS: u64 = 150;

/// The published acceleration is nearest to second differences of positions this many ticks apart.
const STRIDE: usize = 5;

/// One tick, in mm and seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// The number of the tick, from 1.
    pub tick: u64,
    /// The number of the piece, from 0.
    pub piece: usize,
    /// The parameter on the piece's segment.
    pub xi: f64,
    /// The arc-length fraction of equations (6) and (9).
    pub u: f64,
    /// The commanded centre feed V_d, in mm/s.
    pub feed: f64,
    /// The setpoint.
    pub commanded: Position,
    /// The setpoint's x and y in mm.
    pub setpoint: Complex<f64>,
    /// Where the encoders say that the axes are, in mm; without a plant the setpoint.
    pub actual: Complex<f64>,
    /// The speed of the encoder positions over the last tick, in mm/s.
    pub speed: f64,
    /// The magnitude of the second difference of the encoder positions over five ticks, in mm/s^2.
    pub acceleration: f64,
    /// The normal distance of the actual position from the exact path, in mm.
    pub contour_error: f64,
    /// The pace q: 1 at the path's own feed.
    pub pace: f64,
    /// What the executor is about.
    pub state: State,
}

/// The result of a simulation, as `--json` writes it: lengths in the job's units, feeds a minute, times in s.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// The unit of all lengths here.
    pub units: Units,
    /// Ticks until the last point.
    pub ticks: u64,
    /// The time of the path.
    pub time_s: f64,
    /// The length of the part of C that the path runs along.
    pub contact_length: f64,
    /// The length of the tool centre's way.
    pub centre_length: f64,
    /// The largest commanded centre feed.
    pub max_feed: f64,
    /// The largest speed of the encoder positions, over five ticks.
    pub max_measured_feed: f64,
    /// The largest acceleration of the encoder positions, a second squared.
    pub max_acceleration: f64,
    /// The largest contour error.
    pub max_contour_error: f64,
    /// The root of the mean square of the contour error.
    pub rms_contour_error: f64,
    /// The largest distance of an axis from its setpoint: x, y.
    pub max_following_error: [f64; 2],
    /// Ticks, after the settling ones, in which a drive was at its limit: x, y.
    pub saturated_ticks: [u64; 2],
    /// The most full steps that a stepping axis fell away from its field: x, y.
    pub lost_steps: [u32; 2],
    /// Ticks in which a stepping axis was asked for more steps than its pulses allow: x, y.
    pub overrun_ticks: [u64; 2],
    /// Ticks at the start that the maxima leave out.
    pub settling_ticks: u64,
    /// One number for all setpoints.
    pub setpoint_hash: String,
    /// How it ended: `finished`, or what a script made of it.
    pub state: &'static str,
    /// What was done of a script.
    pub script: Vec<Carried>,
}

/// Gathers the samples of a run.
pub(super) struct Gauge<'a> {
    path: &'a Path,
    error: ContourError<'a>,
    settling: u64,
    recent: VecDeque<Complex<f64>>,
    counted: u64,
    square_sum: f64,
    max: Maxima,
}

#[derive(Default)]
struct Maxima {
    feed: f64,
    speed: f64,
    acceleration: f64,
    error: f64,
    following: [f64; 2],
    saturated: [u64; 2],
    lost_steps: [u32; 2],
    overrun: [u64; 2],
}

impl<'a> Gauge<'a> {
    pub(super) fn new(path: &'a Path, settling: u64) -> Self {
        Self {
            path,
            error: ContourError::new(path),
            settling,
            recent: VecDeque::with_capacity(2 * STRIDE + 1),
            counted: 0,
            square_sum: 0.0,
            max: Maxima::default(),
        }
    }

    /// Measures the tick at whose end the machine shows `measured`.
    pub(super) fn measure(&mut self, tick: u64, executor: &Executor<f32>, measured: &Measured) -> Sample {
        let [x, y, _] = measured.encoder;
        let actual = Complex::new(x, y);
        let commanded = executor.setpoint();
        let setpoint = Complex::new(commanded[0].to_mm(), commanded[1].to_mm());
        let place =
            executor.place().unwrap_or(Place { piece: 0, tau: -0.5, parameter: -0.5, rate: 0.0, point: Complex::ZERO });
        let number = place.piece as usize;
        let (xi, feed) = match self.path.pieces.get(number) {
            Some(piece) => (piece.parameter(f64::from(place.parameter)), f64::from(executor.centre_feed())),
            None => (0.0, 0.0),
        };
        let contour_error = self.error.at(actual, number, xi);
        let (speed, acceleration) = self.differences(actual);
        let sample = Sample {
            tick,
            piece: number,
            xi,
            u: f64::from(executor.fraction()),
            feed,
            commanded,
            setpoint,
            actual,
            speed,
            acceleration,
            contour_error,
            pace: f64::from(executor.pace()),
            state: executor.state(),
        };
        self.max.feed = self.max.feed.max(feed);
        for (most, lost) in self.max.lost_steps.iter_mut().zip(measured.lost_steps) {
            *most = (*most).max(lost.unsigned_abs());
        }
        for (ticks, overrun) in self.max.overrun.iter_mut().zip(measured.overrun) {
            *ticks += u64::from(overrun);
        }
        if tick > self.settling {
            for (ticks, saturated) in self.max.saturated.iter_mut().zip(measured.saturated) {
                *ticks += u64::from(saturated);
            }
            let apart = setpoint - actual;
            self.counted += 1;
            self.square_sum += contour_error * contour_error;
            self.max.speed = self.max.speed.max(speed);
            self.max.acceleration = self.max.acceleration.max(acceleration);
            self.max.error = self.max.error.max(contour_error);
            self.max.following[0] = self.max.following[0].max(apart.re.abs());
            self.max.following[1] = self.max.following[1].max(apart.im.abs());
        }
        sample
    }

    /// Speed and acceleration of the encoder positions over a stride of ticks; zero until there are enough of them.
    fn differences(&mut self, actual: Complex<f64>) -> (f64, f64) {
        if self.recent.len() == 2 * STRIDE + 1 {
            self.recent.pop_front();
        }
        self.recent.push_back(actual);
        let span = STRIDE as f64 * f64::from(shared::TICK);
        let (Some(&oldest), Some(&middle), true) =
            (self.recent.front(), self.recent.get(STRIDE), self.recent.len() == 2 * STRIDE + 1)
        else {
            return (0.0, 0.0);
        };
        let speed = (actual - middle).norm() / span;
        (speed, (actual - middle * 2.0 + oldest).norm() / (span * span))
    }

    pub(super) fn outcome(&self, run: &super::Run, units: Units) -> Outcome {
        let length = |mm: f64| mm / units.mm();
        let per_minute = |mm_per_s: f64| mm_per_s / units.mm() * 60.0;
        Outcome {
            units,
            ticks: run.ticks,
            time_s: run.time,
            contact_length: length(self.path.contact_length()),
            centre_length: length(self.path.centre_length()),
            max_feed: per_minute(self.max.feed),
            max_measured_feed: per_minute(self.max.speed),
            max_acceleration: length(self.max.acceleration),
            max_contour_error: length(self.max.error),
            rms_contour_error: length((self.square_sum / self.counted.max(1) as f64).sqrt()),
            max_following_error: self.max.following.map(length),
            saturated_ticks: self.max.saturated,
            lost_steps: self.max.lost_steps,
            overrun_ticks: self.max.overrun,
            settling_ticks: self.settling,
            setpoint_hash: format!("{:016x}", run.hash.value()),
            state: run.state.name(),
            script: run.carried.clone(),
        }
    }
}

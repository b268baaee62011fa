//! The verifier of a motion: peaks of velocity, acceleration and jerk, from the setpoints alone.
//!
//! It knows no curve, no feed law and no plan: it differentiates the integers that the controller puts out, one each tick of
//! T = 2^-10 s, and says how sure it is of each peak.
//!
//! # The difference, and its noise
//!
//! The derivative of order n is read off the n-th difference over a stride of h ticks,
//!
//! D = sum over k of (-1)^(n-k) binomial(n, k) x(t + (k - n/2) h T) / (h T)^n,
//!
//! summed in integers. Its weights add up to 2^n in magnitude, so setpoints that are off by e at most put it off by
//! **2^n e / (h T)^n** at most. Rounding to the unit u = 2^-18 mm has e = u/2:
//!
//! | n | noise | limit: stride that keeps the noise below 0.25 % of it, window n h T |
//! | --- | --- | --- |
//! | 1 | 2^-8 / h mm/s | 0.1 mm/s: 16, 15.6 ms; 1: 2, 2.0 ms; 10 and more: 1, 1.0 ms |
//! | 2 | 8 / h^2 mm/s^2 | 100 mm/s^2: 6, 11.7 ms; 1000: 2, 3.9 ms; 10^4: 1, 2.0 ms |
//! | 3 | 16384 / h^3 mm/s^3 | 1000 mm/s^3: 19, 55.7 ms; 10^4: 9, 26.4 ms; 10^5: 5, 14.6 ms; 10^6: 2, 5.9 ms |
//!
//! Setpoints of the controller are computed in singles first. With pieces up to 60 mm from start to end that does not show; with
//! the 116 mm of `examples/farouki2018.toml` e is 2.34 units at least, the noise 4.7 times the table's, a stride for jerk 1.7
//! times its (test `singles_show_on_long_pieces`). Give [`Standard::rounding`] 4 units there.
//!
//! The stride is chosen for each limit, since no one stride serves: at h = 1 a jerk is noise, at h = 19 a short one is gone.
//!
//! # What the difference does to a peak
//!
//! D is the mean of the derivative under a weight that is nowhere negative (the B-spline of order n, n h T wide). Apart from
//! noise it therefore never exceeds the true peak: what exceeds a limit by more than the noise is a violation, however rough the
//! motion is. It may fall short of the peak. Where the derivative has a second derivative B of its own it is off by
//! n (h T)^2 B/24; a rectangle of acceleration that lasts 2 h T or longer shows whole and one of h T with 75 %; a rectangle of
//! jerk of 3 h T shows whole, of 2 h T with 96 %, of h T with 67 %. Hence [`Peak::proven`] also asks the strides 1, 2, 4 .. below
//! the chosen one: a short peak that stands out of their larger noise is found too.
//!
//! # Why not a polynomial of least squares
//!
//! Fitted over a window W, the polynomial of degree n gives a mean of the same spread (for n = 3: W^2/36 both), but a larger
//! bound: 3, 23.1 and 273 e/W^n for n = 1, 2, 3, against 2, 16 and 216 here. No sum over a window can be below 2, 16 and 192
//! (Chebyshev), so differences have the least bound there is, or, for jerk, a window 4 % longer than the least. Least squares
//! wins on average, where errors are independent; those of a steady motion are not, they repeat, and a verdict needs the bound.

mod corner;
#[cfg(test)]
mod tests;

use std::ops::Range;

use serde::Serialize;
use shared::fixed::{Position, UNITS_PER_MM};

pub use corner::{Step, Steps};

/// The period of the tick, in s; exact.
const PERIOD: f64 = shared::TICK as f64;
/// The error of a setpoint that is rounded to the nearest unit, in mm.
pub const ROUNDING: f64 = 0.5 / UNITS_PER_MM;
/// The part of a limit below which rounding stays, unless the caller has another one.
pub const SHARE: f64 = 0.0025;
/// The weights of the differences of order 0 to 3.
const WEIGHTS: [&[i64]; 4] = [&[1], &[-1, 1], &[1, -2, 1], &[-1, 3, -3, 1]];

/// What one axis may do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// In mm/s.
    pub velocity: f64,
    /// In mm/s^2.
    pub acceleration: f64,
    /// In mm/s^3.
    pub jerk: f64,
}

/// What a motion is judged by. A limit of infinity is none, and is measured over the stride 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standard {
    /// Of x, y and z.
    pub axes: [Limits; 3],
    /// Of the speed along the path, in mm/s.
    pub feed: f64,
    /// Of the acceleration across the path, in mm/s^2.
    pub centripetal: f64,
    /// The part of a limit that noise may reach; above 0.
    pub share: f64,
    /// The largest error of a coordinate of a setpoint, in mm. [`ROUNDING`] for what is computed in doubles; the controller's
    /// singles add to it on pieces that reach far from their start, as the module says.
    pub rounding: f64,
    /// The time in ticks over which a jerk is a mean at the least, 1 or more: a step of acceleration is none in itself, and what it is over
    /// this time counts. Strides are no finer.
    pub jerk_ticks: usize,
}

impl Standard {
    /// By limits of the axes: the path may do what they allow together.
    pub fn new(axes: [Limits; 3]) -> Self {
        let together = |of: fn(&Limits) -> f64| norm(axes.each_ref().map(of));
        Self {
            axes,
            feed: together(|limits| limits.velocity),
            centripetal: together(|limits| limits.acceleration),
            share: SHARE,
            rounding: ROUNDING,
            jerk_ticks: 1,
        }
    }
}

/// How a motion stands to a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Every mean over the stencil is within the limit, give or take twice the share that noise may have.
    Kept,
    /// Noise cannot explain the peak.
    Exceeded,
    /// Nothing is proven, but there are setpoints that the stencil does not fit between, or noise is above its share.
    Open,
}

/// The largest magnitude of one quantity, in its limit's unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Peak {
    /// Over the stride; 0 where no stencil fits.
    pub measured: f64,
    /// Where: the setpoint in the middle of the stencil, counted from 0, or the one before the middle.
    pub tick: usize,
    /// What it is judged by.
    pub limit: f64,
    /// Ticks between the setpoints of the difference: the fewest that keep noise below its share of the limit, or the most that
    /// fit between corners.
    pub stride: usize,
    /// How far `measured` may be off by the errors of setpoints; a bound, not an average.
    pub noise: f64,
    /// The most that is certain: of all strides up to `stride`, the largest magnitude less its noise. Never negative.
    pub proven: f64,
    /// Where that was, as `tick`.
    pub proven_tick: usize,
    /// Setpoints outside every stencil of this stride, because corners or ends are too close together. Corners do not count.
    pub unjudged: usize,
    /// What follows from all that.
    pub verdict: Verdict,
}

impl Peak {
    /// The measured peak in parts of the limit.
    pub fn ratio(&self) -> f64 {
        self.measured / self.limit
    }
}

/// The peaks of one axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AxisPeaks {
    /// Of the velocity, in mm/s.
    pub velocity: Peak,
    /// Of the acceleration, in mm/s^2.
    pub acceleration: Peak,
    /// Of the jerk, in mm/s^3.
    pub jerk: Peak,
}

/// What the setpoints of a motion show.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Peaks {
    /// Of x, y and z.
    pub axes: [AxisPeaks; 3],
    /// The speed along the path, in mm/s.
    pub feed: Peak,
    /// The acceleration across the velocity, in mm/s^2. Both are means of one window, so that it is off by the order of
    /// (h T)^2, to either side. Its noise grows as the motion slows down and loses its direction, up to all of the
    /// acceleration; the peak is where most is certain.
    pub centripetal: Peak,
    /// The steps of velocity at corners.
    pub steps: Steps,
}

/// Measures `setpoints`, one a tick.
///
/// `corners` are numbers of setpoints, from 0 and in any order, beside which the velocity may step: within a tick before or
/// after. No difference uses one or reaches across; the steps are measured apart. The last setpoint of a path that ends within a
/// tick belongs there too: the motion into it is shorter than a tick.
pub fn peaks(setpoints: &[Position], corners: &[usize], standard: &Standard) -> Peaks {
    let groups = corner::groups(corners, setpoints.len());
    let motion = Motion::new(setpoints, &groups, standard.share);
    let Standard { rounding, .. } = *standard;
    let axis = |axis: usize| {
        let peak = |order: u32, limit| {
            let finest = if order == 3 { standard.jerk_ticks } else { 1 };
            motion.peak(order, finest, limit, rounding, |start, stride| {
                let value = difference(setpoints, axis, order, start, stride).abs();
                (value, noise(order, stride, rounding))
            })
        };
        let Limits { velocity, acceleration, jerk } = standard.axes[axis];
        AxisPeaks { velocity: peak(1, velocity), acceleration: peak(2, acceleration), jerk: peak(3, jerk) }
    };
    // Of a vector, when every coordinate has the largest error.
    let error = rounding * 3_f64.sqrt();
    let vector = |order, start, stride| [0, 1, 2].map(|axis| difference(setpoints, axis, order, start, stride));
    Peaks {
        axes: [0, 1, 2].map(axis),
        feed: motion.peak(1, 1, standard.feed, error, |start, stride| {
            (norm(vector(1, start, stride)), noise(1, stride, error))
        }),
        centripetal: motion.peak(2, 1, standard.centripetal, error, |start, stride| {
            let (acceleration, off) = (vector(2, start, stride), noise(2, stride, error));
            let velocity = vector(1, start, 2 * stride);
            // A velocity that is off by d points off by an angle whose sine is d/|v| at most, and so much of the acceleration
            // gets across.
            let sine = (noise(1, 2 * stride, error) / norm(velocity)).min(1.0);
            (across(acceleration, velocity), off + (norm(acceleration) + off) * sine)
        }),
        steps: corner::steps(setpoints, &groups, rounding),
    }
}

/// Setpoints, cut at corners.
struct Motion {
    runs: Vec<Range<usize>>,
    longest: usize,
    share: f64,
}

impl Motion {
    fn new(setpoints: &[Position], groups: &[Range<usize>], share: f64) -> Self {
        let mut runs = Vec::new();
        let mut from = 0;
        for group in groups {
            runs.push(from..group.start);
            from = group.end;
        }
        runs.push(from..setpoints.len());
        runs.retain(|run| !run.is_empty());
        let longest = runs.iter().map(Range::len).max().unwrap_or(0);
        Self { runs, longest, share }
    }

    /// The peak of what `at` gives, with its noise, for the stencil that begins at a setpoint and has a stride.
    fn peak(&self, order: u32, finest: usize, limit: f64, error: f64, at: impl Fn(usize, usize) -> (f64, f64)) -> Peak {
        let stride = self.stride(order, limit, error).max(finest);
        let (mut measured, mut proven) = (Found::default(), Found::default());
        let finer = (0..usize::BITS).map(|k| finest << k).take_while(|&finer| finer < stride);
        for stride in finer.chain([stride]) {
            let Some(found) = self.search(order as usize * stride, |start| at(start, stride)) else { continue };
            if found.certain() > proven.certain() {
                proven = found;
            }
            measured = found;
        }
        let span = order as usize * stride;
        if self.longest <= span {
            // What a finer stride found is not of this one.
            measured = Found { noise: noise(order, stride, error), ..Found::default() };
        }
        let unjudged = self.runs.iter().map(Range::len).filter(|&length| length <= span).sum();
        let verdict = if proven.certain() > limit {
            Verdict::Exceeded
        } else if unjudged == 0 && noise(order, stride, error) <= self.share * limit {
            Verdict::Kept
        } else {
            Verdict::Open
        };
        let Found { value, noise, tick } = measured;
        let proven_tick = proven.tick;
        let proven = proven.certain();
        Peak { measured: value, tick, limit, stride, noise, proven, proven_tick, unjudged, verdict }
    }

    /// The smallest stride whose noise is below its share of `limit`, if it fits into the longest run.
    fn stride(&self, order: u32, limit: f64, error: f64) -> usize {
        let most = (self.longest.saturating_sub(1) / order as usize).max(1);
        let allowed = self.share * limit;
        let root = 2.0 / PERIOD * (error / allowed).powf(1.0 / f64::from(order));
        // A limit of 0 gives infinity, and the cast saturates.
        let mut stride = (root as usize).clamp(1, most);
        while stride < most && noise(order, stride, error) > allowed {
            stride += 1;
        }
        stride
    }

    /// The stencil, `span` ticks wide, of which most is certain.
    fn search(&self, span: usize, at: impl Fn(usize) -> (f64, f64)) -> Option<Found> {
        let starts = self.runs.iter().flat_map(|run| run.start..run.end.saturating_sub(span));
        let all = starts.map(|start| {
            let (value, noise) = at(start);
            Found { value, noise, tick: start + span / 2 }
        });
        all.reduce(|best, next| if next.value - next.noise > best.value - best.noise { next } else { best })
    }
}

/// What one stencil shows.
#[derive(Clone, Copy, Default)]
struct Found {
    value: f64,
    noise: f64,
    tick: usize,
}

impl Found {
    fn certain(self) -> f64 {
        (self.value - self.noise).max(0.0)
    }
}

/// How far a difference may be off where setpoints are off by `error`.
fn noise(order: u32, stride: usize, error: f64) -> f64 {
    error * (2.0 / (stride as f64 * PERIOD)).powi(order as i32)
}

/// The difference of an axis from the setpoint `start` on. Rounded only where the sum becomes a float and is divided.
fn difference(setpoints: &[Position], axis: usize, order: u32, start: usize, stride: usize) -> f64 {
    let along = setpoints[start..].iter().step_by(stride);
    let sum: i64 = WEIGHTS[order as usize].iter().zip(along).map(|(w, at)| w * i64::from(at[axis].0)).sum();
    sum as f64 / UNITS_PER_MM / (stride as f64 * PERIOD).powi(order as i32)
}

fn norm([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}

/// The length of the part of `a` that is normal to `v`; all of it where `v` is zero.
fn across(a: [f64; 3], v: [f64; 3]) -> f64 {
    let speed = norm(v);
    if speed == 0.0 {
        return norm(a);
    }
    norm([a[1] * v[2] - a[2] * v[1], a[2] * v[0] - a[0] * v[2], a[0] * v[1] - a[1] * v[0]]) / speed
}

//! How fast the pace of a path may change: what the axes have left beside what the path asks for by itself.
//!
//! With x(T) an axis along the path at its own feed and q the pace, its acceleration is q^2 x'' + q' x'. Over samples of the whole
//! path, |q'| may be R(c) = min (A - c^2 |x''|)/|x'| while q is at most c. A higher c leaves less for q', so the largest c is taken
//! that leaves half of R(1), or 2/s if that is more, and at most 2. Of the jerk only q'' x' is the pace's: |q''| <= min J/|x'|. At
//! a corner the velocity steps, whatever anybody does; its step is the feed law's and is left out.

use shared::complex::Complex;
use shared::curve::Curve as _;
use shared::error::PathError;
use shared::pace::{PaceLimits, Pacer};

use crate::measure::Slowness;
use crate::path::{Path, PathPiece};

/// Samples of one piece, where there are few.
const MOST_SAMPLES: usize = 512;

/// Samples of a whole path, about.
const ALL_SAMPLES: usize = 200_000;

/// A part of the limits that is not given away: for what lies between two samples, and for a tick's differences, which are not yet
/// derivatives.
const KEPT: f64 = 0.02;

/// A slope of the pace that is not lowered for the sake of higher overrides, in 1/s.
const BRISK: f64 = 2.0;

/// Where nobody says what the axes bear, the pace adds this much to what the path asks for: mm/s^2 and mm/s^3.
const USUAL_ACCELERATION: f64 = 1e3;
const USUAL_JERK: f64 = 2e4;

/// The jerk limit for an acceleration limit, where nobody says: all of it in 50 ms.
pub const JERK_PER_ACCELERATION: f64 = 20.0;

/// What the axes bear: x, y in mm/s^2 and mm/s^3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLimits {
    /// The largest acceleration of each axis: of the path and of its pace together.
    pub acceleration: [f64; 2],
    /// The largest jerk of each axis that starts, stops and overrides may add.
    pub jerk: [f64; 2],
}

/// Why a path cannot be paced within limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PacingError {
    /// The path itself asks an axis for more than what it bears, or leaves nothing.
    Acceleration {
        /// The piece.
        piece: usize,
        /// What it asks for, in mm/s^2.
        asked: f64,
    },
    /// So little is left that the controller refuses it.
    Refused(PathError),
}

/// An axis at one point of a path, at the path's own feed: mm/s and mm/s^2.
#[derive(Clone, Copy, Debug)]
struct Sample {
    piece: usize,
    velocity: Complex<f64>,
    acceleration: Complex<f64>,
}

/// Limits of the pace within which no axis gets beyond `limits`.
pub fn within(path: &Path, limits: &AxisLimits) -> Result<PaceLimits<f32>, PacingError> {
    let samples = samples(path);
    let bears = limits.acceleration.map(|a| a * (1.0 - KEPT));
    // R(c), and the sample that says so.
    let slope = |c: f64| {
        let by_axis = samples.iter().flat_map(|sample| {
            let Complex { re: vx, im: vy } = sample.velocity;
            let Complex { re: ax, im: ay } = sample.acceleration;
            [(bears[0] - c * c * ax.abs()) / vx.abs(), (bears[1] - c * c * ay.abs()) / vy.abs()]
                .map(|slope| (if slope.is_nan() { f64::NEG_INFINITY } else { slope }, sample))
        });
        by_axis.reduce(|a, b| if b.0 < a.0 { b } else { a })
    };
    let Some((alone, tightest)) = slope(1.0) else { return Ok(PaceLimits::USUAL) };
    if alone <= 0.0 {
        let Complex { re, im } = tightest.acceleration;
        return Err(PacingError::Acceleration { piece: tightest.piece, asked: re.abs().max(im.abs()) });
    }
    let enough = (0.5 * alone).max(alone.min(BRISK));
    let leaves_enough = |c: f64| slope(c).is_some_and(|(slope, _)| slope >= enough);
    let (mut most, mut beyond) = (1.0, 2.0);
    if leaves_enough(2.0) {
        most = 2.0;
    } else {
        // To a hundredth of a per cent.
        for _ in 0..14 {
            let middle = 0.5 * (most + beyond);
            if leaves_enough(middle) { most = middle } else { beyond = middle }
        }
    }
    let slope = slope(most).map_or(alone, |(slope, _)| slope);
    let bend = samples
        .iter()
        .flat_map(|s| [limits.jerk[0] / s.velocity.re.abs(), limits.jerk[1] / s.velocity.im.abs()])
        .fold(f64::INFINITY, f64::min);
    let found = PaceLimits { slope: finite(slope), bend: finite(bend), most: most as f32 };
    Pacer::activate(&found, shared::TICK).map_err(PacingError::Refused)?;
    Ok(found)
}

/// Limits of the pace where nobody says what the axes bear: 1 m/s^2 and 20 m/s^3 beside what the path asks for.
pub fn usual(path: &Path) -> PaceLimits<f32> {
    let fastest = samples(path).iter().map(|sample| sample.velocity.norm()).fold(0.0, f64::max);
    // Between a second and 20 ms for a start, so that it is one.
    let slope = (USUAL_ACCELERATION / fastest).clamp(1.0, 50.0);
    let bend = (USUAL_JERK / fastest).clamp(10.0, 2500.0);
    PaceLimits { slope: finite(slope), bend: finite(bend), most: 2.0 }
}

/// A number for the wire; beyond a million it makes no difference.
fn finite(x: f64) -> f32 {
    x.min(1e6) as f32
}

fn samples(path: &Path) -> Vec<Sample> {
    let count = (ALL_SAMPLES / path.pieces.len().max(1)).clamp(16, MOST_SAMPLES);
    let numbered = path.pieces.iter().enumerate();
    numbered.flat_map(|(number, piece)| samples_of(number, piece, path.weight, count)).collect()
}

fn samples_of(number: usize, piece: &PathPiece, weight: f64, count: usize) -> impl Iterator<Item = Sample> {
    let (law, [from, to]) = (Slowness::new(piece, weight), piece.interval);
    let velocity = move |xi: f64| {
        // Equation (13): the centre moves along the tangent of C.
        let along = piece.segment.derivative(xi) * (1.0 + piece.segment.curvature(xi) * piece.offset);
        along * (1.0 / law.at(xi))
    };
    (0..=count).map(move |k| {
        let xi = from + (to - from) * k as f64 / count as f64;
        // A difference of doubles over a hundred-thousandth of the piece is good to eight digits.
        let (before, after) = ((xi - 1e-5 * (to - from)).max(from), (xi + 1e-5 * (to - from)).min(to));
        let slope = (velocity(after) - velocity(before)) * (1.0 / (after - before));
        Sample { piece: number, velocity: velocity(xi), acceleration: slope * (1.0 / law.at(xi)) }
    })
}

#[cfg(test)]
mod tests {
    use shared::piece::Order;

    use super::*;
    use crate::job::Job;

    fn path(feed: f64, segments: &str) -> Path {
        let text = format!("units = \"mm\"\nclosed = false\n[feed]\nrate = {}\n{segments}", feed * 60.0);
        Path::new(&Job::from_toml("job.toml", &text).unwrap(), Order::First).unwrap()
    }

    fn both(acceleration: f64, jerk: f64) -> AxisLimits {
        AxisLimits { acceleration: [acceleration; 2], jerk: [jerk; 2] }
    }

    /// On a line the path asks for nothing: all that an axis bears is the pace's, up to twice the feed.
    #[test]
    fn on_a_line_everything_is_left() {
        let path = path(50.0, "[[segment]]\nline = { start = [0.0, 0.0], to = [30.0, 40.0] }\n");
        // y moves at 4/5 of the feed.
        let found = within(&path, &both(400.0, 8000.0)).unwrap();
        assert!((f64::from(found.slope) / (0.98 * 400.0 / 40.0) - 1.0).abs() < 1e-6);
        assert!((f64::from(found.bend) / (8000.0 / 40.0) - 1.0).abs() < 1e-6 && found.most == 2.0);
    }

    /// On an arc of radius r the path asks for v^2/r, in every direction in turn: with q = c and |q'| = R an axis gets
    /// c^2 v^2/r |cos| + R v |sin|.
    #[test]
    fn on_an_arc_the_rest_is_left() {
        let arc = "[[segment]]\narc = { start = [10.0, 0.0], to = [10.0, 0.0], centre = [0.0, 0.0], ccw = true }\n";
        let path = path(50.0, arc);
        for limit in [300.0, 700.0, 5000.0] {
            let PaceLimits { slope, most, .. } = within(&path, &both(limit, 1e4)).unwrap();
            let (slope, most) = (f64::from(slope), f64::from(most));
            let worst = |c: f64| (c * c * 250.0).hypot(slope * 50.0);
            assert!(worst(most) <= limit, "{limit}: {}", worst(most));
            assert!(worst(most) > 0.97 * limit && most > 1.0 && most <= 2.0, "{limit}: {} at {most}", worst(most));
        }
        let found = within(&path, &both(240.0, 1e4));
        assert!(matches!(found, Err(PacingError::Acceleration { piece: 0, asked }) if (asked - 250.0).abs() < 0.1));
        // A little more than nothing is left.
        assert!(matches!(within(&path, &both(255.2, 1e4)), Err(PacingError::Refused(PathError::SlowStop { .. }))));
    }
}

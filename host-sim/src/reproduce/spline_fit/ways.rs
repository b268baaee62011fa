//! The ways to run a program of lines that are compared.

use serde::Serialize;
use shared::curve::Segment;

use crate::fit::Kind;
use crate::plan::{Limits, Manner, Rests};
use crate::strokes::{Lines, Pace, Stroke, Strokes};

/// How far a way may be from the lines, in mm.
pub const TOLERANCE_MM: f64 = 0.01;

/// One way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Way {
    /// The lines, with a rest at the end of each.
    ExactStop,
    /// The lines with small arcs at their breaks, by a control that knows the block it runs and the one after it.
    MicroArcs,
    /// The same by a control that looks ahead as far as it matters.
    LookAhead,
    /// Arcs (G2 and G3).
    Arcs,
    /// Cubics with common tangents, as published.
    Cubics,
    /// B-splines with continuous curvature: the paper's future work.
    Bsplines,
    /// PH quintics with continuous curvature.
    Ph,
}

impl Way {
    /// All of them, the slowest first.
    pub const ALL: [Self; 7] =
        [Self::ExactStop, Self::MicroArcs, Self::LookAhead, Self::Arcs, Self::Cubics, Self::Bsplines, Self::Ph];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::ExactStop => "lines, exact stop",
            Self::MicroArcs => "lines, micro arcs",
            Self::LookAhead => "micro arcs, look-ahead",
            Self::Arcs => "arcs",
            Self::Cubics => "cubic spline, as published",
            Self::Bsplines => "curvature-continuous spline",
            Self::Ph => "curvature-continuous PH",
        }
    }

    /// What becomes of the program's lines.
    pub fn lines(self) -> Lines {
        match self {
            Self::ExactStop => Lines::Kept,
            Self::MicroArcs | Self::LookAhead => Lines::Rounded(TOLERANCE_MM),
            Self::Arcs => Lines::Fitted(Kind::Arcs, TOLERANCE_MM),
            Self::Cubics => Lines::Fitted(Kind::Bezier, TOLERANCE_MM),
            Self::Bsplines => Lines::Fitted(Kind::Bspline, TOLERANCE_MM),
            Self::Ph => Lines::Fitted(Kind::Ph, TOLERANCE_MM),
        }
    }

    /// How it is planned.
    pub fn manner(self) -> Manner {
        let rests = if self == Self::ExactStop { Rests::AtNodes } else { Rests::Never };
        Manner { rests, ..Manner::USUAL }
    }
}

/// Without look-ahead an arc is passed no faster than lets the machine rest at the end of the block behind it: the line from its vertex to
/// that of the next arc.
pub fn forget_what_comes(strokes: &mut Strokes, limits: &Limits) {
    let least = |of: [f64; 3]| of.into_iter().fold(f64::INFINITY, f64::min);
    let (acceleration, jerk) = (least(limits.acceleration), least(limits.jerk));
    let is_arc = |stroke: &Stroke| matches!(stroke.segment, Segment::Arc(_));
    let length = |stroke: &Stroke| stroke.height.way_to(&stroke.segment, 1.0);
    let behind = |behind: &[Stroke]| match behind {
        [next, ..] if is_arc(next) => 0.5 * length(next),
        [line, next, ..] if is_arc(next) => length(line) + 0.5 * length(next),
        [line, ..] => length(line),
        [] => 0.0,
    };
    let ways: Vec<f64> = (1..=strokes.strokes.len()).map(|k| behind(&strokes.strokes[k..])).collect();
    for (stroke, way) in strokes.strokes.iter_mut().zip(ways) {
        if let (true, Pace::Feed(feed)) = (is_arc(stroke), stroke.pace) {
            stroke.pace = Pace::Feed(feed.min(stops_within(way, acceleration, jerk)));
        }
    }
}

/// The largest speed from which a motion can come to rest on a way, with a ramp of acceleration at both ends of its braking.
fn stops_within(way: f64, acceleration: f64, jerk: f64) -> f64 {
    // Where the acceleration is not reached: v = J (T/2)^2 and the way is v T/2.
    let short = (way * way * jerk).cbrt();
    let reached = acceleration * acceleration / jerk;
    if short <= reached {
        return short;
    }
    // way = v/2 (v/A + A/J).
    let half = 0.5 * reached;
    (half * half + 2.0 * acceleration * way).sqrt() - half
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The braking itself, by steps: to the largest acceleration at the jerk, kept, and back.
    #[test]
    fn a_braking_takes_its_way() {
        for way in [0.01, 0.2, 5.0, 40.0] {
            let (acceleration, jerk) = (2000.0, 50_000.0);
            let speed = stops_within(way, acceleration, jerk);
            let rise = (acceleration / jerk).min((speed / jerk).sqrt());
            let keep = (speed / (jerk * rise) - rise).max(0.0);
            let (mut v, mut x, dt) = (speed, 0.0, 1e-7);
            let whole = 2.0 * rise + keep;
            for k in 0..(whole / dt) as u32 {
                let t = (f64::from(k) + 0.5) * dt;
                let a = jerk * t.min(rise).min(whole - t);
                x += v * dt;
                v -= a * dt;
            }
            assert!(v.abs() < 1e-3 * speed + 1e-3 && (x / way - 1.0).abs() < 2e-3, "{way}: {v} {x}");
        }
    }
}

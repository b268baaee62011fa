//! Bolsunovsky & Vermel, *Toolpath spline approximation*: one program of lines, run in the ways that the paper compares and in the two that
//! it left open, by this project's planner within the same limits.
//!
//! The paper's part, machine and numbers are not in its text: it says which way is faster and why. So no figure is laid beside a published
//! one; what is checked is what the paper found ([`Claim`]).

pub mod job;
pub mod ways;

use serde::Serialize;
use shared::piece::Order;

use crate::input::InputError;
use crate::job::Job;
use crate::path::{Path, PathPiece};
use crate::plan::course::Place;
use crate::plan::{Limits, Plan, plan};
use crate::strokes::{Strokes, Tooling};
use crate::units::Units;
use crate::vector::Vector;

pub use ways::{TOLERANCE_MM, Way};

/// The machine: a mill of medium size. mm and s.
pub const LIMITS: Limits = Limits {
    velocity: [400.0; 3],
    acceleration: [3000.0; 3],
    jerk: [60_000.0; 3],
    corner_step: [3000.0 * crate::plan::limits::JERK_WINDOW; 3],
    feed: f64::INFINITY,
    centripetal: f64::INFINITY,
};

/// Stands in errors.
const NAME: &str = "plate.ngc";

/// How smoothly one stroke goes on to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Continuity {
    /// The direction breaks.
    Corner,
    /// The curvature jumps.
    Tangent,
    /// Neither.
    Curvature,
}

/// A node of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Where it is, in mm.
    pub at: Vector,
    /// How the way goes on.
    pub continuity: Continuity,
}

/// A moment of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// The time in s.
    pub time: f64,
    /// Where the tool is, in mm.
    pub at: Vector,
    /// Its feed in mm/s.
    pub feed: f64,
    /// The curvature of its way in 1/mm.
    pub curvature: f64,
}

/// What one way came to.
#[derive(Clone, Debug, Serialize)]
pub struct Run {
    /// The way.
    pub way: Way,
    /// What it is called.
    pub name: &'static str,
    /// Curves of the program.
    pub strokes: usize,
    /// How long it takes, in s.
    pub time_s: f64,
    /// The same, of exact stop, in percent.
    pub relative_percent: f64,
    /// Nodes where the direction breaks.
    pub corners: usize,
    /// Nodes where only the curvature jumps.
    pub curvature_jumps: usize,
    /// Nodes where neither does.
    pub smooth: usize,
    /// The least feed within [`FILLET`], in mm/s.
    pub fillet_least_feed: f64,
    /// The time that the tool spends there, in s.
    pub fillet_time_s: f64,
    /// Its nodes.
    #[serde(skip)]
    pub nodes: Vec<Node>,
    /// Its moments.
    #[serde(skip)]
    pub moments: Vec<Moment>,
}

/// Something that the paper found: a ratio that is below one.
#[derive(Clone, Debug, Serialize)]
pub struct Claim {
    /// What it is.
    pub name: &'static str,
    /// What it is below: the paper has no numbers in its text.
    pub published: f64,
    /// The ratio here.
    pub measured: f64,
    /// Whether it is so here.
    pub holds: bool,
}

/// All of it.
#[derive(Clone, Debug, Serialize)]
pub struct Reproduction {
    /// What the paper found, and what came out here.
    pub rows: Vec<Claim>,
    /// Way by way.
    pub runs: Vec<Run>,
    /// Lines of the program.
    pub lines: usize,
    /// The tolerance of all ways, in mm.
    pub tolerance: f64,
    /// The programmed feed, in mm/s.
    pub feed: f64,
    /// Of lengths.
    pub units: Units,
}

/// The part that the paper looks at: straight, a fillet, straight. Its lower left and upper right corner, in mm, on the second level.
pub const FILLET: [Vector; 2] = [Vector([96.0, -1.0, -2.5]), Vector([121.0, 16.0, -1.5])];

/// How many steps a reproduction has.
pub const STEPS: u64 = Way::ALL.len() as u64;

/// Whether a place is in [`FILLET`].
pub fn in_fillet(Vector(at): Vector) -> bool {
    let [Vector(low), Vector(high)] = FILLET;
    (0..3).all(|axis| (low[axis]..=high[axis]).contains(&at[axis]))
}

/// Runs all ways; `step` is told of each. Errors are sentences.
pub fn reproduce(mut step: impl FnMut()) -> Result<Reproduction, String> {
    let mut runs = Vec::new();
    for way in Way::ALL {
        runs.push(run(way).map_err(|error| error.to_string())?);
        step();
    }
    let longest = runs.first().map_or(f64::NAN, |run| run.time_s);
    for run in &mut runs {
        run.relative_percent = 100.0 * run.time_s / longest;
    }
    let rows = claims(&runs);
    let lines = job::program().lines().filter(|line| line.contains('X')).count();
    Ok(Reproduction { rows, runs, lines, tolerance: TOLERANCE_MM, feed: job::FEED / 60.0, units: Units::Mm })
}

/// What the paper found, as ratios.
fn claims(runs: &[Run]) -> Vec<Claim> {
    let of = |way: Way| runs.iter().find(|run| run.way == way);
    let ratio = |name, faster: Way, slower: Way, value: fn(&Run) -> f64| {
        let measured = of(faster).map_or(f64::NAN, value) / of(slower).map_or(f64::NAN, value);
        Claim { name, published: 1.0, measured, holds: measured < 1.0 }
    };
    let time: fn(&Run) -> f64 = |run| run.time_s;
    vec![
        ratio("time: micro arcs to exact stop", Way::MicroArcs, Way::ExactStop, time),
        ratio("time: look-ahead to none", Way::LookAhead, Way::MicroArcs, time),
        ratio("time: arcs to micro arcs with look-ahead", Way::Arcs, Way::LookAhead, time),
        ratio("time: published cubics to micro arcs with look-ahead", Way::Cubics, Way::LookAhead, time),
        ratio("time: continuous curvature to published cubics", Way::Bsplines, Way::Cubics, time),
        ratio("time: PH to published cubics", Way::Ph, Way::Cubics, time),
        ratio(
            "least feed at the fillet: published cubics to continuous curvature",
            Way::Cubics,
            Way::Bsplines,
            |run| run.fillet_least_feed,
        ),
    ]
}

/// The program in one way, as strokes.
pub fn strokes(way: Way) -> Result<Strokes, InputError> {
    let (mut strokes, _) = crate::strokes::read(NAME, job::program().as_bytes(), way.lines(), &Tooling::default())?;
    if way == Way::MicroArcs {
        ways::forget_what_comes(&mut strokes, &LIMITS);
    }
    Ok(strokes)
}

fn run(way: Way) -> Result<Run, InputError> {
    let job = Job::from_strokes(NAME, strokes(way)?)?;
    let path = Path::new(&job, Order::First)?;
    let plan = plan(&path.pieces, path.weight, &LIMITS, &way.manner())
        .map_err(|error| InputError::new(NAME, format_args!("{error:?}")))?;
    let nodes = nodes(&path);
    let count = |continuity| nodes.iter().filter(|node| node.continuity == continuity).count();
    let moments = moments(&path, &plan);
    let fillet: Vec<&Moment> = moments.iter().filter(|moment| in_fillet(moment.at)).collect();
    let span = match fillet.as_slice() {
        [first, .., last] => last.time - first.time,
        _ => 0.0,
    };
    Ok(Run {
        way,
        name: way.name(),
        strokes: job.strokes.len(),
        time_s: plan.time,
        relative_percent: 100.0,
        corners: count(Continuity::Corner),
        curvature_jumps: count(Continuity::Tangent),
        smooth: count(Continuity::Curvature),
        fillet_least_feed: fillet.iter().map(|moment| moment.feed).fold(f64::INFINITY, f64::min),
        fillet_time_s: span,
        nodes,
        moments,
    })
}

/// Where strokes meet, and how.
fn nodes(path: &Path) -> Vec<Node> {
    /// A break of the direction in radians, and a jump of the curvature as a part of the larger one, that are none; and a curvature in 1/mm
    /// against which less is straight.
    const BREAK: f64 = 1e-6;
    const JUMP: f64 = 1e-3;
    const STRAIGHT: f64 = 1e-4;
    let pairs = path.pieces.windows(2).filter(|pair| pair[0].segment != pair[1].segment);
    pairs
        .map(|pair| {
            let [end, start] = [pair[0].space(pair[0].interval[1]), pair[1].space(pair[1].interval[0])];
            let larger = end.bend.norm().max(start.bend.norm()).max(STRAIGHT);
            let continuity = if end.direction.angle(start.direction) > BREAK {
                Continuity::Corner
            } else if (start.bend - end.bend).norm() > JUMP * larger {
                Continuity::Tangent
            } else {
                Continuity::Curvature
            };
            Node { at: place(&pair[1], pair[1].interval[0]), continuity }
        })
        .collect()
}

fn place(piece: &PathPiece, xi: f64) -> Vector {
    let point = piece.point(xi);
    Vector([point.re, point.im, piece.z(xi).unwrap_or(0.0)])
}

/// The plan place by place.
fn moments(path: &Path, plan: &Plan) -> Vec<Moment> {
    let mut time = 0.0;
    let mut before = 0.0;
    let all = plan.course.places.iter().zip(&plan.speed);
    let of = |(at, &feed): (&Place, &f64)| {
        if at.step > 0.0 && feed + before > 0.0 {
            time += 2.0 * at.step / (feed + before);
        }
        before = feed;
        let at_piece = path.pieces.get(at.piece);
        let point = at_piece.map_or_else(Vector::default, |piece| place(piece, at.xi));
        Moment { time, at: point, feed, curvature: at.curvature() }
    };
    all.map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The whole comparison: what the paper found holds here, and what it left for later is the fastest.
    #[test]
    fn what_the_paper_found_holds() {
        let found = reproduce(|| ()).unwrap();
        for row in &found.rows {
            assert!(row.holds, "{}: {}", row.name, row.measured);
        }
        let of = |way: Way| found.runs.iter().find(|run| run.way == way).unwrap();
        for way in [Way::Bsplines, Way::Ph] {
            assert!(of(way).curvature_jumps < of(Way::Cubics).curvature_jumps / 4, "{way:?}");
        }
    }
}

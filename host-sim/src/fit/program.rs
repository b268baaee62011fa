//! Fits of a whole program: each chain of lines becomes curves, everything else stays as it is.
//!
//! A chain goes on as long as lines follow each other at the same feed; it is fitted as soon as it ends, so that only the longest one is in
//! memory.

use serde::Serialize;

use super::joins::joins;
use super::{Fit, Kind, fit};
use crate::program::item::PathMode;
use crate::program::quintic;
use crate::program::{Action, Feed, Item, Motion};
use crate::vector::Vector;

/// What a program comes to, one after the other.
#[derive(Debug)]
pub enum Step<'a> {
    /// A chain of lines, as curves.
    Curves {
        /// The curves.
        fit: &'a Fit,
        /// Their feed.
        feed: Feed,
        /// The program's line of the first of them.
        line: usize,
    },
    /// A chain of lines as it is, where lines are kept.
    Lines {
        /// Their ends, in mm.
        points: &'a [Vector],
        /// Their feed.
        feed: Feed,
        /// The program's line of the first of them.
        line: usize,
    },
    /// A motion or an event of the program that is no line.
    Kept(&'a Item<'a>),
}

/// What fitting came to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Summary {
    /// Points of the lines.
    pub points: usize,
    /// Lines of the program.
    pub lines: usize,
    /// Curves in their place.
    pub segments: usize,
    /// Motions that are no lines.
    pub other_motions: usize,
    /// An upper bound in mm of how far curves and lines are apart anywhere.
    pub max_deviation: f64,
    /// The largest break of the direction in radians where one curve goes on smoothly to the next.
    pub max_tangent_break: f64,
    /// The largest jump of the curvature there, as a part of the larger one.
    pub max_curvature_jump: f64,
}

/// Points that are one, in mm: less is rounding.
const SAME: f64 = 1e-9;

/// Takes the items of a program.
pub struct Fitter<'a> {
    kind: Option<Kind>,
    tolerance: f64,
    points: Vec<Vector>,
    feed: Feed,
    line: usize,
    /// Whether the program may change the tolerance.
    listens: bool,
    /// Whether its curves are fitted too.
    samples: bool,
    summary: Summary,
    sink: &'a mut dyn FnMut(Step<'_>) -> Result<(), String>,
}

impl<'a> Fitter<'a> {
    /// Gives what it makes to `sink`; the tolerance is in mm.
    pub fn new(kind: Kind, tolerance: f64, sink: &'a mut dyn FnMut(Step<'_>) -> Result<(), String>) -> Self {
        Self {
            kind: Some(kind),
            tolerance,
            points: Vec::new(),
            feed: Feed::Unset,
            line: 0,
            listens: false,
            samples: false,
            summary: Summary::default(),
            sink,
        }
    }

    /// Gives chains of lines as they are.
    pub fn keeping_lines(sink: &'a mut dyn FnMut(Step<'_>) -> Result<(), String>) -> Self {
        Self { kind: None, ..Self::new(Kind::Bezier, 0.0, sink) }
    }

    /// Where the program says a tolerance itself (G64 P), that one holds from there on.
    pub fn with_the_programs_tolerance(self) -> Self {
        Self { listens: true, ..self }
    }

    /// Curves that the program gives as such are fitted too, as the polylines that they are to a fifth of a micrometre
    /// ([`quintic::CHORD_MM`]).
    pub fn with_its_curves(self) -> Self {
        Self { samples: true, ..self }
    }

    /// The next item. Errors are those of the sink.
    pub fn take(&mut self, item: &Item<'_>) -> Result<(), String> {
        if let Action::Motion(Motion::Line { to }) = item.action {
            self.go_on(item, &[Vector(to)])?;
            self.summary.lines += 1;
            return Ok(());
        }
        if let (true, Action::Motion(motion)) = (self.samples, &item.action)
            && let Some(parts) = quintic::drawn(item.from, motion).map_err(|error| error.to_string())?
        {
            return self.go_on(item, &quintic::polyline(&parts));
        }
        self.close()?;
        if let Action::PathMode(PathMode::Blend { tolerance: Some(tolerance), .. }) = item.action
            && self.listens
            && tolerance > 0.0
        {
            self.tolerance = tolerance;
        }
        if matches!(item.action, Action::Motion(_)) {
            self.summary.other_motions += 1;
        }
        (self.sink)(Step::Kept(item))
    }

    /// Goes on to these points.
    fn go_on(&mut self, item: &Item<'_>, points: &[Vector]) -> Result<(), String> {
        if item.feed != self.feed || matches!(item.feed, Feed::Duration(_)) {
            self.close()?;
            self.feed = item.feed;
        }
        if self.points.is_empty() {
            self.points.push(Vector(item.from));
            self.line = item.line;
        }
        for &point in points {
            if self.points.last().is_none_or(|&last| (point - last).norm() > SAME) {
                self.points.push(point);
            }
        }
        Ok(())
    }

    /// Ends the program. Errors are those of the sink.
    pub fn finish(mut self) -> Result<Summary, String> {
        self.close()?;
        Ok(self.summary)
    }

    /// Gives the chain that is open to the sink. Errors are those of the sink.
    pub fn close(&mut self) -> Result<(), String> {
        let points = std::mem::take(&mut self.points);
        if points.len() < 2 {
            return Ok(());
        }
        let Some(kind) = self.kind else {
            self.summary.points += points.len();
            self.summary.segments += points.len() - 1;
            return (self.sink)(Step::Lines { points: &points, feed: self.feed, line: self.line });
        };
        let fit = fit(&points, kind, self.tolerance);
        let found = joins(&fit.parts);
        let all = &mut self.summary;
        all.points += points.len();
        all.segments += fit.parts.len();
        all.max_deviation = fit.parts.iter().map(|part| part.deviation).fold(all.max_deviation, f64::max);
        all.max_tangent_break = all.max_tangent_break.max(found.tangent);
        all.max_curvature_jump = all.max_curvature_jump.max(found.curvature);
        (self.sink)(Step::Curves { fit: &fit, feed: self.feed, line: self.line })
    }
}

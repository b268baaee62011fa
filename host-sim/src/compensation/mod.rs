//! Cutter compensation: the path of the tool's centre in the place of the contour between G41 or G42 and G40.
//!
//! The contour of a run becomes its exact trimmed offset ([`crate::offset`]): nothing is made of small lines. [`Compensator`] takes the
//! items of a program and gives on what is not compensated as it comes, so only a run is ever in memory.
//!
//! | module | what |
//! | --- | --- |
//! | `tool` | tool tables |
//! | `run` | a run as it is collected |
//! | `curves` | motions as segments that have an exact offset |
//! | `chain` | the contour of a run, and where it comes back to itself |
//! | `follow` | the trimmed offset along it, from its start to its end |
//! | `lead`, `clear` | the ways onto it and off it, and whether the first one cuts |
//! | `piece`, `centre` | what comes of it |
//! | `error` | what can be wrong, and what is worth a word |
//!
//! # As LinuxCNC has it, and as it does not
//!
//! The first motion leads from where the tool is to beside its programmed end, an arc along the circle that ends tangentially there. A
//! convex corner is rounded about its point. No motion leads out: the first one behind G40 begins where the tool's centre is.
//!
//! | | LinuxCNC | here |
//! | --- | --- | --- |
//! | a motion that the tool cannot follow at all | an error | left out, with a [`Warning`]; [`Gouge::Refuse`] makes it an error |
//! | a wall that is not next in the program | is cut into | is kept clear of |
//! | a concave corner behind the first motion | an error | the first motion leads to where the path begins |
//! | a straight entry to the start of a round, or exit from its end | cuts a little into it | first rounds its corner |
//! | G18 | XZ compensation | an error where it has arcs |
//! | Z alone just behind G40 | | straight up, where the tool's centre is |
//! | splines | errors | PH quintics within [`Options::tolerance`], and their offset |
//!
//! A round is a closed contour within a run, whatever leads in and out. What leads is kept clear of the half of the round that it meets and
//! not of all of it; nothing is said of a straight way out that cuts. A point that is within a micrometre of a line or an arc lies on it.

mod centre;
mod chain;
mod clear;
mod curves;
mod error;
mod follow;
mod lead;
mod piece;
mod run;
#[cfg(test)]
mod tests;
mod tool;

use shared::complex::Complex;

use centre::Leaving;
use run::Run;

use crate::program::item::{Compensation, Cutter, Side};
use crate::program::{Action, Item, Motion};
use curves::{SAME, flat};

pub use error::{CompensationError, Fault, Trouble, Warning, Within};
pub use piece::CentrePiece;
pub use tool::{Tool, ToolTable};

/// What is done where the tool cannot follow the contour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gouge {
    /// What it cannot reach is left out, with a warning; a way in that cuts is run, with one.
    #[default]
    Trim,
    /// It is an error.
    Refuse,
}

/// How to compensate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// What is done where the tool cannot follow.
    pub gouge: Gouge,
    /// How far PH quintics may be from the splines in whose place they stand, in mm; positive.
    pub tolerance: f64,
    /// If chains of lines are to become PH quintics first, how far these may be from them, in mm.
    pub lines: Option<f64>,
}

impl Default for Options {
    /// A micrometre for splines; lines stay lines.
    fn default() -> Self {
        Self { gouge: Gouge::Trim, tolerance: 1e-3, lines: None }
    }
}

/// What a program comes to, one after the other.
#[derive(Debug)]
pub enum Step<'a> {
    /// A motion or an event that is not compensated. Behind a run it begins where the tool's centre is.
    Kept(&'a Item<'a>),
    /// A part of a run, up to its end or to an event within it.
    Centre(&'a [CentrePiece]),
    /// Something that is left, before the pieces of its run.
    Warning(&'a Warning),
}

/// What compensating came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    /// Compensated runs.
    pub runs: usize,
    /// Pieces in the place of their motions.
    pub pieces: usize,
    /// Inside corners that keep the roundness of the tool, and no more.
    pub corners: usize,
    /// Warnings.
    pub warnings: usize,
}

/// Takes the items of a program.
pub struct Compensator<'a> {
    tools: &'a ToolTable,
    options: Options,
    loaded: Option<u32>,
    run: Option<Run>,
    /// Whether a tool without thickness is compensated for: nothing changes.
    is_thin: bool,
    /// Where the tool's centre is, behind a run.
    leaving: Option<Leaving>,
    summary: Summary,
    sink: &'a mut dyn FnMut(Step<'_>) -> Result<(), String>,
}

impl<'a> Compensator<'a> {
    /// Gives what it makes to `sink`.
    pub fn new(
        tools: &'a ToolTable,
        options: Options,
        sink: &'a mut dyn FnMut(Step<'_>) -> Result<(), String>,
    ) -> Self {
        Self {
            tools,
            options,
            loaded: None,
            run: None,
            is_thin: false,
            leaving: None,
            summary: Summary::default(),
            sink,
        }
    }

    /// The next item. Errors are sentences about it, about an earlier line that they name, or those of the sink.
    pub fn take(&mut self, item: &Item<'_>) -> Result<(), String> {
        match item.action {
            Action::Compensation(Compensation::Off) => {
                self.is_thin = false;
                self.close()
            }
            Action::Compensation(Compensation::On { side, cutter }) => self.begin(side, cutter).map_err(sentence),
            Action::Motion(motion) => self.motion(item, &motion),
            action => {
                if action == Action::End {
                    self.close()?;
                }
                self.event(item, action)
            }
        }
    }

    /// Ends the program. Errors are those of [`Self::take`].
    pub fn finish(mut self) -> Result<Summary, String> {
        self.close()?;
        Ok(self.summary)
    }

    fn begin(&mut self, side: Side, cutter: Cutter) -> Result<(), Fault> {
        if self.run.is_some() || self.is_thin {
            return Err(Fault::AlreadyOn);
        }
        let diameter = match cutter {
            Cutter::Diameter(diameter) => diameter,
            Cutter::Number(number) => self.diameter(number)?,
            Cutter::Loaded => self.diameter(self.loaded.ok_or(Fault::NothingLoaded)?)?,
        };
        let distance = 0.5 * if side == Side::Right { diameter } else { -diameter };
        if !distance.is_finite() {
            return Err(Fault::Diameter);
        }
        self.is_thin = distance == 0.0;
        self.run = (!self.is_thin).then(|| Run::new(distance, self.options.tolerance, self.options.lines));
        Ok(())
    }

    fn diameter(&self, number: u32) -> Result<f64, Fault> {
        self.tools.tool(number).map(|tool| tool.diameter).ok_or(Fault::NoTool(number))
    }

    fn event(&mut self, item: &Item<'_>, action: Action<'_>) -> Result<(), String> {
        if let Some(run) = self.run.as_mut() {
            let within = match action {
                Action::ToolChange(_) => Some(Within::ToolChange),
                Action::ToolLength(_) => Some(Within::ToolLength),
                Action::Further { .. } => Some(Within::Further),
                _ => None,
            };
            if let Some(within) = within {
                return Err(sentence(Fault::Within(within)));
            }
            if run.entry.is_some()
                && let Some(action) = lasting(action)
            {
                let Item { line, column, from, feed, .. } = *item;
                return run.event(Item { line, column, from, feed, action }).map_err(sentence);
            }
        }
        if let Action::ToolChange(number) = action {
            self.loaded = (number > 0).then_some(number);
        }
        let from = self.place(item.from);
        (self.sink)(Step::Kept(&Item { from, ..*item }))
    }

    fn motion(&mut self, item: &Item<'_>, motion: &Motion<'_>) -> Result<(), String> {
        if let Some(run) = self.run.as_mut()
            && run.entry.is_some()
        {
            return run.take(item, motion).map_err(sentence);
        }
        let to = motion.to().unwrap_or(item.from);
        let is_straight = matches!(motion, Motion::Rapid { .. } | Motion::Line { .. });
        if is_straight && (flat(to) - flat(item.from)).norm() <= SAME {
            // Up or down, where the tool is.
            let [from, to] = [item.from, to].map(|point| self.place(point));
            let motion =
                if matches!(motion, Motion::Rapid { .. }) { Motion::Rapid { to } } else { Motion::Line { to } };
            return (self.sink)(Step::Kept(&Item { from, action: Action::Motion(motion), ..*item }));
        }
        let from = self.place(item.from);
        let leaving = self.leaving.take();
        if let Some(run) = self.run.as_mut() {
            return run.enter(flat(from), item, motion).map_err(sentence);
        }
        let Some(leaving) = leaving else { return (self.sink)(Step::Kept(item)) };
        if !is_straight {
            return Err(sentence(Fault::ExitCurve));
        }
        let from = match leaving.rounding(flat(to), from[2]) {
            Some(piece) => {
                self.give(&[piece])?;
                let end = piece.end();
                [end.re, end.im, from[2]]
            }
            None => from,
        };
        (self.sink)(Step::Kept(&Item { from, ..*item }))
    }

    /// Where the tool's centre is, for a programmed point.
    fn place(&self, point: [f64; 3]) -> [f64; 3] {
        self.leaving.map_or(point, |leaving| leaving.place(point))
    }

    fn give(&mut self, pieces: &[CentrePiece]) -> Result<(), String> {
        if pieces.is_empty() {
            return Ok(());
        }
        self.summary.pieces += pieces.len();
        (self.sink)(Step::Centre(pieces))
    }

    /// Ends a run, if there is one.
    fn close(&mut self) -> Result<(), String> {
        let Some(mut run) = self.run.take() else { return Ok(()) };
        let Some(centre) = centre::of(&mut run).map_err(|error| error.to_string())? else { return Ok(()) };
        self.summary.runs += 1;
        self.summary.corners += centre.corners;
        for warning in &centre.left {
            if self.options.gouge == Gouge::Refuse {
                return Err(Fault::Refused(*warning).to_string());
            }
            self.summary.warnings += 1;
            (self.sink)(Step::Warning(warning))?;
        }
        let mut from = 0;
        let mut z = centre.start_z;
        for (before, item) in &centre.events {
            self.give(&centre.pieces[from..*before])?;
            z = if *before > from { centre.pieces[*before - 1].z[1] } else { z };
            from = *before;
            let at = centre.point(*before);
            let in_space = |z: f64| [at.re, at.im, z];
            let action = match item.action {
                Action::Motion(motion) => {
                    let height = motion.to().map_or(z, |to| to[2]);
                    // The next piece may begin a little on, where what is between cannot be reached.
                    let height = centre.pieces.get(*before).map_or(height, |piece| piece.z[0]);
                    let to = in_space(height);
                    Action::Motion(if matches!(motion, Motion::Rapid { .. }) {
                        Motion::Rapid { to }
                    } else {
                        Motion::Line { to }
                    })
                }
                action => action,
            };
            (self.sink)(Step::Kept(&Item { from: in_space(z), action, ..*item }))?;
            z = if let Action::Motion(motion) = action { motion.to().map_or(z, |to| to[2]) } else { z };
        }
        self.give(&centre.pieces[from..])?;
        self.leaving = Some(centre.leaving);
        Ok(())
    }
}

fn sentence(fault: Fault) -> String {
    fault.to_string()
}

/// An event as such; none of a motion.
fn lasting(action: Action<'_>) -> Option<Action<'static>> {
    Some(match action {
        Action::Motion(_) => return None,
        Action::Further { axis, to } => Action::Further { axis, to },
        Action::Dwell(time) => Action::Dwell(time),
        Action::PathMode(mode) => Action::PathMode(mode),
        Action::Compensation(compensation) => Action::Compensation(compensation),
        Action::ToolLength(length) => Action::ToolLength(length),
        Action::ToolSelect(number) => Action::ToolSelect(number),
        Action::ToolChange(number) => Action::ToolChange(number),
        Action::Spindle(spindle) => Action::Spindle(spindle),
        Action::Coolant(coolant) => Action::Coolant(coolant),
        Action::Stop { optional } => Action::Stop { optional },
        Action::End => Action::End,
    })
}

/// A point of the centre.
type Point = Complex<f64>;

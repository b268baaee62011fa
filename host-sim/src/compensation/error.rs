//! What can be wrong with a compensated program, and what is worth a word.

use std::fmt;

use shared::complex::Complex;

use crate::offset::OffsetError;
use crate::units::{Units, plain};

/// Why a program cannot be compensated. Lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// The tool is not in the table.
    NoTool(u32),
    /// The loaded tool is asked for, and there is none.
    NothingLoaded,
    /// The diameter is not a number.
    Diameter,
    /// It is on already.
    AlreadyOn,
    /// Something that cannot stand in a compensated run.
    Within(Within),
    /// An arc in another plane than XY.
    Plane,
    /// A curve whose height does not change evenly.
    Height,
    /// A curve that no PH quintic follows within the tolerance.
    NoFit(f64),
    /// A Bezier curve or B-spline as the first motion.
    EntryCurve,
    /// The first motion is no longer than the tool's radius.
    EntryShort {
        /// How long it is.
        length: f64,
        /// The tool's radius.
        radius: f64,
    },
    /// No arc leads from where the tool is to the compensated end of the first motion.
    EntryArc,
    /// A motion behind G40 is not straight.
    ExitCurve,
    /// The contour has no offset.
    Offset {
        /// Why.
        error: OffsetError,
        /// The signed distance.
        distance: f64,
    },
    /// No connected path leads along the contour from the first motion to the last.
    Apart {
        /// The tool's radius.
        radius: f64,
    },
    /// The contour crosses itself more often than is followed.
    Tangle,
    /// Something is left, and that was to be refused.
    Refused(Warning),
}

/// What cannot stand in a compensated run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Within {
    /// Another tool is put in.
    ToolChange,
    /// The tool's length changes.
    ToolLength,
    /// A further axis moves.
    Further,
}

/// A fault, and line and column of what it is about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompensationError {
    /// What is wrong.
    pub fault: Fault,
    /// Line and column, from 1.
    pub place: [usize; 2],
}

/// What a warning is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trouble {
    /// The tool leaves material because it cannot come there.
    Left,
    /// The way in cuts into the closed contour that it leads to.
    Entry,
}

/// What is thinner or less deep than this, in mm, is worth no word: programs are rounded.
pub(super) const WORTH: f64 = 1e-3;

/// A place at which the part is not as the program has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Warning {
    /// What is so.
    pub trouble: Trouble,
    /// The lines of the first and the last motion that are not run whole; of the way in.
    pub lines: [usize; 2],
    /// The column of the first one.
    pub column: usize,
    /// The thickness of the material that is left, or how deep the cut is; at the thickest and deepest place, in mm.
    pub depth: f64,
    /// The point of the contour where that is, in mm.
    pub at: Complex<f64>,
    /// The tool's radius in mm.
    pub radius: f64,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [first, last] = self.lines;
        if first == last {
            write!(f, "line {first}")?;
        } else {
            write!(f, "lines {first} to {last}")?;
        }
        let [depth, radius] = [self.depth, self.radius].map(|mm| Units::Mm.length(mm));
        let at = Units::Mm.point(self.at);
        match self.trouble {
            Trouble::Left => {
                write!(f, ": a tool of radius {radius} cannot enter and leaves up to {depth} of material at {at} mm")
            }
            Trouble::Entry => {
                write!(f, ": a tool of radius {radius} cuts {depth} into the contour on its way in, at {at} mm")
            }
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NoTool(number) => write!(f, "tool {number} is in no tool table; add it to the one that --tools names, or give D with G41.1 or G42.1"),
            Self::NothingLoaded => {
                f.write_str("no tool is loaded for cutter compensation; put one in with T and M6, or give D")
            }
            Self::Diameter => f.write_str("the diameter of the tool is not a number"),
            Self::AlreadyOn => f.write_str("cutter compensation is on already; put G40 before it"),
            Self::Within(within) => write!(f, "{within} within cutter compensation; put G40 before it"),
            Self::Plane => f.write_str("cutter compensation is in the XY plane here; give its arcs in G17"),
            Self::Height => {
                f.write_str("a curve under cutter compensation changes its height unevenly; keep it at one height")
            }
            Self::NoFit(tolerance) => {
                write!(f, "no PH curve follows this one within {} mm; allow a larger tolerance", plain(tolerance))
            }
            Self::EntryCurve => {
                f.write_str("the first motion under cutter compensation is a spline; lead in with a line or an arc")
            }
            Self::EntryShort { length, radius } => write!(
                f,
                "the first motion under cutter compensation is {} mm long; it needs more than the tool's radius of {} mm",
                plain(length),
                plain(radius)
            ),
            Self::EntryArc => f.write_str(
                "no arc leads from here to the compensated end of the first motion; lead in with a line, or a larger arc",
            ),
            Self::ExitCurve => {
                f.write_str("the first motion behind cutter compensation is a curve; lead out with a line before it")
            }
            Self::Offset { error, distance } => f.write_str(&error.sentence(distance.abs(), Units::Mm)),
            Self::Apart { radius } => write!(
                f,
                "a tool of radius {} mm cannot go along this contour from its start to its end; take a smaller tool",
                plain(radius)
            ),
            Self::Tangle => f.write_str("the contour under cutter compensation crosses itself too often; put G40 in between"),
            Self::Refused(warning) => match warning.trouble {
                Trouble::Left => write!(f, "{warning}; take a smaller tool, or let it be trimmed"),
                Trouble::Entry => write!(f, "{warning}; lead in from farther away, or on an arc"),
            },
        }
    }
}

impl fmt::Display for Within {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::ToolChange => "a tool change stands",
            Self::ToolLength => "a change of the tool's length stands",
            Self::Further => "a motion of an axis other than X, Y and Z stands",
        })
    }
}

/// With the line, since a run's error comes when the run ends.
impl fmt::Display for CompensationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [line, column] = self.place;
        write!(f, "{} (line {line}, column {column})", self.fault)
    }
}

impl std::error::Error for CompensationError {}

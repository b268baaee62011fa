//! Programs as strokes: read, compensated, fitted.

use std::cell::RefCell;
use std::io::BufRead;

use super::Strokes;
use crate::compensation::{self, Compensator, Gouge, ToolTable};
use crate::fit::Kind;
use crate::fit::program::{Fitter, Step};
use crate::input::InputError;
use crate::program;

/// What becomes of chains of lines. Lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lines {
    /// They stay.
    Kept,
    /// Their breaks are rounded within a tolerance.
    Rounded(f64),
    /// Curves within a tolerance stand for them.
    Fitted(Kind, f64),
    /// Curves within a tolerance, or within the program's own where it says one (G64 P).
    FittedAsTold(Kind, f64),
}

/// What a program does not say itself.
#[derive(Clone, Debug, Default)]
pub struct Tooling {
    /// The tools.
    pub tools: ToolTable,
    /// What is done where one cannot follow its contour.
    pub gouge: Gouge,
}

/// The strokes of a program, whose language its name tells, and what is worth a word. Errors: those of its reader, and what the axes of a job cannot do.
pub fn read(
    name: &str,
    input: impl BufRead,
    lines: Lines,
    tooling: &Tooling,
) -> Result<(Strokes, Vec<String>), InputError> {
    let strokes = RefCell::new(match lines {
        Lines::Rounded(tolerance) => Strokes::rounding(tolerance),
        Lines::Kept | Lines::Fitted(..) | Lines::FittedAsTold(..) => Strokes::default(),
    });
    let mut take = |step: Step<'_>| strokes.borrow_mut().take(&step);
    let mut fitter = match lines {
        Lines::Kept | Lines::Rounded(_) => Fitter::keeping_lines(&mut take),
        Lines::Fitted(kind, tolerance) => Fitter::new(kind, tolerance, &mut take),
        Lines::FittedAsTold(kind, tolerance) => Fitter::new(kind, tolerance, &mut take).with_the_programs_tolerance(),
    };
    let mut warnings = Vec::new();
    let options = compensation::Options {
        gouge: tooling.gouge,
        // A contour is fitted before it is offset, so that its offset is exact.
        lines: match lines {
            Lines::Fitted(Kind::Ph | Kind::Drivable, tolerance)
            | Lines::FittedAsTold(Kind::Ph | Kind::Drivable, tolerance) => Some(tolerance),
            _ => None,
        },
        ..compensation::Options::default()
    };
    let mut give = |step: compensation::Step<'_>| match step {
        compensation::Step::Kept(item) => fitter.take(item),
        compensation::Step::Centre(pieces) => {
            fitter.close()?;
            pieces.iter().for_each(|piece| strokes.borrow_mut().centre(piece));
            Ok(())
        }
        compensation::Step::Warning(warning) => {
            warnings.push(format!("{name}: {warning}"));
            Ok(())
        }
    };
    let mut compensator = Compensator::new(&tooling.tools, options, &mut give);
    program::read(name, input, &mut |item| compensator.take(item))?;
    compensator.finish().map_err(|message| InputError::new(name, message))?;
    fitter.finish().map_err(|message| InputError::new(name, message))?;
    Ok((strokes.into_inner(), warnings))
}

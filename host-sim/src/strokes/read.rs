//! Programs as strokes.

use std::io::BufRead;

use super::Strokes;
use crate::fit::Kind;
use crate::fit::program::Fitter;
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

/// The strokes of a program, whose language its name tells. Errors: those of its reader, and what the axes of a job cannot do.
pub fn read(name: &str, input: impl BufRead, lines: Lines) -> Result<Strokes, InputError> {
    let mut strokes = match lines {
        Lines::Rounded(tolerance) => Strokes::rounding(tolerance),
        Lines::Kept | Lines::Fitted(..) | Lines::FittedAsTold(..) => Strokes::default(),
    };
    let mut take = |step: crate::fit::program::Step<'_>| strokes.take(&step);
    let mut fitter = match lines {
        Lines::Kept | Lines::Rounded(_) => Fitter::keeping_lines(&mut take),
        Lines::Fitted(kind, tolerance) => Fitter::new(kind, tolerance, &mut take),
        Lines::FittedAsTold(kind, tolerance) => Fitter::new(kind, tolerance, &mut take).with_the_programs_tolerance(),
    };
    program::read(name, input, &mut |item| fitter.take(item))?;
    fitter.finish().map_err(|message| InputError::new(name, message))?;
    Ok(strokes)
}

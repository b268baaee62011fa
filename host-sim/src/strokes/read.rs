//! Programs as strokes: read, compensated, fitted.

use std::cell::RefCell;
use std::io::BufRead;

use shared::fixed::REACH_MM;

use super::Strokes;
use crate::compensation::{self, Compensator, Gouge, ToolTable};
use crate::fit::Kind;
use crate::fit::program::{Fitter, Step};
use crate::input::InputError;
use crate::program::{self, Action, Item, Motion};

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

/// How far a program may go from its zero, in mm: twice as far as a controller does, which the length of a tool never makes up for. Numbers
/// beyond it are refused before anything is made of them.
const FARTHEST: f64 = 2.0 * REACH_MM;

/// The same of the centre of an arc, which may be all but straight.
const FARTHEST_CENTRE: f64 = 1e6 * REACH_MM;

/// The error is a sentence: a point of an item is out of any reach.
fn within_reach(item: &Item<'_>) -> Result<(), String> {
    let Action::Motion(motion) = item.action else { return Ok(()) };
    let (points, centre) = match motion {
        Motion::Rapid { .. } | Motion::Line { .. } => (&[][..], [0.0; 2]),
        Motion::Arc(arc) => (&[][..], arc.centre),
        Motion::Bezier { points } => (points, [0.0; 2]),
        Motion::Nurbs(curve) => (curve.points, [0.0; 2]),
    };
    let ends = [item.from, motion.to().unwrap_or(item.from)];
    let is_near = |x: &f64| x.abs() <= FARTHEST;
    if !ends.iter().chain(points).flatten().all(is_near) || !centre.iter().all(|x| x.abs() <= FARTHEST_CENTRE) {
        let metres = FARTHEST / 1e3;
        return Err(format!("this leads farther than {metres} m from the program's zero; no machine here goes so far"));
    }
    Ok(())
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
            pieces.iter().try_for_each(|piece| strokes.borrow_mut().centre(piece))
        }
        compensation::Step::Warning(warning) => {
            warnings.push(format!("{name}: {warning}"));
            Ok(())
        }
    };
    let mut compensator = Compensator::new(&tooling.tools, options, &mut give);
    program::read(name, input, &mut |item| {
        within_reach(item)?;
        compensator.take(item)
    })?;
    compensator.finish().map_err(|message| InputError::new(name, message))?;
    fitter.finish().map_err(|message| InputError::new(name, message))?;
    Ok((strokes.into_inner(), warnings))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each is refused at its line, and at once.
    #[test]
    fn what_is_out_of_reach_is_refused() {
        let sentence = |block: &str| {
            let program = format!("G21 G90 F100\nG0 X1\n{block}\nM2\n");
            read("far.ngc", program.as_bytes(), Lines::Kept, &Tooling::default()).map(|_| ()).map_err(|e| e.position)
        };
        assert_eq!(sentence("G1 X7999"), Ok(()));
        for block in ["G0 Y8001", "G1 Z-10000000000000", "G5 X2 Y2 I0 J9000 P0 Q1"] {
            assert_eq!(sentence(block).map_err(|place| place.map(|(line, _)| line)), Err(Some(3)), "{block}");
        }
    }
}

//! Programs for the Sinumerik 840D, with the B-splines that CAM systems write for it.
//!
//! ```
//! use host_sim::program::{Action, Motion, sinumerik};
//!
//! let mut knots = Vec::new();
//! let program = b"G710 G17 G90\nG1 X0 Y0 F600\nBSPLINE SD=3 X1 PL=0\nX2 Y1 PL=0\nX3 Y1 PL=2\nX4 Y0 PL=1\nM30";
//! sinumerik::read("part.mpf", &program[..], &sinumerik::Settings::default(), &mut |item| {
//!     if let Action::Motion(Motion::Nurbs(curve)) = item.action {
//!         knots.extend_from_slice(curve.knots);
//!     }
//!     Ok(())
//! })?;
//! assert_eq!(knots, [0.0, 0.0, 0.0, 0.0, 2.0, 3.0, 3.0, 3.0, 3.0]);
//! # Ok::<(), host_sim::input::InputError>(())
//! ```
//!
//! # The knots of BSPLINE
//!
//! The control points of a spline are the place of the tool, P0, and the points of its blocks, P1 to Pn. SD is the degree d,
//! 2 or 3, and 3 without. PW is the weight of a point, 1 without; P0 weighs 1. PL is the length of an interval of the
//! parameter, the difference of two knots, by this rule:
//!
//! - The spline begins and ends at its first and last point: there the knots stand d + 1 times.
//! - So there are n + 1 - d intervals. They belong to Pd, …, Pn, in order; without PL an interval is 1 long.
//! - P1 to P(d-1) have no interval: PL is 0 there, or missing. P0 has none either.
//! - A PL of 0 makes a knot multiple. The first and the last interval are longer than 0, and no more than d - 1 in a row are
//!   0 (the spline would be torn). A spline of Bézier curves has PL = 0, 0, 1, 0, 0, 1, ….
//!
//! A program that says something else is refused at the PL that does, for it was written for another rule and would give
//! another curve. The programming manual leaves open which intervals the control takes where no PL stands at all.
//!
//! A spline ends before a block with another motion, with BSPLINE, or without a point and with a dwell, an M, S or T; behind
//! the last kind, a next spline needs its BSPLINE. A spline is one motion: F cannot change within it, and M, S and T stand
//! before its second point or behind its end.
//!
//! # What else is read
//!
//! G0 to G4, G17 to G19, G40 to G42, G60, G64 and G641 to G645, G70 G71 G700 G710, G90 G91, G93 G94, I J K, CR=, TURN=, F S T,
//! M0 to M9, M17, M30, N, `:`, `/`, `;`, `%` lines and MSG. D is left out, as are words that only say how smoothly a
//! control runs a path (SOFT, COMPCAD, G601). One of G54 to G57, G500 may be named, the same all through: coordinates are
//! those of this one system. Any other word is an error that names it, among them tool orientation (ORIWKS, TRAORI, A3=),
//! axes other than X, Y, Z, cycles, R parameters and expressions.
//!
//! | module | what |
//! | --- | --- |
//! | `words` | a line as words |
//! | `block` | the words of a line by what they do |
//! | `reader` | what blocks do |
//! | `spline` | control points and knots |
//! | `fault` | what can be wrong |

mod block;
mod fault;
mod reader;
mod spline;
#[cfg(test)]
mod tests;
mod words;

use std::io::BufRead;

use super::Sink;
use super::lines::Lines;
use super::output::Output;
use crate::input::InputError;
use crate::units::Units;
use block::Block;
use fault::{Fault, Misplaced, Place};
use reader::Reader;

/// What a program does not say itself. Lengths in mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The unit before the first G70, G71, G700 or G710.
    pub units: Units,
    /// Where the tip is before the first motion.
    pub start: [f64; 3],
    /// Whether blocks that begin with `/` are left out.
    pub block_delete: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self { units: Units::Mm, start: [0.0; 3], block_delete: true }
    }
}

/// Reads a program and gives its items to `sink`; the last one is [`super::Action::End`]. Returns how many lines were read.
///
/// Errors: the file cannot be read, a block is wrong, or the sink refuses an item. What stands before has been given then.
pub fn read(name: &str, input: impl BufRead, settings: &Settings, sink: Sink<'_>) -> Result<usize, InputError> {
    let mut lines = Lines::new(name, input);
    let mut block = Block::default();
    let mut reader = Reader::new(settings);
    loop {
        let more = lines.advance()?;
        let mut out = Output::new(lines.number(), lines.text(), sink);
        let done = if more {
            let read = block.read(lines.text(), settings.block_delete);
            read.and_then(|()| reader.block(&block, &mut out))
        } else {
            reader.end(0, &mut out).map(|()| true)
        };
        match done {
            Ok(true) => return Ok(lines.number()),
            Ok(false) => {}
            Err(Misplaced { place, fault }) => {
                let message = out.refusal.take().filter(|_| fault == Fault::Refused);
                let message = message.unwrap_or_else(|| fault.to_string());
                return Err(match place {
                    Place::Here(at) => lines.error(at, message),
                    // That line is no longer held: its place alone is named.
                    Place::Before { line, column } => {
                        InputError { position: Some((line, column)), ..InputError::new(name, message) }
                    }
                });
            }
        }
    }
}

//! RS-274 (G-code) as LinuxCNC and Grbl speak it.
//!
//! ```
//! use host_sim::program::{Action, Motion, rs274};
//!
//! let mut ends = Vec::new();
//! rs274::read("part.ngc", &b"g21 f600\ng0 x1 y2\ng1 x[1+2]\nm2"[..], &rs274::Settings::default(), &mut |item| {
//!     if let Action::Motion(motion) = item.action {
//!         ends.extend(motion.to());
//!     }
//!     Ok(())
//! })?;
//! assert_eq!(ends, [[1.0, 2.0, 0.0], [3.0, 2.0, 0.0]]);
//! # Ok::<(), host_sim::input::InputError>(())
//! ```
//!
//! Read are G0 G1 G2 G3 G4 G5 G5.1 G5.2 G5.3 G10 (L2 L20) G17 to G21 G28 G28.1 G30 G30.1 G40 to G42 (and .1) G43 G43.1 G49
//! G53 to G59.3 G61 G61.1 G64 G80 G90 G90.1 G91 G91.1 G92 (and .1 .2 .3) G93 G94 G96 G97, M0 to M9 M30 M60, F S T N,
//! comments, `%`, `/`, parameters and expressions. M48 to M53 are read and left out: they let a person change feeds while
//! the program runs, or not. Rules and sentences are those of the RS274/NGC standard (NIST IR 6556) and LinuxCNC's manual.
//!
//! Where the two speak differently, or loosely:
//!
//! - F and S beside G20 or G21 are in that unit, as Grbl has it and as people mean it; LinuxCNC takes F in the unit before.
//! - A program needs no end: neither `%` nor M2. What follows an end is not read.
//! - G2 or G3 without any word only makes arcs the motion in force.
//! - With G64 P and no Q, points are thinned by P, as LinuxCNC does.
//! - An F for a motion of turning axes alone is taken as if it were a length per minute.
//! - O words, canned cycles, probing, threads, turned coordinate systems and user M codes are errors.
//!
//! | module | what |
//! | --- | --- |
//! | `words` | a line as a block of words |
//! | `expression`, `parameters`, `known` | values that are computed, and what they are computed from |
//! | `codes` | the codes, their modal groups and their words |
//! | `fault` | what can be wrong |
//! | `frames` | coordinate systems, shifts, tool length |
//! | `interpreter` | modal state, and the order in which a block acts |
//! | `events`, `setup`, `motion` | what the codes do |
//! | `nurbs` | the curve between G5.2 and G5.3 |

mod codes;
mod events;
mod expression;
mod fault;
mod frames;
mod interpreter;
mod known;
mod motion;
mod nurbs;
mod parameters;
mod setup;
#[cfg(test)]
mod tests;
mod words;

use std::collections::BTreeMap;
use std::io::BufRead;

use super::Sink;
use super::lines::Lines;
use super::output::Output;
use crate::input::InputError;
use crate::units::Units;
use fault::{Fault, Misplaced};
use interpreter::Interpreter;
use words::{Block, Kind};

/// What a program does not say itself. Lengths in mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The unit before the first G20 or G21.
    pub units: Units,
    /// Where the tip is before the first motion, in the program's frame.
    pub start: [f64; 3],
    /// Whether blocks that begin with `/` are left out.
    pub block_delete: bool,
    /// The machine's coordinates of the zeros of G54 to G59.3; G54 is active at the beginning, and its zero is the frame's.
    pub systems: [[f64; 3]; 9],
    /// The machine's coordinates of the places of G28 and G30.
    pub homes: [[f64; 3]; 2],
    /// The lengths of tools by number, for G43. One that is not here has length 0, which only G53, G28 and G30 can tell.
    pub lengths: BTreeMap<u32, f64>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            units: Units::Mm,
            start: [0.0; 3],
            block_delete: true,
            systems: [[0.0; 3]; 9],
            homes: [[0.0; 3]; 2],
            lengths: BTreeMap::new(),
        }
    }
}

/// Reads a program and gives its items to `sink`; the last one is [`super::Action::End`]. Returns how many lines were read.
///
/// Errors: the file cannot be read, a block is wrong, or the sink refuses an item. What stands before has been given then.
pub fn read(name: &str, input: impl BufRead, settings: &Settings, sink: Sink<'_>) -> Result<usize, InputError> {
    let mut lines = Lines::new(name, input);
    let mut interpreter = Interpreter::new(settings);
    let mut block = Block::default();
    let mut begun = false;
    loop {
        let more = lines.advance()?;
        let mut out = Output::new(lines.number(), lines.text(), sink);
        let known = interpreter.known(out.line);
        let kind = block.read(lines.text(), settings.block_delete, &interpreter.parameters, &known);
        let done = kind.and_then(|kind| match kind {
            _ if !more => interpreter.end(0, &mut out).map(|()| true),
            Kind::Words => interpreter.block(&mut block, &mut out).inspect(|_| begun |= !block.is_empty()),
            // The first one may stand in front; behind a block it ends the program.
            Kind::Percent if std::mem::replace(&mut begun, true) => interpreter.end(0, &mut out).map(|()| true),
            Kind::Percent | Kind::Deleted => Ok(false),
        });
        match done {
            Ok(true) => return Ok(lines.number()),
            Ok(false) => {}
            Err(Misplaced { at, fault }) => {
                let message = out.refusal.take().filter(|_| fault == Fault::Refused);
                return Err(lines.error(at, message.unwrap_or_else(|| fault.to_string())));
            }
        }
    }
}

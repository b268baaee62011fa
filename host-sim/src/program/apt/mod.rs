//! Cutter-location files, as CAM systems write them in the words of APT (ISO 4343).
//!
//! Motions are FROM, GOTO, GODLTA, RAPID (for the motion behind it) and CIRCLE, whose arc ends at the GOTO behind it and turns
//! to the left about the axis that it gives. FEDRAT takes its unit from MMPM or IPM beside the number, and is per minute in the
//! file's unit without. UNITS, SPINDL, COOLNT, LOADTL, CUTCOM, DELAY, STOP, OPSTOP, END and FINI are events. What only tells of
//! the CAM system (names, pictures, its tolerances) is left out; any other statement is an error, for it might move.
//!
//! | module | what |
//! | --- | --- |
//! | `statement` | words, over as many lines as a statement has |
//! | `reader` | what statements do |
//! | `fault` | what can be wrong |

mod fault;
mod reader;
mod statement;
#[cfg(test)]
mod tests;

use std::io::BufRead;

use super::Sink;
use super::lines::Lines;
use super::output::Output;
use crate::input::InputError;
use crate::units::Units;
use fault::{Fault, Misplaced};
use reader::Reader;
use statement::Statement;

/// Reads a file whose unit is `units` unless it says another one, and gives its items to `sink`; the last one is
/// [`super::Action::End`]. The tool is at the origin where no FROM says another place. Returns how many lines were read.
///
/// Errors: the file cannot be read, a statement is wrong, or the sink refuses an item. What stands before has been given then.
pub fn read(name: &str, input: impl BufRead, units: Units, sink: Sink<'_>) -> Result<usize, InputError> {
    let mut lines = Lines::new(name, input);
    let mut statement = Statement::default();
    let mut reader = Reader::new(units);
    loop {
        let more = lines.advance()?;
        let mut out = Output::new(lines.number(), lines.text(), sink);
        let done = if more {
            let whole = statement.line(out.line, lines.text());
            whole.and_then(|whole| if whole { reader.statement(&statement.words, &mut out) } else { Ok(false) })
        } else {
            reader.end(&mut out, 0).map(|()| true)
        };
        match done {
            Ok(true) => return Ok(lines.number()),
            Ok(false) => {}
            Err(Misplaced { line, at, fault }) => {
                let message = out.refusal.take().filter(|_| fault == Fault::Refused);
                let message = message.unwrap_or_else(|| fault.to_string());
                // Of a statement that began in another line, that line is no longer held: its place alone is named.
                return Err(if line == lines.number() {
                    lines.error(at, message)
                } else {
                    InputError { position: Some((line, at + 1)), ..InputError::new(name, message) }
                });
            }
        }
    }
}

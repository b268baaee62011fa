//! Drawings: the curves of a file, brought into chains, each of which is drawn without a rapid.
//!
//! ```
//! use host_sim::program::{Action, Motion, drawing};
//!
//! let text = r#"<svg xmlns="http://www.w3.org/2000/svg" width="10mm" height="10mm" viewBox="0 0 10 10">
//!     <path d="M 1 1 H 5" stroke="black"/></svg>"#;
//! let mut ends = Vec::new();
//! let seen = drawing::svg::read("part.svg", text.as_bytes(), &mut |item| {
//!     if let Action::Motion(Motion::Line { to }) = item.action {
//!         ends.push(to.map(f64::round));
//!     }
//!     Ok(())
//! })?;
//! assert_eq!(ends, [[5.0, 9.0, 0.0]]);
//! assert_eq!((seen.chains, seen.warnings.len()), (1, 0));
//! # Ok::<(), host_sim::input::InputError>(())
//! ```
//!
//! Items are those of programs. A rapid leads from the end of a chain, and at first from the origin, to where the next one
//! begins; it goes straight, and how the tool is lifted for it is not a matter of the drawing. No item has a feed. A drawing has
//! no lines that a person would look for: the line of an item is the number of its chain, the column that of its motion in
//! the chain, both from 1. What a drawing has beside curves is left out and named in [`Seen::warnings`].
//!
//! | module | what |
//! | --- | --- |
//! | [`svg`] | paths of SVG, in px, mm or inch |
//! | [`dxf`] | entities of DXF |
//! | `curve` | curves that own their points, and can be turned round |
//! | `join` | chains whose ends meet become one |

mod curve;
pub mod dxf;
mod join;
pub mod svg;

use std::collections::BTreeMap;

use super::{Action, Feed, Item, Motion, Sink};
use crate::input::InputError;
use curve::{Chain, finite};

/// What a drawing came to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Seen {
    /// How many chains were given.
    pub chains: usize,
    /// What was left out, each with how many there are of it.
    pub warnings: Vec<Warning>,
}

/// Something of a drawing that is no curve of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// What it is, in the words of the file's language.
    pub what: String,
    /// How many there are.
    pub count: usize,
}

impl std::fmt::Display for Warning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} × {} left out", self.count, self.what)
    }
}

/// Counts what is left out.
#[derive(Clone, Debug, Default)]
struct LeftOut(BTreeMap<String, usize>);

impl LeftOut {
    fn add(&mut self, what: impl Into<String>) {
        *self.0.entry(what.into()).or_default() += 1;
    }

    fn warnings(self) -> Vec<Warning> {
        self.0.into_iter().map(|(what, count)| Warning { what, count }).collect()
    }
}

/// Gives chains to a sink. Errors: a number is none, or the sink refuses an item.
fn give(name: &str, chains: &[Chain], sink: Sink<'_>) -> Result<(), InputError> {
    let mut place = [0.0; 3];
    for (number, chain) in chains.iter().enumerate() {
        let line = number + 1;
        let fail =
            |column, message: String| InputError { position: Some((line, column)), ..InputError::new(name, message) };
        if !finite(chain) {
            return Err(fail(1, "a number of this chain is none, or too large for a machine".to_string()));
        }
        let Some(start) = chain.start() else { continue };
        let mut give = |column, from, action| {
            sink(&Item { line, column, from, feed: Feed::Unset, action }).map_err(|message| fail(column, message))
        };
        if start != place || number == 0 {
            give(1, place, Action::Motion(Motion::Rapid { to: start }))?;
        }
        place = start;
        for (index, curve) in chain.0.iter().enumerate() {
            give(index + 1, place, Action::Motion(curve.motion()))?;
            place = curve.to();
        }
    }
    let end = Item { line: chains.len().max(1), column: 1, from: place, feed: Feed::Unset, action: Action::End };
    sink(&end).map_err(|message| InputError::new(name, message))
}

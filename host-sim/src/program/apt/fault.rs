//! What can be wrong in a statement, as a person reads it.

use std::fmt;

use crate::program::arc::NoArc;

/// A fault, and the line and the byte of it where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misplaced {
    /// The line, from 1: a statement may go on over several.
    pub line: usize,
    /// The byte.
    pub at: usize,
    /// The fault.
    pub fault: Fault,
}

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// A byte that belongs to no word.
    Unexpected(u8),
    /// A number that is none, or beyond the bound of all readers.
    Number,
    /// A statement with more words than any has.
    TooLong(usize),
    /// A statement that does not begin with a name.
    NoMajor,
    /// A statement that is not read.
    Unknown,
    /// A statement with other words than it takes, and those that it takes.
    Takes(&'static str),
    /// A word that the statement does not know.
    Minor,
    /// A tool that is not upright.
    Tilted,
    /// A circle about another axis.
    Oblique,
    /// A circle, and no motion behind it.
    LooseCircle,
    /// An arc that there is not.
    Arc(NoArc),
    /// A cut without feed.
    NoFeed,
    /// A feed for each turn of the spindle.
    PerTurn,
    /// The sink refused an item; the reason is kept beside.
    Refused,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Unexpected(byte) if byte.is_ascii_graphic() => {
                write!(f, "`{}` belongs to no word; names, numbers and commas would do", char::from(byte))
            }
            Self::Unexpected(byte) => write!(f, "the byte {byte} belongs to no word; names, numbers and commas would do"),
            Self::Number => f.write_str("this is no number that a machine could use"),
            Self::TooLong(most) => write!(f, "a statement of more than {most} words"),
            Self::NoMajor => f.write_str("a statement begins with its name, as in GOTO/1,2,3"),
            Self::Unknown => f.write_str(
                "this statement is not supported; motions are FROM, GOTO, GODLTA, RAPID and CIRCLE with a GOTO behind it",
            ),
            Self::Takes(words) => write!(f, "this statement takes {words}"),
            Self::Minor => f.write_str("this word means nothing in this statement"),
            Self::Tilted => f.write_str("the tool is not upright; only an axis of 0, 0, 1 can be run"),
            Self::Oblique => f.write_str("the axis of this circle is none of X, Y and Z; only such arcs can be run"),
            Self::LooseCircle => f.write_str("behind CIRCLE stands the GOTO to the end of its arc"),
            Self::Arc(reason) => reason.fmt(f),
            Self::NoFeed => f.write_str("there is no feed yet; put FEDRAT before this motion"),
            Self::PerTurn => f.write_str("feeds for each turn of the spindle are not supported; use MMPM or IPM"),
            Self::Refused => f.write_str("this cannot be used"),
        }
    }
}

//! What can be wrong in a block, as a person reads it.

use std::fmt;

use super::codes::{self, Code};
use crate::program::arc::NoArc;
use crate::program::output::{Output, Refused};
use crate::program::{Action, Feed, Plane};
use crate::units::plain;

/// A fault and the byte of the line where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misplaced {
    /// The byte.
    pub at: usize,
    /// The fault.
    pub fault: Fault,
}

/// What a part of reading returns.
pub type Checked<T> = Result<T, Misplaced>;

/// A fault at a byte, as the error of a result.
pub fn fail<T>(at: usize, fault: Fault) -> Checked<T> {
    Err(Misplaced { at, fault })
}

/// Gives an item that the word at `at` asks for.
pub fn give(out: &mut Output<'_, '_>, at: usize, from: [f64; 3], feed: Feed, action: Action<'_>) -> Checked<()> {
    out.give(at, from, feed, action).or_else(|Refused| fail(at, Fault::Refused))
}

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// A comment without end.
    OpenComment,
    /// A comment in a comment.
    NestedComment,
    /// A byte that begins no word.
    Unexpected(u8),
    /// A `/` that is not at the beginning.
    Slash,
    /// An N word that is not at the beginning, or is no whole number.
    LineNumber,
    /// A word without number.
    NoNumber(char),
    /// A word twice.
    Twice(char),
    /// Two codes of one modal group.
    SameGroup(Code, Code),
    /// A code that is not read, as it was written.
    UnknownCode(char, f64),
    /// An O word.
    OWord,
    /// A number beyond [`super::words::LARGEST`].
    TooLarge,

    /// Something else where a value should stand.
    NoValue,
    /// A bracket without its other half.
    OpenBracket,
    /// Something else where an operator should stand.
    NoOperator,
    /// A function that does not exist.
    NoFunction,
    /// ATAN with one argument.
    AtanSlash,
    /// Brackets or functions deeper than [`super::expression::DEPTH`].
    TooDeep,
    /// A division by zero.
    ByZero,
    /// An argument for which a function or a power has no value.
    Domain(f64),
    /// A result that is no finite number.
    NotFinite,
    /// A parameter number that does not exist.
    NoParameter(f64),
    /// A named parameter that has no value.
    NoName,
    /// A parameter that the machine keeps.
    Kept,
    /// More named parameters than are held.
    TooManyNames(usize),
    /// A parameter without `=`.
    NoEquals,

    /// Axis words and nothing that uses them.
    NoMotion(char),
    /// Two codes that both use the word.
    Shared(char, Code, Code),
    /// A word that nothing uses.
    Unused(char),
    /// A code that needs a word.
    Needs(Code, &'static str),
    /// A word that must be a whole number within bounds.
    Whole(char, u32, u32),
    /// A word that must not be negative.
    Negative(char),
    /// A word that must be positive.
    NotPositive(char),
    /// A cut without feed.
    NoFeed(Code),
    /// A cut without F while feeds are inverse times.
    NoInverseFeed(Code),

    /// An arc with neither a centre nor a radius.
    ArcCentre(Code),
    /// An arc with both.
    ArcBoth(Code),
    /// A centre word across the plane.
    ArcAcross(char, Plane),
    /// One centre word of two, where they are absolute.
    ArcHalf(char),
    /// An arc that there is not.
    Arc(NoArc),

    /// G53 without G0 or G1.
    MachineMotion,
    /// G53 in incremental distances.
    MachineIncremental,
    /// G10 with another L.
    SetupKind,
    /// G10 L2 with R.
    SetupTurned,
    /// A code that must not stand while compensation is on.
    Compensated(Code),
    /// Compensation in the YZ plane.
    CompensationPlane,
    /// A spline in another plane.
    SplinePlane(Code),
    /// G5 without I and J, and nothing before it that it could continue.
    SplineStart,
    /// Something between G5.2 and G5.3.
    NurbsOpen,
    /// G5.3 without G5.2.
    NurbsNone,
    /// A control point of which one coordinate is missing.
    NurbsHalf,
    /// A control point in incremental distances.
    NurbsIncremental,
    /// Fewer control points than the order.
    NurbsFew(usize, usize),
    /// The program ended before G5.3.
    NurbsEnd,
    /// More control points than are held.
    NurbsMany(usize),
    /// The sink refused an item; the reason is kept beside.
    Refused,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::OpenComment => f.write_str("this comment does not end; put `)` behind it"),
            Self::NestedComment => {
                f.write_str("a comment in a comment; end the first one with `)`, or use other brackets")
            }
            Self::Unexpected(byte) if byte.is_ascii_graphic() => {
                write!(f, "`{}` begins no word; a word is a letter and a number", char::from(byte))
            }
            Self::Unexpected(byte) => write!(f, "the byte {byte} begins no word; a word is a letter and a number"),
            Self::Slash => f.write_str("`/` marks a block that may be left out, and stands at its beginning"),
            Self::LineNumber => f.write_str("N is a line's whole number, and stands once at the beginning of a block"),
            Self::NoNumber(letter) => write!(f, "{letter} has no number behind it"),
            Self::Twice(letter) => write!(f, "a second {letter} word; a block may have one"),
            Self::SameGroup(one, other) => {
                write!(f, "{other} beside {one}: of one modal group, a block may have one code")
            }
            Self::UnknownCode(letter, number) => {
                let code = Code { letter, tenths: (number * 10.0).round() as u16 };
                write!(f, "{letter}{} is not supported: {}", plain(number), codes::reason(code))
            }
            Self::OWord => {
                f.write_str("O words (subprograms, loops, conditions) are not supported; write their blocks out")
            }
            Self::TooLarge => f.write_str("this number is too large for any machine"),
            Self::NoValue => f.write_str("no value; a number, `#` with a parameter, `[` or a function would do"),
            Self::OpenBracket => f.write_str("this bracket has no other half"),
            Self::NoOperator => {
                f.write_str("no operator; + - * / ** MOD, AND OR XOR, EQ NE GT GE LT LE or `]` would do")
            }
            Self::NoFunction => f.write_str(
                "no such function; there are ABS ACOS ASIN ATAN COS EXISTS EXP FIX FUP LN ROUND SIN SQRT TAN",
            ),
            Self::AtanSlash => f.write_str("ATAN takes two values, as in ATAN[1]/[2]"),
            Self::TooDeep => write!(f, "brackets and functions are nested more than {} deep", super::expression::DEPTH),
            Self::ByZero => f.write_str("a division by zero"),
            Self::Domain(value) => write!(f, "this has no value for {}", plain(value)),
            Self::NotFinite => f.write_str("the result is no finite number"),
            Self::NoParameter(number) => {
                write!(f, "there is no parameter {}; they are numbered 1 to {}", plain(number), super::parameters::LAST)
            }
            Self::NoName => f.write_str("this parameter has no value yet; set it first"),
            Self::Kept => f.write_str("the machine itself keeps this parameter; G10, G92, G28.1 and G30.1 change it"),
            Self::TooManyNames(most) => write!(f, "more than {most} named parameters"),
            Self::NoEquals => f.write_str("a parameter at this place is set, and needs `=` and a value"),
            Self::NoMotion(letter) => write!(f, "{letter} without a motion that is in force; put G0 or G1 before it"),
            Self::Shared(letter, one, other) => {
                write!(f, "{one} and {other} would both use {letter}; give each its block")
            }
            Self::Unused(letter) => write!(f, "nothing in this block uses {letter}"),
            Self::Needs(code, words) => write!(f, "{code} needs {words}"),
            Self::Whole(letter, low, high) => write!(f, "{letter} must be a whole number from {low} to {high}"),
            Self::Negative(letter) => write!(f, "{letter} must not be negative"),
            Self::NotPositive(letter) => write!(f, "{letter} must be positive"),
            Self::NoFeed(code) => write!(f, "{code} has no feed yet; put an F word before it"),
            Self::NoInverseFeed(code) => {
                write!(f, "{code} needs a positive F of its own while feeds are inverse times (G93)")
            }
            Self::ArcCentre(code) => write!(f, "{code} needs its centre (I, J, K) or its radius (R)"),
            Self::ArcBoth(code) => write!(f, "{code} has both a centre and a radius; leave one out"),
            Self::ArcAcross(letter, plane) => {
                let name = match plane {
                    Plane::Xy => "XY plane (G17)",
                    Plane::Zx => "XZ plane (G18)",
                    Plane::Yz => "YZ plane (G19)",
                };
                write!(f, "{letter} is no word of a centre in the {name}")
            }
            Self::ArcHalf(letter) => write!(f, "an absolute centre (G90.1) needs {letter} too"),
            Self::Arc(reason) => reason.fmt(f),
            Self::MachineMotion => f.write_str("G53 goes with G0 or G1 only"),
            Self::MachineIncremental => f.write_str("G53 needs absolute distances (G90)"),
            Self::SetupKind => f.write_str("of G10, L2 and L20 are supported"),
            Self::SetupTurned => f.write_str("coordinate systems that are turned (G10 L2 R) are not supported"),
            Self::Compensated(code) => write!(f, "{code} while cutter compensation is on; put G40 before it"),
            Self::CompensationPlane => {
                f.write_str("cutter compensation needs the XY plane (G17) or the XZ plane (G18)")
            }
            Self::SplinePlane(code) => write!(f, "{code} needs the XY plane (G17)"),
            Self::SplineStart => f.write_str("the first G5 of a chain needs I and J"),
            Self::NurbsOpen => f.write_str("between G5.2 and G5.3 stand control points alone; put G5.3 before this"),
            Self::NurbsNone => f.write_str("G5.3 ends what G5.2 begins, and nothing has begun"),
            Self::NurbsHalf => f.write_str("a control point needs both X and Y"),
            Self::NurbsIncremental => f.write_str("control points need absolute distances (G90)"),
            Self::NurbsFew(points, order) => {
                write!(f, "{points} control points, the start among them, make no curve of order {order}")
            }
            Self::NurbsEnd => f.write_str("the program ends within a curve; put G5.3 behind its control points"),
            Self::NurbsMany(most) => write!(f, "more than {most} control points in one curve; make several of it"),
            Self::Refused => f.write_str("this cannot be used"),
        }
    }
}

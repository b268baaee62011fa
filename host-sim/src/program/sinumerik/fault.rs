//! What can be wrong in a block, as a person reads it.

use std::fmt;

use super::words::Name;
use crate::program::arc::NoArc;
use crate::program::output::Refused;

/// Where a fault is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// At this byte of the line that is read.
    Here(usize),
    /// In a line before it.
    Before {
        /// The line, from 1.
        line: usize,
        /// The column in characters, from 1.
        column: usize,
    },
}

/// A fault and where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misplaced {
    /// The place.
    pub place: Place,
    /// The fault.
    pub fault: Fault,
}

/// What a part of reading returns.
pub type Checked<T> = Result<T, Misplaced>;

/// A fault at a byte of the line that is read, as the error of a result.
pub fn fail<T>(at: usize, fault: Fault) -> Checked<T> {
    Err(Misplaced { place: Place::Here(at), fault })
}

/// What the sink returned, as the result of the word at `at`.
pub fn given(at: usize, result: Result<(), Refused>) -> Checked<()> {
    result.or_else(|Refused| fail(at, Fault::Refused))
}

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// A byte that begins no word.
    Unexpected(u8),
    /// A word that is not read.
    Unsupported(Name),
    /// A word without number.
    NoNumber(Name),
    /// A number beyond the bound of all readers.
    TooLarge,
    /// A text, list or MSG without end.
    Open,
    /// A word twice.
    Twice(Name),
    /// Two codes of one group.
    SameGroup(Name),
    /// A number that is not whole, or out of the range of its word.
    Range(Name),
    /// A block with more M words than any has.
    ManyM(usize),
    /// G500 or G54 to G57, and another one before.
    System,
    /// Axis words, and no motion to use them.
    NoMotion,
    /// A word that the block's motion does not use.
    NoUse(&'static str),
    /// A cut without feed.
    NoFeed,
    /// G93, and no F in a block that cuts.
    NoDuration,
    /// A feed of zero or less.
    Feed,
    /// A dwell without its time.
    Dwell,
    /// G2 or G3 without a centre and without a radius.
    ArcCentre,
    /// G2 or G3 with both.
    ArcBoth,
    /// I, J or K across the plane.
    ArcAcross,
    /// An arc that there is not.
    Arc(NoArc),
    /// SD behind the first point of a spline.
    LateDegree,
    /// A weight that is not positive.
    Weight,
    /// PL below 0.
    Negative,
    /// PL at a point that has no interval; the degree.
    EarlyInterval(usize),
    /// A PL of 0 at the first interval; the degree.
    FirstInterval(usize),
    /// A PL of 0 at the last interval.
    LastInterval,
    /// Too many intervals of 0 in a row; the degree.
    Torn(usize),
    /// Too few points; how many, and how many there must be.
    Few(usize, usize),
    /// Too many points.
    Many(usize),
    /// F, M, S or T within a spline.
    Within(Name),
    /// A point, and the spline has ended.
    Ended,
    /// The sink refused an item; the reason is kept beside.
    Refused,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Unexpected(byte) if byte.is_ascii_graphic() => {
                write!(f, "no word begins with `{}`", char::from(byte))
            }
            Self::Unexpected(byte) => write!(f, "no word begins with the byte {byte}"),
            Self::Unsupported(name) => write!(f, "{name} is not supported"),
            Self::NoNumber(name) => write!(f, "{name} needs a number; expressions are not supported"),
            Self::TooLarge => f.write_str("this number is too large for a machine"),
            Self::Open => f.write_str("this has no closing bracket in its line"),
            Self::Twice(name) => write!(f, "{name} stands twice in this block"),
            Self::SameGroup(name) => write!(f, "{name} contradicts another word of this block"),
            Self::Range(name) => write!(f, "{name} has another number than it can have"),
            Self::ManyM(most) => write!(f, "a block has at most {most} M words"),
            Self::System => {
                f.write_str("the coordinate system changes; one of G54 to G57 and G500 all through would do")
            }
            Self::NoMotion => f.write_str("there is no motion yet; G0, G1, G2, G3 or BSPLINE would do"),
            Self::NoUse(words) => write!(f, "{words} means nothing to the motion of this block"),
            Self::NoFeed => f.write_str("there is no feed yet; put F before this motion"),
            Self::NoDuration => f.write_str("with G93 every block that cuts needs its own F"),
            Self::Feed => f.write_str("a feed is more than 0"),
            Self::Dwell => f.write_str("G4 needs F with seconds; turns of the spindle are not supported"),
            Self::ArcCentre => f.write_str("an arc needs its centre by I, J, K or its radius by CR="),
            Self::ArcBoth => f.write_str("an arc has a centre or a radius, not both"),
            Self::ArcAcross => f.write_str("this coordinate of the centre is across the plane of arcs"),
            Self::Arc(reason) => reason.fmt(f),
            Self::LateDegree => f.write_str("SD stands before the first point of a spline"),
            Self::Weight => f.write_str("the weight of a point is more than 0"),
            Self::Negative => f.write_str("an interval of the parameter is not shorter than 0"),
            Self::EarlyInterval(degree) => {
                write!(f, "the first {} points behind the start have no interval; PL=0 would do", degree - 1)
            }
            Self::FirstInterval(degree) => write!(
                f,
                "the first interval belongs to point {degree} behind the start and is longer than 0 (the start is where \
                 the tool is and is not written again)"
            ),
            Self::LastInterval => f.write_str("the interval of a spline's last point is longer than 0"),
            Self::Torn(degree) => {
                write!(
                    f,
                    "{degree} intervals of 0 in a row tear a spline of degree {degree}; at most {} would do",
                    degree - 1
                )
            }
            Self::Few(count, least) => {
                write!(f, "a spline of {count} points with its start; its degree needs {least} or more")
            }
            Self::Many(most) => write!(f, "a spline of more than {most} points"),
            Self::Within(name) => {
                write!(
                    f,
                    "{name} within a spline; it can stand before the second point or behind the end, a spline is one motion"
                )
            }
            Self::Ended => f.write_str("the block before has ended the spline; another one begins with BSPLINE"),
            Self::Refused => f.write_str("this cannot be used"),
        }
    }
}

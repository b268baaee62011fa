//! The G and M codes that are read: their modal groups, and the words that each makes use of.
//!
//! Groups are those of the RS274/NGC standard (NIST IR 6556, table 4): a block may hold one code of each.

use std::fmt;

/// A G or M code in tenths: G5.1 is 51.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Code {
    /// `G` or `M`.
    pub letter: char,
    /// Ten times its number.
    pub tenths: u16,
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { letter, tenths } = *self;
        match tenths % 10 {
            0 => write!(f, "{letter}{}", tenths / 10),
            tenth => write!(f, "{letter}{}.{tenth}", tenths / 10),
        }
    }
}

/// A modal group of G codes; the number is its place in a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// G4 G10 G28 G30 G53 G92: for one block.
    Once,
    /// G0 G1 G2 G3 G5 G80.
    Motion,
    /// G17 G18 G19.
    Plane,
    /// G90 G91.
    Distance,
    /// G90.1 G91.1.
    Centres,
    /// G93 G94.
    FeedMode,
    /// G20 G21.
    Units,
    /// G40 G41 G42.
    Cutter,
    /// G43 G49.
    Length,
    /// G54 to G59.3.
    System,
    /// G61 G64.
    Path,
    /// G96 G97.
    SpindleMode,
    /// M0 M1 M2 M30 M60.
    Stop,
    /// M6.
    Tool,
    /// M3 M4 M5.
    Spindle,
    /// M7 M8 M9.
    Coolant,
    /// M48 to M53, which let a person change feed and speed while the program runs, or not: no part of the path.
    Override,
}

/// How many groups there are.
pub const GROUPS: usize = 17;

/// A set of letters, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Letters(pub u32);

impl Letters {
    /// The letters of a text.
    pub const fn of(text: &[u8]) -> Self {
        let (mut set, mut at) = (0, 0);
        while at < text.len() {
            set |= 1 << (text[at] - b'A');
            at += 1;
        }
        Self(set)
    }

    /// Those in both.
    pub fn and(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// Those in either.
    pub fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Those that are not in the other.
    pub fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Whether there is none.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The number of the first one, `A` being 0.
    pub fn first(self) -> Option<usize> {
        (!self.is_empty()).then_some(self.0.trailing_zeros() as usize)
    }
}

/// The words that name places of axes.
pub const AXES: Letters = Letters::of(b"XYZABCUVW");
/// The words of an arc's centre.
pub const CENTRE: Letters = Letters::of(b"IJK");
/// The words that any block may have.
pub const ALWAYS: Letters = Letters::of(b"NFST");

/// The group of a G code; none if it is not read.
pub fn g_group(tenths: u16) -> Option<Group> {
    Some(match tenths {
        0 | 10 | 20 | 30 | 50 | 51 | 52 | 53 | 800 => Group::Motion,
        40 | 100 | 280 | 281 | 300 | 301 | 530 | 920..=923 => Group::Once,
        170 | 180 | 190 => Group::Plane,
        200 | 210 => Group::Units,
        400 | 410 | 411 | 420 | 421 => Group::Cutter,
        430 | 431 | 490 => Group::Length,
        540 | 550 | 560 | 570 | 580 | 590..=593 => Group::System,
        610 | 611 | 640 => Group::Path,
        900 | 910 => Group::Distance,
        901 | 911 => Group::Centres,
        930 | 940 => Group::FeedMode,
        960 | 970 => Group::SpindleMode,
        _ => return None,
    })
}

/// The group of an M code; none if it is not read.
pub fn m_group(tenths: u16) -> Option<Group> {
    Some(match tenths {
        0 | 10 | 20 | 300 | 600 => Group::Stop,
        30 | 40 | 50 => Group::Spindle,
        60 => Group::Tool,
        70 | 80 | 90 => Group::Coolant,
        480..=530 if tenths.is_multiple_of(10) => Group::Override,
        _ => return None,
    })
}

/// The words that a code uses.
pub fn words(code: Code) -> Letters {
    const ARC: Letters = Letters::of(b"XYZABCUVWIJKRP");
    const SETUP: Letters = Letters::of(b"XYZABCUVWLPR");
    if code.letter == 'M' {
        return if matches!(code.tenths, 500..=530) { Letters::of(b"P") } else { Letters(0) };
    }
    match code.tenths {
        0 | 10 | 280 | 300 | 431 | 920 => AXES,
        20 | 30 => ARC,
        50 => Letters::of(b"XYIJPQ"),
        51 => Letters::of(b"XYIJ"),
        52 => Letters::of(b"XYPL"),
        40 => Letters::of(b"P"),
        100 => SETUP,
        410 | 411 | 420 | 421 | 960 => Letters::of(b"D"),
        430 => Letters::of(b"H"),
        640 => Letters::of(b"PQ"),
        _ => Letters(0),
    }
}

/// Why a code is not read, where there is more to say than that.
pub fn reason(code: Code) -> &'static str {
    match (code.letter, code.tenths) {
        ('G', 330..=331 | 760) => "it cuts a thread in step with the spindle",
        ('G', 382..=385) => "it probes",
        ('G', 810..=890 | 730 | 740 | 980 | 990) => "it belongs to canned cycles; write the moves of the cycle instead",
        ('G', 950) => "it gives feeds per turn; use G94 or G93",
        ('G', 520) => "it shifts the coordinates; use G92 or G10 L2",
        ('G', 70..=80 | 171 | 181 | 191) => "it belongs to a lathe or to axes that this path does not have",
        ('M', 620..=680) => "it switches inputs and outputs, which a path does not have",
        ('M', 700..=730 | 980 | 990) => "it belongs to subprograms",
        ('M', 1000..) => "it runs a program of the machine's own",
        _ => "no such code is known here",
    }
}

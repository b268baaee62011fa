//! The words of a line by what they do.

use super::fault::{Checked, Fault, fail};
use super::words::{Name, Word, Words};
use crate::program::Plane;
use crate::program::item::Side;
use crate::units::Units;

/// The most M words of a block.
const MOST_M: usize = 5;
/// Names that say how smoothly a control runs a path, or that nothing turns its coordinates; none says where it runs. The
/// compressors may leave the path within a tolerance; they need not.
const SILENT: [&str; 32] = [
    "SOFT",
    "BRISK",
    "DRIVE",
    "FFWON",
    "FFWOF",
    "COMPOF",
    "COMPON",
    "COMPCURV",
    "COMPCAD",
    "UPATH",
    "SPATH",
    "FNORM",
    "FLIN",
    "CFC",
    "CFTCP",
    "CFIN",
    "CUT2D",
    "CUT2DF",
    "DIAMOF",
    "NORM",
    "G450",
    "G451",
    "TRAFOOF",
    "CDOF",
    "ROTOF",
    "FIFOCTRL",
    "STARTFIFO",
    "STOPRE",
    "DYNNORM",
    "DYNROUGH",
    "DYNSEMIFIN",
    "DYNFINISH",
];

/// A number and the byte of the line where its word begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Number {
    /// The number.
    pub value: f64,
    /// The place.
    pub at: usize,
}

/// A motion that a block can ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Move {
    /// G0.
    Rapid,
    /// G1.
    Line,
    /// G2 and G3.
    Arc {
        /// G3.
        anticlockwise: bool,
    },
    /// BSPLINE.
    Spline,
}

/// The unit of lengths, and whether it is that of feeds too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnitCode {
    /// The unit.
    pub units: Units,
    /// G700 and G710.
    pub feeds: bool,
}

/// How exactly a path is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exactness {
    /// G60, with a rest at the end of each motion.
    Stop,
    /// G64 and G641 to G645.
    Blend,
}

/// A setting of a modal group, and where it stands.
pub type Code<T> = Option<(T, usize)>;

/// The words of a line. What is missing is not there.
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// X, Y, Z.
    pub axes: [Option<Number>; 3],
    /// I, J, K.
    pub centre: [Option<Number>; 3],
    /// CR=.
    pub radius: Option<Number>,
    /// TURN=.
    pub turns: Option<Number>,
    /// PL=.
    pub interval: Option<Number>,
    /// PW=.
    pub weight: Option<Number>,
    /// SD=.
    pub degree: Option<Number>,
    /// F.
    pub feed: Option<Number>,
    /// S.
    pub speed: Option<Number>,
    /// T.
    pub tool: Option<Number>,
    /// The numbers of M words, in order.
    pub m: Vec<(u8, usize)>,
    /// G0 to G3 and BSPLINE.
    pub motion: Code<Move>,
    /// G17 to G19.
    pub plane: Code<Plane>,
    /// G70, G71, G700, G710.
    pub units: Code<UnitCode>,
    /// Whether coordinates are increments: G90 and G91.
    pub incremental: Code<bool>,
    /// Whether F is the inverse of a time: G93 and G94.
    pub inverse: Code<bool>,
    /// G60 and G64.
    pub exactness: Code<Exactness>,
    /// The side, or none for G40.
    pub compensation: Code<Option<Side>>,
    /// The number of G54 to G57 or G500.
    pub system: Code<u16>,
    /// G4.
    pub dwell: Code<()>,
}

impl Block {
    /// Reads a line. `delete` says whether blocks that begin with `/` are left out.
    pub fn read(&mut self, text: &[u8], delete: bool) -> Checked<()> {
        // The list keeps its memory.
        let m = std::mem::take(&mut self.m);
        *self = Self { m, ..Self::default() };
        self.m.clear();
        // A byte order mark is no part of a program.
        let mut words = Words::new(text, if text.starts_with(b"\xEF\xBB\xBF") { 3 } else { 0 });
        let mut fresh = true;
        loop {
            match words.peek() {
                // The name of the program and its folder.
                Some(b'%') if fresh => return Ok(()),
                Some(b'/') if fresh => {
                    if delete {
                        return Ok(());
                    }
                    words.at += 1;
                    words.at += usize::from(text.get(words.at).is_some_and(u8::is_ascii_digit));
                }
                // A main block, `:10`, is a block like others.
                Some(b':') if fresh => {
                    words.at += 1;
                    words.at += text
                        .get(words.at..)
                        .unwrap_or_default()
                        .iter()
                        .take_while(|byte| byte.is_ascii_digit())
                        .count();
                }
                _ => {
                    let Some(word) = words.next()? else { return Ok(()) };
                    if word.name.text() == "N" {
                        // Blocks may be skipped with their number in front.
                        if fresh {
                            continue;
                        }
                        return fail(word.at, Fault::Unsupported(word.name));
                    }
                    self.word(&word)?;
                }
            }
            fresh = false;
        }
    }

    /// Whether there is a word of an axis.
    pub fn has_axes(&self) -> bool {
        self.axes.iter().any(Option::is_some)
    }

    fn word(&mut self, word: &Word) -> Checked<()> {
        let Some(value) = word.value else { return self.name(word) };
        let slot = match word.name.text() {
            "G" => return self.g(value, word),
            "M" => return self.m_word(value, word),
            // The cutting edge of the tool: coordinates are of the tip whatever its length.
            "D" => return Ok(()),
            "X" => &mut self.axes[0],
            "Y" => &mut self.axes[1],
            "Z" => &mut self.axes[2],
            "I" => &mut self.centre[0],
            "J" => &mut self.centre[1],
            "K" => &mut self.centre[2],
            "CR" => &mut self.radius,
            "TURN" => &mut self.turns,
            "PL" => &mut self.interval,
            "PW" => &mut self.weight,
            "SD" => &mut self.degree,
            "F" => &mut self.feed,
            "S" | "S1" => &mut self.speed,
            "T" | "T1" => &mut self.tool,
            _ => return fail(word.at, Fault::Unsupported(word.name)),
        };
        if slot.is_some() {
            return fail(word.at, Fault::Twice(word.name));
        }
        *slot = Some(Number { value, at: word.at });
        Ok(())
    }

    fn name(&mut self, word: &Word) -> Checked<()> {
        match word.name.text() {
            "BSPLINE" => set(&mut self.motion, Move::Spline, word.at, word.name),
            name if SILENT.contains(&name) => Ok(()),
            _ => fail(word.at, Fault::Unsupported(word.name)),
        }
    }

    fn m_word(&mut self, value: f64, word: &Word) -> Checked<()> {
        if self.m.len() >= MOST_M {
            return fail(word.at, Fault::ManyM(MOST_M));
        }
        let known = (0..=30).find(|&m| f64::from(m) == value).filter(|m| matches!(m, 0..=9 | 17 | 30));
        match known {
            Some(m) => self.m.push((m, word.at)),
            None => return fail(word.at, Fault::Unsupported(coded(b'M', value))),
        }
        Ok(())
    }

    fn g(&mut self, value: f64, word: &Word) -> Checked<()> {
        let name = coded(b'G', value);
        let code = if value.fract() == 0.0 && (0.0..=999.0).contains(&value) { value as u16 } else { u16::MAX };
        let at = word.at;
        let unit = |units, feeds| UnitCode { units, feeds };
        match code {
            0 => set(&mut self.motion, Move::Rapid, at, name),
            1 => set(&mut self.motion, Move::Line, at, name),
            2 | 3 => set(&mut self.motion, Move::Arc { anticlockwise: code == 3 }, at, name),
            4 => set(&mut self.dwell, (), at, name),
            17 => set(&mut self.plane, Plane::Xy, at, name),
            18 => set(&mut self.plane, Plane::Zx, at, name),
            19 => set(&mut self.plane, Plane::Yz, at, name),
            40 => set(&mut self.compensation, None, at, name),
            41 => set(&mut self.compensation, Some(Side::Left), at, name),
            42 => set(&mut self.compensation, Some(Side::Right), at, name),
            54..=57 | 500 => set(&mut self.system, code, at, name),
            60 => set(&mut self.exactness, Exactness::Stop, at, name),
            64 | 641..=645 => set(&mut self.exactness, Exactness::Blend, at, name),
            70 => set(&mut self.units, unit(Units::Inch, false), at, name),
            71 => set(&mut self.units, unit(Units::Mm, false), at, name),
            700 => set(&mut self.units, unit(Units::Inch, true), at, name),
            710 => set(&mut self.units, unit(Units::Mm, true), at, name),
            90 | 91 => set(&mut self.incremental, code == 91, at, name),
            93 | 94 => set(&mut self.inverse, code == 93, at, name),
            // How corners are rounded outside, when an exact stop is exact, and that S means turns.
            97 | 450 | 451 | 601..=603 => Ok(()),
            _ => fail(at, Fault::Unsupported(name)),
        }
    }
}

fn set<T>(slot: &mut Code<T>, value: T, at: usize, name: Name) -> Checked<()> {
    match slot {
        Some(_) => fail(at, Fault::SameGroup(name)),
        None => {
            *slot = Some((value, at));
            Ok(())
        }
    }
}

/// A letter with its number, as it is named in a fault.
fn coded(letter: u8, value: f64) -> Name {
    Name::new(format!("{}{value}", char::from(letter)).as_bytes())
}

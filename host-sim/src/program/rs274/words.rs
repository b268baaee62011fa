//! A block: the words of a line.
//!
//! The lexer is the project's own. The crate `gcode` 0.7 passes less than 2 million lines/s to a visitor that only adds up
//! the numbers of `G1 X Y Z`, where this whole reader does 6 (`cargo bench --bench programs`, same desk); it gives numbers as
//! `f32`, in steps of 30 nm at 500 mm, no parameters or expressions, G1.05 as G1.5, and panics at `G4294967295` where
//! overflow is checked.

use super::codes::{Code, GROUPS, Group, Letters, g_group, m_group};
use super::expression::Values;
use super::fault::{Checked, Fault, fail};
use super::parameters::{Kept, Key, Parameters};
use crate::program::number::decimal;

/// The largest value of a word: a thousand kilometres. Sums and squares of what is smaller stay finite.
pub const LARGEST: f64 = 1e9;
/// How far from a tenth the number of a code may be, where it is computed.
const TENTH: f64 = 1e-6;

/// What kind of line was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A block, which may be empty.
    Words,
    /// A block that is left out.
    Deleted,
    /// `%`, which begins and ends a program.
    Percent,
}

/// The words of a line. One is used for all lines of a program; nothing of a line stays in it.
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// Which letters are there, other than G and M.
    pub letters: Letters,
    values: [f64; 26],
    places: [usize; 26],
    /// Bit n: the group of number n has a code.
    groups: u32,
    codes: [u16; GROUPS],
    code_places: [usize; GROUPS],
    /// Parameters that are set when the whole block has been read, and where they stand.
    pub settings: Vec<(usize, Key, f64)>,
}

impl Block {
    /// Reads a line. `delete` says whether blocks that begin with `/` are left out.
    pub fn read(&mut self, text: &[u8], delete: bool, parameters: &Parameters, kept: &dyn Kept) -> Checked<Kind> {
        self.letters = Letters(0);
        self.groups = 0;
        self.settings.clear();
        // A byte order mark is no part of a program.
        let start = if text.starts_with(b"\xEF\xBB\xBF") { 3 } else { 0 };
        let mut values = Values::new(text, start, parameters, kept);
        let mut fresh = true;
        while let Some(byte) = values.peek() {
            let at = values.at;
            match byte {
                b'\r' | b'\n' | b';' => break,
                b'(' => {
                    values.at = comment(text, at)?;
                    continue;
                }
                b'%' if fresh => return Ok(Kind::Percent),
                b'/' if fresh => {
                    if delete {
                        return Ok(Kind::Deleted);
                    }
                    values.at += 1;
                    continue;
                }
                b'/' => return fail(at, Fault::Slash),
                b'#' => self.setting(&mut values)?,
                _ if byte.is_ascii_alphabetic() => self.word(byte.to_ascii_uppercase(), fresh, &mut values)?,
                _ => return fail(at, Fault::Unexpected(byte)),
            }
            fresh = false;
        }
        Ok(Kind::Words)
    }

    /// Reads the word that begins here.
    fn word(&mut self, letter: u8, fresh: bool, values: &mut Values<'_>) -> Checked<()> {
        let at = values.at;
        if letter == b'O' {
            return fail(at, Fault::OWord);
        }
        values.at += 1;
        let value = number(letter, values)?;
        match letter {
            b'G' | b'M' => self.code(char::from(letter), value, at),
            b'N' if !fresh || value < 0.0 || value.fract() != 0.0 => fail(at, Fault::LineNumber),
            _ => {
                let index = usize::from(letter - b'A');
                let bit = Letters(1 << index);
                if !self.letters.and(bit).is_empty() {
                    return fail(at, Fault::Twice(char::from(letter)));
                }
                self.letters = self.letters.or(bit);
                self.values[index] = value;
                self.places[index] = at;
                Ok(())
            }
        }
    }

    /// Puts a G or M code into its group.
    fn code(&mut self, letter: char, value: f64, at: usize) -> Checked<()> {
        let tenths = (value * 10.0).round();
        let exact = (value * 10.0 - tenths).abs() < TENTH && (0.0..=9999.0).contains(&tenths);
        let code = Code { letter, tenths: tenths as u16 };
        let group = if letter == 'G' { g_group(code.tenths) } else { m_group(code.tenths) };
        let Some(group) = group.filter(|_| exact) else { return fail(at, Fault::UnknownCode(letter, value)) };
        if let Some((other, _)) = self.in_group(group) {
            return fail(at, Fault::SameGroup(other, code));
        }
        self.groups |= 1 << group as usize;
        self.codes[group as usize] = code.tenths;
        self.code_places[group as usize] = at;
        Ok(())
    }

    /// Reads `#… = value`.
    fn setting(&mut self, values: &mut Values<'_>) -> Checked<()> {
        let at = values.at;
        let key = values.key()?;
        Parameters::may_set(&key, values.kept).or_else(|fault| fail(at, fault))?;
        if !values.take(b'=') {
            return fail(values.at, Fault::NoEquals);
        }
        let value = values.value()?;
        self.settings.push((at, key, value));
        Ok(())
    }

    /// Whether there is no word that does anything.
    pub fn is_empty(&self) -> bool {
        self.groups == 0 && self.letters.without(Letters::of(b"N")).is_empty()
    }

    /// The value of a letter; none if the block has no such word.
    pub fn value(&self, letter: u8) -> Option<f64> {
        let index = usize::from(letter.wrapping_sub(b'A'));
        let bit = Letters::of(&[letter]);
        if self.letters.and(bit).is_empty() { None } else { self.values.get(index).copied() }
    }

    /// Where the word of this letter begins, or the block.
    pub fn place(&self, letter: u8) -> usize {
        self.places.get(usize::from(letter.wrapping_sub(b'A'))).copied().unwrap_or(0)
    }

    /// The code of a group, and where it stands.
    pub fn in_group(&self, group: Group) -> Option<(Code, usize)> {
        self.numbered(group as usize)
    }

    /// The codes, and where they stand, by the numbers of their groups.
    pub fn codes(&self) -> impl Iterator<Item = (Code, usize)> + '_ {
        let mut left = self.groups;
        std::iter::from_fn(move || {
            let found = self.numbered(left.trailing_zeros() as usize);
            left &= left.wrapping_sub(1);
            found
        })
    }

    /// Whether it has codes of groups other than this one.
    pub fn has_beside(&self, group: Group) -> bool {
        self.groups & !(1 << group as usize) != 0
    }

    fn numbered(&self, group: usize) -> Option<(Code, usize)> {
        if group >= GROUPS || self.groups & (1 << group) == 0 {
            return None;
        }
        let letter = if group >= Group::Stop as usize { 'M' } else { 'G' };
        Some((Code { letter, tenths: self.codes[group] }, self.code_places[group]))
    }

    /// A whole number within bounds; none if there is no such word.
    pub fn whole(&self, letter: u8, low: u32, high: u32) -> Checked<Option<u32>> {
        let Some(value) = self.value(letter) else { return Ok(None) };
        let near = value.round();
        if (value - near).abs() > TENTH || !(f64::from(low)..=f64::from(high)).contains(&near) {
            return fail(self.place(letter), Fault::Whole(char::from(letter), low, high));
        }
        Ok(Some(near as u32))
    }

    /// A number that is not negative; none if there is no such word.
    pub fn positive_or_zero(&self, letter: u8) -> Checked<Option<f64>> {
        match self.value(letter) {
            Some(value) if value < 0.0 => fail(self.place(letter), Fault::Negative(char::from(letter))),
            value => Ok(value),
        }
    }
}

/// The number behind a letter. Nearly all are plain decimals and need no more than this function.
fn number(letter: u8, values: &mut Values<'_>) -> Checked<f64> {
    let at = values.at;
    let negative = values.peek() == Some(b'-');
    if let Some((value, end)) = decimal(values.text, values.at + usize::from(negative)) {
        values.at = end;
        return if value > LARGEST { fail(at, Fault::TooLarge) } else { Ok(if negative { -value } else { value }) };
    }
    match values.peek() {
        None | Some(b'\r' | b'\n' | b';' | b'(') => fail(at - 1, Fault::NoNumber(char::from(letter))),
        _ => {
            let value = values.value()?;
            if value.abs() > LARGEST { fail(at, Fault::TooLarge) } else { Ok(value) }
        }
    }
}

/// The place behind a comment.
fn comment(text: &[u8], at: usize) -> Checked<usize> {
    let inside = text.get(at + 1..).unwrap_or_default();
    match inside.iter().position(|byte| matches!(byte, b'(' | b')')) {
        Some(length) if inside[length] == b')' => Ok(at + length + 2),
        Some(length) => fail(at + 1 + length, Fault::NestedComment),
        None => fail(at, Fault::OpenComment),
    }
}

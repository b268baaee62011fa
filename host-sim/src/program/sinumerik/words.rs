//! A line as words: a letter with its number, `NAME=number`, or a name alone.

use std::fmt;

use super::fault::{Checked, Fault, fail};
use crate::program::number::decimal;

/// The largest value of a word: a thousand kilometres. Sums and squares of what is smaller stay finite.
const LARGEST: f64 = 1e9;
/// Characters of a name that are kept; no word that is read has so many.
const KEPT: usize = 15;

/// The name of a word, in capitals; of a longer one its beginning.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Name {
    bytes: [u8; KEPT],
    length: usize,
}

impl Name {
    /// Of ASCII bytes.
    pub fn new(text: &[u8]) -> Self {
        let mut bytes = [0; KEPT];
        for (kept, byte) in bytes.iter_mut().zip(text) {
            *kept = byte.to_ascii_uppercase();
        }
        Self { bytes, length: text.len() }
    }

    /// The name; of one that is too long only the beginning, which is no name of a word that is read.
    pub fn text(&self) -> &str {
        let kept = self.bytes.get(..self.length).unwrap_or(&self.bytes);
        std::str::from_utf8(kept).unwrap_or_default()
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.text())?;
        if self.length > KEPT { f.write_str("…") } else { Ok(()) }
    }
}

impl fmt::Debug for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// A word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Word {
    /// The byte of the line where it begins.
    pub at: usize,
    /// Its letter or name, with the number of an axis or spindle if it has one (`S1`).
    pub name: Name,
    /// What it is set to.
    pub value: Option<f64>,
}

/// The words of a line, one after another.
#[derive(Clone, Debug)]
pub struct Words<'a> {
    text: &'a [u8],
    /// The byte that is read next.
    pub at: usize,
}

impl<'a> Words<'a> {
    /// From a byte of a line.
    pub fn new(text: &'a [u8], at: usize) -> Self {
        Self { text, at }
    }

    /// The next byte that is no blank; none at the end of the line or before a comment.
    pub fn peek(&mut self) -> Option<u8> {
        self.at += count(self.text, self.at, |byte| matches!(byte, b' ' | b'\t' | b'\r' | b'\n'));
        self.text.get(self.at).copied().filter(|&byte| byte != b';')
    }

    /// The next word, MSG left out; none at the end.
    pub fn next(&mut self) -> Checked<Option<Word>> {
        while let Some(byte) = self.peek() {
            let at = self.at;
            if !byte.is_ascii_alphabetic() && byte != b'_' && byte != b'$' {
                return fail(at, Fault::Unexpected(byte));
            }
            let letters = count(self.text, at, |byte| byte.is_ascii_alphabetic() || matches!(byte, b'_' | b'$')).max(1);
            let whole = at + count(self.text, at, |byte| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'$'));
            // X1=5 is the axis X1, X15 the axis X; N5PL=1 are two words.
            let indexed = letters == 1
                && self
                    .text
                    .get(at + 1..whole)
                    .is_some_and(|rest| !rest.is_empty() && rest.iter().all(u8::is_ascii_digit))
                && self.after_blanks(whole) == Some(b'=');
            if letters == 1 && !indexed {
                self.at += 1;
                let name = Name::new(&[byte]);
                if self.peek() == Some(b'=') {
                    self.at += 1;
                }
                return match self.number()? {
                    Some(value) => Ok(Some(Word { at, name, value: Some(value) })),
                    None => fail(at, Fault::NoNumber(name)),
                };
            }
            let name = Name::new(self.text.get(at..whole).unwrap_or_default());
            self.at = whole;
            match self.peek() {
                Some(b'(') if name.text() == "MSG" => self.skip_list()?,
                Some(b'(' | b'[') => return fail(at, Fault::Unsupported(name)),
                Some(b'=') => {
                    self.at += 1;
                    return match self.number()? {
                        Some(value) => Ok(Some(Word { at, name, value: Some(value) })),
                        None => fail(at, Fault::NoNumber(name)),
                    };
                }
                _ => return Ok(Some(Word { at, name, value: None })),
            }
        }
        Ok(None)
    }

    fn after_blanks(&self, at: usize) -> Option<u8> {
        self.text.get(at + count(self.text, at, |byte| matches!(byte, b' ' | b'\t'))).copied()
    }

    /// A signed number, which may end in EX and a power of ten; none where there is none.
    fn number(&mut self) -> Checked<Option<f64>> {
        let sign = self.peek();
        let at = self.at;
        self.at += usize::from(matches!(sign, Some(b'+' | b'-')));
        let Some((mut value, end)) = decimal(self.text, self.at) else { return Ok(None) };
        self.at = end;
        if self.text.get(end..end + 2).is_some_and(|text| text.eq_ignore_ascii_case(b"EX")) {
            let first = end + 2;
            let signed = usize::from(matches!(self.text.get(first), Some(b'+' | b'-')));
            let digits = count(self.text, first + signed, |byte| byte.is_ascii_digit());
            let power = self.text.get(first..first + signed + digits).and_then(|text| std::str::from_utf8(text).ok());
            let Some(power) = power.and_then(|text| text.parse::<i16>().ok()) else {
                return fail(end, Fault::TooLarge);
            };
            // By way of text, so that the value is the nearest one.
            let Ok(scaled) = format!("{value}e{power}").parse() else { return fail(at, Fault::TooLarge) };
            value = scaled;
            self.at = first + signed + digits;
        }
        match value {
            _ if value > LARGEST => fail(at, Fault::TooLarge),
            _ if sign == Some(b'-') => Ok(Some(-value)),
            _ => Ok(Some(value)),
        }
    }

    /// Skips a list in brackets, in which brackets of texts do not count.
    fn skip_list(&mut self) -> Checked<()> {
        let open = self.at;
        let mut quoted = false;
        while let Some(&byte) = self.text.get(self.at) {
            self.at += 1;
            match byte {
                b'"' => quoted = !quoted,
                b')' if !quoted => return Ok(()),
                _ => {}
            }
        }
        fail(open, Fault::Open)
    }
}

/// How many bytes from `at` on belong together.
fn count(text: &[u8], at: usize, belongs: impl Fn(u8) -> bool) -> usize {
    text.get(at..).unwrap_or_default().iter().take_while(|&&byte| belongs(byte)).count()
}

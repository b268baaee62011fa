//! A statement: `NAME/word,word,…`, over several lines where `$` ends one.

use super::fault::{Fault, Misplaced};

/// The most words of a statement; CIRCLE has eleven.
const MOST: usize = 64;
/// The largest value of a number: a thousand kilometres, as for other programs.
const LARGEST: f64 = 1e9;

/// Statements whose text is for people.
const TEXTS: [&str; 7] = ["PARTNO", "PPRINT", "REMARK", "TPRINT", "INSERT", "LETTER", "MACHIN"];
/// Statements that say nothing about the path: names, pictures, tolerances of the CAM system, its own coordinate system.
const SILENT: [&str; 17] = [
    "TOOL",
    "TLDATA",
    "MSYS",
    "END-OF-PATH",
    "PAINT",
    "DISPLAY",
    "HEAD",
    "INTOL",
    "OUTTOL",
    "CUTTER",
    "MULTAX",
    "SEQNO",
    "LEADER",
    "MODE",
    "CLEARP",
    "OPSKIP",
    "AUXFUN",
];

/// A word.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// A name, in capitals.
    Name(String),
}

/// A word and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Word {
    /// The line, from 1.
    pub line: usize,
    /// The byte of the line.
    pub at: usize,
    /// What it is.
    pub value: Value,
}

/// The statement that is read.
#[derive(Clone, Debug, Default)]
pub struct Statement {
    /// Its words, the name first.
    pub words: Vec<Word>,
    /// Whether it is one whose words are not looked at.
    silent: bool,
    goes_on: bool,
}

impl Statement {
    /// Reads a line. Returns whether the statement is whole with it.
    pub fn line(&mut self, number: usize, text: &[u8]) -> Result<bool, Misplaced> {
        if !self.goes_on {
            self.words.clear();
            self.silent = false;
        }
        self.goes_on = false;
        let mut at = 0;
        while let Some(&byte) = text.get(at) {
            let fail = |fault| Err(Misplaced { line: number, at, fault });
            match byte {
                b' ' | b'\t' | b'\r' | b'\n' | b',' | b'/' => at += 1,
                b'$' => {
                    // Two begin a comment, one goes on in the next line.
                    self.goes_on = text.get(at + 1) != Some(&b'$');
                    break;
                }
                _ if self.silent => at += 1,
                _ if self.words.len() >= MOST => return fail(Fault::TooLong(MOST)),
                b'A'..=b'Z' | b'a'..=b'z' => {
                    let name = run(text, at, |byte| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_'));
                    let value = String::from_utf8_lossy(name).to_ascii_uppercase();
                    if self.words.is_empty() {
                        if TEXTS.iter().any(|text| value.starts_with(text)) {
                            return Ok(false);
                        }
                        self.silent = SILENT.contains(&value.as_str());
                    }
                    self.words.push(Word { line: number, at, value: Value::Name(value) });
                    at += name.len();
                }
                b'0'..=b'9' | b'.' | b'-' | b'+' => {
                    let digits = run(text, at, |byte| matches!(byte, b'0'..=b'9' | b'.' | b'-' | b'+' | b'e' | b'E'));
                    let value = std::str::from_utf8(digits).ok().and_then(|digits| digits.parse::<f64>().ok());
                    match value.filter(|value| value.abs() <= LARGEST) {
                        Some(value) => self.words.push(Word { line: number, at, value: Value::Number(value) }),
                        None => return fail(Fault::Number),
                    }
                    at += digits.len();
                }
                _ => return fail(Fault::Unexpected(byte)),
            }
        }
        Ok(!self.goes_on && !self.silent && !self.words.is_empty())
    }
}

/// The bytes from `at` on that belong together.
fn run(text: &[u8], at: usize, belongs: impl Fn(u8) -> bool) -> &[u8] {
    let rest = text.get(at..).unwrap_or_default();
    &rest[..rest.iter().take_while(|&&byte| belongs(byte)).count()]
}

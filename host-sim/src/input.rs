//! Errors of input: one sentence with the place, what was found and what would do. Exit status 2.
//!
//! Under the sentence about a program stands its block, with a mark at the column: a program is often too long to open.

use std::fmt;
use std::ops::Range;

/// Something in a file, or on the command line, that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputError {
    /// The file's name as it was given, or the option's.
    pub place: String,
    /// Line and column from 1, where they are known.
    pub position: Option<(usize, usize)>,
    /// What was found and what would do, without a full stop.
    pub message: String,
    /// The block of a program that it is in, shown below it.
    pub block: Option<Excerpt>,
}

/// A line of a program, or the part of it around the place of an error.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Excerpt {
    /// What is shown: no control characters, at most [`Excerpt::WIDTH`] characters.
    pub text: String,
    /// How many characters stand before the mark.
    pub before: usize,
}

impl Excerpt {
    /// The most characters that are shown.
    pub const WIDTH: usize = 96;
    /// Characters that are shown before the place in a line that is too long.
    const BEFORE: usize = 48;

    /// The line around the byte at `place`; bytes that are no UTF-8 are shown as the replacement character.
    pub fn new(line: &[u8], place: usize) -> Self {
        let place = place.min(line.len());
        let shown = |c: char| if c.is_control() { ' ' } else { c };
        let before: Vec<char> = String::from_utf8_lossy(&line[..place]).trim_start().chars().map(shown).collect();
        let behind = String::from_utf8_lossy(&line[place..]);
        let cut = before.len().saturating_sub(Self::BEFORE);
        let before = &before[cut..];
        let rest = behind.chars().map(shown).take(Self::WIDTH - before.len());
        let text = before.iter().copied().chain(rest).collect::<String>();
        Self { text: text.trim_end().to_string(), before: before.len() }
    }
}

impl fmt::Display for Excerpt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "    {}\n    {:2$}^", self.text, "", self.before)
    }
}

impl InputError {
    /// An error of a whole file or an option.
    pub fn new(place: impl Into<String>, message: impl fmt::Display) -> Self {
        Self { place: place.into(), position: None, message: message.to_string(), block: None }
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.position {
            Some((line, column)) => write!(f, "{}:{line}:{column}: {}", self.place, self.message)?,
            None => write!(f, "{}: {}", self.place, self.message)?,
        }
        self.block.as_ref().map_or(Ok(()), |block| write!(f, "\n{block}"))
    }
}

impl std::error::Error for InputError {}

/// A text with its name: what turns byte offsets into lines and columns.
#[derive(Clone, Debug)]
pub struct Source {
    /// The file's name as it was given.
    pub name: String,
    /// All of it.
    pub text: String,
}

impl Source {
    /// Reads a file. Errors: it cannot be read, or is not UTF-8.
    pub fn read(name: &str) -> Result<Self, InputError> {
        let text = std::fs::read_to_string(name)
            .map_err(|error| InputError::new(name, format_args!("cannot be read: {error}")))?;
        Ok(Self { name: name.to_string(), text })
    }

    /// An error about the text at `span`.
    pub fn error(&self, span: &Range<usize>, message: impl fmt::Display) -> InputError {
        let before = self.text.get(..span.start).unwrap_or("");
        let line = before.matches('\n').count() + 1;
        let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
        InputError { position: Some((line, column)), ..InputError::new(self.name.clone(), message) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_is_shown_with_a_mark_under_the_place() {
        let error = InputError {
            position: Some((3, 5)),
            block: Some(Excerpt::new(b"\tG1\tX?\r\n", 5)),
            ..InputError::new("part.ngc", "X needs a number")
        };
        assert_eq!(error.to_string(), "part.ngc:3:5: X needs a number\n    G1 X?\n        ^");
    }

    #[test]
    fn of_a_long_line_the_part_around_the_place_is_shown() {
        let line = [b'1'; 1000];
        let shown = Excerpt::new(&line, 500);
        assert_eq!((shown.text.len(), shown.before), (Excerpt::WIDTH, Excerpt::BEFORE));
        let shown = Excerpt::new(&line, 5000);
        assert_eq!((shown.text.len(), shown.before), (Excerpt::BEFORE, Excerpt::BEFORE));
    }
}

//! The lines of a file, one at a time in one buffer: a program of any length needs the memory of its longest line.

use std::io::{BufRead, Read as _};

use crate::input::{Excerpt, InputError};

/// The longest line that is read, in bytes. Real ones have a hundred; without a bound, a file without line ends would be
/// held as a whole.
pub const LONGEST: usize = 1 << 16;

/// Reads lines.
pub struct Lines<'a, R> {
    /// The file's name as it was given.
    name: &'a str,
    input: R,
    /// The number of the line that was read last, from 1.
    number: usize,
    buffer: Vec<u8>,
}

impl<'a, R: BufRead> Lines<'a, R> {
    /// Begins.
    pub fn new(name: &'a str, input: R) -> Self {
        Self { name, input, number: 0, buffer: Vec::with_capacity(256) }
    }

    /// Reads the next line; false at the end. Errors: the file cannot be read, or the line is too long.
    pub fn advance(&mut self) -> Result<bool, InputError> {
        self.buffer.clear();
        let read = self.input.by_ref().take(LONGEST as u64).read_until(b'\n', &mut self.buffer);
        let count = read.map_err(|error| InputError::new(self.name, format_args!("cannot be read: {error}")))?;
        self.number += usize::from(count > 0);
        if count == LONGEST && self.buffer.last() != Some(&b'\n') {
            return Err(self.error(0, format!("this line is longer than {LONGEST} bytes; break it up")));
        }
        Ok(count > 0)
    }

    /// The line that was read last, with what ends it.
    pub fn text(&self) -> &[u8] {
        &self.buffer
    }

    /// Its number, from 1.
    pub fn number(&self) -> usize {
        self.number
    }

    /// An error about the byte at `place` of the line that was read last; at the end of the file there is none to show.
    pub fn error(&self, place: usize, message: String) -> InputError {
        InputError {
            position: Some((self.number, column(&self.buffer, place))),
            block: (!self.buffer.is_empty()).then(|| Excerpt::new(&self.buffer, place)),
            ..InputError::new(self.name, message)
        }
    }
}

/// The column in characters, from 1, of the byte at `place`.
pub fn column(line: &[u8], place: usize) -> usize {
    // Bytes of the form 10xxxxxx go on with a character.
    1 + line.iter().take(place).filter(|&&byte| byte & 0xC0 != 0x80).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters() {
        let line = "(größer) X".as_bytes();
        assert_eq!(column(line, line.len() - 1), 10);
        assert_eq!(column(line, 0), 1);
    }

    #[test]
    fn a_line_without_end_is_refused_and_not_held() {
        let mut lines = Lines::new("long.ngc", std::io::BufReader::new(std::io::repeat(b'X')));
        let error = lines.advance().unwrap_err();
        assert_eq!(error.position, Some((1, 1)));
        assert!(error.message.contains("65536"));
    }
}

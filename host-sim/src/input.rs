//! Errors of input: one sentence with the place, what was found and what would do. Exit status 2.

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
}

impl InputError {
    /// An error of a whole file or an option.
    pub fn new(place: impl Into<String>, message: impl fmt::Display) -> Self {
        Self { place: place.into(), position: None, message: message.to_string() }
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.position {
            Some((line, column)) => write!(f, "{}:{line}:{column}: {}", self.place, self.message),
            None => write!(f, "{}: {}", self.place, self.message),
        }
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

//! Why a plant's parameters cannot be used.

use std::fmt;

/// A place in a file; both count from 1, columns in characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Line.
    pub line: usize,
    /// Column.
    pub column: usize,
}

impl Place {
    /// The place of the byte `offset` in `text`.
    pub fn of(text: &str, offset: usize) -> Self {
        let before = text.get(..offset).unwrap_or(text);
        let start = before.rfind('\n').map_or(0, |at| at + 1);
        Self { line: before.matches('\n').count() + 1, column: before[start..].chars().count() + 1 }
    }
}

/// A fault in a plant's parameters. Its text is one sentence that starts with line and column; a caller puts the file before it.
#[derive(Clone, Debug, PartialEq)]
pub enum PlantError {
    /// Not TOML, or not in the form of a plant: an unknown or a missing key, a value of another type.
    Form {
        /// Where.
        place: Place,
        /// What the reader says about it.
        message: String,
    },
    /// A value that no machine has, or that the model cannot integrate.
    Value {
        /// Where.
        place: Place,
        /// The axis' names and the key, as `axis x, y: drive.velocity.peak_torque`.
        key: String,
        /// What was found.
        found: String,
        /// What would do.
        needed: String,
    },
}

impl PlantError {
    /// Where in the file.
    pub fn place(&self) -> Place {
        match self {
            Self::Form { place, .. } | Self::Value { place, .. } => *place,
        }
    }

    /// The sentence without its place.
    pub fn message(&self) -> String {
        match self {
            Self::Form { message, .. } => message.clone(),
            Self::Value { key, found, needed, .. } => format!("{key} is {found}; it must be {needed}"),
        }
    }
}

impl fmt::Display for PlantError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Place { line, column } = self.place();
        write!(f, "{line}:{column}: {}", self.message())
    }
}

impl std::error::Error for PlantError {}

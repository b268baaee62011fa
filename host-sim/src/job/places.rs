//! Where a job's file says what, for errors that show only when a path is made of it.

use std::fmt;
use std::ops::Range;

use crate::input::{InputError, Source};

/// Where a value was given.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Place {
    /// At this span of the file.
    File(Range<usize>),
    /// As this option of the command line.
    Option(&'static str),
    /// Nowhere: it is a default.
    Nowhere,
}

/// The spans of a file's parts.
#[derive(Clone, Debug)]
pub(super) struct Places {
    pub source: Source,
    pub segments: Vec<Range<usize>>,
    pub pieces: Vec<Range<usize>>,
    pub distance: Place,
    pub chosen: Place,
}

impl Places {
    /// An error about the value that was given at `place`; about the file, where it was given nowhere.
    pub(super) fn error(&self, place: &Place, message: impl fmt::Display) -> InputError {
        match place {
            Place::File(span) => self.source.error(span, message),
            Place::Option(name) => InputError::new(*name, message),
            Place::Nowhere => self.about(None, message),
        }
    }

    /// An error about a segment, at its [[segment]].
    pub(super) fn segment_error(&self, segment: usize, message: impl fmt::Display) -> InputError {
        self.about(self.segments.get(segment), message)
    }

    /// An error about a given piece, at its [[piece]].
    pub(super) fn piece_error(&self, piece: usize, message: impl fmt::Display) -> InputError {
        self.about(self.pieces.get(piece), format_args!("piece {piece}: {message}"))
    }

    fn about(&self, span: Option<&Range<usize>>, message: impl fmt::Display) -> InputError {
        match span {
            Some(span) => self.source.error(span, message),
            None => InputError::new(self.source.name.clone(), message),
        }
    }
}

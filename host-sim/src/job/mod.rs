//! What a person wants cut: a contour, the tool's offset, the feed, and possibly the trimmed pieces of the offset.

mod contour_file;
mod schema;

use std::ops::Range;

use serde::{Deserialize, Serialize};
use shared::complex::Complex;
use shared::curve::Segment;
use shared::feed::Ramp;

use crate::input::{InputError, Source};

/// The unit of lengths in a job's file and in what is reported of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Units {
    /// Millimetres; feeds in mm/min.
    Mm,
    /// Inches; feeds in inch/min.
    Inch,
}

impl Units {
    /// Millimetres in one unit.
    pub fn mm(self) -> f64 {
        match self {
            Self::Mm => 1.0,
            Self::Inch => 25.4,
        }
    }

    /// As it is written after a number.
    pub fn short(self) -> &'static str {
        match self {
            Self::Mm => "mm",
            Self::Inch => "in",
        }
    }
}

/// The feed as a person gives it, in mm and seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedWish {
    /// V in mm/s.
    pub rate: f64,
    /// w.
    pub weight: f64,
    /// f at every corner that has none of its own.
    pub reduction: f64,
    /// lambda at every corner that has none of its own.
    pub ramp: f64,
}

/// What a command line may put in the place of a job's own feed; feeds in the job's units a minute.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FeedOverride {
    /// In the place of `feed.rate`.
    pub rate: Option<f64>,
    /// In the place of `feed.weight`.
    pub weight: Option<f64>,
    /// In the place of `feed.reduction`.
    pub reduction: Option<f64>,
    /// In the place of `feed.ramp`.
    pub ramp: Option<f64>,
}

/// The curve that a given piece runs along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Along {
    /// A part of a segment.
    Segment {
        /// Its number, from 0.
        segment: usize,
        /// First parameter.
        from: f64,
        /// Last parameter.
        to: f64,
    },
    /// The arc that fills the gap at a convex node.
    Fill {
        /// The node at the end of the segment of this number.
        node: usize,
    },
}

/// What a corner at an end of a piece says of its ramp: a value of its own, or the job's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Corner {
    /// f, in the place of the job's.
    pub reduction: Option<f64>,
    /// lambda, in the place of the job's.
    pub ramp: Option<f64>,
}

impl Corner {
    /// The ramp here under the job's feed.
    pub fn ramp(&self, feed: &FeedWish) -> Ramp<f64> {
        Ramp { length: self.ramp.unwrap_or(feed.ramp), factor: self.reduction.unwrap_or(feed.reduction) }
    }
}

/// A piece of the trimmed offset, as a job gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GivenPiece {
    /// The curve.
    pub along: Along,
    /// The corner at its start, if there is one.
    pub start: Option<Corner>,
    /// The corner at its end, if there is one.
    pub end: Option<Corner>,
}

/// A job: validated as far as it can be without making a path of it. Lengths in mm.
#[derive(Clone, Debug)]
pub struct Job {
    /// The unit of its file.
    pub units: Units,
    /// Whether the contour ends where it starts.
    pub closed: bool,
    /// The widest gap that is taken for none.
    pub tolerance: f64,
    /// Whether the path begins and ends at rest.
    pub rest: bool,
    /// The signed offset distance d, positive right of travel.
    pub offset: f64,
    /// The feed.
    pub feed: FeedWish,
    /// The contour C.
    pub segments: Vec<Segment<f64>>,
    /// The trimmed offset; without offset, the contour itself.
    pub pieces: Vec<GivenPiece>,
    /// Where the file says what, for errors that show later.
    places: Places,
}

#[derive(Clone, Debug)]
struct Places {
    source: Source,
    segments: Vec<Range<usize>>,
    pieces: Vec<Range<usize>>,
}

impl Job {
    /// Reads a job by its file's ending. Errors name file, line and column.
    pub fn read(name: &str) -> Result<Self, InputError> {
        let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending).to_ascii_lowercase();
        match ending.as_str() {
            "toml" => contour_file::read(Source::read(name)?),
            _ => Err(InputError::new(
                name,
                "is not a job that can be read here; give a contour in TOML (.toml), as examples/farouki2018.toml",
            )),
        }
    }

    /// Reads a contour from a text that is at hand; `name` stands in errors.
    pub fn from_toml(name: &str, text: &str) -> Result<Self, InputError> {
        contour_file::read(Source { name: name.to_string(), text: text.to_string() })
    }

    /// This job with values from the command line in the place of its own. Errors name the option.
    pub fn with_feed(mut self, by: FeedOverride) -> Result<Self, InputError> {
        if let Some(rate) = by.rate {
            self.feed.rate = check_rate(rate).map_err(|m| InputError::new("--feed", m))? * self.units.mm() / 60.0;
        }
        if let Some(weight) = by.weight {
            self.feed.weight = check_weight(weight).map_err(|m| InputError::new("--weight", m))?;
        }
        if let Some(reduction) = by.reduction {
            self.feed.reduction = check_reduction(reduction).map_err(|m| InputError::new("--reduction", m))?;
        }
        if let Some(ramp) = by.ramp {
            self.feed.ramp = check_ramp(ramp).map_err(|m| InputError::new("--ramp", m))?;
        }
        Ok(self)
    }

    /// An error about the piece with this number.
    pub fn piece_error(&self, piece: usize, message: impl std::fmt::Display) -> InputError {
        let message = format!("piece {piece}: {message}");
        let Places { source, segments, pieces } = &self.places;
        match pieces.get(piece).or_else(|| segments.get(piece)) {
            Some(span) => source.error(span, message),
            None => InputError::new(source.name.clone(), message),
        }
    }

    /// The name of the job's file.
    pub fn name(&self) -> &str {
        &self.places.source.name
    }

    /// The first and last point of a segment.
    pub(crate) fn ends(segment: &Segment<f64>) -> [Complex<f64>; 2] {
        use shared::curve::Curve as _;
        [segment.point(0.0), segment.point(1.0)]
    }
}

fn check_rate(rate: f64) -> Result<f64, String> {
    let usable = rate > 0.0 && rate.is_finite();
    usable
        .then_some(rate)
        .ok_or_else(|| format!("the feed is {rate}; it must be a number above zero, in units a minute"))
}

fn check_weight(weight: f64) -> Result<f64, String> {
    (0.0..=1.0).contains(&weight).then_some(weight).ok_or_else(|| {
        format!("the weight is {weight}; it must be within 0 (constant contact feed) and 1 (constant centre feed)")
    })
}

fn check_reduction(reduction: f64) -> Result<f64, String> {
    let usable = reduction > 0.0 && reduction <= 1.0;
    usable.then_some(reduction).ok_or_else(|| {
        format!("the reduction is {reduction}; it must be above 0, or the corner is never reached, and at most 1")
    })
}

fn check_ramp(ramp: f64) -> Result<f64, String> {
    (0.0..=1.0).contains(&ramp).then_some(ramp).ok_or_else(|| {
        format!("the ramp takes {ramp} of its piece; it must be within 0 and 1, and both ends' at most 1")
    })
}

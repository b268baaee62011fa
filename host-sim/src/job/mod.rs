//! What a person wants cut: a contour, the tool's offset, the feed, and possibly the trimmed pieces of the offset.

mod contour_file;
mod places;
mod program_file;
mod reduction;
mod schema;
mod splines;
mod trim;

use crate::contour::{Along, Contour};
use crate::input::{InputError, Source};
use crate::offset::Offset;
use crate::program;
use crate::strokes::{Event, Pace, Stroke, Strokes, Tooling};

pub use crate::units::Units;
use places::{Place, Places};
pub use reduction::{Corner, Reduction};

/// The feed as a person gives it, in mm and seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedWish {
    /// V in mm/s; 0 where the file gives none.
    pub rate: f64,
    /// w.
    pub weight: f64,
    /// f at every corner that has none of its own.
    pub reduction: Reduction,
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
    pub reduction: Option<Reduction>,
    /// In the place of `feed.ramp`.
    pub ramp: Option<f64>,
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

/// What a file says of the part and the tool: all that an offset takes. Lengths in mm.
#[derive(Clone, Debug)]
pub struct Part {
    /// The unit of its file.
    pub units: Units,
    /// The signed offset distance d, positive right of travel; 0 where the file gives none.
    pub offset: f64,
    /// The contour C.
    pub contour: Contour,
    places: Places,
}

/// A job: validated as far as it can be without making a path of it. Lengths in mm.
#[derive(Clone, Debug)]
pub struct Job {
    /// The unit of its file.
    pub units: Units,
    /// The widest gap that is taken for none.
    pub tolerance: f64,
    /// Whether the path begins and ends at rest.
    pub rest: bool,
    /// The signed offset distance d, positive right of travel.
    pub offset: f64,
    /// Which loop of the trimmed offset is run, where one was chosen.
    pub chosen: Option<usize>,
    /// The feed.
    pub feed: FeedWish,
    /// The contour C.
    pub contour: Contour,
    /// The strokes of a program, which are run as they are; none where the job is a contour.
    pub strokes: Vec<Stroke>,
    /// What a program does between them.
    pub events: Vec<Event>,
    /// What of the file is worth a word: what was left out, and where a tool cannot follow its contour.
    pub warnings: Vec<String>,
    /// The trimmed offset as the file gives it; without any the offset is trimmed when a path is made.
    pub pieces: Vec<GivenPiece>,
    /// Where the file says what, for errors that show later.
    places: Places,
}

impl Job {
    /// Reads a job by its file's ending: a contour, a drawing of one contour, or a program, whose lines become curves within 10 um, or within what its G64 P says.
    /// Errors name file, line and column.
    pub fn read(name: &str) -> Result<Self, InputError> {
        Self::read_with(name, &Tooling::default())
    }

    /// The same with the tools that a program compensates for.
    pub fn read_with(name: &str, tooling: &Tooling) -> Result<Self, InputError> {
        if program::is_one(name) { program_file::job(name, tooling) } else { contour_file::job(open(name)?) }
    }

    /// The job of a program's strokes; `name` stands in errors. Errors: there is no stroke.
    pub fn from_strokes(name: &str, strokes: Strokes) -> Result<Self, InputError> {
        program_file::of_strokes(name, strokes)
    }

    /// Reads a contour from a text that is at hand; `name` stands in errors.
    pub fn from_toml(name: &str, text: &str) -> Result<Self, InputError> {
        contour_file::job(Source { name: name.to_string(), text: text.to_string() })
    }

    /// This job with values from the command line in the place of its own. Errors name the option.
    pub fn with_feed(mut self, by: FeedOverride) -> Result<Self, InputError> {
        if let Some(rate) = by.rate {
            self.feed.rate = check_rate(rate).map_err(|m| InputError::new("--feed", m))? * self.units.mm() / 60.0;
            for stroke in self.strokes.iter_mut().filter(|stroke| stroke.pace != Pace::Rapid) {
                stroke.pace = Pace::Feed(self.feed.rate);
            }
        }
        if let Some(weight) = by.weight {
            self.feed.weight = check_weight(weight).map_err(|m| InputError::new("--weight", m))?;
        }
        if let Some(reduction) = by.reduction {
            self.feed.reduction = check_wish(reduction).map_err(|m| InputError::new("--reduction", m))?;
        }
        if let Some(ramp) = by.ramp {
            self.feed.ramp = check_ramp(ramp).map_err(|m| InputError::new("--ramp", m))?;
        }
        Ok(self)
    }

    /// This job with the loop of this number chosen, if there is one, in the place of its own choice.
    pub fn with_loop(mut self, number: Option<usize>) -> Self {
        if number.is_some() {
            (self.chosen, self.places.chosen) = (number, Place::Option("--loop"));
        }
        self
    }

    /// The trimmed offset of the contour. Errors name the place in the file that they are about.
    pub fn trim(&self) -> Result<Offset, InputError> {
        self.places.trim(&self.contour, self.offset, self.units)
    }

    /// An error about a piece of the path: at its `[[piece]]` where the job gives its pieces, at the `[[segment]]` that it runs
    /// along where it does not.
    pub fn piece_error(&self, piece: usize, along: Along, message: impl std::fmt::Display) -> InputError {
        if !self.strokes.is_empty() {
            let (Along::Segment { segment: number, .. } | Along::Fill { node: number, .. }) = along;
            let line = self.strokes.get(number).map_or(1, |stroke| stroke.line);
            return self.line_error(line, message);
        }
        if !self.pieces.is_empty() {
            return self.places.piece_error(piece, message);
        }
        match along {
            Along::Segment { segment, from, to } => {
                self.places.segment_error(segment, format_args!("segment {segment} from {from} to {to}: {message}"))
            }
            Along::Fill { node, .. } => {
                self.places.segment_error(node, format_args!("the arc about node {node}: {message}"))
            }
        }
    }

    /// An error about a line of a program.
    pub fn line_error(&self, line: usize, message: impl std::fmt::Display) -> InputError {
        // A drawing has no lines that a person would look for.
        let position = (!program::is_drawing(self.name())).then_some((line, 1));
        InputError { position, ..InputError::new(self.name(), message) }
    }

    /// An error about the offset distance.
    pub fn distance_error(&self, message: impl std::fmt::Display) -> InputError {
        self.places.error(&self.places.distance, message)
    }

    /// An error about the choice of a loop, or the lack of one.
    pub fn choice_error(&self, message: impl std::fmt::Display) -> InputError {
        self.places.error(&self.places.chosen, message)
    }

    /// The name of the job's file.
    pub fn name(&self) -> &str {
        &self.places.source.name
    }
}

impl Part {
    /// Reads contour and offset of a file by its ending; it needs no feed. Errors name file, line and column.
    pub fn read(name: &str) -> Result<Self, InputError> {
        contour_file::part(open(name)?)
    }

    /// Reads a contour from a text that is at hand; `name` stands in errors.
    pub fn from_toml(name: &str, text: &str) -> Result<Self, InputError> {
        contour_file::part(Source { name: name.to_string(), text: text.to_string() })
    }

    /// This part with another distance, in the file's units, if there is one, in the place of its own.
    pub fn with_distance(mut self, distance: Option<f64>) -> Self {
        if let Some(distance) = distance {
            (self.offset, self.places.distance) = (distance * self.units.mm(), Place::Option("--distance"));
        }
        self
    }

    /// The trimmed offset. Errors name the place in the file, or the option, that they are about.
    pub fn trim(&self) -> Result<Offset, InputError> {
        if self.places.distance == Place::Nowhere {
            let message = "the file has no [offset] with a distance; give the tool's radius with --distance, positive right of travel";
            return Err(self.places.error(&Place::Nowhere, message));
        }
        self.places.trim(&self.contour, self.offset, self.units)
    }

    /// The name of the file.
    pub fn name(&self) -> &str {
        &self.places.source.name
    }
}

/// The text of a job's file. Errors: it cannot be read, or its ending tells of something else.
fn open(name: &str) -> Result<Source, InputError> {
    let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending).to_ascii_lowercase();
    match ending.as_str() {
        "toml" => Source::read(name),
        _ if program::is_one(name) => program_file::source(name),
        _ => Err(InputError::new(
            name,
            "is not a job that can be read here; give a contour in TOML (.toml), as examples/farouki2018.toml, a program (.ngc .nc \
             .gcode .tap .mpf .spf .apt .cls), or a drawing (.svg .dxf)",
        )),
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

fn check_wish(reduction: Reduction) -> Result<Reduction, String> {
    match reduction {
        Reduction::Fixed(factor) => check_reduction(factor).map(Reduction::Fixed),
        Reduction::Auto => Ok(reduction),
    }
}

fn check_ramp(ramp: f64) -> Result<f64, String> {
    (0.0..=1.0).contains(&ramp).then_some(ramp).ok_or_else(|| {
        format!("the ramp takes {ramp} of its piece; it must be within 0 and 1, and both ends' at most 1")
    })
}

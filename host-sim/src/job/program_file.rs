//! Programs as jobs: their lines become PH curves, and every motion is a stroke of the path.
//!
//! The offset of a program is that of the one contour that it cuts.

use std::fs::File;
use std::io::BufReader;

use super::{FeedWish, Job, Place, Places, Reduction};
use crate::contour::Contour;
use crate::fit::Kind;
use crate::fit::contour::{Chains, only};
use crate::fit::program::{Fitter, Step};
use crate::input::{InputError, Source};
use crate::program::item::Compensation;
use crate::program::{self, Action, Item, Motion};
use crate::strokes::{self, Lines, Pace, Stroke, Strokes, Tooling};
use crate::units::Units;

/// The widest gap between two strokes that is taken for none, in mm.
const GAP_MM: f64 = 1e-3;

/// How far curves may be from a program's lines in mm, where it does not say so itself (G64 P).
pub const TOLERANCE_MM: f64 = 0.01;

/// The job of a program: all that it does. Errors: those of its reader, and what the axes of a job cannot do.
pub(super) fn job(name: &str, tooling: &Tooling) -> Result<Job, InputError> {
    if program::is_drawing(name) {
        return drawing(name);
    }
    let lines = Lines::FittedAsTold(Kind::Drivable, TOLERANCE_MM);
    let (strokes, warnings) = strokes::read(name, open(name)?, lines, tooling)?;
    of_strokes(name, strokes).map(|job| Job { warnings, ..job })
}

/// The job of a drawing: its one contour, which has no feed. How a tool would get from one contour to another is not in a drawing.
fn drawing(name: &str) -> Result<Job, InputError> {
    let mut strokes = Strokes::default();
    let mut chains = 0;
    let mut take = |step: Step<'_>| match step {
        Step::Kept(Item { action: Action::Motion(Motion::Rapid { .. }), .. }) => {
            chains += 1;
            Ok(())
        }
        step if chains == 1 => strokes.take(&step),
        _ => Ok(()),
    };
    let mut fitter = Fitter::new(Kind::Ph, TOLERANCE_MM, &mut take).with_its_curves();
    let left_out = program::read(name, open(name)?, &mut |item| fitter.take(item))?;
    fitter.finish().map_err(|message| InputError::new(name, message))?;
    if chains > 1 {
        let message = format!(
            "there are {chains} contours, and how a tool gets from one to another is not in a drawing; `hodograph fit` with \
             --contour 0 to {} takes one",
            chains - 1
        );
        return Err(InputError::new(name, message));
    }
    let warnings = left_out.iter().map(|warning| format!("{name}: {warning}")).collect();
    of_strokes(name, strokes).map(|job| Job { warnings, ..job })
}

fn open(name: &str) -> Result<BufReader<File>, InputError> {
    let file = File::open(name).map_err(|error| InputError::new(name, format_args!("cannot be read: {error}")))?;
    Ok(BufReader::new(file))
}

/// The job of strokes. Errors: there are none.
pub(super) fn of_strokes(name: &str, Strokes { strokes, events, .. }: Strokes) -> Result<Job, InputError> {
    if strokes.is_empty() {
        return Err(InputError::new(name, "the program moves nothing, so there is nothing to run"));
    }
    let cut = |stroke: &Stroke| if let Pace::Feed(feed) = stroke.pace { Some(feed) } else { None };
    // The largest one stands for all where one number is asked for.
    let rate = strokes.iter().filter_map(cut).fold(0.0, f64::max);
    let feed = FeedWish { rate, weight: 0.0, reduction: Reduction::Fixed(1.0), ramp: 0.25 };
    let segments = strokes.iter().map(|stroke| stroke.segment).collect();
    let places = Places {
        // Errors name lines; the text itself is not needed.
        source: Source { name: name.to_string(), text: String::new() },
        segments: Vec::new(),
        pieces: Vec::new(),
        distance: Place::Nowhere,
        chosen: Place::Nowhere,
    };
    Ok(Job {
        units: Units::Mm,
        tolerance: GAP_MM,
        rest: true,
        offset: 0.0,
        chosen: None,
        feed,
        contour: Contour { segments, closed: false },
        strokes,
        events,
        warnings: Vec::new(),
        pieces: Vec::new(),
        places,
    })
}

/// What is said of a program that is offset already.
const BESIDE: &str =
    "the program compensates for its tool itself, so there is no contour to offset; take G41 and G42 out";

/// The contour form of a program. Errors: those of its reader, and a program that cuts no contour, or several.
pub(super) fn source(name: &str) -> Result<Source, InputError> {
    let mut chains = Chains::default();
    let mut take = |step: Step<'_>| chains.take(&step).map_err(|error| error.to_string());
    let mut fitter = Fitter::new(Kind::Ph, TOLERANCE_MM, &mut take).with_the_programs_tolerance().with_its_curves();
    let mut centre = |item: &Item<'_>| match item.action {
        Action::Compensation(Compensation::On { .. }) => Err(BESIDE.to_string()),
        _ => fitter.take(item),
    };
    program::read(name, open(name)?, &mut centre)?;
    fitter.finish().map_err(|message| InputError::new(name, message))?;
    let text = only(&chains.chains, None).map_err(|message| InputError::new(name, message))?.to_toml();
    // Lines and columns of errors are those of the contour, as `hodograph fit -o` writes it.
    Ok(Source { name: format!("{name} (as a contour)"), text })
}

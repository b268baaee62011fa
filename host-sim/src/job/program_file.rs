//! Programs as jobs: their lines become PH curves, and the one contour that they cut becomes the job.

use std::fs::File;
use std::io::BufReader;

use crate::fit::Kind;
use crate::fit::contour::{Chains, only};
use crate::fit::program::{Fitter, Step};
use crate::input::{InputError, Source};
use crate::program;

/// How far curves may be from a program's lines in mm, where it does not say so itself (G64 P).
pub const TOLERANCE_MM: f64 = 0.01;

/// The contour form of a program. Errors: those of its reader, and a program that cuts no contour, or several.
pub(super) fn source(name: &str) -> Result<Source, InputError> {
    let file = File::open(name).map_err(|error| InputError::new(name, format_args!("cannot be read: {error}")))?;
    let mut chains = Chains::default();
    let mut take = |step: Step<'_>| chains.take(&step).map_err(|error| error.to_string());
    let mut fitter = Fitter::new(Kind::Ph, TOLERANCE_MM, &mut take).with_the_programs_tolerance();
    program::read(name, BufReader::new(file), &mut |item| fitter.take(item))?;
    fitter.finish().map_err(|message| InputError::new(name, message))?;
    let text = only(&chains.chains, None).map_err(|message| InputError::new(name, message))?.to_toml();
    // Lines and columns of errors are those of the contour, as `hodograph fit -o` writes it.
    Ok(Source { name: format!("{name} (as a contour)"), text })
}

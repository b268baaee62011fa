//! Options of the pace: rest, and what the axes bear.

use clap::Args;
use host_sim::input::InputError;
use host_sim::job::Job;
use host_sim::pacing::{self, AxisLimits, JERK_PER_ACCELERATION, PacingError};
use host_sim::path::Path;

/// What the command line says of starts, stops and overrides.
#[derive(Args)]
pub struct Pacing {
    /// Begin and end the path at rest, whatever the job says
    #[arg(long)]
    rest: bool,
    /// The largest acceleration of an axis, in the job's units/s2: starts, stops and overrides take what the path leaves of it.
    /// Without it they add 1 m/s2 to what the path asks for
    #[arg(long, value_name = "A", allow_negative_numbers = true)]
    acceleration: Option<f64>,
    /// The largest jerk of an axis by starts, stops and overrides, in the job's units/s3; 20 times the acceleration where it is
    /// left out
    #[arg(long, value_name = "J", allow_negative_numbers = true, requires = "acceleration")]
    jerk: Option<f64>,
}

impl Pacing {
    /// The path with this in the place of its own. Errors name the option, or the piece that asks for too much.
    pub fn apply(&self, mut path: Path, job: &Job) -> Result<Path, InputError> {
        path.header.rest |= self.rest;
        let Some(acceleration) = self.acceleration else { return Ok(path) };
        let jerk = self.jerk.unwrap_or(JERK_PER_ACCELERATION * acceleration);
        for (option, value) in [("--acceleration", acceleration), ("--jerk", jerk)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(InputError::new(
                    option,
                    format_args!("the limit is {value}; it must be a number above zero"),
                ));
            }
        }
        let mm = job.units.mm();
        let limits = AxisLimits { acceleration: [acceleration * mm; 2], jerk: [jerk * mm; 2] };
        let pace = pacing::within(&path, &limits).map_err(|error| match error {
            PacingError::Acceleration { piece, asked } => {
                let (asked, unit) = (asked / mm, job.units.short());
                let message = format!(
                    "it asks an axis for {asked:.1} {unit}/s2 at its own feed, of {acceleration}; lower the feed or raise --acceleration"
                );
                match path.pieces.get(piece) {
                    Some(at) => job.piece_error(piece, at.along, message),
                    None => InputError::new("--acceleration", message),
                }
            }
            PacingError::Refused(error) => InputError::new("--acceleration or --jerk", error),
        })?;
        path.header.pace = pace;
        Ok(path)
    }
}

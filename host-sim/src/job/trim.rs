//! Trims the contour of a file, and tells its owner what is wrong where it stands.

use super::Units;
use super::places::Places;
use crate::contour::Contour;
use crate::input::InputError;
use crate::offset::{Offset, OffsetError, trim};

impl Places {
    /// The trimmed offset at `distance` mm; an error stands where the file tells of what is wrong.
    pub(super) fn trim(&self, contour: &Contour, distance: f64, units: Units) -> Result<Offset, InputError> {
        trim(contour, distance).map_err(|error| match error {
            OffsetError::Empty { largest } => {
                let named = OffsetError::Empty { largest: fitting(contour, distance, largest, units) };
                self.error(&self.distance, named.sentence(distance, units))
            }
            OffsetError::Distance | OffsetError::Degenerate => {
                self.error(&self.distance, error.sentence(distance, units))
            }
            OffsetError::Crossing { segments: [segment, _], .. }
            | OffsetError::Cusp { segment }
            | OffsetError::Spline { segment }
            | OffsetError::Reversal { node: segment } => self.segment_error(segment, error.sentence(distance, units)),
        })
    }
}

/// The radius in mm of the largest tool with five figures that fits: `largest`, which is good to some 1e-7, rounded down, and
/// tried. 0 where none fits.
fn fitting(contour: &Contour, distance: f64, largest: f64, units: Units) -> f64 {
    /// What `largest` may be too small, so that a round radius stays one.
    const ERROR: f64 = 1e-6;
    if !(largest > 0.0 && largest.is_finite()) {
        return 0.0;
    }
    let largest = largest / units.mm();
    // Decimals, not their unit: dividing by a power of ten gives the number that was meant, multiplying by its inverse does not.
    let scale = 10_f64.powf(4.0 - (largest * (1.0 - ERROR)).log10().floor());
    let figures = (largest * (1.0 + ERROR) * scale).floor();
    let fits = |radius: &f64| trim(contour, radius.copysign(distance)).is_ok();
    [0.0, 1.0, 2.0].map(|less| (figures - less) / scale * units.mm()).into_iter().find(fits).unwrap_or(0.0)
}

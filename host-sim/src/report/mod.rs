//! Results as pictures and tables, in one self-contained HTML file.
//!
//! | module | what |
//! | --- | --- |
//! | `simulation`, `plan`, `reproduction`, `feed_correction`, `spline_fit` | the reports: what stands in which order, and the sentences between |
//! | `fitting` | lines before and curves after |
//! | `figures`, `plan_figures` | one function for each kind of picture |
//! | `limited`, `causes` | what limits a plan and where; how that is named and coloured |
//! | `tables` | published tables beside what came out here |
//! | `plane`, `chart` | coordinates: the plane with one scale on both axes; strips over one time axis |
//! | `geometry`, `leftover`, `series` | the points to draw: offsets and contact points; what the tool leaves; thinned series and round ticks |
//! | `canvas`, `page`, `style` | marks as SVG, text as HTML, colours and sizes |

mod canvas;
mod causes;
mod chart;
mod feed_correction;
mod figures;
mod fitting;
mod geometry;
mod leftover;
mod limited;
mod page;
mod plan;
mod plan_figures;
mod plane;
mod reproduction;
mod series;
mod simulation;
mod spline_fit;
mod style;
mod tables;

use std::fmt;

use crate::job::{Job, Part};
use crate::offset::{Offset, Undercut};
use crate::path::Path;
use crate::simulate::Sample;

pub use feed_correction::feed_correction;
pub use fitting::Fitted;
pub use plan::plan;
pub use reproduction::reproduction;
pub use simulation::simulation;
pub use spline_fit::spline_fit;

/// Why there is no report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReportError {
    /// The run kept no samples.
    NoSamples,
    /// The drawing backend refused a mark.
    Drawing,
}

impl fmt::Display for ReportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoSamples => "there is nothing to draw: the run kept none of its ticks",
            Self::Drawing => "a picture could not be drawn",
        })
    }
}

impl std::error::Error for ReportError {}

/// One picture as an SVG file: the path coloured by its centre feed, with the contour and the corners.
pub fn picture(job: &Job, path: &Path, samples: &[Sample]) -> Result<String, ReportError> {
    if samples.is_empty() {
        return Err(ReportError::NoSamples);
    }
    let most = figures::scale_end(job.units, samples.iter().map(|sample| sample.feed));
    Ok(figures::feed_along_path(job, path, samples, most)?.file())
}

/// The trimming of a contour as an SVG file: contour, untrimmed and trimmed offset, trim points, and what the tool leaves.
pub fn offset_picture(part: &Part, offset: &Offset, undercuts: &[Undercut]) -> Result<String, ReportError> {
    Ok(figures::trimming(part, offset, undercuts)?.file())
}

/// A fit as an SVG file: the lines and the curves, whole and near where most lines meet. Errors: there is nothing to draw.
pub fn fit_picture(fitted: &Fitted) -> Result<String, ReportError> {
    Ok(fitting::fitting(fitted)?.file())
}

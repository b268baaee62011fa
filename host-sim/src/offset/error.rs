//! Why a contour has no trimmed offset, as a person reads it.

use std::fmt;

use shared::complex::Complex;

use crate::units::Units;

/// Why there is no trimmed offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OffsetError {
    /// The distance is zero or not a number.
    Distance,
    /// The contour crosses itself.
    Crossing {
        /// The segments that cross.
        segments: [usize; 2],
        /// Where, in mm.
        at: Complex<f64>,
    },
    /// A segment stands still and turns back inside itself: its parametric speed vanishes.
    Cusp {
        /// Its number.
        segment: usize,
    },
    /// A segment is a polynomial curve, whose offset is no curve that can be driven exactly.
    Spline {
        /// Its number.
        segment: usize,
    },
    /// At a node the contour goes back the way it came.
    Reversal {
        /// The node at the end of the segment of this number.
        node: usize,
    },
    /// Nothing of the offset is left.
    Empty {
        /// The largest |d| on this side that would leave a path, in mm.
        largest: f64,
    },
    /// Pieces were found that do not join to loops, at every one of a few distances within 1e-9 of the given one.
    Degenerate,
}

impl OffsetError {
    /// What was found and what would do, in one sentence, for an offset at `distance` mm; its lengths are in `units`.
    pub fn sentence(&self, distance: f64, units: Units) -> String {
        self.describe(&format!(" at distance {}", units.length(distance)), units)
    }

    /// The sentence with `at_distance` behind what is so at this distance alone.
    fn describe(&self, at_distance: &str, units: Units) -> String {
        let point = |at| units.point(at);
        match *self {
            Self::Distance => "the offset distance is zero or not a number; give the radius of a tool".to_string(),
            Self::Crossing { segments: [one, other], at } if one == other => {
                format!("the contour crosses itself: segment {one} does at {}; {UNCROSSED}", point(at))
            }
            Self::Crossing { segments: [one, other], at } => {
                format!("the contour crosses itself: segments {one} and {other} meet at {}; {UNCROSSED}", point(at))
            }
            Self::Cusp { segment } => format!(
                "segment {segment} stands still inside and turns back there, so it has no normal; make two segments of it"
            ),
            Self::Spline { segment } => format!(
                "segment {segment} is a polynomial spline, which has no exact offset; give its offset a distance of 0, or draw it \
                 with `ph` or `hermite`"
            ),
            Self::Reversal { node } => format!(
                "at node {node}, where segment {node} ends, the contour goes back the way it came; no tool fits in between, \
                 so leave the way back out or keep it apart"
            ),
            Self::Empty { largest } if largest > 0.0 => {
                format!("no path is left{at_distance}: the largest tool that fits has radius {}", units.length(largest))
            }
            Self::Empty { .. } => format!("no path is left{at_distance}: no tool fits on this side of the contour"),
            Self::Degenerate => format!(
                "the offset{at_distance} is degenerate: its pieces do not join to loops, nor do those within 1e-9 of it; a \
                 slightly different distance will do"
            ),
        }
    }
}

const UNCROSSED: &str = "only a contour that does not cross itself has a tool side and a part side";

/// As [`OffsetError::sentence`] in mm, but without the distance, which an error does not know.
impl fmt::Display for OffsetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.describe("", Units::Mm))
    }
}

impl std::error::Error for OffsetError {}

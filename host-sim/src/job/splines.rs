//! Splines in the contour form: `bezier`, one curve by its control points, and `spline`, a chain of curves through points.

use serde::Deserialize;
use shared::complex::Complex;
use shared::curve::{Segment, Spline};
use shared::spline::CorrectionOrder;

use super::Units;
use super::schema::Point;
use crate::spline::{Interpolant, Parametrisation};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawBezier {
    pub start: Option<Point>,
    pub points: Vec<Point>,
    #[serde(default)]
    pub correction: CorrectionOrder,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawSpline {
    pub start: Option<Point>,
    pub points: Vec<Point>,
    pub degree: Option<u8>,
    #[serde(default)]
    pub parameter: Parametrisation,
    #[serde(default)]
    pub correction: CorrectionOrder,
}

impl RawBezier {
    /// The curve from `start` on.
    pub(super) fn read(&self, start: Complex<f64>, units: Units) -> Result<Segment<f64>, String> {
        let points: Vec<Complex<f64>> = self.points.iter().map(|&point| in_mm(point, units)).collect();
        let correction = self.correction;
        match *points.as_slice() {
            [b, c, d] => Ok(Segment::Spline(Spline::cubic([start, b, c, d], correction))),
            [b, c, d, e, f] => Ok(Segment::Spline(Spline { points: [start, b, c, d, e, f], correction })),
            _ => Err(format!(
                "a `bezier` has {} points behind its start; it needs 3 for a cubic or 5 for a quintic",
                points.len()
            )),
        }
    }
}

impl RawSpline {
    /// The curves through `start` and all points; a ring where `closed` and the last point is the start again.
    pub(super) fn read(
        &self,
        start: Complex<f64>,
        closed: bool,
        units: Units,
        tolerance: f64,
    ) -> Result<Vec<Segment<f64>>, String> {
        let mut points = vec![[start.re, start.im]];
        points.extend(self.points.iter().map(|&point| in_mm(point, units)).map(|point| [point.re, point.im]));
        let ring = closed && points.last().is_some_and(|&[x, y]| (Complex::new(x, y) - start).norm() <= tolerance);
        if ring {
            points.pop();
        }
        let spline = match self.degree {
            None | Some(3) => Interpolant::cubic(&points, ring, self.parameter),
            Some(5) => Interpolant::quintic(&points, ring, self.parameter),
            Some(degree) => return Err(format!("a `spline` has degree 3 or 5, not {degree}")),
        };
        let spline = spline.map_err(|error| format!("{error} (point 0 is its start)"))?;
        Ok(spline.curves(self.correction).map(Segment::Spline).collect())
    }
}

fn in_mm([x, y]: Point, units: Units) -> Complex<f64> {
    Complex::new(x * units.mm(), y * units.mm())
}

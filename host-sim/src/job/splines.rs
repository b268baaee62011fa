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
    pub correction: RawCorrection,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawSpline {
    pub start: Option<Point>,
    pub points: Vec<Point>,
    pub degree: Option<u8>,
    #[serde(default)]
    pub parameter: RawParameter,
    #[serde(default)]
    pub correction: RawCorrection,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum RawParameter {
    #[default]
    Chord,
    Arc,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum RawCorrection {
    Natural,
    Fifth,
    FifthJoined,
    #[default]
    Seventh,
    Ninth,
}

impl From<RawCorrection> for CorrectionOrder {
    fn from(raw: RawCorrection) -> Self {
        match raw {
            RawCorrection::Natural => Self::Natural,
            RawCorrection::Fifth => Self::FifthFitted,
            RawCorrection::FifthJoined => Self::FifthJoined,
            RawCorrection::Seventh => Self::Seventh,
            RawCorrection::Ninth => Self::Ninth,
        }
    }
}

impl RawBezier {
    /// The curve from `start` on.
    pub(super) fn read(&self, start: Complex<f64>, units: Units) -> Result<Segment<f64>, String> {
        let points: Vec<Complex<f64>> = self.points.iter().map(|&point| in_mm(point, units)).collect();
        let correction = self.correction.into();
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
        let by = match self.parameter {
            RawParameter::Chord => Parametrisation::Chord,
            RawParameter::Arc => Parametrisation::Arc,
        };
        let spline = match self.degree {
            None | Some(3) => Interpolant::cubic(&points, ring, by),
            Some(5) => Interpolant::quintic(&points, ring, by),
            Some(degree) => return Err(format!("a `spline` has degree 3 or 5, not {degree}")),
        };
        let spline = spline.map_err(|error| format!("{error} (point 0 is its start)"))?;
        Ok(spline.curves(self.correction.into()).map(Segment::Spline).collect())
    }
}

fn in_mm([x, y]: Point, units: Units) -> Complex<f64> {
    Complex::new(x * units.mm(), y * units.mm())
}

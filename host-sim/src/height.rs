//! How z goes along a segment.

use shared::complex::Complex;
use shared::curve::{Curve as _, Segment, Spline};
use shared::spline::{CorrectionOrder, PolynomialSegment};

/// z along a whole segment, in mm. The tick moves z linearly along lines, arcs and PH curves, so that only a spline bends in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Height {
    /// Linearly in the segment's own length.
    Linear {
        /// z at the segment's start.
        start: f64,
        /// What it rises for a mm of the segment.
        slope: f64,
    },
    /// Straight up or down, on a line without a chord: from and to.
    Vertical([f64; 2]),
    /// The z of a spline's control points.
    Bezier([f64; 6]),
}

impl Height {
    /// From `from` to `to` along a segment.
    pub fn between(segment: &Segment<f64>, [from, to]: [f64; 2]) -> Self {
        let length = segment.length();
        if length > 0.0 {
            Self::Linear { start: from, slope: (to - from) / length }
        } else {
            Self::Vertical([from, to])
        }
    }

    /// At one z all along.
    pub fn level(z: f64) -> Self {
        Self::Linear { start: z, slope: 0.0 }
    }

    /// Whether z stays where it is.
    pub fn is_level(&self) -> bool {
        matches!(self, Self::Linear { slope: 0.0, .. })
    }

    /// z at a parameter of the segment.
    pub fn at(&self, segment: &Segment<f64>, xi: f64) -> f64 {
        match *self {
            Self::Linear { start, slope: 0.0 } => start,
            Self::Linear { start, slope } => start + slope * segment.length_to(xi),
            Self::Vertical([from, to]) => from + (to - from) * xi,
            Self::Bezier(ordinates) => ordinate(ordinates).point(xi).re,
        }
    }

    /// The length that a feed is along, from the start of the segment to a parameter, in mm: that of the segment itself, the height
    /// where z moves alone, or the length in space of a spline that bends in z.
    pub fn way_to(&self, segment: &Segment<f64>, xi: f64) -> f64 {
        match *self {
            Self::Linear { .. } => segment.length_to(xi),
            Self::Vertical([from, to]) => (to - from).abs() * xi,
            Self::Bezier(_) => self.in_space(segment).map_or(0.0, |curve| curve.length_over(-0.5, xi)),
        }
    }

    /// The derivative of that length by the parameter, in mm.
    pub fn way_speed(&self, segment: &Segment<f64>, xi: f64) -> f64 {
        match *self {
            Self::Linear { .. } => segment.speed(xi),
            Self::Vertical([from, to]) => (to - from).abs(),
            Self::Bezier(_) => self.in_space(segment).map_or(0.0, |curve| curve.speed(xi - 0.5)),
        }
    }

    /// How far the tool goes in space for a unit of that length, where it is on the segment itself.
    pub fn stretch(&self) -> f64 {
        match *self {
            Self::Linear { slope, .. } => slope.hypot(1.0),
            Self::Vertical(_) | Self::Bezier(_) => 1.0,
        }
    }

    /// A spline that bends in space, in powers of v = xi - 1/2; none where z does not bend.
    pub fn in_space(&self, segment: &Segment<f64>) -> Option<PolynomialSegment<f64, 3>> {
        let (Segment::Spline(spline), Self::Bezier(ordinates)) = (segment, *self) else { return None };
        let (plane, z) = (spline.segment(), ordinate(ordinates).segment());
        let mut coefficients = [[0.0; 3]; 6];
        for ((slot, [x, y]), [z, _]) in coefficients.iter_mut().zip(plane.0).zip(z.0) {
            *slot = [x, y, z];
        }
        Some(PolynomialSegment(coefficients))
    }

    /// z over a part of a spline's parameter.
    pub fn part(&self, from: f64, to: f64) -> Self {
        match *self {
            Self::Bezier(ordinates) => Self::Bezier(ordinate(ordinates).part(from, to).points.map(|point| point.re)),
            other => other,
        }
    }

    /// What z departs from its straight way by ([`shared::piece::SplineShape::bow`]) over a part of the parameter; zeros where it does not
    /// bend.
    pub fn bow(&self, from: f64, to: f64) -> [f64; 4] {
        let Self::Bezier(ordinates) = *self else { return [0.0; 4] };
        let [_, _, c2, c3, c4, c5] = ordinate(ordinates).part(from, to).segment().0.map(|[z, _]| z);
        let [b2, b3] = [-c4, -c5];
        [0.25 * b2 - c2, 0.25 * b3 - c3, b2, b3]
    }
}

/// The ordinates as a curve of one coordinate.
fn ordinate(ordinates: [f64; 6]) -> Spline<f64> {
    Spline { points: ordinates.map(|z| Complex::new(z, 0.0)), correction: CorrectionOrder::Natural }
}

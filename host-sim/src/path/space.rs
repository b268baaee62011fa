//! How the tool's centre moves at a place of a piece, in space.

use shared::complex::Complex;
use shared::curve::{Curve as _, Segment};
use shared::fixed::Fixed;
use shared::further::Travel;

use super::PathPiece;
use crate::height::Height;
use crate::vector::Vector;

/// The motion at a place for a unit of length that the feed is along: that of the contact point on C, that of z where only z moves, or the
/// length in space of a spline that bends in z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Space {
    /// The unit tangent of the centre's way.
    pub direction: Vector,
    /// The curvature of that way: the derivative of the direction by its length, in 1/mm.
    pub bend: Vector,
    /// How far the centre moves for a unit of that length.
    pub stretch: f64,
    /// The derivative of that along the length, in 1/mm.
    pub stretching: f64,
}

impl PathPiece {
    /// z at a parameter of the segment; none where the path does not speak of it.
    pub fn z(&self, xi: f64) -> Option<f64> {
        self.height.map(|height| height.at(&self.segment, xi))
    }

    /// The length that the feed is along, from the start of the segment to a parameter, in mm ([`Height::way_to`]).
    pub fn way_to(&self, xi: f64) -> f64 {
        self.height.map_or_else(|| self.segment.length_to(xi), |height| height.way_to(&self.segment, xi))
    }

    /// The derivative of that length by the parameter, in mm.
    pub fn way_speed(&self, xi: f64) -> f64 {
        self.height.map_or_else(|| self.segment.speed(xi), |height| height.way_speed(&self.segment, xi))
    }

    /// How the centre moves at a parameter.
    pub fn space(&self, xi: f64) -> Space {
        /// Half the difference for the derivative of the stretch, as a part of a segment.
        const NEAR: f64 = 1e-5;
        if let Some(Height::Vertical([from, to])) = self.height {
            let direction = Vector([0.0, 0.0, (to - from).signum()]);
            return Space { direction, bend: Vector::default(), stretch: 1.0, stretching: 0.0 };
        }
        if let Some(curve) = self.height.and_then(|height| height.in_space(&self.segment)) {
            let [first, second] = [curve.derivative::<1>(xi - 0.5), curve.derivative::<2>(xi - 0.5)].map(Vector);
            let speed = first.norm();
            let direction = first * (1.0 / speed);
            let bend = (second - direction * second.dot(direction)) * (1.0 / (speed * speed));
            return Space { direction, bend, stretch: 1.0, stretching: 0.0 };
        }
        let kappa = self.segment.curvature(xi);
        let stretch = (1.0 + kappa * self.offset).abs();
        let stretching = match self.segment {
            Segment::Line(_) | Segment::Arc(_) => 0.0,
            Segment::Ph(_) | Segment::Spline(_) if self.offset == 0.0 => 0.0,
            Segment::Ph(_) | Segment::Spline(_) => {
                let (low, high) = ((xi - NEAR).max(0.0), (xi + NEAR).min(1.0));
                (self.stretch(high) - self.stretch(low)) / ((high - low) * self.segment.speed(xi))
            }
        };
        let tangent = self.direction(xi);
        // The tangents of curve and offset turn alike, over lengths in the ratio |1 + kappa d|; backwards the turn per length changes sign.
        let turn = if self.is_forward() { kappa } else { -kappa };
        let flat = |z: Complex<f64>| Vector([z.re, z.im, 0.0]);
        let (along, left) = (flat(tangent), flat(tangent.left()));
        let slope = match self.height {
            Some(Height::Linear { slope, .. }) if slope != 0.0 => slope,
            _ => return Space { direction: along, bend: left * (turn / stretch), stretch, stretching },
        };
        // Along C the centre moves by stretch t + slope e_z.
        let rate = along * stretch + Vector([0.0, 0.0, slope]);
        let change = along * stretching + left * (turn * stretch);
        let whole = rate.norm();
        let direction = rate * (1.0 / whole);
        let growing = change.dot(direction);
        Space {
            direction,
            bend: (change - direction * growing) * (1.0 / (whole * whole)),
            stretch: whole,
            stretching: growing,
        }
    }

    /// How z moves with the piece, as the controller gets it.
    pub(super) fn travel(&self) -> Option<Travel> {
        let [from, to] = self.interval.map(|xi| self.z(xi).map(|z| [Fixed::from_mm(z)]));
        Some(Travel { from: from?, to: to? })
    }
}

#[cfg(test)]
mod tests {
    use shared::active::ActivePiece;
    use shared::curve::{Arc, Line, PhQuintic, Spline};
    use shared::spline::CorrectionOrder;

    use super::*;
    use crate::contour::{Along, Contour};

    fn piece(segment: Segment<f64>, interval: [f64; 2], offset: f64, height: Height) -> PathPiece {
        let contour = Contour { segments: vec![segment], closed: false };
        let [from, to] = interval;
        let along = Along::Segment { segment: 0, from, to };
        PathPiece { height: Some(height), ..PathPiece::new(&contour, along, offset, 10.0).unwrap() }
    }

    fn all() -> Vec<PathPiece> {
        let at = Complex::new;
        let line = Segment::Line(Line { start: at(1.0, 2.0), end: at(4.0, 6.0) });
        let none = Segment::Line(Line { start: at(1.0, 2.0), end: at(1.0, 2.0) });
        let arc = Segment::Arc(Arc { start: at(3.0, 0.0), radius: at(3.0, 0.0), sweep: 2.5 });
        let ph = Segment::Ph(PhQuintic { start: at(0.0, 1.0), w: [at(2.0, 0.0), at(1.8, 0.7), at(1.2, 1.4)] });
        let points = [(0.0, 0.0), (3.0, 4.0), (7.0, -2.0), (9.0, 5.0), (14.0, 8.0), (16.0, 6.0)].map(|(x, y)| at(x, y));
        let spline = Segment::Spline(Spline { points, correction: CorrectionOrder::Seventh });
        vec![
            piece(line, [0.0, 1.0], 0.0, Height::between(&line, [1.0, -2.0])),
            piece(none, [0.0, 1.0], 0.0, Height::between(&none, [1.0, -2.0])),
            piece(none, [0.25, 0.75], 0.0, Height::between(&none, [1.0, 5.0])),
            piece(arc, [0.1, 0.9], 0.0, Height::between(&arc, [0.0, 3.0])),
            piece(ph, [0.2, 1.0], 0.0, Height::between(&ph, [0.0, 1.0])),
            piece(ph, [0.1, 0.9], 0.7, Height::between(&ph, [0.0, 4.0])),
            piece(spline, [0.1, 0.8], 0.0, Height::Bezier([0.0, 4.0, -3.0, 2.0, 2.0, 1.0])),
        ]
    }

    fn point(piece: &PathPiece, xi: f64) -> Vector {
        let p = piece.point(xi);
        Vector([p.re, p.im, piece.z(xi).unwrap()])
    }

    /// Direction, curvature and stretch against difference quotients of the points themselves.
    #[test]
    fn the_motion_is_that_of_the_points() {
        const H: f64 = 1e-4;
        for (number, piece) in all().iter().enumerate() {
            for xi in [0.3, 0.5, 0.6] {
                let Space { direction, bend, stretch, stretching } = piece.space(xi);
                let way = |a: f64, b: f64| piece.way_to(b) - piece.way_to(a);
                let chord = |a: f64, b: f64| (point(piece, b) - point(piece, a)) * (1.0 / way(a, b));
                let rate = chord(xi - H, xi + H);
                assert!(
                    (rate - direction * stretch).norm() < 1e-6,
                    "{number} at {xi}: {rate:?} {direction:?} {stretch}"
                );
                let turn = piece.space(xi + H).direction - piece.space(xi - H).direction;
                let turn = turn * (1.0 / (way(xi - H, xi + H) * stretch));
                assert!((turn - bend).norm() < 1e-5, "{number} at {xi}: {turn:?} {bend:?}");
                let growth = (piece.space(xi + H).stretch - piece.space(xi - H).stretch) / way(xi - H, xi + H);
                assert!((growth - stretching).abs() < 1e-4, "{number} at {xi}: {growth} {stretching}");
                assert!((way(xi - H, xi + H) / (2.0 * H) - piece.way_speed(xi)).abs() < 1e-4, "{number} at {xi}");
            }
        }
    }

    /// What the controller makes of a piece goes through the same points, z and all.
    #[test]
    fn the_controller_goes_through_the_same_heights() {
        for (number, piece) in all().iter().enumerate() {
            let wire = piece.exact(None);
            let active = ActivePiece::activate(&wire, 0.0, f64::from(shared::TICK)).unwrap();
            for tau in [-0.5, -0.3, 0.0, 0.2, 0.5] {
                let parameter = active.parameter(tau);
                let exact = point(piece, piece.parameter(parameter));
                let at = active.place(active.point_and_rate(tau).0);
                let [z] = active.further(tau).unwrap();
                let found = Vector([at[0].to_mm(), at[1].to_mm(), z.to_mm()]);
                // Origin and end are rounded to 2 nm in each axis, and so is the sum.
                assert!((found - exact).norm() < 6e-6, "{number} at {tau}: {found:?} {exact:?}");
            }
        }
    }
}

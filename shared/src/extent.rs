//! Soft limits: how far a piece reaches, and whether an axis may go there. Load time, before anything moves.
//!
//! | piece | its box |
//! | --- | --- |
//! | line | exact |
//! | arc | exact: its ends, and the circle's outermost points that lie on it |
//! | further axes | exact: their ends |
//! | spline | holds it, z too: the hull of the control points of each [`PARTS`]-th |
//! | PH curve, or its offset | holds it; on a common curve wider by less than 1 % of its size (test `the_box_of_a_common_curve_is_tight`) |
//!
//! r_d is a rational Bezier curve of degree 9 with the weights sigma (Farouki & Sakkalis 1990): the numerator is r sigma + d(-i w^2). On
//! each [`PARTS`]-th of a piece the curve lies in the hull of its control points where all weights are above zero, and within |d|
//! of the hull of r everywhere. Boxes are widened by the rounding of all this, 40 roundoffs of the largest coordinate.

use crate::complex::Complex;
use crate::curve::speed_bernstein;
use crate::error::PathError;
use crate::fixed::Fixed;
use crate::piece::{Piece, Shape, SplineShape};
use crate::polynomial::{Polynomial, bernstein_product};
use crate::real::Real;
use crate::spline::PolynomialSegment;

/// Into how many parts a PH curve is cut.
pub const PARTS: i32 = 8;

/// What a piece may seem to leave the travel by, in mm: a job that goes right to its end is not refused for rounding.
pub const SLACK_MM: f64 = 1e-3;

/// The smallest and the largest coordinates of x and y, in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent<T> {
    /// The smallest x and y.
    pub low: [T; 2],
    /// The largest x and y.
    pub high: [T; 2],
}

impl<T: Real> Extent<T> {
    fn of(point: Complex<T>) -> Self {
        Self { low: [point.re, point.im], high: [point.re, point.im] }
    }

    /// Widened so that it holds `point` and what is within `margin` of it.
    fn with(self, point: Complex<T>, margin: T) -> Self {
        let ([x0, y0], [x1, y1]) = (self.low, self.high);
        Self {
            low: [x0.least(point.re - margin), y0.least(point.im - margin)],
            high: [x1.most(point.re + margin), y1.most(point.im + margin)],
        }
    }

    /// Widened by the rounding of its computation.
    fn rounded(self, magnitude: T) -> Self {
        let margin = magnitude * (T::lit(40.0) * T::ROUNDOFF);
        Self { low: self.low.map(|c| c - margin), high: self.high.map(|c| c + margin) }
    }
}

impl<T: Real, const F: usize> Piece<T, F> {
    /// A box that holds the piece, relative to its origin. Of a piece that the loader would refuse it may be anything.
    pub fn extent(&self) -> Extent<T> {
        match self.shape {
            Shape::Line { chord } => Extent::of(chord * T::HALF).with(chord * -T::HALF, T::ZERO),
            Shape::Arc { radius, sweep, .. } => arc(radius, sweep),
            Shape::Ph { preimage, offset } => ph(preimage, offset),
            Shape::Spline(shape) => spline(&shape),
        }
    }
}

/// The arc of a circle about -`radius` that passes through 0 half-way.
fn arc<T: Real>(radius: Complex<T>, sweep: T) -> Extent<T> {
    let size = radius.norm();
    let half = sweep.abs() * T::HALF;
    let end = |angle: T| {
        let (sine, versine) = angle.sin_versin();
        radius * Complex::new(-versine, sine)
    };
    let ends = Extent::of(end(half)).with(end(-half), T::ZERO);
    let directions = [(T::ONE, T::ZERO), (T::ZERO, T::ONE), (-T::ONE, T::ZERO), (T::ZERO, -T::ONE)];
    let whole = directions.into_iter().fold(ends, |extent, (x, y)| {
        let direction = Complex::new(x, y);
        // An outermost point that lies beyond an end by rounding only is as good as the end.
        let turn = radius.cross(direction).atan2(radius.dot(direction)).abs();
        if turn <= half { extent.with(direction * size + radius * -T::ONE, T::ZERO) } else { extent }
    });
    whole.rounded(size)
}

/// The offset of the curve with the preimage A + B tau + C tau^2.
fn ph<T: Real>([a, b, c]: [Complex<T>; 3], offset: T) -> Extent<T> {
    let third = T::lit(1.0 / 3.0);
    let integral = Polynomial([
        a.square(),
        a * b,
        (b.square() + (a * c) * T::TWO) * third,
        (b * c) * T::HALF,
        c.square() * T::lit(0.2),
    ]);
    let step = T::ONE / T::from_int(PARTS);
    let mut extent: Option<Extent<T>> = None;
    let mut largest = offset.abs();
    for part in 0..PARTS {
        let from = T::from_int(part) * step - T::HALF;
        // The preimage on this part, in Bernstein form.
        let (first, last) = (a + (b + c * from) * from, a + (b + c * (from + step)) * (from + step));
        let middle = first + (b + c * (from * T::TWO)) * (step * T::HALF);
        let w = [first, middle, last];
        let square = [
            first.square(),
            first * middle,
            (middle.square() * T::TWO + first * last) * third,
            middle * last,
            last.square(),
        ];
        let mut point = integral.at(from, Complex::ZERO) * from;
        let mut r = [point; 6];
        for (slot, square) in r.iter_mut().skip(1).zip(square) {
            point = point + square * (step * T::lit(0.2));
            *slot = point;
        }
        largest = r.iter().fold(largest, |largest, point| largest.most(point.re.abs()).most(point.im.abs()));
        let hull = |extent: Option<Extent<T>>, point: Complex<T>, margin: T| {
            Some(extent.unwrap_or(Extent::of(point)).with(point, margin))
        };
        extent = match rational(w, square, r, offset) {
            Some(points) => points.into_iter().fold(extent, |extent, point| hull(extent, point, T::ZERO)),
            None => r.into_iter().fold(extent, |extent, point| hull(extent, point, offset.abs())),
        };
    }
    extent.unwrap_or(Extent::of(Complex::ZERO)).rounded(largest)
}

/// The hull of the control points on each part.
fn spline<T: Real>(shape: &SplineShape<T>) -> Extent<T> {
    let [re, im] = [|z: Complex<T>| z.re, |z: Complex<T>| z.im].map(|coordinate| {
        let [a, b, c, d, e] = shape.plane.map(coordinate);
        range(Polynomial([T::ZERO, a, b, c, d, e]))
    });
    Extent { low: [re[0], im[0]], high: [re[1], im[1]] }
}

/// The lowest and the highest control point of a polynomial on all parts of -1/2..=1/2, widened by their rounding.
fn range<T: Real, const N: usize>(polynomial: Polynomial<T, N>) -> [T; 2] {
    let step = T::ONE / T::from_int(PARTS);
    let parts = (0..PARTS).flat_map(|part| polynomial.bernstein(T::from_int(part) * step - T::HALF, step));
    let start = polynomial.at(-T::HALF, T::ZERO);
    let [low, high] = parts.fold([start; 2], |[low, high], point| [low.least(point), high.most(point)]);
    let size = polynomial.0.iter().fold(T::ZERO, |sum, c| sum + c.abs());
    let margin = size * (T::lit(40.0) * T::ROUNDOFF);
    [low - margin, high + margin]
}

/// The control points of the offset of one part as a rational curve; none where a weight is not clearly above zero.
fn rational<T: Real>(
    w: [Complex<T>; 3],
    square: [Complex<T>; 5],
    r: [Complex<T>; 6],
    offset: T,
) -> Option<[Complex<T>; 10]> {
    let sigma = speed_bernstein(w);
    let raise = |values: [T; 5]| -> [T; 10] { bernstein_product(values, [T::ONE; 6]) };
    let weights = raise(sigma);
    let most = weights.iter().fold(T::ZERO, |most: T, weight| most.most(weight.abs()));
    // Small weights would enlarge the rounding of what they divide.
    if !weights.iter().all(|&weight| weight > most * T::lit(0.05)) {
        return None;
    }
    // -i w^2 is w^2 turned to the right.
    let (x, y): ([T; 10], [T; 10]) =
        (bernstein_product(r.map(|point| point.re), sigma), bernstein_product(r.map(|point| point.im), sigma));
    let (u, v) = (raise(square.map(|z| z.right().re)), raise(square.map(|z| z.right().im)));
    let mut points = [Complex::ZERO; 10];
    let rows = points.iter_mut().zip(weights).zip(x.into_iter().zip(y)).zip(u.into_iter().zip(v));
    for (((point, weight), (x, y)), (u, v)) in rows {
        *point = Complex::new((x + u * offset) / weight, (y + v * offset) / weight);
    }
    Some(points)
}

/// The travel of the axes x, y and of `F` further ones, in machine coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SoftLimits<const F: usize = 1> {
    /// The lowest and the highest x and y.
    pub plane: [[Fixed; 2]; 2],
    /// The lowest and the highest coordinates of the further axes.
    pub further: [[Fixed; 2]; F],
}

impl<const F: usize> SoftLimits<F> {
    /// The same in coordinates whose zero stands at `zero` and `further` of these, in mm; at most at the end of what a coordinate can say.
    pub fn seen_from(self, zero: [f64; 2], further: [f64; F]) -> Self {
        let [x, y] = zero.map(Fixed::from_mm);
        let moved = |[low, high]: [Fixed; 2], by: Fixed| {
            [Fixed(low.0.saturating_sub(by.0)), Fixed(high.0.saturating_sub(by.0))]
        };
        let [along_x, along_y] = self.plane;
        let mut seen = Self { plane: [moved(along_x, x), moved(along_y, y)], ..self };
        for (travel, zero) in seen.further.iter_mut().zip(further) {
            *travel = moved(*travel, Fixed::from_mm(zero));
        }
        seen
    }

    /// Whether all of a piece lies within the travel. Errors: the first axis that would leave it, by more than [`SLACK_MM`],
    /// and by how much.
    pub fn check<T: Real>(&self, piece: &Piece<T, F>) -> Result<(), PathError> {
        let extent = piece.extent();
        let reach = extent.low.into_iter().zip(extent.high);
        for (axis, ((origin, travel), (low, high))) in (0..).zip(piece.origin.iter().zip(self.plane).zip(reach)) {
            within(axis, travel, *origin, low, high)?;
        }
        // A further axis moves from one end to the other, so its ends are its extremes; only the z of a spline may bend.
        if let Some(further) = &piece.further {
            for (axis, ((from, to), travel)) in (2..).zip(further.from.iter().zip(further.to).zip(self.further)) {
                within(axis, travel, *from, T::ZERO, T::ZERO)?;
                within(axis, travel, to, T::ZERO, T::ZERO)?;
            }
        }
        if let (Shape::Spline(shape), Some(further)) = (&piece.shape, &piece.further)
            && let (Some(from), Some(to), Some(travel)) =
                (further.from.first(), further.to.first(), self.further.first())
        {
            let [low, high] = bow(shape, to.minus(*from));
            within(2, *travel, *to, low, high)?;
        }
        Ok(())
    }
}

/// How far below and above its end the z of a spline goes that rises by `rise`, ends included, in mm.
fn bow<T: Real>(shape: &SplineShape<T>, rise: T) -> [T; 2] {
    let PolynomialSegment(space) = shape.segment(rise);
    let z = Polynomial(space.map(|[_, _, z]| z));
    let end = z.at(T::HALF, T::ZERO);
    range(z).map(|z| z - end)
}

/// Whether what reaches from `low` to `high` about an origin lies within the travel of an axis.
fn within<T: Real>(axis: u8, [least, most]: [Fixed; 2], origin: Fixed, low: T, high: T) -> Result<(), PathError> {
    // From the limit to the origin in integers, so that this is as exact far from zero as near it. Written so that a NaN fails.
    let (below, above) = (origin.minus::<T>(least) + low, origin.minus::<T>(most) + high);
    let slack = T::lit(SLACK_MM);
    if below >= -slack && above <= slack {
        return Ok(());
    }
    let beyond = if above > slack { above } else { below };
    Err(PathError::SoftLimit { axis, beyond: beyond.to_f32() })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::active::ActivePiece;
    use crate::further::Travel;
    use crate::spline::CorrectionOrder;

    fn piece<T: Real>(shape: Shape<T>) -> Piece<T> {
        Piece {
            origin: [Fixed(0); 2],
            shape,
            interval: [T::ZERO, T::ONE],
            feed: T::ONE,
            start: None,
            end: None,
            profile: None,
            further: None,
            last: None,
        }
    }

    fn close(found: Extent<f64>, low: [f64; 2], high: [f64; 2]) {
        for (found, expected) in found.low.into_iter().chain(found.high).zip(low.into_iter().chain(high)) {
            assert!((found - expected).abs() < 1e-12, "{found} for {expected}");
        }
    }

    #[test]
    fn lines_and_arcs_have_exact_boxes() {
        let line = piece(Shape::Line { chord: Complex::new(-6.0, 4.0) });
        close(line.extent(), [-3.0, -2.0], [3.0, 2.0]);
        let quadrant = core::f64::consts::FRAC_PI_2;
        let arc = |sweep| piece(Shape::Arc { radius: Complex::new(0.0, 5.0), sweep, ratio: 1.0 }).extent();
        // About (0, -5) through the origin: a quarter, three quarters, the whole circle.
        let side = 5.0 * core::f64::consts::FRAC_1_SQRT_2;
        close(arc(quadrant), [-side, side - 5.0], [side, 0.0]);
        close(arc(-3.0 * quadrant), [-5.0, -5.0 - side], [5.0, 0.0]);
        close(arc(4.0 * quadrant), [-5.0, -10.0], [5.0, 0.0]);
    }

    #[test]
    fn a_limit_is_told_with_its_axis_and_by_how_much() {
        let mm = |range: [f64; 2]| range.map(Fixed::from_mm);
        let travel = SoftLimits { plane: [mm([0.0, 10.0]), mm([0.0, 3.0])], further: [mm([-20.0, 0.0])] };
        let mut line = piece(Shape::Line { chord: Complex::new(10.0_f32, 2.0) });
        line.origin = [5.0_f64, 1.0].map(Fixed::from_mm);
        assert_eq!(travel.check(&line), Ok(()));
        line.origin = [5.0_f64, 3.5].map(Fixed::from_mm);
        assert_eq!(travel.check(&line), Err(PathError::SoftLimit { axis: 1, beyond: 1.5 }));
        line.origin = [4.0_f64, 1.0].map(Fixed::from_mm);
        assert_eq!(travel.check(&line), Err(PathError::SoftLimit { axis: 0, beyond: -1.0 }));
        line.origin = [5.0_f64, 1.0].map(Fixed::from_mm);
        let [low, up] = [-20.0_f64, 0.5].map(|z| [Fixed::from_mm(z)]);
        line.further = Some(Travel { from: low, to: low });
        assert_eq!(travel.check(&line), Ok(()));
        line.further = Some(Travel { from: low, to: up });
        assert_eq!(travel.check(&line), Err(PathError::SoftLimit { axis: 2, beyond: 0.5 }));
        line.further = None;
        line.shape = Shape::Line { chord: Complex::new(f32::NAN, 0.0) };
        assert!(travel.check(&line).is_err());
    }

    prop_compose! {
        fn number()(value in -4.0..4.0_f64) -> f64 { value }
    }

    proptest! {
        /// Every point that the tick would put out lies in the box, in f32 as in f64, and the box is hardly wider than the points.
        #[test]
        fn the_box_holds_every_point(
            [a, b, c, d, e, f] in prop::array::uniform6(number()), offset in -8.0..8.0_f64,
        ) {
            let preimage = [Complex::new(a, b), Complex::new(c, d), Complex::new(e, f)];
            let exact = piece(Shape::Ph { preimage, offset });
            let single = preimage.map(|z| Complex::new(z.re as f32, z.im as f32));
            let rounded = piece(Shape::Ph { preimage: single, offset: offset as f32 });
            if let (Ok(active), Ok(small)) = (
                ActivePiece::activate(&exact, 0.0, 1e-3), ActivePiece::activate(&rounded, 0.0, 1e-3),
            ) {
                let (wide, narrow) = (exact.extent(), rounded.extent());
                for k in -500..=500 {
                    let (point, _) = active.point_and_rate(f64::from(k) * 1e-3);
                    prop_assert!(point.re >= wide.low[0] && point.re <= wide.high[0], "{point:?} {wide:?}");
                    prop_assert!(point.im >= wide.low[1] && point.im <= wide.high[1], "{point:?} {wide:?}");
                    let (point, _) = small.point_and_rate(k as f32 * 1e-3);
                    prop_assert!(point.re >= narrow.low[0] && point.re <= narrow.high[0], "{point:?} {narrow:?}");
                    prop_assert!(point.im >= narrow.low[1] && point.im <= narrow.high[1], "{point:?} {narrow:?}");
                }
            }
        }
    }

    proptest! {
        /// The same of a spline in space, z included, in f32 as in f64.
        #[test]
        fn the_box_of_a_spline_holds_every_point(
            plane in prop::array::uniform10(number()), bow in prop::array::uniform4(number()), rise in number(),
        ) {
            let [a, b, c, d, e, f, g, h, i, j] = plane;
            let exact = SplineShape {
                plane: [(a, b), (c, d), (e, f), (g, h), (i, j)].map(|(x, y)| Complex::new(x, y)),
                bow,
                correction: CorrectionOrder::Seventh,
            };
            let single = SplineShape {
                plane: exact.plane.map(|z| Complex::new(z.re as f32, z.im as f32)),
                bow: bow.map(|b| b as f32),
                correction: exact.correction,
            };
            let (wide, narrow) = (piece(Shape::Spline(exact)).extent(), piece(Shape::Spline(single)).extent());
            let ([low, high], [single_low, single_high]) = (super::bow(&exact, rise), super::bow(&single, rise as f32));
            let (space, single_space) = (exact.segment(rise), single.segment(rise as f32));
            let (end, single_end) = (space.point(0.5)[2], single_space.point(0.5)[2]);
            for k in -200..=200 {
                let [x, y, z] = space.point(f64::from(k) * 2.5e-3);
                prop_assert!(x >= wide.low[0] && x <= wide.high[0] && y >= wide.low[1] && y <= wide.high[1]);
                prop_assert!(z - end >= low && z - end <= high, "{z} {end} {low} {high}");
                let [x, y, z] = single_space.point(k as f32 * 2.5e-3);
                prop_assert!(x >= narrow.low[0] && x <= narrow.high[0] && y >= narrow.low[1] && y <= narrow.high[1]);
                prop_assert!(z - single_end >= single_low && z - single_end <= single_high);
            }
        }
    }

    /// A spline that ends where it starts in z, and bows beyond the travel between.
    #[test]
    fn a_bow_beyond_the_travel_is_told() {
        let travel = SoftLimits {
            plane: [[Fixed(-1 << 30), Fixed(1 << 30)]; 2],
            further: [[-20.0_f64, 0.0].map(Fixed::from_mm)],
        };
        let mut plane = [Complex::<f32>::ZERO; 5];
        plane[0] = Complex::new(30.0, 0.0);
        let arched = |height: f32| {
            let shape = SplineShape { plane, bow: [4.0 * height, 0.0, 0.0, 0.0], correction: CorrectionOrder::Seventh };
            let at = Fixed::from_mm(-1.0_f64);
            Piece { further: Some(Travel { from: [at], to: [at] }), ..piece(Shape::Spline(shape)) }
        };
        assert_eq!(travel.check(&arched(0.9)), Ok(()));
        let Err(PathError::SoftLimit { axis: 2, beyond }) = travel.check(&arched(1.5)) else {
            panic!("it stays within")
        };
        assert!((beyond - 0.5).abs() < 0.02, "{beyond}");
    }

    /// On a curve as people draw it the box is wider than the curve by less than a hundredth of its size.
    #[test]
    fn the_box_of_a_common_curve_is_tight() {
        let preimage = [Complex::new(3.0, 0.5), Complex::new(0.3, 1.5), Complex::new(-0.2, 0.2)];
        let curve = piece::<f64>(Shape::Ph { preimage, offset: -2.0 });
        let active = ActivePiece::activate(&curve, 0.0, 1e-3).unwrap();
        let first = Extent::of(active.point_and_rate(-0.5).0);
        let sampled =
            (-5_000..=5_000).fold(first, |extent, k| extent.with(active.point_and_rate(f64::from(k) * 1e-4).0, 0.0));
        let size = sampled.high[0] - sampled.low[0];
        let found = curve.extent();
        for axis in 0..2 {
            assert!(sampled.low[axis] - found.low[axis] < 0.01 * size, "{sampled:?} {found:?}");
            assert!(found.high[axis] - sampled.high[axis] < 0.01 * size, "{sampled:?} {found:?}");
        }
    }
}

//! Rational B-splines: what makes one, its ends brought to its first and last point, and its Bézier pieces.
//!
//! All by the blossom: the control point between the knots t(1), …, t(d) is the blossom of the curve's polynomial at these d
//! values. New control points for other knots are therefore d + 1 local points and no more, however long the curve is.

use std::fmt;

use super::item::Nurbs;

/// Why numbers make no curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoCurve {
    /// The degree is 0, or there are not enough points for it.
    Few,
    /// There are other than as many weights as points, or `order` more knots.
    Counts,
    /// A number is not finite.
    NotFinite,
    /// A weight is not positive.
    Weight,
    /// Knots fall.
    Falling,
    /// A knot inside stands more than `degree` times: the curve is torn there. Or all of them are one.
    Torn,
}

impl fmt::Display for NoCurve {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Few => "a spline needs more points than its degree",
            Self::Counts => "a spline has as many weights as points, and as many knots as points, degree and one",
            Self::NotFinite => "a number of this spline is none",
            Self::Weight => "the weights of a spline are more than 0",
            Self::Falling => "the knots of a spline never fall",
            Self::Torn => "this spline is torn: a knot stands more often than its degree",
        })
    }
}

/// A curve that passes through its first and last point, its points times their weights.
#[derive(Clone, Debug, PartialEq)]
pub struct Clamped {
    /// The degree.
    pub degree: usize,
    /// x, y, z times the weight, and the weight.
    pub points: Vec<[f64; 4]>,
    /// The knots, of which the first and the last stand `degree + 1` times.
    pub knots: Vec<f64>,
}

impl Clamped {
    /// The same curve, over the interval that the knots leave it. Errors: it is none.
    pub fn new(curve: &Nurbs<'_>) -> Result<Self, NoCurve> {
        let Nurbs { order, points, weights, knots } = *curve;
        let count = points.len();
        if order < 2 || count < order {
            return Err(NoCurve::Few);
        }
        if weights.len() != count || knots.len() != count + order {
            return Err(NoCurve::Counts);
        }
        let degree = order - 1;
        if !points.iter().flatten().chain(weights).chain(knots).all(|x| x.is_finite()) {
            return Err(NoCurve::NotFinite);
        }
        if weights.iter().any(|&weight| weight <= 0.0) {
            return Err(NoCurve::Weight);
        }
        if knots.windows(2).any(|pair| pair[0] > pair[1]) {
            return Err(NoCurve::Falling);
        }
        let (first, last) = (knots[degree], knots[count]);
        let new: Vec<f64> = knots.iter().map(|knot| knot.clamp(first, last)).collect();
        if (1..count).any(|i| new[i] >= new[i + degree]) {
            return Err(NoCurve::Torn);
        }
        let points = points.iter().zip(weights).map(|(&[x, y, z], &w)| [x * w, y * w, z * w, w]).collect();
        let old = Self { degree, points, knots: knots.to_vec() };
        let points = (0..count).map(|i| old.renewed(i, &new)).collect();
        Ok(Self { degree, points, knots: new })
    }

    /// The control point of number `i` if the knots are `new`, which leave the spans inside as they are.
    fn renewed(&self, i: usize, new: &[f64]) -> [f64; 4] {
        let degree = self.degree;
        let same = |k: usize| new[k] == self.knots[k];
        if (i + 1..=i + degree).all(same) {
            return self.points[i];
        }
        let mut spans = i.max(degree)..=(i + degree).min(self.points.len() - 1);
        let span = spans.find(|&k| self.knots[k] < self.knots[k + 1]);
        span.map_or(self.points[i], |span| self.blossom(span, |k| new[i + 1 + k]))
    }

    /// The blossom of the polynomial in the span behind knot number `span` at `degree` values.
    fn blossom(&self, span: usize, value: impl Fn(usize) -> f64) -> [f64; 4] {
        let degree = self.degree;
        let mut local = self.points[span - degree..=span].to_vec();
        for round in 1..=degree {
            for j in (round..=degree).rev() {
                let (low, high) = (self.knots[span - degree + j], self.knots[span + 1 + j - round]);
                let part = (value(round - 1) - low) / (high - low);
                local[j] = std::array::from_fn(|k| local[j - 1][k] * (1.0 - part) + local[j][k] * part);
            }
        }
        local[degree]
    }

    /// The control points, `degree + 1` each, of the Bézier curves that it consists of.
    pub fn pieces(&self) -> impl Iterator<Item = Vec<[f64; 4]>> + '_ {
        let degree = self.degree;
        let spans = (degree..self.points.len()).filter(|&span| self.knots[span] < self.knots[span + 1]);
        spans.map(move |span| {
            let ends = [self.knots[span], self.knots[span + 1]];
            (0..=degree).map(|j| self.blossom(span, |k| ends[usize::from(k < j)])).collect()
        })
    }

    /// Whether the knots inside are equally far apart, as G5.2 has them.
    pub fn is_uniform(&self) -> bool {
        let spans = self.points.len() - self.degree;
        let (first, last) = (self.knots[0], self.knots[self.knots.len() - 1]);
        let step = (last - first) / spans as f64;
        // A knot that is off by this part of its interval moves the curve by no more of a piece's length.
        const OFF: f64 = 1e-13;
        (0..=spans).all(|k| (self.knots[self.degree + k] - (first + step * k as f64)).abs() <= OFF * step)
    }
}

/// A point and its weight.
pub fn projected([x, y, z, w]: [f64; 4]) -> ([f64; 3], f64) {
    ([x / w, y / w, z / w], w)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A uniform quadratic B-spline begins midway between its first two points, and is two parabolas.
    #[test]
    fn an_open_spline_begins_midway() {
        let points = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [4.0, 2.0, 0.0]];
        let knots = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        let curve = Clamped::new(&Nurbs { order: 3, points: &points, weights: &[1.0; 4], knots: &knots }).unwrap();
        assert_eq!(curve.knots, [2.0, 2.0, 2.0, 3.0, 4.0, 4.0, 4.0]);
        let found: Vec<_> = curve.points.iter().map(|&[x, y, ..]| [x, y]).collect();
        assert_eq!(found, [[1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [3.0, 2.0]]);
        let pieces: Vec<Vec<[f64; 2]>> =
            curve.pieces().map(|piece| piece.iter().map(|&[x, y, ..]| [x, y]).collect()).collect();
        assert_eq!(pieces, [[[1.0, 0.0], [2.0, 0.0], [2.0, 1.0]], [[2.0, 1.0], [2.0, 2.0], [3.0, 2.0]]]);
        assert!(curve.is_uniform());
    }

    #[test]
    fn each_fault_is_found() {
        let curve = |order, weights: &[f64], knots: &[f64]| {
            Clamped::new(&Nurbs { order, points: &[[0.0; 3]; 3], weights, knots }).err()
        };
        let (ones, right) = ([1.0; 3], [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
        assert_eq!(curve(3, &ones, &right), None);
        assert_eq!(curve(4, &ones, &right), Some(NoCurve::Few));
        assert_eq!(curve(3, &ones[1..], &right), Some(NoCurve::Counts));
        assert_eq!(curve(3, &[1.0, f64::NAN, 1.0], &right), Some(NoCurve::NotFinite));
        assert_eq!(curve(3, &[1.0, 0.0, 1.0], &right), Some(NoCurve::Weight));
        assert_eq!(curve(3, &ones, &[0.0, 0.0, 0.0, 1.0, 0.5, 1.0]), Some(NoCurve::Falling));
        assert_eq!(curve(3, &ones, &[1.0; 6]), Some(NoCurve::Torn));
        assert_eq!(curve(2, &ones, &[0.0, 0.0, 0.5, 1.0, 1.0]), None);
    }
}

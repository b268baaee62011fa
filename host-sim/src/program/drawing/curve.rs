//! Curves that own their points, and chains of them.

use crate::program::item::{Arc, Motion, Nurbs};

/// The largest coordinate: a thousand kilometres, as in programs.
const LARGEST: f64 = 1e9;

/// A curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Where it begins.
    pub from: [f64; 3],
    /// How it goes on.
    pub shape: Shape,
}

/// The shape of a curve.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Straight, to its end.
    Line([f64; 3]),
    /// A part of a circle, a whole one at most.
    Arc(Arc),
    /// A cubic Bézier curve: the points behind its start.
    Bezier([[f64; 3]; 3]),
    /// A rational B-spline that passes through its first and last point.
    Nurbs {
        /// The degree and one.
        order: usize,
        /// Control points, two or more.
        points: Vec<[f64; 3]>,
        /// Their weights.
        weights: Vec<f64>,
        /// The knots.
        knots: Vec<f64>,
    },
}

impl Curve {
    /// A straight one.
    pub fn line(from: [f64; 3], to: [f64; 3]) -> Self {
        Self { from, shape: Shape::Line(to) }
    }

    /// Where it ends.
    pub fn to(&self) -> [f64; 3] {
        match &self.shape {
            Shape::Line(to) | Shape::Bezier([.., to]) => *to,
            Shape::Arc(arc) => arc.to,
            Shape::Nurbs { points, .. } => points.last().copied().unwrap_or(self.from),
        }
    }

    /// As a motion from its start.
    pub fn motion(&self) -> Motion<'_> {
        match &self.shape {
            Shape::Line(to) => Motion::Line { to: *to },
            Shape::Arc(arc) => Motion::Arc(*arc),
            Shape::Bezier(points) => Motion::Bezier { points },
            Shape::Nurbs { order, points, weights, knots } => {
                Motion::Nurbs(Nurbs { order: *order, points, weights, knots })
            }
        }
    }

    /// Moves its start by no more than a tolerance.
    pub fn begin_at(&mut self, place: [f64; 3]) {
        self.from = place;
        if let Shape::Nurbs { points, .. } = &mut self.shape
            && let Some(first) = points.first_mut()
        {
            *first = place;
        }
    }

    /// Moves its end by no more than a tolerance.
    pub fn end_at(&mut self, place: [f64; 3]) {
        match &mut self.shape {
            Shape::Line(to) | Shape::Bezier([.., to]) => *to = place,
            Shape::Arc(arc) => arc.to = place,
            Shape::Nurbs { points, .. } => {
                if let Some(last) = points.last_mut() {
                    *last = place;
                }
            }
        }
    }

    /// The other way round.
    fn turn(&mut self) {
        let (from, to) = (self.from, self.to());
        self.from = to;
        match &mut self.shape {
            Shape::Line(end) => *end = from,
            Shape::Arc(arc) => {
                arc.to = from;
                arc.sweep = -arc.sweep;
            }
            Shape::Bezier(points) => *points = [points[1], points[0], from],
            Shape::Nurbs { points, weights, knots, .. } => {
                points.reverse();
                weights.reverse();
                knots.reverse();
                knots.iter_mut().for_each(|knot| *knot = -*knot);
            }
        }
    }
}

/// Curves, each of which begins where the one before ends.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chain(pub Vec<Curve>);

impl Chain {
    /// Where it begins; none where it is empty.
    pub fn start(&self) -> Option<[f64; 3]> {
        self.0.first().map(|curve| curve.from)
    }

    /// Where it ends; none where it is empty.
    pub fn end(&self) -> Option<[f64; 3]> {
        self.0.last().map(Curve::to)
    }

    /// The other way round.
    pub fn turn(&mut self) {
        self.0.reverse();
        self.0.iter_mut().for_each(Curve::turn);
    }

    /// Puts another one behind it, whose start is moved to its end.
    pub fn append(&mut self, mut other: Self) {
        if let (Some(end), Some(first)) = (self.end(), other.0.first_mut()) {
            first.begin_at(end);
        }
        self.0.append(&mut other.0);
    }
}

/// The distance of two places.
pub fn distance(p: [f64; 3], q: [f64; 3]) -> f64 {
    (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt()
}

/// Whether all numbers of a chain are ones that a machine could use.
pub fn finite(chain: &Chain) -> bool {
    let fits = |values: &[f64]| values.iter().all(|value| value.abs() <= LARGEST);
    chain.0.iter().all(|curve| {
        fits(&curve.from)
            && match &curve.shape {
                Shape::Line(to) => fits(to),
                Shape::Arc(arc) => fits(&arc.to) && fits(&arc.centre) && fits(&[arc.sweep]),
                Shape::Bezier(points) => fits(points.as_flattened()),
                Shape::Nurbs { points, .. } => fits(points.as_flattened()),
            }
    })
}

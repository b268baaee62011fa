//! Cubic B-splines with continuous curvature (SA 5): what the paper left as future work.
//!
//! The parameter is the way along the polyline, the knots are single, so that two derivatives are continuous. Control points come from least
//! squares of the vertices, and of points between them where a span has few. A span that breaks a condition is halved, and all is solved
//! again, until none does.

use super::band::Band;
use super::curve::{Cubic, Local};
use super::polyline::Polyline;
use super::spans::{LOOKS, Span, bernstein, parts, place};
use crate::vector::Vector;

/// A cubic spline over the way along a polyline.
#[derive(Clone, Debug, PartialEq)]
pub struct Bspline {
    /// The knots, those at the ends four times.
    pub knots: Vec<f64>,
    /// Its control points.
    pub points: Vec<Vector>,
}

/// A spline that is slower than this turns back on itself: there is a cusp, and the polyline has a corner.
const STANDING: f64 = 0.2;

/// How often spans are halved.
const ROUNDS: usize = 24;

impl Bspline {
    /// The span of that number by its Bernstein points.
    pub fn span(&self, k: usize) -> Cubic {
        bernstein(&self.points[k..k + 4], &parts(&self.knots, k))
    }
}

/// A spline through a polyline.
#[derive(Clone, Debug)]
pub(super) struct Fitted {
    pub spline: Bspline,
    /// Its spans with their deviations ...
    pub spans: Vec<Span>,
    /// ... and their curves.
    pub curves: Vec<Cubic>,
}

impl Fitted {
    /// Where the spline is at a way; derivatives are by the way.
    pub(super) fn at(&self, way: f64) -> Local {
        self.on(self.spans.partition_point(|span| span.ends[0] <= way).max(1) - 1, way)
    }

    /// As [`Fitted::at`], on the span of that number.
    pub(super) fn on(&self, number: usize, way: f64) -> Local {
        let [from, to] = self.spans[number].ends;
        let inverse = 1.0 / (to - from);
        let local = self.curves[number].at(((way - from) * inverse).clamp(0.0, 1.0));
        Local { first: local.first * inverse, second: local.second * (inverse * inverse), ..local }
    }

    /// The way at which it is slowest, where it is slower than [`STANDING`] at one of some looked at: 1 is where it goes as far as its
    /// parameter.
    fn standing(&self) -> Option<f64> {
        let mut slowest = None;
        let mut least = STANDING;
        for (Span { ends: [from, to], .. }, curve) in self.spans.iter().zip(&self.curves) {
            let step = to - from;
            // No point of the first derivative is nearer to zero than its control points are along the chord.
            let chord = (curve.points[3] - curve.points[0]) * (1.0 / step);
            let bar = STANDING * step * chord.norm();
            if chord.norm() > 0.0 && curve.points.windows(2).all(|pair| 3.0 * (pair[1] - pair[0]).dot(chord) >= bar) {
                continue;
            }
            for look in 0..LOOKS {
                let t = place(look);
                let speed = curve.at(t).first.norm() / step;
                if speed < least {
                    (least, slowest) = (speed, Some(from + step * t));
                }
            }
        }
        slowest
    }
}

/// The spline through a run of at least two points, within `tolerance`, and its deviation on each span. The error is the number of a vertex
/// near which no spline keeps it.
pub(super) fn fit(line: &Polyline<'_>, tolerance: f64) -> Result<Fitted, usize> {
    // Three control points at an end that is held.
    let first = if line.held == [None; 2] { 1 } else { 4 };
    let way = |k: usize| line.length() * k as f64 / first as f64;
    let mut spans: Vec<Span> = (0..first).map(|k| Span::new(line, [way(k), way(k + 1)])).collect();
    let mut scratch = Vec::new();
    for _ in 0..ROUNDS {
        let spline = least_squares(line, &mut spans, tolerance, &mut scratch);
        if let Some(spline) = spline
            && spans.iter().all(|span| span.deviation <= tolerance)
        {
            let curves = (0..spans.len()).map(|k| spline.span(k)).collect();
            let fitted = Fitted { spline, spans, curves };
            return match fitted.standing() {
                Some(way) if line.points.len() > 2 => Err(corner(line, way)),
                _ => Ok(fitted),
            };
        }
        let mut finer = Vec::with_capacity(2 * spans.len());
        for span in spans {
            if span.deviation <= tolerance {
                finer.push(span);
            } else if span.ends[1] - span.ends[0] < 0.5 * tolerance {
                return Err(corner(line, 0.5 * (span.ends[0] + span.ends[1])));
            } else {
                finer.extend(span.halves(line));
            }
        }
        spans = finer;
    }
    Err(corner(line, 0.5 * line.length()))
}

/// The inner vertex that is nearest to a way.
fn corner(line: &Polyline<'_>, way: f64) -> usize {
    let k = line.segment(way);
    let near = if way - line.ways[k] < line.ways[k + 1] - way { k } else { k + 1 };
    near.clamp(1, line.points.len().saturating_sub(2).max(1))
}

/// Holds the ends, with their derivatives where these are given.
fn hold(band: &mut Band, line: &Polyline<'_>, knots: &[f64]) {
    let last = knots.len() - 5;
    let ends = [(line.points[0], 1.0), (line.points[line.points.len() - 1], -1.0)];
    for (side, ((point, sign), held)) in ends.into_iter().zip(line.held).enumerate() {
        // From this end on, whichever it is.
        let number = |k: usize| if side == 0 { k } else { last - k };
        band.hold(number(0), point);
        if let Some([first, second]) = held {
            let way =
                |k: usize| if side == 0 { knots[3 + k] - knots[3] } else { knots[last + 1] - knots[last + 1 - k] };
            // r' = 3 (P1 - P0)/t1, r'' = 6/t1 ((P2 - P1)/t2 - (P1 - P0)/t1).
            let (near, far) = (way(1), way(2));
            let third = first * (sign / 3.0);
            let next = point + third * near;
            band.hold(number(1), next);
            band.hold(number(2), next + (second * (near / 6.0) + third) * far);
        }
    }
}

/// Fits the control points, and says in each span how far it and the polyline are apart. None where data leave a control point open: then no
/// span keeps the tolerance.
fn least_squares(line: &Polyline<'_>, spans: &mut [Span], tolerance: f64, scratch: &mut Vec<f64>) -> Option<Bspline> {
    let count = spans.len();
    let (first, last) = (0.0, line.length());
    let mut knots = Vec::with_capacity(count + 7);
    knots.extend([first; 3]);
    knots.extend(spans.iter().map(|span| span.ends[0]));
    knots.extend([last; 4]);
    let mut band = Band::new(count + 3);
    let parts: Vec<[[f64; 4]; 4]> = (0..count).map(|k| parts(&knots, k)).collect();
    for (k, (span, parts)) in spans.iter().zip(&parts).enumerate() {
        span.add_to(&mut band, k, parts);
    }
    hold(&mut band, line, &knots);
    let Some(points) = band.solve() else {
        spans.iter_mut().for_each(|span| span.deviation = f64::INFINITY);
        return None;
    };
    for (k, (span, parts)) in spans.iter_mut().zip(&parts).enumerate() {
        span.take(line, bernstein(&points[k..k + 4], parts), tolerance, scratch);
    }
    Some(Bspline { knots, points })
}

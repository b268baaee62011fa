//! Cubic B-splines with continuous curvature (SA 5): what the paper left as future work.
//!
//! The parameter is the way along the polyline, the knots are single, so that two derivatives are continuous. Control points come from least
//! squares of the vertices, and of points between them where a span has few. A span that breaks a condition is halved, and all is solved
//! again, until none does.

use super::band::Band;
use super::conditions::walk;
use super::curve::{Bezier, Cubic, Local};
use super::polyline::Polyline;
use super::vector::Vector;

/// A cubic spline over the way along a polyline.
#[derive(Clone, Debug, PartialEq)]
pub struct Bspline {
    /// The knots, those at the ends four times.
    pub knots: Vec<f64>,
    /// Its control points.
    pub points: Vec<Vector>,
}

/// The places that a span is looked at in at least.
const LOOKS: usize = 6;

/// A spline that is slower than this turns back on itself: there is a cusp, and the polyline has a corner.
const STANDING: f64 = 0.2;

/// How often spans are halved.
const ROUNDS: usize = 24;

impl Bspline {
    fn count(&self) -> usize {
        self.knots.len() - 7
    }

    /// The ways at which spans end.
    pub(super) fn breaks(&self) -> &[f64] {
        &self.knots[3..self.knots.len() - 3]
    }

    /// The span of that number by its Bernstein points.
    pub fn span(&self, k: usize) -> Cubic {
        let (from, to) = (self.knots[k + 3], self.knots[k + 4]);
        let blossom = |ways: [f64; 3]| {
            let mut p = [self.points[k], self.points[k + 1], self.points[k + 2], self.points[k + 3]];
            for (step, way) in ways.into_iter().enumerate() {
                for j in 0..3 - step {
                    let (low, high) = (self.knots[k + 1 + step + j], self.knots[k + 4 + j]);
                    p[j] = p[j].toward(p[j + 1], (way - low) / (high - low));
                }
            }
            p[0]
        };
        Bezier { points: [[from; 3], [from, from, to], [from, to, to], [to; 3]].map(blossom) }
    }

    /// The part between two ways of one span.
    pub(super) fn part(&self, ways: [f64; 2]) -> Cubic {
        let middle = 0.5 * (ways[0] + ways[1]);
        let k = self.breaks().partition_point(|&at| at <= middle).clamp(1, self.count()) - 1;
        let (from, to) = (self.knots[k + 3], self.knots[k + 4]);
        let [start, end] = ways.map(|way| ((way - from) / (to - from)).clamp(0.0, 1.0));
        let [before, _] = self.span(k).split(end);
        let [_, part] = before.split(if end > 0.0 { start / end } else { 0.0 });
        part
    }

    /// The way at which it is slowest, of some looked at, and how fast it is there: 1 where it goes as far as its parameter.
    fn slowest(&self) -> (f64, f64) {
        let looks = self
            .breaks()
            .windows(2)
            .flat_map(|ends| (0..LOOKS).map(|look| ends[0] + (ends[1] - ends[0]) * (look as f64 + 0.5) / LOOKS as f64));
        looks.map(|way| (way, self.at(way).first.norm())).min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0.0, 1.0))
    }

    /// Where it is at a way; derivatives are by the way.
    pub(super) fn at(&self, way: f64) -> Local {
        let k = self.breaks().partition_point(|&at| at <= way).clamp(1, self.count()) - 1;
        let (from, to) = (self.knots[k + 3], self.knots[k + 4]);
        let step = to - from;
        let local = self.span(k).at(((way - from) / step).clamp(0.0, 1.0));
        Local { first: local.first * (1.0 / step), second: local.second * (1.0 / (step * step)), ..local }
    }
}

/// The four basis functions that are not zero on span `k`, at a way.
fn basis(knots: &[f64], k: usize, way: f64) -> [f64; 4] {
    let mut parts = [1.0, 0.0, 0.0, 0.0];
    for degree in 1..4 {
        let mut carried = 0.0;
        for j in 0..degree {
            let (low, high) = (knots[k + 4 + j - degree], knots[k + 4 + j]);
            let part = parts[j] / (high - low);
            parts[j] = carried + (high - way) * part;
            carried = (way - low) * part;
        }
        parts[degree] = carried;
    }
    parts
}

/// The spline through a run of at least two points, within `tolerance`, and its deviation on each span. The error is the number of a vertex
/// near which no spline keeps it.
pub(super) fn fit(line: &Polyline<'_>, tolerance: f64) -> Result<(Bspline, Vec<f64>), usize> {
    let mut breaks = vec![0.0, line.length()];
    for _ in 0..ROUNDS {
        let spline = least_squares(line, &breaks);
        let deviations: Vec<f64> = match &spline {
            Some(spline) => (0..spline.count()).map(|k| deviation(line, spline, k, tolerance)).collect(),
            None => vec![f64::INFINITY; breaks.len() - 1],
        };
        let worst = deviations.iter().copied().fold(0.0, f64::max);
        if let Some(spline) = spline
            && worst <= tolerance
        {
            return match spline.slowest() {
                (way, speed) if speed < STANDING && line.points.len() > 2 => Err(corner(line, way)),
                _ => Ok((spline, deviations)),
            };
        }
        let mut finer = Vec::with_capacity(2 * breaks.len());
        for (ends, &deviation) in breaks.windows(2).zip(&deviations) {
            finer.push(ends[0]);
            if deviation > tolerance {
                let middle = 0.5 * (ends[0] + ends[1]);
                if ends[1] - ends[0] < 0.5 * tolerance {
                    return Err(corner(line, middle));
                }
                finer.push(middle);
            }
        }
        finer.push(line.length());
        breaks = finer;
    }
    Err(corner(line, 0.5 * line.length()))
}

/// The inner vertex that is nearest to a way.
fn corner(line: &Polyline<'_>, way: f64) -> usize {
    let k = line.segment(way);
    let near = if way - line.ways[k] < line.ways[k + 1] - way { k } else { k + 1 };
    near.clamp(1, line.points.len().saturating_sub(2).max(1))
}

fn least_squares(line: &Polyline<'_>, breaks: &[f64]) -> Option<Bspline> {
    let spans = breaks.len() - 1;
    let (first, last) = (breaks[0], breaks[spans]);
    let mut knots = vec![first; 3];
    knots.extend_from_slice(breaks);
    knots.extend([last; 3]);
    let mut band = Band::new(spans + 3);
    for (k, ends) in breaks.windows(2).enumerate() {
        let vertices = line.between(ends[0], ends[1]);
        if vertices.len() >= LOOKS {
            for j in vertices {
                band.add(k, basis(&knots, k, line.ways[j]), line.points[j]);
            }
        } else {
            for look in 0..LOOKS {
                let way = ends[0] + (ends[1] - ends[0]) * (look as f64 + 0.5) / LOOKS as f64;
                band.add(k, basis(&knots, k, way), line.at(way));
            }
        }
    }
    band.hold(0, line.points[0]);
    band.hold(spans + 2, line.points[line.points.len() - 1]);
    let points = band.solve()?;
    Some(Bspline { knots, points })
}

/// How far span `k` and the polyline are apart.
fn deviation(line: &Polyline<'_>, spline: &Bspline, k: usize, tolerance: f64) -> f64 {
    let curve = spline.span(k);
    let ways = [spline.knots[k + 3], spline.knots[k + 4]];
    across(line, &curve, ways, tolerance)
}

/// How far a curve and the polyline between two ways are apart; infinite where it is more than the tolerance.
pub(super) fn across<const N: usize>(line: &Polyline<'_>, curve: &Bezier<N>, ways: [f64; 2], tolerance: f64) -> f64 {
    // The ends of the curve stand for the points of the polyline that are nearest to them, on their segments.
    let ends = [(ways[0], curve.points[0]), (ways[1], curve.points[N - 1])].map(|(way, end)| {
        let k = line.segment(way);
        let along = line.points[k + 1] - line.points[k];
        let part = ((end - line.points[k]).dot(along) / along.dot(along)).clamp(0.0, 1.0);
        (line.ways[k] + part * (line.ways[k + 1] - line.ways[k]), line.points[k].toward(line.points[k + 1], part))
    });
    let vertices = line.between(ends[0].0, ends[1].0);
    let length = ends[1].0 - ends[0].0;
    let mut points = Vec::with_capacity(vertices.len() + 2);
    let mut feet = Vec::with_capacity(vertices.len() + 2);
    points.push(ends[0].1);
    feet.push(0.0);
    for j in vertices {
        points.push(line.points[j]);
        feet.push((line.ways[j] - ends[0].0) / length);
    }
    points.push(ends[1].1);
    feet.push(1.0);
    walk(curve, &points, &mut feet, tolerance, tolerance).map_or(f64::INFINITY, |walk| walk.deviation)
}

//! PH quintic splines with two continuous derivatives.
//!
//! r' = w^2, and w is a quadratic spline with a continuous derivative: so r' and r'' = 2 w w' are continuous. With a control point z_i for
//! each span and spans of h_i, w on span i has the Bernstein coefficients
//! (h_i z_{i-1} + h_{i-1} z_i)/(h_{i-1} + h_i), z_i, (h_{i+1} z_i + h_i z_{i+1})/(h_i + h_{i+1}). That each span goes from its point to the next
//! is one quadratic equation for each, in three neighbouring z; with equal spans it is that of [Albrecht & Farouki 1996]:
//! 3 z_{i-1}^2 + 27 z_i^2 + 3 z_{i+1}^2 + z_{i-1} z_{i+1} + 13 z_{i-1} z_i + 13 z_i z_{i+1} = 60 (q_i - q_{i-1}).
//!
//! The ends are clamped: the derivative is given there, so w0 of the first span and w2 of the last are its roots. One span alone is then the
//! Hermite interpolant. Of the many solutions Newton's method finds that which is near a start, here the cubic B-spline through the polyline;
//! its derivative in the middle of a span is near z^2.

use shared::complex::Complex;
use shared::curve::PhQuintic;

use super::bspline::{self, Fitted};
use super::conditions::{Polynomial, across};
use super::curve::Local;
use super::ph::{self, Node, RisingPh, rise};
use super::polyline::Polyline;
use super::{Curve, Part};
use crate::vector::Vector;

type Plane = Complex<f64>;

/// Newton's steps at the most.
const STEPS: usize = 25;

/// What may be left of a chord, as a part of the longest.
const EXACT: f64 = 1e-13;

/// How often nodes are put between others.
const ROUNDS: usize = 8;

/// The part of the tolerance that the B-spline takes.
const SPLINE: f64 = 0.4;

/// The coefficients of w on one span by the control points of three.
#[derive(Clone, Copy, Debug, Default)]
struct Mix {
    /// Of the span before and of this one in the first coefficient.
    first: [f64; 2],
    /// Of this span and of the next one in the last coefficient.
    last: [f64; 2],
}

/// The preimages w of the C2 PH spline through `points`, one for each span; `steps` are the spans' lengths of the parameter, by which r' is
/// taken; `ends` are w at both ends, and `start` holds a guess of z for each span. The coefficients are those of w over a parameter of 0..=1,
/// as [`PhQuintic`] has them. None where the numbers of points, steps and guesses do not fit, or Newton's method finds nothing.
pub fn spline(points: &[Plane], steps: &[f64], ends: [Plane; 2], start: &[Plane]) -> Option<Vec<[Plane; 3]>> {
    let count = steps.len();
    if count == 0 || points.len() != count + 1 || start.len() != count {
        return None;
    }
    let share = |a: f64, b: f64| a / (a + b);
    let mixes: Vec<Mix> = (0..count)
        .map(|i| {
            let neighbour = |k: Option<usize>| k.and_then(|k| steps.get(k)).copied();
            let before = neighbour(i.checked_sub(1));
            let first = before.map_or([0.0; 2], |h| [share(steps[i], h), share(h, steps[i])]);
            let last = neighbour(Some(i + 1)).map_or([0.0; 2], |h| [share(h, steps[i]), share(steps[i], h)]);
            Mix { first, last }
        })
        .collect();
    let mut z = start.to_vec();
    let longest = points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).fold(0.0, f64::max);
    let mut before = f64::INFINITY;
    let mut rows = vec![[Plane::ZERO; 3]; count];
    let mut left = vec![Plane::ZERO; count];
    for _ in 0..STEPS {
        let mut size = 0.0_f64;
        for i in 0..count {
            let [w0, w1, w2] = coefficients(&z, &mixes[i], i, ends);
            let scale = steps[i] / 15.0;
            let sum = w0 * w0 * 3.0 + w0 * w1 * 3.0 + w1 * w1 * 2.0 + w0 * w2 + w1 * w2 * 3.0 + w2 * w2 * 3.0;
            left[i] = sum * scale - (points[i + 1] - points[i]);
            size = size.max(left[i].norm());
            let by_first = (w0 * 6.0 + w1 * 3.0 + w2) * scale;
            let by_middle = (w0 * 3.0 + w1 * 4.0 + w2 * 3.0) * scale;
            let by_last = (w0 + w1 * 3.0 + w2 * 6.0) * scale;
            let Mix { first, last } = mixes[i];
            rows[i] = [by_first * first[0], by_first * first[1] + by_middle + by_last * last[0], by_last * last[1]];
        }
        if size.is_nan() {
            return None;
        }
        if size <= EXACT * longest || (size < 1e3 * EXACT * longest && size > 0.5 * before) {
            let of = |i: usize| coefficients(&z, &mixes[i], i, ends).map(|w| w * steps[i].sqrt());
            return Some((0..count).map(of).collect());
        }
        before = size;
        tridiagonal(&mut rows, &mut left)?;
        z.iter_mut().zip(&left).for_each(|(z, step)| *z = *z - *step);
    }
    None
}

fn coefficients(z: &[Plane], mix: &Mix, i: usize, ends: [Plane; 2]) -> [Plane; 3] {
    let first = i.checked_sub(1).map_or(ends[0], |before| z[before] * mix.first[0] + z[i] * mix.first[1]);
    let last = z.get(i + 1).map_or(ends[1], |next| z[i] * mix.last[0] + *next * mix.last[1]);
    [first, z[i], last]
}

/// Solves a tridiagonal system, whose solution takes the place of the right side. None where it is singular.
fn tridiagonal(rows: &mut [[Plane; 3]], right: &mut [Plane]) -> Option<()> {
    let inverse = |pivot: Plane| {
        let square = pivot.norm() * pivot.norm();
        (square > 0.0 && square.is_finite()).then(|| pivot.conj() * (1.0 / square))
    };
    let count = rows.len();
    for i in 1..count {
        let factor = rows[i][0] * inverse(rows[i - 1][1])?;
        rows[i][1] = rows[i][1] - factor * rows[i - 1][2];
        right[i] = right[i] - factor * right[i - 1];
    }
    for i in (0..count).rev() {
        let beyond = if i + 1 < count { rows[i][2] * right[i + 1] } else { Plane::ZERO };
        right[i] = (right[i] - beyond) * inverse(rows[i][1])?;
    }
    Some(())
}

/// Fits a run of at least two points with nodes on a B-spline through it, at first where every second span ends, and between those where the
/// tolerance does not hold. Where no such spline follows, and where the way goes straight up or down, the curves of [`ph::fit`] stay. The error is as
/// that of [`bspline::fit`].
pub(super) fn fit(line: &Polyline<'_>, first: usize, tolerance: f64, parts: &mut Vec<Part>) -> Result<(), usize> {
    let fitted = bspline::fit(line, SPLINE * tolerance)?;
    // A PH quintic follows farther than a cubic, and may be farther off: every second node may do.
    let lines = line.points.len() - 1;
    let found = [(2, fitted.spans.len().min(lines)), (1, lines)]
        .into_iter()
        .find_map(|(stride, most)| refined(line, &fitted, stride, most, tolerance));
    let Some((ways, curves)) = found else { return ph::fit(line, first, tolerance, parts) };
    let vertex = |way: f64| first + line.segment(way) + usize::from(way >= line.length());
    parts.extend(curves.into_iter().zip(ways.windows(2)).enumerate().map(|(k, ((curve, deviation), ends))| {
        let vertices = [vertex(ends[0]), vertex(ends[1])];
        Part { curve: Curve::Ph(curve), vertices, deviation, is_smooth: k > 0 }
    }));
    Ok(())
}

/// The ways of nodes, and the curves between them with their deviations.
type Refined = (Vec<f64>, Vec<(RisingPh, f64)>);

/// The spline with nodes where every so many spans end, and between those where the tolerance does not hold, with its deviations; and where its
/// nodes are. None where it would have more than `most` curves.
fn refined(line: &Polyline<'_>, fitted: &Fitted, stride: usize, most: usize, tolerance: f64) -> Option<Refined> {
    let mut ways: Vec<f64> = fitted.spans.iter().step_by(stride).map(|span| span.ends[0]).collect();
    ways.push(line.length());
    let mut scratch = Vec::new();
    for _ in 0..ROUNDS {
        if ways.len() - 1 > most {
            return None;
        }
        let measured = |(curve, ends): (RisingPh, &[f64])| {
            let bezier = curve.bezier();
            (curve, across(line, &Polynomial::new(&bezier), [ends[0], ends[1]], tolerance, &mut scratch))
        };
        let curves: Vec<(RisingPh, f64)> =
            through(fitted, &ways)?.into_iter().zip(ways.windows(2)).map(measured).collect();
        if curves.iter().all(|(_, deviation)| *deviation <= tolerance) {
            return Some((ways, curves));
        }
        let mut finer = Vec::with_capacity(2 * ways.len());
        for (ends, (_, deviation)) in ways.windows(2).zip(&curves) {
            finer.push(ends[0]);
            if deviation.is_nan() || *deviation > tolerance {
                finer.push(0.5 * (ends[0] + ends[1]));
            }
        }
        finer.push(line.length());
        ways = finer;
    }
    None
}

/// The spline whose nodes are on a B-spline, at these ways.
fn through(fitted: &Fitted, ways: &[f64]) -> Option<Vec<RisingPh>> {
    let nodes: Vec<Node> = ways.iter().map(|&way| Node::of(&fitted.at(way))).collect::<Option<_>>()?;
    let points: Vec<Plane> = nodes.iter().map(|node| node.point).collect();
    let steps: Vec<f64> = ways.windows(2).map(|ends| ends[1] - ends[0]).collect();
    // Roots of the derivative, each on the side of the one before it.
    let mut behind = Plane::ZERO;
    let mut root = |way: f64| {
        let Local { first: Vector([x, y, _]), .. } = fitted.at(way);
        let root = Complex::new(x, y).sqrt();
        behind = if behind.dot(root) < 0.0 { root * -1.0 } else { root };
        behind
    };
    let start = root(*ways.first()?);
    let middles: Vec<Plane> = ways.windows(2).map(|ends| root(0.5 * (ends[0] + ends[1]))).collect();
    let end = root(*ways.last()?);
    let preimages = spline(&points, &steps, [start, end], &middles)?;
    let curve = |(k, w): (usize, [Plane; 3])| {
        let plane = PhQuintic { start: points[k], w };
        RisingPh { plane, z: rise(&plane, &nodes[k], &nodes[k + 1]) }
    };
    Some(preimages.into_iter().enumerate().map(curve).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn complex([re, im]: [f64; 2]) -> Plane {
        Complex::new(re, im)
    }

    /// The published Hermite interpolant: its control points, and its length.
    #[test]
    fn one_span_is_the_published_interpolant() {
        let [p0, p1, p4, p5] = [[0.8, 1.4], [2.4, 0.8], [2.6, 4.2], [4.2, 3.6]].map(complex);
        let ends = [(p1 - p0) * 5.0, (p5 - p4) * 5.0].map(|d| d.sqrt());
        let w = spline(&[p0, p5], &[1.0], ends, &[(p5 - p0).sqrt()]).unwrap();
        let curve = PhQuintic { start: p0, w: w[0] };
        let points = curve.control_points();
        for (found, published) in [(points[2], [2.8377, 2.5140]), (points[3], [2.1623, 2.4860])] {
            assert!((found - complex(published)).norm() < 1e-4, "{found:?} {published:?}");
        }
        let length: f64 = curve.speed_coefficients().iter().sum::<f64>() / 5.0;
        assert!((length - 4.824_164).abs() < 1e-6, "{length}");
    }

    /// Points of a spiral, with spans that are even, and with spans that are not: the equation of the even ones as published, and two
    /// derivatives that go on at every node.
    #[test]
    fn two_derivatives_go_on() {
        for uneven in [0.0, 0.3] {
            let at = |t: f64| Complex::new((2.0 + t) * t.cos(), (2.0 + t) * t.sin());
            let slope = |t: f64| Complex::new(t.cos() - (2.0 + t) * t.sin(), t.sin() + (2.0 + t) * t.cos());
            let times: Vec<f64> = (0..=12).map(|k| 0.4 * (f64::from(k) + uneven * f64::from(k % 3))).collect();
            let points: Vec<Plane> = times.iter().map(|&t| at(t)).collect();
            let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let mut behind = slope(0.0).sqrt();
            let mut root = |t: f64| {
                let root = slope(t).sqrt();
                behind = if behind.dot(root) < 0.0 { root * -1.0 } else { root };
                behind
            };
            let first = root(0.0);
            let middles: Vec<Plane> = times.windows(2).map(|pair| root(0.5 * (pair[0] + pair[1]))).collect();
            let last = root(times[12]);
            let found = spline(&points, &steps, [first, last], &middles).unwrap();
            for (k, w) in found.iter().enumerate() {
                let end = PhQuintic { start: points[k], w: *w }.control_points()[5];
                assert!((end - points[k + 1]).norm() < 1e-12);
            }
            for (k, pair) in found.windows(2).enumerate() {
                // By the parameter: r' = w^2 / h, r'' = 2 w w' / h^2.
                let end = |w: &[Plane; 3], h: f64| [w[2] * w[2] * (1.0 / h), w[2] * (w[2] - w[1]) * (4.0 / (h * h))];
                let start = |w: &[Plane; 3], h: f64| [w[0] * w[0] * (1.0 / h), w[0] * (w[1] - w[0]) * (4.0 / (h * h))];
                for (a, b) in end(&pair[0], steps[k]).into_iter().zip(start(&pair[1], steps[k + 1])) {
                    assert!((a - b).norm() < 1e-9 * a.norm(), "{a:?} {b:?}");
                }
            }
            if uneven == 0.0 {
                let scale = 1.0 / steps[0].sqrt();
                for i in 1..11 {
                    let [a, b, c] = [i - 1, i, i + 1].map(|k| found[k][1] * scale);
                    let sum = a * a * 3.0 + b * b * 27.0 + c * c * 3.0 + a * c + a * b * 13.0 + b * c * 13.0;
                    let wanted = (points[i + 1] - points[i]) * (60.0 / steps[0]);
                    assert!((sum - wanted).norm() < 1e-9 * wanted.norm());
                }
            }
        }
    }
}

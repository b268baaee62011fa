//! The distance of a point from an offset path, to rounding.
//!
//! A curve and its offset have their normals in common, so the feet of q on a piece at the distance d lie over the feet of q
//! on its segment, nearest and farthest ones alike: all zeros of Re((r - q) conj(r')), degree 9 on a PH quintic. Its Bernstein
//! coefficients isolate them.

use shared::complex::Complex;
use shared::curve::{Arc, Curve as _, Line, PhQuintic, Segment};

use super::nearest::{Bounds, halves, on_arc, on_line};

/// Intervals below this width are not halved any more: what is left in them is one zero, or a pair that touches.
const NARROW: f64 = 1e-9;
/// Parts of a piece in whose lengths its box is reckoned.
const PARTS: u32 = 8;

/// Answers how far a point is from a path.
#[derive(Debug)]
pub(super) struct PathDistance {
    pieces: Vec<Part>,
}

#[derive(Debug)]
struct Part {
    /// The piece's segment, cut to its interval.
    segment: Segment<f64>,
    offset: f64,
    bounds: Bounds,
}

impl PathDistance {
    /// Of the path of `pieces`: carrier, parameter interval, distance from the carrier.
    pub(super) fn new(pieces: impl IntoIterator<Item = (Segment<f64>, [f64; 2], f64)>) -> Self {
        let pieces = pieces
            .into_iter()
            .map(|(segment, interval, offset)| {
                let segment = part(&segment, interval);
                Part { segment, offset, bounds: bounds(&segment, offset) }
            })
            .collect();
        Self { pieces }
    }

    /// The distance of `q` from the nearest point of the path, in mm; infinite where there is no path.
    pub(super) fn at(&self, q: Complex<f64>) -> f64 {
        let mut best = f64::INFINITY;
        for Part { segment, offset, .. } in &self.pieces {
            best = best.min((segment.offset_point(0.0, *offset) - q).norm());
        }
        for Part { segment, offset, bounds } in &self.pieces {
            if bounds.distance_sqr(q) >= best * best {
                continue;
            }
            let mut offer = |xi: f64| {
                best = best.min((segment.offset_point(xi, *offset) - q).norm());
                best
            };
            offer(1.0);
            match segment {
                Segment::Line(line) => {
                    offer(on_line(line, q));
                }
                Segment::Arc(arc) => {
                    for xi in on_arc(arc, q) {
                        offer(xi);
                    }
                }
                Segment::Ph(curve) => on_ph(curve, *offset, q, &mut offer),
            }
        }
        best
    }
}

/// The part of a segment over an interval, as a segment of its own.
fn part(segment: &Segment<f64>, [from, to]: [f64; 2]) -> Segment<f64> {
    match segment {
        Segment::Line(_) => Segment::Line(Line { start: segment.point(from), end: segment.point(to) }),
        Segment::Arc(arc) => {
            let start = arc.point(from);
            let sweep = arc.sweep * (to - from);
            let radius = arc.derivative(from).right() * (1.0 / arc.sweep);
            Segment::Arc(Arc { start, radius, sweep })
        }
        Segment::Ph(curve) => Segment::Ph(ph_part(curve, from, to)),
    }
}

/// The part of a PH quintic over an interval: its preimage is the blossom's values there, times the root of the width.
fn ph_part(curve: &PhQuintic<f64>, from: f64, to: f64) -> PhQuintic<f64> {
    let [w0, w1, w2] = curve.w;
    let blossom = |a: f64, b: f64| w0 * ((1.0 - a) * (1.0 - b)) + w1 * (a * (1.0 - b) + b * (1.0 - a)) + w2 * (a * b);
    let root = (to - from).max(0.0).sqrt();
    PhQuintic { start: curve.point(from), w: [(from, from), (from, to), (to, to)].map(|(a, b)| blossom(a, b) * root) }
}

/// A box around the offset of a whole segment: between two of its points a curve leaves their box by less than half its length.
fn bounds(segment: &Segment<f64>, offset: f64) -> Bounds {
    let points = (0..=PARTS).map(|k| segment.offset_point(f64::from(k) / f64::from(PARTS), offset));
    let longest = (0..PARTS).map(|k| {
        let [from, to] = [k, k + 1].map(|k| f64::from(k) / f64::from(PARTS));
        let turn = match segment {
            Segment::Line(_) => 0.0,
            Segment::Arc(arc) => arc.sweep.abs() / f64::from(PARTS),
            Segment::Ph(curve) => {
                // The control polygon of a preimage turns by no less than the preimage.
                let [a, b, c] = ph_part(curve, from, to).w;
                2.0 * ((a.conj() * b).arg().abs() + (b.conj() * c).arg().abs())
            }
        };
        segment.length_to(to) - segment.length_to(from) + offset.abs() * turn
    });
    Bounds::around(points).grown(0.5 * longest.fold(0.0, f64::max))
}

/// Offers every foot of `q` on a whole PH quintic that can carry a point of its offset nearer than the best one.
fn on_ph(curve: &PhQuintic<f64>, offset: f64, q: Complex<f64>, offer: &mut impl FnMut(f64) -> f64) {
    let slope = |xi: f64| (curve.point(xi) - q).dot(curve.derivative(xi));
    let mut best = offer(0.0);
    let mut stack = vec![(super::nearest::squared_distance(&curve.control_points().map(|r| r - q)), 0.0, 1.0)];
    while let Some((d, from, to)) = stack.pop() {
        let low = d.iter().copied().fold(f64::INFINITY, f64::min).max(0.0).sqrt();
        if low - offset.abs() >= best {
            continue;
        }
        // Signs of the derivative's coefficients.
        let signs = d.windows(2).map(|w| w[1] > w[0]);
        let changes = signs.clone().zip(signs.skip(1)).filter(|(a, b)| a != b).count();
        if changes == 0 {
            // No zero inside, and the ends of the interval have been offered.
            continue;
        }
        if to - from < NARROW {
            best = best.min(offer(0.5 * (from + to)));
            continue;
        }
        if changes == 1 {
            best = best.min(offer(zero(&slope, from, to)));
            continue;
        }
        let middle = 0.5 * (from + to);
        let (left, right) = halves(d);
        best = best.min(offer(middle));
        stack.push((left, from, middle));
        stack.push((right, middle, to));
    }
}

/// The zero of `f` where it changes its sign between `low` and `high`, by regula falsi in its Illinois form.
fn zero(f: &impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let [mut at_low, mut at_high] = [f(low), f(high)];
    if (at_low > 0.0) == (at_high > 0.0) {
        // The change is lost in rounding: it is at an end.
        return if at_low.abs() < at_high.abs() { low } else { high };
    }
    let mut last_side = 0;
    for _ in 0..100 {
        let xi = (low * at_high - high * at_low) / (at_high - at_low);
        let value = f(xi);
        if value == 0.0 || high - low < 1e-13 {
            return xi;
        }
        if (value > 0.0) == (at_high > 0.0) {
            (high, at_high) = (xi, value);
            at_low *= if last_side == 1 { 0.5 } else { 1.0 };
            last_side = 1;
        } else {
            (low, at_low) = (xi, value);
            at_high *= if last_side == -1 { 0.5 } else { 1.0 };
            last_side = -1;
        }
    }
    0.5 * (low + high)
}

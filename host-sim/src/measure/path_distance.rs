//! The distance of a point from an offset path, to rounding.
//!
//! A curve and its offset have their normals in common, so the feet of q on a piece at the distance d lie over the feet of q
//! on its segment, nearest and farthest ones alike: all zeros of Re((r - q) conj(r')), degree 9 on a PH quintic. Its Bernstein
//! coefficients isolate them. The tip of a cusp of the offset may be nearest as well; no trimmed piece has one inside.

use shared::complex::Complex;
use shared::curve::{Arc, Curve as _, Line, PhQuintic, Segment};

use super::bounds::{Bounds, Tree};
use super::nearest::{halves, on_arc, on_line};
use super::quintic::Quintic;

/// Intervals below this width are not halved any more: what is left in them is one zero, or a pair that touches.
const NARROW: f64 = 1e-9;
/// Parts of a piece in whose lengths its box is reckoned.
const PARTS: u32 = 8;

/// Answers how far a point is from a path.
#[derive(Debug)]
pub(super) struct PathDistance {
    pieces: Vec<Part>,
    tree: Tree,
}

#[derive(Debug)]
struct Part {
    /// The piece's segment, cut to its interval.
    segment: Segment<f64>,
    offset: f64,
    /// Where the offset has cusps.
    cusps: Vec<f64>,
}

impl PathDistance {
    /// Of the path of `pieces`: carrier, parameter interval, distance from the carrier.
    pub(super) fn new(pieces: impl IntoIterator<Item = (Segment<f64>, [f64; 2], f64)>) -> Self {
        let pieces: Vec<_> = pieces
            .into_iter()
            .map(|(segment, interval, offset)| {
                let segment = part(&segment, interval);
                Part { segment, offset, cusps: cusps(&segment, offset) }
            })
            .collect();
        let tree = Tree::new(pieces.iter().map(|part| bounds(&part.segment, part.offset)));
        Self { pieces, tree }
    }

    /// The distance of `q` from the nearest point of the path, in mm; infinite where there is no path.
    pub(super) fn at(&self, q: Complex<f64>) -> f64 {
        let mut best = f64::INFINITY;
        self.tree.visit(q, best, |number| {
            if let Some(part) = self.pieces.get(number) {
                part.improve(&mut best, q);
            }
            best
        });
        best
    }
}

impl Part {
    /// Puts the distance of `q` from this part in the place of `best`, if it is less.
    fn improve(&self, best: &mut f64, q: Complex<f64>) {
        let Self { segment, offset, cusps } = self;
        let mut offer = |xi: f64| {
            *best = best.min((segment.offset_point(xi, *offset) - q).norm());
            *best
        };
        offer(0.0);
        offer(1.0);
        for xi in cusps {
            offer(*xi);
        }
        match segment {
            Segment::Line(line) => {
                offer(on_line(line, q));
            }
            Segment::Arc(arc) => {
                for xi in on_arc(arc, q) {
                    offer(xi);
                }
            }
            Segment::Ph(curve) => on_quintic(curve, *offset, q, &mut offer),
            Segment::Spline(curve) => on_quintic(curve, *offset, q, &mut offer),
        }
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
        Segment::Spline(curve) => Segment::Spline(curve.part(from, to)),
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
            // A spline has no offset.
            Segment::Line(_) | Segment::Spline(_) => 0.0,
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

/// Where 1 + kappa d changes its sign along a segment.
fn cusps(segment: &Segment<f64>, offset: f64) -> Vec<f64> {
    /// Places where the sign is asked; two cusps between neighbours are so close that neither is much nearer than they are.
    const PLACES: u32 = 256;
    if !matches!(segment, Segment::Ph(_)) || offset == 0.0 {
        return Vec::new();
    }
    let stretch = |xi: f64| 1.0 + segment.curvature(xi) * offset;
    let places = (0..PLACES).map(|k| [k, k + 1].map(|k| f64::from(k) / f64::from(PLACES)));
    let changes = places.filter(|[from, to]| (stretch(*from) > 0.0) != (stretch(*to) > 0.0));
    changes.map(|[from, to]| zero(&stretch, from, to)).collect()
}

/// Offers every foot of `q` on a whole quintic that can carry a point of its offset nearer than the best one.
fn on_quintic(curve: &impl Quintic, offset: f64, q: Complex<f64>, offer: &mut impl FnMut(f64) -> f64) {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64) -> Complex<f64> {
        Complex::new(x, y)
    }

    /// Parts of a bent PH curve, an arc and a line at distances to both sides, with and without cusps of the offset, against
    /// 20 000 points of each.
    #[test]
    fn no_sample_of_a_piece_is_nearer() {
        let segments = [
            Segment::Ph(PhQuintic { start: at(-3.0, 1.0), w: [at(3.0, -2.0), at(-1.0, 2.5), at(4.0, 1.0)] }),
            Segment::Arc(Arc { start: at(5.0, 1.0), radius: at(3.0, 0.0), sweep: -4.0 }),
            Segment::Line(Line { start: at(1.0, 1.0), end: at(9.0, 5.0) }),
        ];
        for segment in segments {
            for (interval, offset) in [([0.0, 1.0], 0.0), ([0.1, 0.9], 0.7), ([0.0, 0.6], -2.0), ([0.3, 1.0], 6.0)] {
                let path = PathDistance::new([(segment, interval, offset)]);
                let [from, to] = interval;
                let sample = |k: u32| segment.offset_point(from + (to - from) * f64::from(k) / 2e4, offset);
                let samples: Vec<_> = (0..=20_000).map(sample).collect();
                let spacing = samples.windows(2).map(|pair| (pair[1] - pair[0]).norm()).fold(0.0, f64::max);
                for k in 0..100 {
                    let q = at(-12.0 + f64::from(k % 10) * 3.1, -12.0 + f64::from(k / 10) * 2.7);
                    let brute = samples.iter().map(|p| (*p - q).norm()).fold(f64::INFINITY, f64::min);
                    let found = path.at(q);
                    assert!(found <= brute + 1e-13 && found >= brute - spacing, "{q:?}: {found} beside {brute}");
                }
            }
        }
    }
}

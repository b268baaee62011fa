//! Whether a contour crosses itself, decided without sampling.
//!
//! From each point of a curve whose tangent turns by no more than t in all, the ends are seen at an angle of at least pi - t. So
//! the curve stays within a lens about its chord, whose sides leave the ends at t to the chord and which is chord tan(t/2)/2
//! high on either side. Two parts are apart when their chords are farther apart than both heights, and parts that share an end
//! meet nowhere else when the chords form an angle there that is larger than both turns. What cannot be decided is halved.

use shared::complex::Complex;
use shared::curve::{Curve as _, Segment};

use host_sim::contour::Contour;

/// Halvings of a segment after which two parts are taken to meet.
const DEPTH: u32 = 44;
/// The largest turn of a part whose lens is used.
const TURN: f64 = 1.0;

/// A part of a segment.
#[derive(Clone, Copy)]
struct Part<'a> {
    segment: &'a Segment<f64>,
    number: usize,
    from: f64,
    to: f64,
    start: Complex<f64>,
    end: Complex<f64>,
    /// A bound of how much the tangent turns in all.
    turn: f64,
    depth: u32,
}

impl<'a> Part<'a> {
    fn new(segment: &'a Segment<f64>, number: usize, from: f64, to: f64, depth: u32) -> Self {
        let turn = match segment {
            Segment::Line(_) => 0.0,
            Segment::Arc(arc) => arc.sweep.abs() * (to - from),
            // No bound is known, and none of these contours has one.
            Segment::Spline(_) => f64::INFINITY,
            Segment::Ph(curve) => {
                // The control polygon of a preimage turns by no less than the preimage.
                let [w0, w1, w2] = curve.w;
                let blossom =
                    |a: f64, b: f64| w0 * ((1.0 - a) * (1.0 - b)) + w1 * (a * (1.0 - b) + b * (1.0 - a)) + w2 * (a * b);
                let [a, b, c] = [blossom(from, from), blossom(from, to), blossom(to, to)];
                2.0 * ((a.conj() * b).arg().abs() + (b.conj() * c).arg().abs())
            }
        };
        Self { segment, number, from, to, start: segment.point(from), end: segment.point(to), turn, depth }
    }

    fn halves(self) -> [Self; 2] {
        let middle = 0.5 * (self.from + self.to);
        [(self.from, middle), (middle, self.to)]
            .map(|(from, to)| Self::new(self.segment, self.number, from, to, self.depth + 1))
    }

    fn height(&self) -> f64 {
        0.5 * (self.end - self.start).norm() * (0.5 * self.turn).tan()
    }
}

/// Two segments of `contour` that cross or touch outside their common node, or come so close that it cannot be told; none if
/// it is simple.
pub fn crossing(contour: &Contour) -> Option<[usize; 2]> {
    let count = contour.segments.len();
    let mut parts: Vec<Part> = Vec::new();
    for (number, segment) in contour.segments.iter().enumerate() {
        split(Part::new(segment, number, 0.0, 1.0, 0), &mut parts);
    }
    let last = parts.len() - 1;
    for (i, a) in parts.iter().enumerate() {
        for (j, b) in parts.iter().enumerate().skip(i + 1) {
            let follows = j == i + 1;
            let precedes = contour.closed && i == 0 && j == last;
            let met = if follows && precedes {
                // Two parts that are all of a closed contour share both ends: their halves share one.
                a.halves().into_iter().zip(b.halves()).any(|(p, q)| meet(p, q, false, false))
            } else {
                meet(*a, *b, follows, precedes)
            };
            if met {
                return Some([a.number, b.number]);
            }
        }
    }
    // A closed chain of fewer than three parts was not told apart from one that runs back on itself.
    (count == 0 || (contour.closed && last < 2)).then_some([0, 0])
}

/// Splits a segment into parts that have lenses.
fn split<'a>(part: Part<'a>, parts: &mut Vec<Part<'a>>) {
    if part.turn < TURN || part.depth >= DEPTH {
        parts.push(part);
    } else {
        part.halves().into_iter().for_each(|half| split(half, parts));
    }
}

/// Whether two parts meet; `follows` if b begins at a's end, `precedes` if b ends at a's start.
fn meet(a: Part<'_>, b: Part<'_>, follows: bool, precedes: bool) -> bool {
    if follows || precedes {
        let [here, there] =
            if follows { [a.start - a.end, b.end - b.start] } else { [a.end - a.start, b.start - b.end] };
        let angle = (here.conj() * there).arg().abs();
        if angle > a.turn + b.turn {
            return false;
        }
    } else if apart([a.start, a.end], [b.start, b.end]) > a.height() + b.height() {
        return false;
    }
    if a.depth >= DEPTH || b.depth >= DEPTH {
        return true;
    }
    let ([a0, a1], [b0, b1]) = (a.halves(), b.halves());
    if follows {
        meet(a1, b0, true, false)
            || meet(a0, b0, false, false)
            || meet(a0, b1, false, false)
            || meet(a1, b1, false, false)
    } else if precedes {
        meet(a0, b1, false, true)
            || meet(a0, b0, false, false)
            || meet(a1, b0, false, false)
            || meet(a1, b1, false, false)
    } else if a.height() + b.height() == 0.0 {
        true
    } else {
        [a0, a1].into_iter().any(|p| [b0, b1].into_iter().any(|q| meet(p, q, false, false)))
    }
}

/// The distance of two straight edges; 0 if they cross.
fn apart(a: [Complex<f64>; 2], b: [Complex<f64>; 2]) -> f64 {
    let side = |[p, q]: [Complex<f64>; 2], r: Complex<f64>| (q - p).cross(r - p);
    let crosses = side(a, b[0]) * side(a, b[1]) < 0.0 && side(b, a[0]) * side(b, a[1]) < 0.0;
    if crosses {
        return 0.0;
    }
    let to = |[p, q]: [Complex<f64>; 2], r: Complex<f64>| {
        let t = ((r - p).dot(q - p) / (q - p).norm_sqr()).clamp(0.0, 1.0);
        (r - (p + (q - p) * t)).norm()
    };
    to(a, b[0]).min(to(a, b[1])).min(to(b, a[0])).min(to(b, a[1]))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use shared::curve::hermite_candidates;

    use super::*;
    use crate::chain::Chain;

    fn square() -> Chain {
        Chain::at(Complex::ZERO).line(Complex::new(1.0, 0.0)).line(Complex::new(1.0, 1.0)).line(Complex::new(0.0, 1.0))
    }

    #[test]
    fn simple_contours_are_simple() {
        assert_eq!(crossing(&square().close()), None);
        assert_eq!(crossing(&square().open()), None);
        let disc = Chain::at(Complex::new(1.0, 0.0)).turn(Complex::ZERO, 2.0 * PI).closed_as_it_is();
        assert_eq!(crossing(&disc), None);
        let slot = Chain::at(Complex::ZERO)
            .line(Complex::new(9.0, 0.0))
            .turn(Complex::new(9.0, 0.5), PI)
            .line(Complex::new(0.0, 1.0))
            .turn(Complex::new(0.0, 0.5), PI)
            .closed_as_it_is();
        assert_eq!(crossing(&slot), None);
    }

    #[test]
    fn crossings_are_found() {
        let bow = Chain::at(Complex::ZERO)
            .line(Complex::new(1.0, 1.0))
            .line(Complex::new(1.0, 0.0))
            .line(Complex::new(0.0, 1.0))
            .close();
        assert!(crossing(&bow).is_some());
        // Of the four Hermite curves of symmetric data the one that turns least is an arch, the others have loops.
        let d = Complex::new(3.0, 4.0);
        let curves = hermite_candidates(Complex::ZERO, Complex::new(4.0, 0.0), d, d.conj());
        let crosses = |curve| crossing(&Contour { segments: vec![Segment::Ph(curve)], closed: false }).is_some();
        for curve in curves {
            assert_eq!(crosses(curve), curve.absolute_rotation() > 1.0);
        }
        // An arc that dips 1e-9 through a line.
        let touch = |dip: f64| {
            Chain::at(Complex::ZERO)
                .line(Complex::new(4.0, 0.0))
                .line(Complex::new(4.0, 1.0 - dip))
                .line(Complex::new(3.0, 1.0 - dip))
                .turn(Complex::new(2.0, 1.0 - dip), -PI)
                .line(Complex::new(0.0, 1.0 - dip))
                .close()
        };
        assert!(crossing(&touch(1e-9)).is_some());
        assert_eq!(crossing(&touch(-1e-9)), None);
    }
}

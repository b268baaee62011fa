//! The nearest point of a contour, to rounding.
//!
//! A line and an arc have it in closed form. On a PH quintic the squared distance from p is a polynomial of degree 10; its
//! Bernstein coefficients bound it from below on any interval, so intervals that cannot hold the minimum are dropped and the
//! others halved until the polynomial is convex there. Newton's method on Re((p - r) conj(r')) = 0 then finds the foot point,
//! and the distance is measured to the point itself: it is good to a few roundoffs of the contour's size, as an error of the
//! foot point counts in second order only. No sample density has to be trusted.

use std::f64::consts::TAU;

use shared::complex::Complex;
use shared::curve::{Arc, Curve as _, Line, Segment};

use super::bounds::{Bounds, Tree};
use super::quintic::Quintic;
use crate::contour::Contour;

/// What sums of squares may be wrong by, relative to the largest term.
const SLACK: f64 = 64.0 * f64::EPSILON;
/// Parameter intervals below this width are not halved any more: less than a roundoff of distance is left to gain.
const NARROW: f64 = 1e-9;
/// Halvings of a bracket, and Newton steps, before it is as narrow as numbers are.
const STEPS: u32 = 80;

/// A nearest point of a contour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// How far it is, in mm.
    pub distance: f64,
    /// The segment that holds it.
    pub segment: usize,
    /// Its parameter there.
    pub xi: f64,
    /// The point, in mm.
    pub point: Complex<f64>,
}

/// Answers which point of a contour is nearest to a given one.
#[derive(Debug)]
pub struct Nearest<'a> {
    contour: &'a Contour,
    tree: Tree,
}

impl<'a> Nearest<'a> {
    /// For `contour`.
    pub fn new(contour: &'a Contour) -> Self {
        Self { contour, tree: Tree::new(contour.segments.iter().map(Bounds::of)) }
    }

    /// The diagonal of a box around the contour, in mm; not the tightest box.
    pub fn size(&self) -> f64 {
        self.tree.size()
    }

    /// The point nearest to `p`; of a contour without segments, one infinitely far away.
    pub fn at(&self, p: Complex<f64>) -> Foot {
        let mut best = Foot { distance: f64::INFINITY, segment: 0, xi: 0.0, point: p };
        self.tree.visit(p, best.distance, |segment| {
            self.improve(&mut best, segment, p);
            best.distance
        });
        best
    }

    /// Whether a segment other than those `left_out` comes nearer to `p` than `distance`.
    pub(super) fn any_within(&self, p: Complex<f64>, distance: f64, left_out: [usize; 2]) -> bool {
        let mut best = Foot { distance, segment: 0, xi: 0.0, point: p };
        self.tree.visit(p, distance, |segment| {
            if !left_out.contains(&segment) {
                self.improve(&mut best, segment, p);
            }
            // One is enough.
            if best.distance < distance { 0.0 } else { distance }
        });
        best.distance < distance
    }

    /// Puts the nearest point of a segment in the place of `best`, if it is nearer to `p`.
    fn improve(&self, best: &mut Foot, segment: usize, p: Complex<f64>) {
        let Some(curve) = self.contour.segments.get(segment) else { return };
        let mut offer = |xi: f64| {
            let point = curve.point(xi);
            let distance = (point - p).norm();
            if distance < best.distance {
                *best = Foot { distance, segment, xi, point };
            }
            best.distance
        };
        match curve {
            Segment::Line(line) => {
                offer(on_line(line, p));
            }
            Segment::Arc(arc) => {
                for xi in on_arc(arc, p) {
                    offer(xi);
                }
            }
            Segment::Ph(curve) => {
                offer(0.0);
                on_quintic(curve, p, &mut offer);
            }
            Segment::Spline(curve) => {
                offer(0.0);
                on_quintic(curve, p, &mut offer);
            }
        }
    }
}

/// The parameter on a line nearest to `p`.
pub(super) fn on_line(line: &Line<f64>, p: Complex<f64>) -> f64 {
    let chord = line.end - line.start;
    let square = chord.norm_sqr();
    // A line along which only z moves is one point.
    if square > 0.0 { (chord.dot(p - line.start) / square).clamp(0.0, 1.0) } else { 0.0 }
}

/// Parameters on an arc, of which one is nearest to `p`: where p lies towards or opposite, and both ends.
pub(super) fn on_arc(arc: &Arc<f64>, p: Complex<f64>) -> [f64; 6] {
    // The angle of p seen from the centre, written without the centre, which may be far away.
    let apart = p - arc.start;
    let angle = arc.radius.cross(apart).atan2(arc.radius.norm_sqr() + arc.radius.dot(apart));
    let within = |angle: f64| (angle / arc.sweep).clamp(0.0, 1.0);
    let opposite = if angle > 0.0 { angle - TAU / 2.0 } else { angle + TAU / 2.0 };
    let second = |angle: f64| if arc.sweep > 0.0 { (angle + TAU) % TAU } else { (angle - TAU) % TAU };
    [0.0, 1.0, within(angle), within(second(angle)), within(second(opposite)), within(opposite)]
}

/// Offers foot points of `p` on a quintic, the nearest one among them. `offer` takes a parameter and gives the smallest
/// distance so far.
fn on_quintic(curve: &impl Quintic, p: Complex<f64>, offer: &mut impl FnMut(f64) -> f64) {
    let mut best = offer(1.0);
    let coefficients = squared_distance(&curve.control_points().map(|q| q - p));
    let slack = SLACK * coefficients.iter().copied().fold(0.0, f64::max);
    let mut stack = vec![(coefficients, 0.0, 1.0)];
    while let Some((d, from, to)) = stack.pop() {
        let (low, high) = d.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), &x| (l.min(x), h.max(x)));
        if low - slack >= best * best {
            continue;
        }
        let convex = d.windows(3).all(|w| w[0] + w[2] >= 2.0 * w[1]);
        if convex || high - low <= slack || to - from < NARROW {
            best = best.min(offer(foot(curve, p, from, to)));
            continue;
        }
        let middle = 0.5 * (from + to);
        let (left, right) = halves(d);
        best = best.min(offer(middle));
        stack.push((left, from, middle));
        stack.push((right, middle, to));
    }
}

/// Bernstein coefficients of |r - p|^2 from the control points of r - p.
pub(super) fn squared_distance(points: &[Complex<f64>; 6]) -> [f64; 11] {
    const FIVE: [f64; 6] = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
    const TEN: [f64; 11] = [1.0, 10.0, 45.0, 120.0, 210.0, 252.0, 210.0, 120.0, 45.0, 10.0, 1.0];
    let mut product = [0.0; 11];
    for (i, a) in points.iter().enumerate() {
        for (j, b) in points.iter().enumerate() {
            product[i + j] += FIVE[i] * FIVE[j] * a.dot(*b);
        }
    }
    for (value, binomial) in product.iter_mut().zip(TEN) {
        *value /= binomial;
    }
    product
}

/// Bernstein coefficients on both halves.
pub(super) fn halves<const N: usize>(mut d: [f64; N]) -> ([f64; N], [f64; N]) {
    let mut left = d;
    for (k, slot) in left.iter_mut().enumerate().skip(1) {
        for j in 0..N - k {
            d[j] = 0.5 * (d[j] + d[j + 1]);
        }
        *slot = d[0];
    }
    (left, d)
}

/// The foot point of `p` within `from..to`, where the squared distance has one minimum: Newton's method, kept in a bracket.
pub(super) fn foot(curve: &impl Quintic, p: Complex<f64>, from: f64, to: f64) -> f64 {
    let slope = |xi: f64| {
        let [tangent, bend] = curve.two_derivatives(xi);
        let apart = curve.point(xi) - p;
        (apart.dot(tangent), tangent.norm_sqr() + apart.dot(bend))
    };
    if slope(from).0 >= 0.0 {
        return from;
    }
    if slope(to).0 <= 0.0 {
        return to;
    }
    let [mut low, mut high] = [from, to];
    let mut xi = 0.5 * (from + to);
    for _ in 0..STEPS {
        let (value, rise) = slope(xi);
        if value < 0.0 {
            low = xi;
        } else {
            high = xi;
        }
        let newton = xi - value / rise;
        // A step that rounding makes nothing of leads back to an end of the bracket: that is the zero.
        let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
        let step = (next - xi).abs();
        xi = next;
        // Newton's error is about the square of its last step.
        if step < 1e-9 {
            break;
        }
    }
    xi
}

#[cfg(test)]
mod tests {
    use shared::curve::PhQuintic;

    use super::*;

    fn at(x: f64, y: f64) -> Complex<f64> {
        Complex::new(x, y)
    }

    fn contour(segment: Segment<f64>) -> Contour {
        Contour { segments: vec![segment], closed: false }
    }

    #[test]
    fn a_line_has_feet_and_ends() {
        let line = contour(Segment::Line(Line { start: at(1.0, 1.0), end: at(4.0, 5.0) }));
        let nearest = Nearest::new(&line);
        // 2 to the left of the point 3 along; behind the end.
        let foot = nearest.at(at(1.0, 1.0) + at(0.6, 0.8) * 3.0 + at(-0.8, 0.6) * 2.0);
        assert!((foot.distance - 2.0).abs() < 1e-15 && (foot.xi - 0.6).abs() < 1e-15);
        assert_eq!(nearest.at(at(7.0, 9.0)), Foot { distance: 5.0, segment: 0, xi: 1.0, point: at(4.0, 5.0) });
        assert_eq!(nearest.at(at(1.0, 0.0)).distance, 1.0);
    }

    /// An arc of three quarters, from the right anticlockwise to the bottom, and the same one travelled back.
    #[test]
    fn an_arc_has_feet_and_ends() {
        let forth = Arc { start: at(5.0, 1.0), radius: at(3.0, 0.0), sweep: 0.75 * TAU };
        let back = Arc { start: at(2.0, -2.0), radius: at(0.0, -3.0), sweep: -0.75 * TAU };
        for arc in [forth, back] {
            let arc = contour(Segment::Arc(arc));
            let nearest = Nearest::new(&arc);
            for angle in [0.1, 1.0, 3.0, 4.5] {
                let out = at(f64::cos(angle), f64::sin(angle));
                for radius in [1e-3, 1.0, 2.9, 3.1, 40.0] {
                    let foot = nearest.at(at(2.0, 1.0) + out * radius);
                    assert!((foot.distance - (3.0 - radius).abs()).abs() < 1e-14, "{angle} {radius} {foot:?}");
                }
            }
            // In the quarter that is left out the nearer end counts.
            assert!((nearest.at(at(6.0, 0.0)).distance - 2.0_f64.sqrt()).abs() < 1e-14);
            assert!((nearest.at(at(3.0, -3.0)).distance - 2.0_f64.sqrt()).abs() < 1e-14);
        }
    }

    /// An arc of 1e9 mm radius over a chord of 100 mm is 1.25 um high in its middle.
    #[test]
    fn a_nearly_straight_arc_keeps_its_digits() {
        let sweep = 1e-7;
        // The radius leaves the start at half the sweep to the normal of the chord.
        let radius = at(f64::sin(-0.5 * sweep), -f64::cos(-0.5 * sweep)) * 1e9;
        let arc = contour(Segment::Arc(Arc { start: at(0.0, 0.0), radius, sweep }));
        let nearest = Nearest::new(&arc);
        let sagitta = 1e9 * 2.0 * f64::sin(0.25 * sweep).powi(2);
        let foot = nearest.at(at(50.0, 7.0));
        assert!((foot.distance - (7.0 + sagitta)).abs() < 1e-12, "{}", foot.distance - 7.0);
    }

    /// On curves with a bend, a loop and a near cusp, against 20 000 points of each: no point is nearer than the nearest one,
    /// and the nearest of them is farther by no more than their spacing allows.
    #[test]
    fn no_sample_of_a_ph_curve_is_nearer() {
        let w = [
            [at(3.0, -2.0), at(-1.0, 2.5), at(4.0, 1.0)],
            [at(1.0, -4.0), at(1.0, 0.0), at(1.0, 4.0)],
            [at(2.0, 0.0), at(-2.001, 0.01), at(2.0, 0.02)],
            [at(5.0, 0.0), at(5.0, 0.0), at(5.0, 0.0)],
        ];
        for w in w {
            let curve = PhQuintic { start: at(-3.0, 1.0), w };
            let samples: Vec<_> = (0..=20_000).map(|k| curve.point(f64::from(k) / 20_000.0)).collect();
            let spacing = samples.windows(2).map(|pair| (pair[1] - pair[0]).norm()).fold(0.0, f64::max);
            let bent = contour(Segment::Ph(curve));
            let nearest = Nearest::new(&bent);
            for k in 0..400 {
                let p = at(-12.0 + f64::from(k % 20) * 1.7, -12.0 + f64::from(k / 20) * 1.3);
                let brute = samples.iter().map(|q| (*q - p).norm()).fold(f64::INFINITY, f64::min);
                let foot = nearest.at(p);
                assert!(foot.distance <= brute + 1e-14, "{p:?}: {} beside {brute}", foot.distance);
                assert!(foot.distance >= brute - spacing, "{p:?}: {} beside {brute}", foot.distance);
                assert_eq!((foot.point - p).norm(), foot.distance);
                assert_eq!(curve.point(foot.xi), foot.point);
                // Nor are its neighbours at a thousandth of that spacing.
                for xi in [foot.xi - 5e-8, foot.xi + 5e-8] {
                    assert!((curve.point(xi.clamp(0.0, 1.0)) - p).norm() >= foot.distance - 1e-14, "{p:?}");
                }
            }
        }
    }

    /// From the centre of a curve's osculating circle all of its neighbourhood is equally far to third order: the hardest place
    /// for a search by samples.
    #[test]
    fn the_centre_of_curvature_is_no_trap() {
        // r' = (1 + 2 i x)^2 on -1..=1: the vertex bends with the radius 1/4 in x, and in xi = (x + 1)/2 all lengths halve.
        let curve = PhQuintic { start: at(0.0, 0.0), w: [at(1.0, -2.0), at(1.0, 0.0), at(1.0, 2.0)] };
        let vertex = curve.point(0.5);
        let bent = contour(Segment::Ph(curve));
        let radius = 1.0 / curve.curvature(0.5);
        assert!((radius - 0.125).abs() < 1e-15);
        for part in [0.5, 0.99, 1.0] {
            let foot = Nearest::new(&bent).at(vertex + at(0.0, radius * part));
            assert!((foot.distance - radius * part).abs() < 1e-15, "{part}: {foot:?}");
        }
        // Beyond it the vertex is not nearest any more.
        let foot = Nearest::new(&bent).at(vertex + at(0.0, radius * 1.01));
        assert!(foot.distance < radius * 1.01 - 1e-6);
    }
}

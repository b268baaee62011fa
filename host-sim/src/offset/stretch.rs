//! Stretches: parts of a contour or of an offset that are simple enough to be certain about.
//!
//! Along a stretch the tangent turns one way only, by at most [`TURN`], and the curvature grows or falls all the way. Three things
//! follow. A stretch is the graph of a function over any axis within [`TURN`] of its own direction. Its slope over any part lies
//! between the slopes at the part's ends. And a point has at most one nearest and one farthest foot point inside it, because the
//! centres of curvature form a convex arc, to which there are at most two tangents from any point.

use shared::complex::Complex;
use shared::curve::{Arc, Curve as _, PhQuintic, Segment};
use shared::piece::Shape;
use shared::polynomial::bernstein_product;
use shared::real::Real as _;

use super::roots::{elevate, zeros};

/// The largest turn of the tangent along a stretch, in radians.
pub const TURN: f64 = std::f64::consts::FRAC_PI_4;

/// Parameters of a segment nearer to each other than this are not kept apart.
const SHORTEST: f64 = 1e-10;

/// A part of a curve, at an offset distance from it. Lengths in the unit of the contour.
#[derive(Clone, Copy, Debug)]
pub struct Stretch {
    /// First parameter on the curve that it was cut from.
    pub from: f64,
    /// Last parameter.
    pub to: f64,
    /// The signed distance from the curve, positive right of travel.
    pub offset: f64,
    shape: Local,
}

/// The curve, over tau in -1/2..=1/2.
#[derive(Clone, Copy, Debug)]
enum Local {
    /// Preimage in powers of tau, and the point less the origin divided by tau, in powers too.
    Ph { origin: Complex<f64>, w: [Complex<f64>; 3], r: [Complex<f64>; 5] },
    /// Middle and chord.
    Line { middle: Complex<f64>, chord: Complex<f64> },
    /// Middle, vector from the centre to it, and sweep.
    Arc { middle: Complex<f64>, radius: Complex<f64>, sweep: f64 },
}

/// A place on a stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct At {
    /// The point of the offset.
    pub point: Complex<f64>,
    /// The unit tangent, of the curve and of its offset.
    pub tangent: Complex<f64>,
    /// The offset's derivative along the tangent: (1 + kappa d) sigma, negative where the offset runs backwards.
    pub speed: f64,
    /// The turn of the tangent for a unit of tau: kappa sigma.
    pub turning: f64,
}

impl Stretch {
    /// The part of `segment` over `from..=to`, at `offset` from it.
    pub fn new(segment: &Segment<f64>, from: f64, to: f64, offset: f64) -> Self {
        let cut = segment.cut(from, to, 0.0);
        let shape = match cut.shape {
            Shape::Ph { preimage: [a, b, c], .. } => {
                let third = 1.0 / 3.0;
                let r = [a.square(), a * b, (b.square() + a * c * 2.0) * third, (b * c) * 0.5, c.square() * 0.2];
                Local::Ph { origin: cut.origin, w: [a, b, c], r }
            }
            Shape::Line { chord } => Local::Line { middle: cut.origin, chord },
            // `Ground` refuses contours with splines, so that none comes here.
            Shape::Spline(_) => Local::Line { middle: cut.origin, chord: segment.point(to) - segment.point(from) },
            Shape::Arc { radius, sweep, .. } => Local::Arc { middle: cut.origin, radius, sweep },
        };
        Self { from, to, offset, shape }
    }

    /// The same part at another distance.
    pub fn with_offset(self, offset: f64) -> Self {
        Self { offset, ..self }
    }

    /// The parameter on the curve at tau.
    pub fn parameter(&self, tau: f64) -> f64 {
        // From the nearer end, so that both ends are met exactly.
        let width = self.to - self.from;
        if tau < 0.0 { self.from + width * (tau + 0.5) } else { self.to - width * (0.5 - tau) }
    }

    /// The place at tau, which may leave -1/2..=1/2 a little.
    pub fn at(&self, tau: f64) -> At {
        let (point, tangent, sigma, turning) = match &self.shape {
            Local::Ph { origin, w: [a, b, c], r } => {
                let w = *a + (*b + *c * tau) * tau;
                let slope = *b + *c * (2.0 * tau);
                let sigma = w.norm_sqr();
                let way = r.iter().rev().fold(Complex::ZERO, |sum, &c| sum * tau + c) * tau;
                (*origin + way, w.square() * (1.0 / sigma), sigma, 2.0 * w.cross(slope) / sigma)
            }
            Local::Line { middle, chord } => {
                let sigma = chord.norm();
                (*middle + *chord * tau, *chord * (1.0 / sigma), sigma, 0.0)
            }
            Local::Arc { middle, radius, sweep } => {
                let (sine, versine) = (sweep * tau).sin_versin();
                let turn = *radius * Complex::new(-versine, sine);
                let size = radius.norm();
                let tangent = (*radius + turn).left() * (sweep.signum() / size);
                (*middle + turn, tangent, size * sweep.abs(), *sweep)
            }
        };
        At { point: point + tangent.right() * self.offset, tangent, speed: sigma + turning * self.offset, turning }
    }

    /// The first point.
    pub fn start(&self) -> Complex<f64> {
        self.at(-0.5).point
    }

    /// The last point.
    pub fn end(&self) -> Complex<f64> {
        self.at(0.5).point
    }

    /// The curvature of the stretch itself at `at`: kappa/(1 + kappa d).
    pub fn curvature(at: &At) -> f64 {
        at.turning / at.speed
    }

    /// The circle that it is a part of: centre and radius; none of a PH curve or a line.
    pub fn circle(&self) -> Option<(Complex<f64>, f64)> {
        match &self.shape {
            Local::Arc { middle, radius, sweep } => {
                Some((*middle - *radius, (radius.norm() + sweep.signum() * self.offset).abs()))
            }
            _ => None,
        }
    }

    /// A triangle that holds the stretch, if it runs forwards all along, to within the second value: that of its chord and its end
    /// tangents, between which a tangent that turns one way by less than a right angle stays.
    pub fn hull(&self) -> ([Complex<f64>; 3], f64) {
        let (start, end) = (self.at(-0.5), self.at(0.5));
        let chord = end.point - start.point;
        let sine = start.tangent.cross(end.tangent);
        // Where the turn is this small, the triangle's tip is nearer to the chord than this part of its length.
        const STRAIGHT: f64 = 1e-7;
        let rounding = 1e-15 * (1.0 + self.offset.abs());
        if sine.abs() > STRAIGHT {
            let tip = start.point + start.tangent * (chord.cross(end.tangent) / sine);
            ([start.point, end.point, tip], rounding)
        } else {
            ([start.point, end.point, start.point], rounding + STRAIGHT * chord.norm())
        }
    }
}

/// Where to cut a segment into stretches: parameters from 0 to 1, in order, both included.
///
/// A PH curve is cut at its inflections, where the turn changes its direction; at its vertices, where the curvature is extreme;
/// and as often as [`TURN`] demands. All of it depends on the contour alone.
pub fn cuts(segment: &Segment<f64>) -> Vec<f64> {
    let mut cuts = vec![0.0, 1.0];
    match segment {
        Segment::Line(_) | Segment::Spline(_) => {}
        Segment::Arc(arc) => cuts.extend(even(arc)),
        Segment::Ph(curve) => {
            cuts.extend(curve.inflections());
            cuts.extend(vertices(curve));
            tidy(&mut cuts);
            let whole = cuts.clone();
            for pair in whole.windows(2) {
                if let [from, to] = *pair {
                    cut_by_turn(curve, from, to, &mut cuts);
                }
            }
        }
    }
    tidy(&mut cuts);
    cuts
}

/// The parameters in (0, 1) where 1 + kappa `offset` changes its sign, in order: there the offset has a cusp.
pub fn cusps(segment: &Segment<f64>, offset: f64) -> Vec<f64> {
    let Segment::Ph(curve) = segment else { return Vec::new() };
    let sigma = curve.speed_coefficients();
    let mut g: [f64; 9] = bernstein_product(sigma, sigma);
    let turn: [f64; 9] = elevate::<3, 7, 9>(turning(curve));
    for (g, turn) in g.iter_mut().zip(turn) {
        *g += 4.0 * offset * turn;
    }
    zeros(g)
}

/// Im(conj w w')/2 in Bernstein form; kappa is four times that over sigma^2.
fn turning(curve: &PhQuintic<f64>) -> [f64; 3] {
    let [w0, w1, w2] = curve.w;
    [w0.cross(w1), 0.5 * w0.cross(w2), w1.cross(w2)]
}

/// Zeros of kappa': with m = Im(conj w w')/2, of m' sigma - 2 m sigma'.
fn vertices(curve: &PhQuintic<f64>) -> Vec<f64> {
    let m = turning(curve);
    let sigma = curve.speed_coefficients();
    let m_slope = [2.0 * (m[1] - m[0]), 2.0 * (m[2] - m[1])];
    let sigma_slope = [0, 1, 2, 3].map(|k| 4.0 * (sigma[k + 1] - sigma[k]));
    let first: [f64; 6] = bernstein_product(m_slope, sigma);
    let second: [f64; 6] = bernstein_product(m, sigma_slope);
    let mut slope = first;
    for (slope, second) in slope.iter_mut().zip(second) {
        *slope -= 2.0 * second;
    }
    // A line or a circle has no vertices, only rounding.
    let size = first.iter().chain(&second).fold(0.0, |size: f64, c| size.max(c.abs()));
    if slope.iter().all(|c| c.abs() <= 1e-13 * size) {
        return Vec::new();
    }
    zeros(slope)
}

/// Equal parts of an arc.
fn even(arc: &Arc<f64>) -> impl Iterator<Item = f64> {
    let parts = (arc.sweep.abs() / TURN).ceil().max(1.0);
    (1..parts as usize).map(move |k| k as f64 / parts)
}

/// Halves `from..to` until the tangent turns by at most [`TURN`] on every part.
fn cut_by_turn(curve: &PhQuintic<f64>, from: f64, to: f64, cuts: &mut Vec<f64>) {
    let middle = 0.5 * (from + to);
    let [a, m, b] = [from, middle, to].map(|xi| curve.preimage(xi));
    // The tangent turns twice as far as w, and w turns by less than a half turn between two cuts of a parabola's arms.
    let turn = 2.0 * ((a.conj() * m).arg().abs() + (m.conj() * b).arg().abs());
    if turn > TURN && to - from > SHORTEST {
        cuts.push(middle);
        cut_by_turn(curve, from, middle, cuts);
        cut_by_turn(curve, middle, to, cuts);
    }
}

/// In order, and without those that are too near to each other to be kept apart; 0 and 1 stay.
fn tidy(cuts: &mut Vec<f64>) {
    cuts.sort_by(f64::total_cmp);
    cuts.dedup_by(|b, a| *b - *a < SHORTEST);
    if let Some(last) = cuts.last_mut() {
        *last = 1.0;
    }
}

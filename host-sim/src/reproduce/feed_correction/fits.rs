//! The correction polynomials of a whole spline, by every fit that is compared.

use shared::polynomial::Polynomial;
use shared::real::Real;
use shared::spline::published::Published;
use shared::spline::{Correction, CorrectionOrder, Fit, PolynomialSegment, fit};

use crate::spline::Interpolant;
use crate::spline::constrained;
use crate::spline::methods::{Form, Mapping, ends_by};

/// M_min of the paper: into how many parts its shortest segment is cut.
pub const LEAST_DIVISIONS: f64 = 100.0;

/// What the paper knows of a segment before the fit: FC(4).
#[derive(Clone, Debug)]
pub struct Sampled {
    /// The segment.
    pub segment: PolynomialSegment<f64, 2>,
    /// How far u goes.
    pub span: f64,
    /// s and u at all divisions, both ends included; s is a sum of chords.
    pub samples: Vec<(f64, f64)>,
}

impl Sampled {
    /// S.
    pub fn length(&self) -> f64 {
        self.samples.last().map_or(0.0, |&(s, _)| s)
    }

    /// M.
    pub fn divisions(&self) -> usize {
        self.samples.len() - 1
    }
}

/// Cuts every segment into parts in proportion to its span, the shortest into [`LEAST_DIVISIONS`], and sums their chords.
pub fn sampled(spline: &Interpolant<2>) -> Vec<Sampled> {
    let shortest = spline.spans.iter().copied().fold(f64::INFINITY, f64::min);
    let one = |(segment, &span): (&PolynomialSegment<f64, 2>, &f64)| {
        // Less a roundoff, so that the shortest one is not cut once more.
        divided(segment, span, (LEAST_DIVISIONS * span / shortest * (1.0 - 1e-12)).ceil().max(1.0))
    };
    spline.segments.iter().zip(&spline.spans).map(one).collect()
}

/// The way to the end of each of so many equal parts, as a sum of chords.
pub fn chord_sums(segment: &PolynomialSegment<f64, 2>, divisions: u32) -> impl Iterator<Item = f64> {
    let mut before = segment.point(-0.5);
    let mut s = 0.0;
    (1..=divisions).map(move |j| {
        let here = segment.point(f64::from(j) / f64::from(divisions) - 0.5);
        s += (here[0] - before[0]).hypot(here[1] - before[1]);
        before = here;
        s
    })
}

/// Cuts one segment into so many parts, a whole number.
pub fn divided(segment: &PolynomialSegment<f64, 2>, span: f64, divisions: f64) -> Sampled {
    let parts = (1..).map(|j: u32| span * (f64::from(j) / divisions));
    let samples = std::iter::once((0.0, 0.0)).chain(chord_sums(segment, divisions as u32).zip(parts)).collect();
    Sampled { segment: *segment, span, samples }
}

/// FC(15) to FC(20), from all samples.
pub fn closed_form(sampled: &Sampled) -> Option<[f64; 8]> {
    let ends = ends_by(&sampled.segment, sampled.length(), sampled.span)?;
    let mut fit = Published::new(&ends);
    let inner = sampled.samples.get(1..sampled.divisions())?;
    for &(s, u) in inner {
        fit.sample(s, u);
    }
    Some(fit.finish())
}

/// FC(14), from all samples; in powers of s/S.
pub fn fourteen(sampled: &Sampled) -> Option<[f64; 8]> {
    let ends = ends_by(&sampled.segment, sampled.length(), sampled.span)?;
    constrained::fit(&ends, sampled.samples.iter().copied())
}

/// Any order about the middle, from all samples.
pub fn centred(sampled: &Sampled, order: CorrectionOrder) -> Option<Correction<f64>> {
    let length = sampled.length();
    let mut fit = Fit::new(&sampled.segment.ends(length)?, order);
    for &(s, u) in sampled.samples.get(1..sampled.divisions())? {
        fit.sample(s / length - 0.5, u / sampled.span - 0.5);
    }
    Some(fit.finish())
}

/// Powers of u that runs over a span as powers of v, which runs over 1 about 0.
fn of_v(mut coefficients: [f64; 8], span: f64) -> Polynomial<f64, 8> {
    for coefficient in &mut coefficients {
        *coefficient /= span;
    }
    let [.., last] = &mut coefficients;
    *last -= 0.5;
    Polynomial(coefficients)
}

/// Which fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// The closed form of the paper.
    ClosedForm,
    /// The 14 equations.
    Fourteen,
    /// An order about the middle, from the paper's samples.
    Centred(CorrectionOrder),
    /// What the controller does: two samples.
    Controller(CorrectionOrder),
}

/// The correction polynomials of all segments. None where one has none.
pub fn mappings(sampled: &[Sampled], kind: Kind) -> Option<Vec<Mapping>> {
    let one = |one: &Sampled| {
        let length = one.length();
        Some(match kind {
            Kind::ClosedForm => Mapping { length, polynomial: Form::Powers(of_v(closed_form(one)?, one.span)) },
            Kind::Fourteen => Mapping { length, polynomial: Form::Normalised(of_v(fourteen(one)?, one.span)) },
            Kind::Centred(order) => Mapping { length, polynomial: Form::Centred(centred(one, order)?) },
            Kind::Controller(order) => {
                let (length, correction) = fit(&one.segment, order).ok()?;
                Mapping { length, polynomial: Form::Centred(correction) }
            }
        })
    };
    sampled.iter().map(one).collect()
}

/// The seventh order from samples at `nodes` within -1/2..1/2, with the arc length between them by a Gauss rule.
pub fn sparse<T: Real>(
    segment: &PolynomialSegment<T, 2>,
    nodes: &[f64],
    rule: &[(f64, f64)],
) -> Option<(T, Correction<T>)> {
    let mut before = -0.5;
    let mut sum = T::ZERO;
    let mut ways = Vec::with_capacity(nodes.len() + 1);
    for &to in nodes.iter().chain([&0.5]) {
        let width = to - before;
        let panel = rule
            .iter()
            .fold(T::ZERO, |panel, &(x, weight)| panel + T::lit(weight) * segment.speed(T::lit(before + x * width)));
        sum += panel * T::lit(width);
        ways.push(sum);
        before = to;
    }
    let per_length = T::ONE / sum;
    let mut fit = Fit::new(&segment.ends(sum)?, CorrectionOrder::Seventh);
    for (&node, &way) in nodes.iter().zip(&ways) {
        fit.sample(way * per_length - T::HALF, T::lit(node));
    }
    Some((sum, fit.finish()))
}

/// Nodes within 0..1 and weights of the Gauss-Legendre rule of so many nodes: zeros of the Legendre polynomial by Newton's method.
pub fn gauss(count: u32) -> Vec<(f64, f64)> {
    let legendre = |x: f64| {
        let (mut before, mut here) = (1.0, x);
        for k in 2..=count {
            let k = f64::from(k);
            (before, here) = (here, ((2.0 * k - 1.0) * x * here - (k - 1.0) * before) / k);
        }
        // Value and derivative.
        (here, f64::from(count) * (x * here - before) / (x * x - 1.0))
    };
    (0..count)
        .map(|k| {
            let mut x = -(std::f64::consts::PI * (f64::from(k) + 0.75) / (f64::from(count) + 0.5)).cos();
            for _ in 0..20 {
                let (value, slope) = legendre(x);
                x -= value / slope;
            }
            let (_, slope) = legendre(x);
            (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_rules_are_exact_for_their_degree() {
        for count in 2..=6 {
            for power in 0..2 * count {
                let sum: f64 = gauss(count).iter().map(|(x, weight)| weight * x.powi(power as i32)).sum();
                assert!((sum * f64::from(power + 1) - 1.0).abs() < 1e-14, "{count} nodes, power {power}");
            }
        }
    }
}

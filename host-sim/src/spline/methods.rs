//! Ways to drive a spline at a constant feed, tick by tick: figure 2 of the feed correction paper, and an iterative one.

use shared::polynomial::Polynomial;
use shared::spline::{Correction, Ends, PolynomialSegment};

use super::Interpolant;

/// How the parameter of the next tick is found.
#[derive(Clone, Copy, Debug)]
pub enum Method<'a> {
    /// u grows by V dt: figure 2(a).
    Natural,
    /// u grows by V dt u_s: figure 2(b).
    FirstTaylor,
    /// u grows by V dt u_s + (V dt)^2 u_ss/2.
    SecondTaylor,
    /// u is the correction polynomial's at the way s, one a segment: figure 2(c).
    Corrected(&'a [Mapping]),
    /// Newton's method on s(u), from what the correction polynomial says.
    Iterative(&'a [Mapping]),
}

/// The length of a segment and the correction polynomial on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mapping {
    /// S, in mm.
    pub length: f64,
    /// v over the way.
    pub polynomial: Form,
}

/// A correction polynomial as it was fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// About the middle, as the controller has it.
    Centred(Correction<f64>),
    /// A to H of FC(3): powers of s, the highest first.
    Powers(Polynomial<f64, 8>),
    /// Powers of s/S, the highest first.
    Normalised(Polynomial<f64, 8>),
}

impl Mapping {
    /// v at the way `s` from the start.
    pub fn at(&self, s: f64) -> f64 {
        let sigma = s / self.length;
        let powers = |Polynomial(mut c): Polynomial<f64, 8>, x: f64| {
            c.reverse();
            Polynomial(c).at(x, 0.0)
        };
        match self.polynomial {
            Form::Centred(correction) => correction.at(sigma - 0.5),
            Form::Powers(coefficients) => powers(coefficients, s),
            Form::Normalised(coefficients) => powers(coefficients, sigma),
        }
    }
}

/// Where a tick has come to: the number of the segment and v on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// From 0.
    pub segment: usize,
    /// Within -1/2..=1/2.
    pub v: f64,
}

/// The places of all ticks at `feed` mm/s and `tick` s, from the start to the last one before the end.
pub fn drive<const D: usize>(spline: &Interpolant<D>, method: Method<'_>, feed: f64, tick: f64) -> Vec<Place> {
    let step = feed * tick;
    match method {
        Method::Natural => by_parameter(spline, |_, _| step),
        Method::FirstTaylor => by_parameter(spline, |span, [first, _]| step * first * span),
        Method::SecondTaylor => {
            by_parameter(spline, |span, [first, second]| span * step * (first + 0.5 * step * second))
        }
        Method::Corrected(mappings) => by_way(mappings, step, |mapping, _, s| mapping.at(s)),
        Method::Iterative(mappings) => {
            by_way(mappings, step, |mapping, segment, s| match spline.segments.get(segment) {
                Some(curve) => newton(curve, mapping.at(s), s),
                None => 0.5,
            })
        }
    }
}

/// A walk along u; `step` gets the span of the segment, and u_s and u_ss by v there, and says how far u goes.
fn by_parameter<const D: usize>(spline: &Interpolant<D>, step: impl Fn(f64, [f64; 2]) -> f64) -> Vec<Place> {
    let mut places = vec![Place { segment: 0, v: -0.5 }];
    let (mut segment, mut v) = (0, -0.5);
    while let (Some(curve), Some(&span)) = (spline.segments.get(segment), spline.spans.get(segment)) {
        let Some(rates) = curve.rates(v) else { break };
        let [first, second, _] = rates.0;
        let mut left = step(span, [first, second]);
        let mut span = span;
        while left >= (0.5 - v) * span {
            left -= (0.5 - v) * span;
            segment += 1;
            v = -0.5;
            match spline.spans.get(segment) {
                Some(&next) => span = next,
                None => return places,
            }
        }
        v += left / span;
        places.push(Place { segment, v });
    }
    places
}

/// A walk along s.
fn by_way(mappings: &[Mapping], step: f64, place: impl Fn(&Mapping, usize, f64) -> f64) -> Vec<Place> {
    let mut places = vec![Place { segment: 0, v: -0.5 }];
    let (mut segment, mut before) = (0, 0.0);
    // From the tick's number, so that no error grows.
    for tick in 1_u32.. {
        let way = step * f64::from(tick);
        while let Some(mapping) = mappings.get(segment) {
            if way - before < mapping.length {
                break;
            }
            before += mapping.length;
            segment += 1;
        }
        let Some(mapping) = mappings.get(segment) else { break };
        places.push(Place { segment, v: place(mapping, segment, way - before) });
    }
    places
}

/// The v at the way `s`, from a guess: Newton's method on the arc length.
fn newton<const D: usize>(curve: &PolynomialSegment<f64, D>, guess: f64, s: f64) -> f64 {
    let mut v = guess;
    for _ in 0..8 {
        let correction = (curve.length_over(-0.5, v + 0.5) - s) / curve.speed(v);
        v -= correction;
        if correction.abs() < 1e-14 {
            break;
        }
    }
    v
}

/// The feed of every tick in mm/s: the arc length from place to place over the time.
pub fn feeds<const D: usize>(spline: &Interpolant<D>, places: &[Place], tick: f64) -> Vec<f64> {
    let length = |segment: usize, from: f64, to: f64| {
        spline.segments.get(segment).map_or(0.0, |curve| curve.length_over(from, to - from))
    };
    let way = |pair: &[Place]| match *pair {
        [a, b] if a.segment == b.segment => length(a.segment, a.v, b.v),
        [a, b] => {
            let between: f64 = (a.segment + 1..b.segment).map(|k| length(k, -0.5, 0.5)).sum();
            length(a.segment, a.v, 0.5) + between + length(b.segment, -0.5, b.v)
        }
        _ => 0.0,
    };
    places.windows(2).map(|pair| way(pair) / tick).collect()
}

/// Ends of a segment by the paper's u, which runs over `span` from 0.
pub fn ends_by<const D: usize>(segment: &PolynomialSegment<f64, D>, length: f64, span: f64) -> Option<Ends<f64>> {
    let ends = segment.ends(length)?;
    let by = |rates: [f64; 2]| rates.map(|rate| rate * span);
    Some(Ends { parameter: [0.0, span], first: by(ends.first), second: by(ends.second), third: by(ends.third), ..ends })
}

#[cfg(test)]
mod tests {
    use shared::spline::{CorrectionOrder, fit};

    use super::super::Parametrisation;
    use super::*;

    /// On a bent ring at 100 mm/s every method is better than the one before it, the iterative one to rounding.
    #[test]
    fn methods_are_as_good_as_their_kind() {
        let angle = |k: u32| std::f64::consts::TAU * (f64::from(k) + 0.2 * (3.0 * f64::from(k)).sin()) / 17.0;
        let points: Vec<[f64; 2]> = (0..17).map(|k| [20.0 * angle(k).cos(), 12.0 * angle(k).sin()]).collect();
        let spline = Interpolant::cubic(&points, true, Parametrisation::Chord).unwrap();
        let mapping = |segment| {
            let (length, correction) = fit(segment, CorrectionOrder::Seventh).unwrap();
            Mapping { length, polynomial: Form::Centred(correction) }
        };
        let mappings: Vec<Mapping> = spline.segments.iter().map(mapping).collect();
        let methods = [
            Method::Natural,
            Method::FirstTaylor,
            Method::SecondTaylor,
            Method::Corrected(&mappings),
            Method::Iterative(&mappings),
        ];
        let fluctuation = |method| {
            let feeds = feeds(&spline, &drive(&spline, method, 100.0, 1e-3), 1e-3);
            assert!(feeds.len() > 900);
            feeds.iter().fold(0.0_f64, |most, feed| most.max((feed / 100.0 - 1.0).abs()))
        };
        let found = methods.map(fluctuation);
        assert!(found[0] > 1e-2 && found[1] < 0.1 * found[0] && found[2] < 0.1 * found[1], "{found:?}");
        assert!(found[3] < 0.1 * found[0] && found[4] < 1e-9, "{found:?}");
    }
}

//! The time of a path by direct quadrature of equation (21), written from the paper's formulas.

use shared::feed::Ramp;

use crate::path::{Path, PathPiece};

/// Panels of a piece. With eight Gauss nodes each the sum is exact to 1e-12 for every f above 0.01.
const PANELS: u32 = 512;

/// The exact integral of dt = sigma_w/(F V) d(xi) along the path, in s.
pub fn exact_time(path: &Path) -> f64 {
    path.pieces.iter().map(|piece| piece_time(piece, path.weight)).sum()
}

/// dt/d(xi) of equation (21) on one piece.
#[derive(Clone, Copy, Debug)]
pub struct Slowness<'a> {
    piece: &'a PathPiece,
    weight: f64,
    /// Arc length of the segment before the piece, and of the piece.
    start: f64,
    length: f64,
}

impl<'a> Slowness<'a> {
    /// On `piece`, at the weight w of its path.
    pub fn new(piece: &'a PathPiece, weight: f64) -> Self {
        let start = piece.way_to(piece.interval[0]);
        Self { piece, weight, start, length: piece.way() }
    }

    /// The inverse of the rate at a parameter of the segment, in s.
    pub fn at(&self, xi: f64) -> f64 {
        let Self { piece, weight, start, length } = *self;
        let u = (piece.way_to(xi) - start) / length;
        let stretch = piece.stretch(xi);
        // Equation (20); on a fill arc V is the centre feed, and the arc is its own centre path.
        let sigma_w = stretch / ((1.0 - weight) * stretch + weight) * piece.way_speed(xi);
        sigma_w / (reduction(u, piece.start) * reduction(1.0 - u, piece.end) * piece.feed)
    }
}

/// The same of one piece, at the weight w of its path.
pub fn piece_time(piece: &PathPiece, weight: f64) -> f64 {
    if let Some(profile) = piece.profile {
        // The mean of a cubic is that of its Bernstein coefficients.
        return piece.way() / (piece.feed * 0.25 * profile.factors.iter().sum::<f64>());
    }
    let [from, to] = piece.interval;
    let slowness = Slowness::new(piece, weight);
    let width = (to - from) / f64::from(PANELS);
    (0..PANELS)
        .map(|k| {
            let left = from + width * f64::from(k);
            let panel: f64 =
                <f64 as shared::real::Real>::GAUSS.iter().map(|&(x, w)| w * slowness.at(left + x * width)).sum();
            panel * width
        })
        .sum()
}

/// Equations (10) and (11) term by term, at the distance `u` from the ramp's corner.
fn reduction(u: f64, ramp: Option<Ramp<f64>>) -> f64 {
    let Some(Ramp { length, factor }) = ramp else { return 1.0 };
    if u >= length {
        return 1.0;
    }
    const BINOMIALS: [f64; 6] = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
    let (rest, done) = ((length - u) / length, u / length);
    let at_corner = [factor, factor, factor, 1.0, 1.0, 1.0];
    let mut sum = 0.0;
    for (k, (coefficient, binomial)) in at_corner.into_iter().zip(BINOMIALS).enumerate() {
        sum += coefficient * binomial * rest.powi(5 - k as i32) * done.powi(k as i32);
    }
    sum
}

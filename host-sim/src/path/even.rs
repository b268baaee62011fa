//! Cuts a spline where its feed correction polynomial is not good enough.

use shared::curve::{Segment, Spline};
use shared::spline::{CorrectionOrder, PolynomialSegment, fit};

use super::PathPiece;
use crate::height::Height;

/// What the feed may fluctuate by on a spline piece, as a part of it: what the feed correction paper reaches on its airfoil.
const FLUCTUATION: f64 = 1e-3;

/// How often a segment is halved. What is left then is a cusp, which the loader refuses.
const HALVINGS: u32 = 8;

/// The piece itself, or the parts of a spline on each of which the feed fluctuates by less than a thousandth.
pub(super) fn even(piece: &PathPiece) -> Vec<PathPiece> {
    let Segment::Spline(spline) = piece.segment else { return vec![*piece] };
    // Whoever wants no correction wants its fluctuation.
    if spline.correction == CorrectionOrder::Natural {
        return vec![*piece];
    }
    let mut parts = Vec::new();
    let mut stack = vec![(piece.interval, 0)];
    while let Some(([from, to], halvings)) = stack.pop() {
        if halvings == HALVINGS
            || fluctuation(&spline, piece.height, from, to).is_some_and(|found| found <= FLUCTUATION)
        {
            parts.push(piece.over([from, to]));
        } else {
            let middle = 0.5 * (from + to);
            stack.extend([([middle, to], halvings + 1), ([from, middle], halvings + 1)]);
        }
    }
    // A segment that no cut helps, because it stands still, is refused as a whole.
    if parts.len() > 1 << (HALVINGS - 1) { vec![*piece] } else { parts }
}

/// The largest relative departure of the feed from the wanted one; none where there is no correction.
fn fluctuation(spline: &Spline<f64>, height: Option<Height>, from: f64, to: f64) -> Option<f64> {
    let part = spline.part(from, to);
    let bent = height.and_then(|height| height.part(from, to).in_space(&Segment::Spline(part)));
    match bent {
        Some(curve) => of_curve(&curve, spline.correction),
        None => of_curve(&part.segment(), spline.correction),
    }
}

fn of_curve<const D: usize>(curve: &PolynomialSegment<f64, D>, order: CorrectionOrder) -> Option<f64> {
    /// Places where the feed is looked at.
    const PLACES: i32 = 64;
    let (length, correction) = fit(curve, order).ok()?;
    let feed = |k: i32| {
        let tau = f64::from(k) / f64::from(PLACES) - 0.5;
        curve.speed(correction.at(tau)) * correction.derivative(tau) / length
    };
    Some((0..=PLACES).map(|k| (feed(k) - 1.0).abs()).fold(0.0, f64::max))
}

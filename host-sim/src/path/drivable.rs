//! Makes of an exact loop what a controller can drive.
//!
//! The trimmed offset is exact, and so it holds pieces that are no motion: slivers shorter than a setpoint resolves, where a
//! trim point falls on a node; and pieces that touch a cusp of the offset, where 1 + kappa d vanishes because the tool is just
//! as round as the contour. The controller refuses both. Both are harmless as long as nothing is lost but a gap within the
//! job's tolerance, which the controller closes in one tick.

use shared::active::ActivePiece;
use shared::error::PathError;

use super::PathPiece;

/// How often the cut around a cusp is halved below the tolerance, to find the smallest one that does.
const HALVINGS: i32 = 24;

/// `pieces` without those that are no motion, and clear of cusps, each with the number of the piece that it is a part of; no gap
/// that arises is wider than `tolerance` in mm.
///
/// A piece that cannot be helped in this way stays as it is, so that the loader refuses it with a reason.
pub(super) fn drivable(pieces: &[PathPiece], tolerance: f64, weight: f64) -> Vec<(usize, PathPiece)> {
    let mut kept = Vec::with_capacity(pieces.len());
    for (number, piece) in pieces.iter().enumerate() {
        match refusal(piece, weight) {
            None => kept.push((number, *piece)),
            Some(_) if piece.centre_length() <= tolerance => {}
            Some(PathError::Cusp) => match clear_of_cusp(piece, tolerance, weight) {
                Some(parts) => kept.extend(parts.into_iter().map(|part| (number, part))),
                None => kept.push((number, *piece)),
            },
            Some(_) => kept.push((number, *piece)),
        }
    }
    kept
}

/// Why the controller would refuse the piece.
fn refusal(piece: &PathPiece, weight: f64) -> Option<PathError> {
    ActivePiece::activate(&piece.wire(None), weight as f32, shared::TICK).err()
}

/// What is left of a piece on both sides of where |1 + kappa d| is smallest, with the narrowest gap that the controller takes.
/// None where a quarter of the tolerance on each side is not enough.
fn clear_of_cusp(piece: &PathPiece, tolerance: f64, weight: f64) -> Option<Vec<PathPiece>> {
    let [from, to] = piece.interval;
    let cusp = flattest(piece);
    // A quarter of the tolerance at most: two cuts and a part that is left out make one gap.
    (2..=HALVINGS).rev().find_map(|halvings| {
        let cut = tolerance * 0.5_f64.powi(halvings);
        let parts = [[from, away(piece, cusp, from, cut)], [away(piece, cusp, to, cut), to]];
        let parts: Vec<PathPiece> = parts
            .into_iter()
            .filter(|[from, to]| from < to)
            .map(|interval| piece.over(interval))
            // A part that is no motion may go too.
            .filter(|part| part.centre_length() > cut)
            .collect();
        // Behind a cusp across which the offset turns back there is no way on.
        parts.iter().all(|part| part.is_forward() && refusal(part, weight).is_none()).then_some(parts)
    })
}

/// The parameter where |1 + kappa d| is smallest, ends included.
fn flattest(piece: &PathPiece) -> f64 {
    /// Even steps of the search; each round narrows it to two of them.
    const STEPS: u32 = 32;
    const ROUNDS: u32 = 12;
    let [mut from, mut to] = piece.interval;
    let mut best = from;
    for _ in 0..ROUNDS {
        let step = (to - from) / f64::from(STEPS);
        let at = |k: u32| if k == STEPS { to } else { from + step * f64::from(k) };
        let places = (0..=STEPS).map(at);
        best = places.min_by(|&a, &b| piece.stretch(a).total_cmp(&piece.stretch(b))).unwrap_or(best);
        (from, to) = ((best - step).max(from), (best + step).min(to));
    }
    best
}

/// The parameter between `cusp` and `end` at which the centre is `cut` mm away from the cusp; `end` where it never is.
fn away(piece: &PathPiece, cusp: f64, end: f64, cut: f64) -> f64 {
    let start = piece.point(cusp);
    let far = |xi: f64| (piece.point(xi) - start).norm() > cut;
    if !far(end) {
        return end;
    }
    let (mut near, mut beyond) = (cusp, end);
    for _ in 0..60 {
        let middle = 0.5 * (near + beyond);
        if far(middle) { beyond = middle } else { near = middle }
    }
    beyond
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contour::{Along, Contour};
    use shared::complex::Complex;
    use shared::curve::{Arc, Line, Segment, hermite};

    const TOLERANCE: f64 = 1e-3;

    fn piece(segment: Segment<f64>, from: f64, to: f64, distance: f64) -> PathPiece {
        let contour = Contour { segments: vec![segment], closed: false };
        PathPiece::new(&contour, Along::Segment { segment: 0, from, to }, distance, 10.0).unwrap()
    }

    /// A lobe that is symmetric about its middle, where it bends most, and the distance at which 1 + kappa d vanishes there.
    fn lobe() -> (Segment<f64>, f64) {
        use shared::curve::Curve as _;
        let at = Complex::new;
        let segment = Segment::Ph(hermite(at(-10.0, 0.0), at(10.0, 0.0), at(20.0, 60.0), at(20.0, -60.0)).unwrap());
        (segment, -1.0 / segment.curvature(0.5))
    }

    /// The widest gap between neighbours, and from the ends of `whole` to those of the pieces that are kept.
    fn gap(whole: &PathPiece, kept: &[PathPiece]) -> f64 {
        let [from, to] = whole.interval;
        let mut marks = vec![whole.point(from)];
        marks.extend(kept.iter().flat_map(|piece| piece.interval.map(|xi| piece.point(xi))));
        marks.push(whole.point(to));
        marks.chunks(2).map(|pair| (pair[1] - pair[0]).norm()).fold(0.0, f64::max)
    }

    /// The pieces that are kept of these.
    fn drivable(pieces: Vec<PathPiece>, tolerance: f64, weight: f64) -> Vec<PathPiece> {
        super::drivable(&pieces, tolerance, weight).into_iter().map(|(_, piece)| piece).collect()
    }

    #[test]
    fn what_can_be_driven_stays() {
        let (segment, _) = lobe();
        let pieces = vec![piece(segment, 0.0, 1.0, 1.0), piece(segment, 0.25, 0.5, -1.0)];
        assert_eq!(drivable(pieces.clone(), TOLERANCE, 0.5), pieces);
    }

    /// Pieces of 1 nm on a line and on an arc, and one whose parameters are one number in the controller's precision.
    #[test]
    fn slivers_are_left_out() {
        let line = Segment::Line(Line { start: Complex::ZERO, end: Complex::new(1.0, 0.0) });
        let arc = Segment::Arc(Arc { start: Complex::ZERO, radius: Complex::new(1.0, 0.0), sweep: 1.0 });
        let short = |segment| piece(segment, 0.5, 0.5 + 1e-6 * 1e-3, 0.0);
        let narrow = piece(line, 0.7, 0.7 + 2e-8, 0.0);
        assert_eq!(drivable(vec![short(line), short(arc), narrow], TOLERANCE, 0.0), []);
    }

    /// A short piece that is longer than the tolerance is not simply lost: the loader will say why it cannot be.
    #[test]
    fn what_would_leave_a_gap_stays() {
        let line = Segment::Line(Line { start: Complex::ZERO, end: Complex::new(1.0, 0.0) });
        let pieces = vec![piece(line, 0.5, 0.5 + 1e-6 * 1e-3, 0.0)];
        assert_eq!(drivable(pieces.clone(), 1e-10, 0.0), pieces);
    }

    /// The tool is as round as the contour at its tightest: inside a piece, and at either end of one.
    #[test]
    fn a_cusp_is_kept_clear_of() {
        let (segment, distance) = lobe();
        for (from, to, parts) in [(0.0, 1.0, 2), (0.0, 0.5, 1), (0.5, 1.0, 1)] {
            let whole = piece(segment, from, to, distance);
            assert_eq!(refusal(&whole, 0.0), Some(PathError::Cusp));
            let kept = drivable(vec![whole], TOLERANCE, 0.0);
            assert_eq!(kept.len(), parts, "{from}..{to}");
            assert!(kept.iter().all(|piece| refusal(piece, 0.0).is_none()));
            let gap = gap(&whole, &kept);
            // No more than is needed: the offset moves by the cube of the parameter here, so that little is.
            assert!(gap > 0.0 && gap < 1e-2 * TOLERANCE, "{gap}");
        }
    }

    /// Beyond the contour's curvature the offset turns back; no tolerance helps there.
    #[test]
    fn an_offset_that_turns_back_is_left_to_the_loader() {
        let (segment, distance) = lobe();
        for to in [0.5, 1.0] {
            let pieces = vec![piece(segment, 0.0, to, 1.5 * distance)];
            assert_eq!(drivable(pieces.clone(), TOLERANCE, 0.0), pieces);
        }
    }
}

//! A trimmed offset that is known in closed form, and its comparison with a found one, from every side.

use host_sim::contour::{Along, Contour};
use host_sim::offset::{Offset, OffsetError, trim};
use shared::complex::Complex;

use crate::chain::{Placing, reversed, size};

/// The project's bar for closed forms, relative to the value, or to the size for points.
pub const BAR: f64 = 1e-9;

/// What an area may be wrong by at least, in parts of the size squared: a loop that nearly vanishes is a difference of numbers
/// that large.
const ROUNDING: f64 = 1e-14;

/// A loop as it must be.
#[derive(Clone, Debug)]
pub struct Ring {
    /// Its length.
    pub length: f64,
    /// Its signed area when the contour is travelled as it was built; none of an open loop.
    pub area: Option<f64>,
    /// All points where its pieces begin and end.
    pub points: Vec<Complex<f64>>,
}

/// Compares the trimmed offset with `rings`, in any order; and those of the contour travelled backwards, of its mirror image, of
/// both, each turned by some angle and shifted by some sizes. Panics at the first difference.
pub fn assert_rings(contour: &Contour, distance: f64, rings: &[Ring]) {
    for way in ways(contour) {
        let Way { contour, placing, backwards, name } = way;
        let distance = signed(distance, &placing, backwards);
        match trim(&contour, distance) {
            Ok(offset) => assert_offset(&contour, &offset, rings, &placing, backwards, name),
            Err(error) => panic!("{name}: {error:?}"),
        }
    }
}

/// The same ways, where nothing must be left and the largest tool on that side is known; it is told to 1e-7 of itself.
pub fn assert_empty(contour: &Contour, distance: f64, largest: f64) {
    for Way { contour, placing, backwards, name } in ways(contour) {
        match trim(&contour, signed(distance, &placing, backwards)) {
            Err(OffsetError::Empty { largest: told }) => {
                assert!((told / largest - 1.0).abs() < 1e-7, "{name}: {told} instead of {largest}");
            }
            other => panic!("{name}: {other:?} instead of nothing"),
        }
    }
}

/// Hands each of the ways, and the distance there, to `f`.
pub fn each_way(contour: &Contour, distance: f64, f: impl Fn(&Contour, f64, &Placing)) {
    for Way { contour, placing, backwards, .. } in ways(contour) {
        f(&contour, signed(distance, &placing, backwards), &placing);
    }
}

struct Way {
    contour: Contour,
    placing: Placing,
    backwards: bool,
    name: &'static str,
}

fn ways(contour: &Contour) -> Vec<Way> {
    let size = size(contour);
    let turned = Placing { factor: crate::random::unit(0.7), shift: Complex::new(1.3, -0.4) * size, mirror: false };
    let ways = [
        ("as it is", Placing::shift(Complex::ZERO), false),
        ("backwards", Placing::shift(Complex::ZERO), true),
        ("mirrored", Placing::mirror_x(), false),
        ("mirrored and backwards", Placing::mirror_x(), true),
        ("turned", turned, false),
        ("turned and mirrored", Placing { mirror: true, ..turned }, true),
    ];
    ways.into_iter()
        .map(|(name, placing, backwards)| {
            let image = placing.contour(contour);
            Way { contour: if backwards { reversed(&image) } else { image }, placing, backwards, name }
        })
        .collect()
}

fn signed(distance: f64, placing: &Placing, backwards: bool) -> f64 {
    placing.distance(distance) * if backwards { -1.0 } else { 1.0 }
}

fn assert_offset(contour: &Contour, offset: &Offset, rings: &[Ring], placing: &Placing, backwards: bool, name: &str) {
    assert_eq!(offset.loops.len(), rings.len(), "{name}: loops");
    let sense = if backwards == placing.mirror { 1.0 } else { -1.0 };
    let size = size(contour).max(offset.distance.abs());
    let mut left: Vec<&Ring> = rings.iter().collect();
    for ring in &offset.loops {
        let nearest = (0..left.len()).min_by(|&a, &b| {
            let off = |k: usize| (left[k].length - ring.length).abs();
            off(a).total_cmp(&off(b))
        });
        let Some(expected) = nearest.map(|k| left.swap_remove(k)) else { return };
        let off = (ring.length - expected.length) / expected.length;
        assert!(off.abs() < BAR, "{name}: length {} instead of {}, {off:e}", ring.length, expected.length);
        assert_eq!(ring.closed, expected.area.is_some(), "{name}: closed");
        if let Some(area) = expected.area {
            let off = ring.area - area * sense;
            assert!(
                off.abs() < BAR * area.abs() + ROUNDING * size * size,
                "{name}: area {} instead of {area}",
                ring.area
            );
        }
        let points: Vec<_> = expected.points.iter().map(|p| placing.point(*p)).collect();
        let ends: Vec<_> = ring.pieces.iter().flat_map(|piece| [piece.start, piece.end]).collect();
        let near = |a: &Complex<f64>, b: &Complex<f64>| (*a - *b).norm() < BAR * size;
        for end in &ends {
            assert!(points.iter().any(|p| near(p, end)), "{name}: {end:?} is no end of a piece; {points:?} are");
        }
        for point in &points {
            assert!(ends.iter().any(|p| near(p, point)), "{name}: no piece ends at {point:?}, but at {ends:?}");
        }
        for piece in &ring.pieces {
            let (Along::Segment { from, to, .. } | Along::Fill { from, to, .. }) = piece.along;
            assert!(from < to, "{name}: {:?}", piece.along);
        }
    }
}

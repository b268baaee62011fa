use shared::curve::{Arc, Line};

use super::*;
use crate::offset::{Loop, Piece};

fn at(x: f64, y: f64) -> Complex<f64> {
    Complex::new(x, y)
}

/// A square of side 10, anticlockwise: the outside is right of travel.
fn square() -> Contour {
    let corners = [at(0.0, 0.0), at(10.0, 0.0), at(10.0, 10.0), at(0.0, 10.0)];
    let line = |k: usize| Segment::Line(Line { start: corners[k], end: corners[(k + 1) % 4] });
    Contour { segments: (0..4).map(line).collect(), closed: true }
}

/// An offset of one closed loop along `alongs`; what clearances do not ask for is left empty.
fn offset(contour: &Contour, distance: f64, alongs: &[Along]) -> Offset {
    let piece = |along: &Along| {
        let (segment, [from, to], d) = contour.carrier(*along, distance).unwrap();
        let [start, end] = [from, to].map(|xi| segment.offset_point(xi, d));
        Piece { along: *along, start, end, start_turn: 0.0, end_turn: 0.0 }
    };
    let pieces = alongs.iter().map(piece).collect();
    Offset { distance, loops: vec![Loop { closed: true, pieces, length: 0.0, area: 0.0, parent: None, depth: 0 }] }
}

fn segments(count: usize, from: f64, to: f64) -> Vec<Along> {
    (0..count).map(|segment| Along::Segment { segment, from, to }).collect()
}

fn fills(count: usize) -> Vec<Along> {
    (0..count).map(|node| Along::Fill { node, from: 0.0, to: 1.0 }).collect()
}

#[test]
fn around_a_square_nothing_is_removed_or_left() {
    let square = square();
    let whole = [segments(4, 0.0, 1.0), fills(4)].concat();
    let found = clearance(&square, &offset(&square, 1.5, &whole));
    assert!((found.smallest - 1.5).abs() < 1e-14, "{found:?}");
    assert_eq!(found.largest_removed, 0.0);
    assert!(found.largest_undercut.abs() < 1e-14, "{found:?}");
}

/// Inside a square of side 10 a tool of radius 1 stays between 1 and 9, and leaves sqrt 2 - 1 in each corner. A point at t from a
/// corner could be touched by a tool of t.
#[test]
fn inside_a_square_the_corners_are_left() {
    let square = square();
    let found = clearance(&square, &offset(&square, -1.0, &segments(4, 0.1, 0.9)));
    assert!((found.smallest - 1.0).abs() < 1e-14, "{found:?}");
    assert!(found.largest_removed < 1.0 && found.largest_removed > 0.99, "{found:?}");
    assert!((found.largest_undercut - (2.0_f64.sqrt() - 1.0)).abs() < 1e-14, "{found:?}");
    assert!([0.0, 10.0].contains(&found.largest_undercut_at.re) && [0.0, 10.0].contains(&found.largest_undercut_at.im));
}

#[test]
fn a_piece_that_is_not_trimmed_is_seen() {
    let square = square();
    // The untrimmed ends lie on the neighbouring sides.
    let found = clearance(&square, &offset(&square, -1.0, &segments(4, 0.0, 1.0)));
    assert!(found.smallest < 1e-14, "{found:?}");
    // 1e-5 too far, on one side alone.
    let mut alongs = segments(4, 0.1, 0.9);
    alongs[2] = Along::Segment { segment: 2, from: 0.1, to: 0.9 + 1e-6 };
    let found = clearance(&square, &offset(&square, -1.0, &alongs));
    assert!((found.smallest - (1.0 - 1e-5)).abs() < 1e-13, "{found:?}");
    assert!((found.smallest_at - at(1.0 - 1e-5, 9.0)).norm() < 1e-13, "{found:?}");
}

#[test]
fn a_piece_that_should_have_stayed_is_seen() {
    let square = square();
    // A fill arc is missing: nothing keeps a tool of twice the radius, which is as far as is looked, from that corner.
    let mut alongs = [segments(4, 0.0, 1.0), fills(4)].concat();
    alongs.pop();
    let found = clearance(&square, &offset(&square, 1.5, &alongs));
    assert!((found.largest_removed - 3.0).abs() < 1e-9, "{found:?}");
    // Inside, a part of a side is missing: from 3 to 7. Its middle could be touched by a tool of 2, and up to 5.
    let mut alongs = segments(4, 0.1, 0.9);
    alongs[0] = Along::Segment { segment: 0, from: 0.1, to: 0.3 };
    alongs.push(Along::Segment { segment: 0, from: 0.7, to: 0.9 });
    let found = clearance(&square, &offset(&square, -1.0, &alongs));
    assert!((found.largest_removed - 2.0).abs() < 1e-9, "{found:?}");
    // At most 2 from the next point of the path in length, and 1 in height.
    let most = 5.0_f64.sqrt() - 1.0;
    assert!(found.largest_undercut <= most && found.largest_undercut > most - 0.05, "{found:?}");
    // Trimmed 1e-5 too early: a tool of 1 + 1e-5 could stand there.
    let mut alongs = segments(4, 0.1, 0.9);
    alongs[2] = Along::Segment { segment: 2, from: 0.1 + 1e-6, to: 0.9 };
    let found = clearance(&square, &offset(&square, -1.0, &alongs));
    assert!(found.largest_removed > 1.0 && found.largest_removed < 1.0 + 1e-5, "{found:?}");
}

/// A slot of width 2 and length 10 between round ends is one line there and back for a tool of radius 1; slightly larger tools
/// touch nothing.
#[test]
fn a_slot_bounds_the_tool_by_half_its_width() {
    let line = |a, b| Segment::Line(Line { start: a, end: b });
    let bow = |start, radius| Segment::Arc(Arc { start, radius, sweep: std::f64::consts::PI });
    let segments = vec![
        line(at(0.0, 0.0), at(10.0, 0.0)),
        bow(at(10.0, 0.0), at(0.0, -1.0)),
        line(at(10.0, 2.0), at(0.0, 2.0)),
        bow(at(0.0, 2.0), at(0.0, 1.0)),
    ];
    let slot = Contour { segments, closed: true };
    for tool in [1.0 + 1e-7, 1.5, 20.0] {
        let found = clearance(&slot, &Offset { distance: -tool, loops: Vec::new() });
        assert!((found.largest_removed - 1.0).abs() < 1e-6, "{tool}: {found:?}");
    }
    let found = clearance(&slot, &offset(&slot, -0.75, &self::segments(4, 0.0, 1.0)));
    assert!((found.smallest - 0.75).abs() < 1e-14 && found.largest_undercut.abs() < 1e-14, "{found:?}");
    assert_eq!(found.largest_removed, 0.0);
}

/// A PH curve like a parabola, r' = (1 + i x/2)^2 on -1..=1: its vertex bends with the radius 1/2 (xi runs half as fast as x), so
/// that larger tools do not come there.
#[test]
fn a_bend_bounds_the_tool_by_its_radius() {
    let curve = shared::curve::PhQuintic { start: at(0.0, 0.0), w: [at(1.0, -0.5), at(1.0, 0.0), at(1.0, 0.5)] };
    let lobe = Contour { segments: vec![Segment::Ph(curve)], closed: false };
    // Left of travel is the inside of the bend. At 1 + kappa d = 0 the offset has a cusp.
    let whole = segments(1, 0.0, 1.0);
    let found = clearance(&lobe, &offset(&lobe, -0.5, &whole));
    assert!((found.smallest - 0.5).abs() < 1e-14 && found.largest_undercut.abs() < 1e-14, "{found:?}");
    let found = clearance(&lobe, &offset(&lobe, -0.6, &whole));
    assert!(found.smallest < 0.6 - 1e-3, "{found:?}");
    // Nothing but the vertex left out: a tool of its radius would do there, but no larger one.
    let around = [(0.0, 0.499), (0.501, 1.0)].map(|(from, to)| Along::Segment { segment: 0, from, to });
    let found = clearance(&lobe, &offset(&lobe, -0.4, &around));
    assert!((found.largest_removed - 0.5).abs() < 1e-6, "{found:?}");
}

#[test]
fn progress_goes_from_nothing_to_all() {
    let square = square();
    let mut told = Vec::new();
    let found = clearance_with(&square, &offset(&square, -1.0, &segments(4, 0.1, 0.9)), 4, |done| told.push(done));
    // Pieces, removed parts at both ends of each, segments.
    assert_eq!(told.len(), 4 + 8 + 4);
    assert!(told.windows(2).all(|pair| pair[0] < pair[1]) && told.last() == Some(&1.0));
    assert!(found.samples > 4 * (4 + 8 + 4));
}

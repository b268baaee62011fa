//! Contours that do not, and all else that stands in a program.

use std::f64::consts::{FRAC_PI_2, PI};

use super::*;
use crate::program::Feed;

/// A notch of 10 x 4 mm is too narrow for a tool of radius 6: it rolls over both edges, whose arcs meet above the middle, and leaves most
/// of it.
#[test]
fn a_notch_that_is_too_narrow_is_left_with_a_warning() {
    let program = "t4 m6\ng0 x-20 y0\ng41 g1 x0 y0\nx10\ny-4\nx20\ny0\nx30\ng40 g0 y50\n";
    let found = with(program);
    let height = (36.0_f64 - 25.0).sqrt();
    assert_ends(&found, &[[0.0, 6.0], [10.0, 6.0], [15.0, height], [20.0, 6.0], [30.0, 6.0]]);
    let [warning] = found.warnings[..] else { panic!("{:?}", found.warnings) };
    // The corners of the bottom are farthest away.
    assert!((warning.depth - (5.0_f64.hypot(height + 4.0) - 6.0)).abs() < 1e-6, "{warning}");
    assert_eq!(warning.lines, [6, 8]);
    assert!(warning.to_string().starts_with("lines 6 to 8: a tool of radius 6 mm cannot enter and leaves up to 2.8"));
    let refused = try_with(program, Options { gouge: Gouge::Refuse, ..Options::default() }).unwrap_err();
    assert!(refused.contains("lines 6 to 8: a tool of radius 6 mm cannot enter"), "{refused}");
}

/// An inside corner of arcs that are rounder than the tool is none; one that is tighter is left.
#[test]
fn an_inside_arc_is_followed_if_the_tool_is_no_larger() {
    let program = |radius: f64| {
        format!("t1 m6\ng0 x10 y9\ng41 g1 x0 y9\ny{radius}\ng3 x{radius} y0 r{radius}\ng1 x20\ng40 g0 y9\n")
    };
    let found = with(&program(3.0));
    assert_ends(&found, &[[1.0, 9.0], [1.0, 3.0], [3.0, 1.0], [20.0, 1.0]]);
    assert!(found.warnings.is_empty());
    let found = with(&program(0.5));
    assert_ends(&found, &[[1.0, 9.0], [1.0, 1.0], [20.0, 1.0]]);
    let [warning] = found.warnings[..] else { panic!("{:?}", found.warnings) };
    assert_eq!(warning.lines, [5, 7]);
    assert!((warning.depth - 0.5 * (2.0_f64.sqrt() - 1.0)).abs() < 1e-6, "{warning}");
}

/// G42.1 and G41.1 need no table, a negative diameter is the other side, and none is no compensation.
#[test]
fn diameters_come_from_the_word_or_the_table() {
    let run = |on: &str| ends(&with(&format!("t1 m6\ng0 x-10 y0\n{on} g1 x0 y0\nx20\ny20\ng40 g0 x50\n")));
    let right = run("g42");
    assert_eq!(right[..2], [[0.0, -1.0], [20.0, -1.0]]);
    assert_eq!(run("g42 d1"), right);
    assert_eq!(run("g42.1 d2"), right);
    assert_eq!(run("g41 d2"), right);
    assert_eq!(run("g42 d2"), run("g41"));
    let found = with("g0 x-10 y0\ng42 d3 g1 x0 y0\nx20\ng40 g0 x50\n");
    assert_eq!((found.pieces.len(), found.summary.runs), (0, 0));
    assert_eq!(found.kept.iter().filter(|(_, item)| matches!(item.action, Action::Motion(_))).count(), 4);
}

/// The tool's centre goes along a circle that begins where the tool is and ends tangentially beside the programmed arc's end: its centre is
/// at the height of that, and (9 - c)^2 = c^2 + 10^2.
#[test]
fn an_arc_may_lead_in() {
    let found = with("t1 m6\ng0 x0 y0\ng41 g3 x10 y10 i0 j10\ng1 y20\ng40 g0 x0\n");
    assert_ends(&found, &[[9.0, 10.0], [9.0, 20.0]]);
    let Segment::Arc(arc) = found.pieces[0].segment else { panic!("{:?}", found.pieces[0]) };
    assert!((arc.centre() - Complex::new(-19.0 / 18.0, 10.0)).norm() < 1e-9, "{:?}", arc.centre());
}

/// A run that begins where another one has just ended begins where the tool's centre is.
#[test]
fn a_run_may_follow_another() {
    let found = with("t1 m6\ng0 x-10 y0\ng41 g1 x0 y0\nx20\ng40\ng42 y-20\nx0\ng40 g0 x-50\n");
    // Right of the way back is above it; the corner in between is concave.
    assert_ends(&found, &[[0.0, 1.0], [20.0, 1.0], [20.0, -19.0], [0.0, -19.0]]);
}

/// A ramp falls evenly along its side; where a corner cannot be reached the heights on both sides of it meet.
#[test]
fn heights_go_along() {
    let found = with("t1 m6\ng0 x10 y9\ng41 g1 x0 y9 z-1\ny0 z-10\nx20 z-30\ng40 g0 y9 z5\n");
    assert_ends(&found, &[[1.0, 9.0], [1.0, 1.0], [20.0, 1.0]]);
    let z: Vec<[f64; 2]> = found.pieces.iter().map(|piece| piece.z).collect();
    // At 8 mm of the first wall it is at -9, at 1 mm of the second one at -11.
    for (found, wanted) in z.iter().zip([[0.0, -1.0], [-1.0, -10.0], [-10.0, -30.0]]) {
        assert!((found[0] - wanted[0]).abs() < 1e-9 && (found[1] - wanted[1]).abs() < 1e-9, "{z:?}");
    }
}

/// What happens between two motions happens there.
#[test]
fn events_stay_where_they_are() {
    let found = with("t1 m6\ng0 x-10 y0\ng41 g1 x0 y0\nm8\nx20\nm9 x40\ng4 p1\ng0 x60\ng1 x80\ng40\ng0 z9\nx90 y9\n");
    let inside = found.kept.iter().filter(|(before, _)| *before > 0 && *before < found.pieces.len());
    let events: Vec<_> = inside.map(|(before, item)| (*before, item.action, item.from)).collect();
    let coolant = |flood| Action::Coolant(crate::program::item::Coolant { mist: false, flood });
    assert_eq!(
        events,
        [
            (1, coolant(true), [0.0, 1.0, 0.0]),
            (2, coolant(false), [20.0, 1.0, 0.0]),
            (3, Action::Dwell(1.0), [40.0, 1.0, 0.0])
        ]
    );
    assert_eq!(found.pieces.iter().map(|piece| piece.is_rapid).collect::<Vec<_>>(), [false, false, false, true, false]);
    let behind: Vec<_> = found.kept.iter().filter(|(before, _)| *before == 5).map(|(_, item)| *item).collect();
    assert_eq!(
        (behind[0].from, behind[0].action),
        ([80.0, 1.0, 0.0], Action::Motion(Motion::Rapid { to: [80.0, 1.0, 9.0] }))
    );
    assert_eq!(
        (behind[1].from, behind[1].action),
        ([80.0, 1.0, 9.0], Action::Motion(Motion::Rapid { to: [90.0, 9.0, 9.0] }))
    );
}

/// Lines, arcs and rapids as a program has them.
#[test]
fn pieces_are_motions_again() {
    let found = with("t1 m6\ng0 x-10 y0\ng42 g1 x0 y0\nx20\ny20\ng40 g0 x50\n");
    let item = found.pieces[2].item().unwrap();
    let Action::Motion(Motion::Arc(arc)) = item.action else { panic!("{item:?}") };
    assert_eq!((item.feed, item.line, item.from), (Feed::Rate(10.0), 5, [20.0, -1.0, 0.0]));
    assert!((arc.centre[0] - 20.0).hypot(arc.centre[1]) < 1e-12 && (arc.sweep - FRAC_PI_2).abs() < 1e-12);
}

/// The time of a whole motion becomes its rate along the contour: 20 mm in 6 s.
#[test]
fn inverse_time_becomes_a_rate() {
    let found = with("t1 m6\ng0 x-10 y0\ng93 g42 g1 x0 y0 f10\nx20 f10\ng40 g1 x50 f10\n");
    assert_eq!(found.pieces[0].feed, Feed::Duration(6.0));
    assert_eq!(found.pieces[1].feed, Feed::Rate(20.0 / 6.0));
}

/// The offset of a cubic arch: PH pieces at the tool's radius, and as far from the cubic itself but for the tolerance.
#[test]
fn splines_are_offset_as_ph_curves() {
    let found = with("t1 m6\ng0 x0 y-10\ng41 g1 x0 y0\ng5 i0 j12 p0 q12 x20 y0\ng40 g0 x50\n");
    let (ph, others): (Vec<CentrePiece>, Vec<_>) =
        found.pieces.iter().partition(|piece| matches!(piece.segment, Segment::Ph(_)));
    assert!(ph.len() > 2 && others.len() <= 2, "{others:?}");
    assert!(ph.iter().all(|piece| piece.offset == -1.0));
    let contour: Vec<Segment<f64>> = ph.iter().map(|piece| piece.segment).collect();
    let nearest = clearance(&ph, &contour);
    assert!((nearest - 1.0).abs() < 1e-9, "{nearest}");
    let cubic = |t: f64| Complex::new(60.0 * t * t - 40.0 * t * t * t, 36.0 * t * (1.0 - t));
    let points: Vec<[f64; 2]> = (0..=2000).map(|k| cubic(f64::from(k) / 2000.0)).map(|p| [p.re, p.im]).collect();
    let chords = polygon(&points);
    let nearest = clearance(&ph, &chords);
    assert!((nearest - 1.0).abs() < 1.01e-3, "{nearest}");
}

/// A circle of 720 short lines becomes a few curves.
#[test]
fn chains_of_lines_may_become_curves() {
    let mut program = "t1 m6\ng0 x20 y0\ng42 g1 x10 y0\n".to_string();
    for k in 1..=720 {
        let (sine, cosine) = (PI * f64::from(k) / 360.0).sin_cos();
        program.push_str(&format!("x{:.5} y{:.5}\n", 10.0 * cosine, 10.0 * sine));
    }
    program.push_str("g40 g0 x50\n");
    let found = try_with(&program, Options { lines: Some(0.002), ..Options::default() }).unwrap();
    assert!(found.pieces.len() < 80, "{}", found.pieces.len());
    for piece in &found.pieces[1..] {
        let [from, to] = piece.interval;
        for k in 0..=20 {
            let point = piece.point(from + (to - from) * f64::from(k) / 20.0);
            assert!((point.norm() - 11.0).abs() < 0.0025, "{}", point.norm());
        }
    }
}

#[test]
fn each_fault_has_a_sentence() {
    let line = "g0 x-10 y0\ng42 g1 x0 y0\nx20\n";
    let of = |program: &str| sentence(program).split_once(": ").unwrap().1.lines().next().unwrap().to_string();
    assert!(of("g41 g1 x9").starts_with("no tool is loaded for cutter compensation;"));
    assert!(of("g41 d7 g1 x9").starts_with("tool 7 is in no tool table;"));
    assert!(of("t9 m6\ng41 g1 x9").starts_with("tool 9 is in no tool table;"));
    assert!(
        of("t4 m6\ng41 g1 x5\ny9\ng40")
            .contains("is 5 mm long; it needs more than the tool's radius of 6 mm (line 3, column")
    );
    assert!(of(&format!("t1 m6\n{line}t2 m6")).starts_with("a tool change stands within cutter compensation"));
    assert!(of(&format!("t1 m6\n{line}g1 a5")).starts_with("a motion of an axis other than X, Y and Z stands"));
    assert!(
        of(&format!("t1 m6\n{line}g40 g2 x30 i5"))
            .starts_with("the first motion behind cutter compensation is a curve")
    );
    assert!(
        of("t1 m6\ng41 g5 i1 j1 p1 q1 x9 y9").starts_with("the first motion under cutter compensation is a spline")
    );
    assert!(of("g18 g41.1 d1 g1 x5\ng2 x7 i1").starts_with("cutter compensation is in the XY plane here"));
    let bore = "t4 m6\ng0 x0 y0\ng41 g1 x20 y0\ng3 x20 i4\ng40 g0 x0";
    assert!(of(bore).contains("the largest tool that fits has radius 4 mm (line 5, column"), "{}", of(bore));
}

//! Contours that come back to themselves.

use std::f64::consts::PI;

use super::*;

/// Outside a square of 20 mm with a tool of radius 1: four sides, three corners, and the fourth one where it begins.
#[test]
fn a_square_outside_is_rounded_at_its_corners() {
    let found = with(&format!("t1 m6\ng0 x-10 y0\ng42 g1 x0 y0\n{SQUARE}g40 g1 x0 y-10\n"));
    // The way in touches the circle about the corner: its angle has the sine 1/10.
    let (sine, cosine) = (0.1, 0.99_f64.sqrt());
    assert_ends(
        &found,
        &[
            [-sine, -cosine],
            [0.0, -1.0],
            [20.0, -1.0],
            [21.0, 0.0],
            [21.0, 20.0],
            [20.0, 21.0],
            [0.0, 21.0],
            [-1.0, 20.0],
            [-1.0, 0.0],
            // And off again, about the same corner.
            [-cosine, -sine],
        ],
    );
    assert!((clearance(&found.pieces, &polygon(&CORNERS)) - 1.0).abs() < 1e-9);
    assert!(found.warnings.is_empty());
    let last = found.kept.iter().rfind(|(_, item)| matches!(item.action, Action::Motion(_))).unwrap().1;
    assert_eq!(last.action, Action::Motion(Motion::Line { to: [0.0, -10.0, 0.0] }));
}

/// Inside the same square, from its middle: the way in leads straight to the wall, and corners keep the tool's roundness.
#[test]
fn a_pocket_is_entered_from_its_middle() {
    let found = with("t1 m6\ng0 x10 y10\ng41 g1 x10 y0\nx20\ny20\nx0\ny0\nx10\ng40 g1 x10 y10\n");
    assert_ends(&found, &[[10.0, 1.0], [19.0, 1.0], [19.0, 19.0], [1.0, 19.0], [1.0, 1.0], [10.0, 1.0]]);
    assert!((clearance(&found.pieces, &polygon(&CORNERS)) - 1.0).abs() < 1e-9);
    assert_eq!(found.summary, Summary { runs: 1, pieces: 6, corners: 4, warnings: 0 });
}

/// A pocket that begins in a corner: the path begins where both walls are touched.
#[test]
fn a_pocket_that_begins_in_a_corner_is_kept_clear_of_both_walls() {
    let found = with(&format!("t1 m6\ng0 x10 y10\ng41 g1 x0 y0\n{SQUARE}g40 g1 x10 y10\n"));
    assert_ends(&found, &[[1.0, 1.0], [19.0, 1.0], [19.0, 19.0], [1.0, 19.0], [1.0, 1.0]]);
    assert!((clearance(&found.pieces, &polygon(&CORNERS)) - 1.0).abs() < 1e-9);
}

/// A bore of radius 10 with a half circle of radius 5 in and out: circles of radius 9 and 4.
#[test]
fn a_bore_is_entered_and_left_on_tangent_arcs() {
    let found =
        with("t1 m6\ng0 x0 y0\ng41 g1 x5 y-5\ng3 x10 y0 i0 j5\ng3 x10 y0 i-10 j0\ng3 x5 y5 i-5 j0\ng40 g1 x0 y0\n");
    assert_ends(&found, &[[5.0, -4.0], [9.0, 0.0], [9.0, 0.0], [5.0, 4.0]]);
    let Segment::Arc(round) = found.pieces[2].segment else { panic!("{:?}", found.pieces[2]) };
    assert!((round.sweep - 2.0 * PI).abs() < 1e-9 && round.centre().norm() < 1e-9, "{round:?}");
    assert!(found.warnings.is_empty());
}

/// A square that is begun in the middle of a side on an arc, run over its start by 2 mm, and left on an arc.
#[test]
fn a_round_may_run_over_its_start() {
    let found = with(
        "t1 m6\ng0 x5 y-10\ng42 g1 x5 y-5\ng2 x10 y0 i5 j0\ng1 x20\ny20\nx0\ny0\nx12\n\
         g2 x17 y-5 i0 j-5\ng40 g1 x17 y-10\n",
    );
    assert_ends(
        &found,
        &[
            [6.0, -5.0],
            [10.0, -1.0],
            [20.0, -1.0],
            [21.0, 0.0],
            [21.0, 20.0],
            [20.0, 21.0],
            [0.0, 21.0],
            [-1.0, 20.0],
            [-1.0, 0.0],
            [0.0, -1.0],
            [12.0, -1.0],
            [16.0, -5.0],
        ],
    );
    assert!((clearance(&found.pieces, &polygon(&CORNERS)) - 1.0).abs() < 1e-9);
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
}

/// The way into a pocket through its wall cuts as deep as the tool is thick on one side.
#[test]
fn a_way_in_that_cuts_is_said() {
    let program = "t1 m6\ng0 x30 y10\ng41 g1 x0 y10\ny0\nx20\ny20\nx0\ny10\ng40 g1 x10 y10\n";
    let found = with(program);
    let [warning] = found.warnings[..] else { panic!("{:?}", found.warnings) };
    assert_eq!((warning.trouble, warning.lines), (Trouble::Entry, [4; 2]));
    assert!((warning.depth - 1.0).abs() < 1e-9 && (warning.at - Complex::new(20.0, 10.0)).norm() < 0.1, "{warning}");
    let refused = try_with(program, Options { gouge: Gouge::Refuse, ..Options::default() }).unwrap_err();
    assert!(refused.contains("cuts 1 mm into the contour on its way in"), "{refused}");
}

/// Two lines that cross without a common point: each side is kept to the left, and the loop is run.
#[test]
fn a_contour_may_cross_itself() {
    let found = with("t1 m6\ng0 x-10 y-10\ng41 g1 x0 y0\nx20 y20\nx20 y0\nx0 y20\ng40 g0 x-20\n");
    let h = 0.5_f64.sqrt();
    assert_ends(&found, &[[-h, h], [20.0 - h, 20.0 + h], [21.0, 20.0], [21.0, 0.0], [20.0 - h, -h], [-h, 20.0 - h]]);
}

/// Three rounds, one deeper than the other: none of them holds up the next.
#[test]
fn rounds_may_be_repeated() {
    let round = "x20\ny20\nx0\ny0\n";
    let found = with(&format!("t1 m6\ng0 x-10 y0\ng42 g1 x0 y0\nz-1\n{round}z-2\n{round}z-3\n{round}g40 g1 x0 y-10\n"));
    // The way in and its arc, then four sides with three or four corners, then the arc off.
    assert_eq!(found.pieces.len(), 2 + 7 + 8 + 8 + 1, "{:?}", ends(&found));
    assert!((clearance(&found.pieces, &polygon(&CORNERS)) - 1.0).abs() < 1e-9);
    let depths = found.kept.iter().filter_map(|(before, item)| match item.action {
        Action::Motion(Motion::Line { to }) => Some((*before, item.from, to)),
        _ => None,
    });
    let depths: Vec<_> = depths.take(3).collect();
    assert_eq!(depths[0], (2, [0.0, -1.0, 0.0], [0.0, -1.0, -1.0]));
    assert_eq!((depths[1].0, depths[1].2[2]), (2 + 7, -2.0));
    assert_eq!((depths[2].0, depths[2].2[2]), (2 + 7 + 8, -3.0));
}

/// Three turns of a helix in a bore of radius 10 are three turns in one of radius 9, as deep.
#[test]
fn turns_of_a_helix_are_rounds() {
    let found = with("t1 m6\ng0 x0 y0\ng41 g1 x10 y0\ng3 x10 y0 z-6 i-10 j0 p3\ng40 g1 x0 y0\n");
    assert_ends(&found, &[[9.0, 0.0]; 4]);
    let z: Vec<[f64; 2]> = found.pieces.iter().map(|piece| piece.z).collect();
    for (found, wanted) in z.iter().zip([[0.0, 0.0], [0.0, -2.0], [-2.0, -4.0], [-4.0, -6.0]]) {
        assert!((found[0] - wanted[0]).abs() < 1e-9 && (found[1] - wanted[1]).abs() < 1e-9, "{z:?}");
    }
}

/// A closed drop of two cubics, its tip at the origin, from outside and from inside.
#[test]
fn a_round_may_be_of_splines() {
    let drop = "g5 i10 j-10 p0 q-8 x20 y0\ng5 i0 j8 p10 q10 x0 y0\n";
    for (on, from, side) in [("g42", "x-10 y0", 1.0), ("g41", "x12 y0", -1.0)] {
        let found = with(&format!("t1 m6\ng0 {from}\n{on} g1 x0 y0\n{drop}g40 g1 {from}\n"));
        let ph: Vec<CentrePiece> =
            found.pieces.iter().copied().filter(|piece| matches!(piece.segment, Segment::Ph(_))).collect();
        assert!(ph.iter().all(|piece| piece.offset == side));
        let contour: Vec<Segment<f64>> = ph.iter().map(|piece| piece.segment).collect();
        let nearest = clearance(&found.pieces[1..], &contour);
        assert!((nearest - 1.0).abs() < 1e-6, "{nearest}");
        assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    }
}

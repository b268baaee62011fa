//! Lines, arcs and splines, against closed forms.

use std::f64::consts::{FRAC_PI_2, PI, SQRT_2, TAU};

use super::{Got, ends, good, good_with};
use crate::program::rs274::Settings;
use crate::program::{Arc, Feed, Plane};

/// Programs here have at most six decimals, and coordinates below 100.
const CLOSE: f64 = 1e-12;

/// The only arc of a program.
fn arc(program: &str) -> Arc {
    let arcs: Vec<Arc> = good(program)
        .into_iter()
        .filter_map(|item| if let Got::Arc(arc) = item.got { Some(arc) } else { None })
        .collect();
    assert_eq!(arcs.len(), 1, "{program}");
    arcs[0]
}

fn check(program: &str, plane: Plane, centre: [f64; 2], sweep: f64) {
    let arc = arc(program);
    assert_eq!(arc.plane, plane, "{program}");
    let off = (arc.centre[0] - centre[0]).hypot(arc.centre[1] - centre[1]);
    assert!(off < CLOSE && (arc.sweep - sweep).abs() < CLOSE, "{program}: {arc:?}");
}

#[test]
fn lines_are_absolute_or_incremental_in_either_unit() {
    assert_eq!(ends("g21 f1 g1 x1 y2 z3\nx4"), [[1.0, 2.0, 3.0], [4.0, 2.0, 3.0]]);
    assert_eq!(ends("g20 f1 g1 x1\ng21 x1"), [[25.4, 0.0, 0.0], [1.0, 0.0, 0.0]]);
    assert_eq!(ends("g0 x1\ng91 x1 y2\nx1"), [[1.0, 0.0, 0.0], [2.0, 2.0, 0.0], [3.0, 2.0, 0.0]]);
    let inch = Settings { units: crate::units::Units::Inch, start: [1.0, 1.0, 1.0], ..Settings::default() };
    let items = good_with("g0 x1", &inch);
    assert_eq!((items[0].from, &items[0].got), ([1.0; 3], &Got::Rapid([25.4, 1.0, 1.0])));
}

#[test]
fn feeds_are_millimetres_in_a_second_or_times() {
    let feeds = |program: &str| good(program).into_iter().map(|item| item.feed).collect::<Vec<_>>();
    assert_eq!(feeds("g0 x1\nf60 g1 x2\nf120\nx3"), [Feed::Unset, Feed::Rate(1.0), Feed::Rate(2.0)]);
    // The unit of a block holds for the whole block, and an old feed stays what it was.
    assert_eq!(feeds("f60 g20 g1 x1\ng21 x2"), [Feed::Rate(25.4 / 60.0 * 60.0); 2]);
    // Inverse time: F 2 is half a minute, whatever the length, and each cut has its own.
    assert_eq!(feeds("g93 g1 x1 f2\nx5 f4"), [Feed::Duration(30.0), Feed::Duration(15.0)]);
}

#[test]
fn arcs_by_centre() {
    check("f1 g0 x1\ng3 x0 y1 i-1", Plane::Xy, [0.0, 0.0], FRAC_PI_2);
    check("f1 g0 x1\ng2 x0 y1 i-1 j0", Plane::Xy, [0.0, 0.0], -3.0 * FRAC_PI_2);
    check("f1 g0 x1 y2\ng90.1 g3 x-1 y2 i0 j2", Plane::Xy, [0.0, 2.0], PI);
    check("f1 g0 x1 y2\ng90.1\ng91.1 g3 x-1 i-1", Plane::Xy, [0.0, 2.0], PI);
    check("f1 g91 g3 x2 i1", Plane::Xy, [1.0, 0.0], PI);
    // Full circles, with and without the end, and all but one.
    check("f1 g3 i5", Plane::Xy, [5.0, 0.0], TAU);
    check("f1 g2 x0 y0 j5", Plane::Xy, [0.0, 5.0], -TAU);
    check("f1 g3 x0.000001 i5", Plane::Xy, [5.0, 0.0], TAU);
    // XZ: Z is the first axis, so that a G2 goes from X to Z.
    check("f1 g18 g0 x1\ng2 x0 z1 i-1", Plane::Zx, [0.0, 0.0], -FRAC_PI_2);
    check("f1 g19 g0 y1\ng3 y0 z1 j-1", Plane::Yz, [0.0, 0.0], FRAC_PI_2);
}

#[test]
fn arcs_by_radius() {
    check("f1 g3 x1 y1 r1", Plane::Xy, [0.0, 1.0], FRAC_PI_2);
    check("f1 g2 x1 y1 r1", Plane::Xy, [1.0, 0.0], -FRAC_PI_2);
    check("f1 g3 x1 y1 r-1", Plane::Xy, [1.0, 0.0], 3.0 * FRAC_PI_2);
    check("f1 g2 x1 y1 r-1", Plane::Xy, [0.0, 1.0], -3.0 * FRAC_PI_2);
    check("f1 g2 x2 r1", Plane::Xy, [1.0, 0.0], -PI);
    // Half a circle whose radius has been rounded down.
    check("f1 g2 x2 r0.9999", Plane::Xy, [1.0, 0.0], -PI);
    check("f1 g18 g3 z1 x1 r1", Plane::Zx, [0.0, 1.0], FRAC_PI_2);
    let item = arc("f1 g20 g3 x1 y1 r1");
    assert!((item.centre[1] - 25.4).abs() < CLOSE && (item.to[0] - 25.4).abs() < CLOSE);
}

#[test]
fn helices_and_turns() {
    let helix = arc("f1 g0 x1\ng3 x0 y1 z7 i-1 p3");
    assert_eq!((helix.to, helix.turns), ([0.0, 1.0, 7.0], 2));
    assert!((helix.sweep - (FRAC_PI_2 + 2.0 * TAU)).abs() < CLOSE);
    let turns = arc("f1 g2 i1 z-3 p3");
    assert_eq!(turns.turns, 2);
    assert!((turns.sweep + 3.0 * TAU).abs() < CLOSE);
    // Arcs stay in force, and a centre alone is a full circle.
    let items = good("f1 g2 x2 i1\nx0 i-1\ni1");
    assert_eq!(items.len(), 3);
    assert!(items.iter().all(|item| matches!(item.got, Got::Arc(_))));
}

/// An S through three points; the second block takes the tangent of the first one over.
#[test]
fn cubic_splines_go_on_smoothly() {
    let items = good("g17 f100 g0 x0 y0 z1\ng5 i0 j3 p0 q-3 x1 y1\nx2 y2 p0 q-3\ng5 i1 j2 p3 q4 x3 y3");
    let [.., a, b, c] = &items[..] else { panic!("{items:?}") };
    assert_eq!(a.got, Got::Bezier(vec![[0.0, 3.0, 1.0], [1.0, -2.0, 1.0], [1.0, 1.0, 1.0]]));
    assert_eq!(b.got, Got::Bezier(vec![[1.0, 4.0, 1.0], [2.0, -1.0, 1.0], [2.0, 2.0, 1.0]]));
    assert_eq!(c.got, Got::Bezier(vec![[3.0, 4.0, 1.0], [6.0, 7.0, 1.0], [3.0, 3.0, 1.0]]));
}

#[test]
fn quadratic_splines_have_one_control_point() {
    let items = good("f1 g20 g5.1 x2 i1 j-1");
    assert_eq!(items[0].got, Got::Bezier(vec![[25.4, -25.4, 0.0], [50.8, 0.0, 0.0]]));
}

/// Five points of order 3 have three spans: the knots by the definition of a clamped uniform vector (Piegl and Tiller).
#[test]
fn nurbs_have_the_start_as_first_point_and_clamped_knots() {
    let items = good("g0 x0 y0\nf10\ng5.2 p2 l3\nx1 y3 p1\nx4 y5 p1\nx6 y2 p1\nx3 y-1 p2\ng5.3\ng0 x9");
    assert_eq!(items[1].place, (8, 1));
    assert_eq!(
        items[1].got,
        Got::Nurbs {
            order: 3,
            points: [[0.0, 0.0], [1.0, 3.0], [4.0, 5.0], [6.0, 2.0], [3.0, -1.0]].map(|[x, y]| [x, y, 0.0]).to_vec(),
            weights: vec![2.0, 1.0, 1.0, 1.0, 2.0],
            knots: vec![0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0],
        }
    );
    // A quarter of a circle: order 3, middle weight cos 45 degrees.
    let items = good(&format!("f1 g0 x1\ng5.2 x1 y1 p{:.12}\nx0 y1\ng5.3", 0.5 * SQRT_2));
    let Got::Nurbs { knots, points, .. } = &items[1].got else { panic!("{items:?}") };
    assert_eq!((knots.as_slice(), points.len()), (&[0.0, 0.0, 0.0, 1.0, 1.0, 1.0][..], 3));
    // Order 4 with as many points is one cubic Bezier curve.
    let items = good("f1 g5.2 x1 y1 l4\nx2 y1\nx3 y0\ng5.3");
    let Got::Nurbs { knots, order, .. } = &items[0].got else { panic!("{items:?}") };
    assert_eq!((*order, knots.as_slice()), (4, &[0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0][..]));
}

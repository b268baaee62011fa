//! Trimmed offsets of figures whose lengths, areas and trim points are known in closed form; each figure in both directions,
//! mirrored, and turned. Areas hold for the direction in which the figure is built.
#![allow(clippy::panic, reason = "a failed test says where")]

use std::f64::consts::{FRAC_PI_2, PI, SQRT_2, TAU};

use host_sim::contour::Contour;
use host_sim::offset::{OffsetError, largest_reaching, trim, undercuts};
use shared::complex::Complex;
use tests::chain::Chain;
use tests::expected::{BAR, Ring, assert_empty, assert_rings, each_way};
use tests::random::unit;

fn at(x: f64, y: f64) -> Complex<f64> {
    Complex::new(x, y)
}

fn ring(length: f64, area: f64, points: Vec<Complex<f64>>) -> Vec<Ring> {
    vec![Ring { length, area: Some(area), points }]
}

/// Undercuts of this thickness at these points of C, and no others.
fn assert_undercuts(contour: &Contour, distance: f64, depth: f64, deepest: &[Complex<f64>]) {
    each_way(contour, distance, |contour, distance, placing| {
        let offset = trim(contour, distance).unwrap_or_else(|error| panic!("{error:?}"));
        let found = undercuts(contour, &offset);
        assert_eq!(found.len(), deepest.len(), "{found:?}");
        for undercut in &found {
            assert!((undercut.depth - depth).abs() < BAR * distance.abs(), "{undercut:?} instead of {depth}");
        }
        for point in deepest.iter().map(|p| placing.point(*p)) {
            // Where the thickness is stationary, its place is good to the root of what its value is.
            let near = found.iter().any(|undercut| (undercut.deepest - point).norm() < 1e-5 * distance.abs());
            assert!(near, "nothing is left at {point:?}, but {found:?}");
        }
    });
}

/// The radius of the largest tool that reaches everything, good to 1e-7 of itself.
fn assert_reaching(contour: &Contour, side: f64, largest: f64) {
    each_way(contour, side, |contour, side, _| {
        let found = largest_reaching(contour, side);
        let same = if largest == 0.0 || largest.is_infinite() {
            found == largest
        } else {
            (found / largest - 1.0).abs() < 1e-7
        };
        assert!(same, "{found} instead of {largest}");
    });
}

fn rectangle(a: f64, b: f64) -> Contour {
    Chain::through(&[at(0.0, 0.0), at(a, 0.0), at(a, b), at(0.0, b)]).close()
}

#[test]
fn rectangle_outside() {
    let (a, b, d) = (7.0, 4.0, 1.25);
    let points = [(0.0, -d), (a, -d), (a + d, 0.0), (a + d, b), (a, b + d), (0.0, b + d), (-d, b), (-d, 0.0)];
    let points = points.map(|(x, y)| at(x, y)).to_vec();
    let sides = 2.0 * (a + b);
    assert_rings(&rectangle(a, b), d, &ring(sides + TAU * d, a * b + sides * d + PI * d * d, points));
    assert_undercuts(&rectangle(a, b), d, 0.0, &[]);
    assert_reaching(&rectangle(a, b), 1.0, f64::INFINITY);
}

#[test]
fn rectangle_inside() {
    let (a, b) = (7.0, 4.0);
    let corners = [at(0.0, 0.0), at(a, 0.0), at(a, b), at(0.0, b)];
    for d in [1e-3, 0.5, 1.25, 1.999_999] {
        let points = vec![at(d, d), at(a - d, d), at(a - d, b - d), at(d, b - d)];
        let (inner_a, inner_b) = (a - 2.0 * d, b - 2.0 * d);
        assert_rings(&rectangle(a, b), -d, &ring(2.0 * (inner_a + inner_b), inner_a * inner_b, points));
        assert_undercuts(&rectangle(a, b), -d, (SQRT_2 - 1.0) * d, &corners);
    }
    for d in [2.000_001, 2.5, 300.0] {
        assert_empty(&rectangle(a, b), -d, 2.0);
    }
    assert_reaching(&rectangle(a, b), -1.0, 0.0);
}

/// A slot between two half circles of radius `h`; a stadium from outside.
fn slot(length: f64, h: f64) -> Contour {
    Chain::at(at(0.0, -h))
        .line(at(length, -h))
        .turn(at(length, 0.0), PI)
        .line(at(0.0, h))
        .turn(at(0.0, 0.0), PI)
        .closed_as_it_is()
}

#[test]
fn slot_and_stadium() {
    let (l, h) = (12.0, 1.5);
    // Negative outside.
    for d in [0.4, 1.2, 1.499, -0.4, -1.5, -30.0] {
        let r = h - d;
        let points = vec![at(0.0, -r), at(l, -r), at(l, r), at(0.0, r)];
        assert_rings(&slot(l, h), -d, &ring(2.0 * l + TAU * r, 2.0 * l * r + PI * r * r, points));
        assert_undercuts(&slot(l, h), -d, 0.0, &[]);
    }
    assert_reaching(&slot(l, h), -1.0, h);
    assert_reaching(&slot(l, h), 1.0, f64::INFINITY);
}

/// A tool that just fits goes along the middle, there and back.
#[test]
fn slot_that_is_as_wide_as_the_tool() {
    let (l, h) = (12.0, 1.5);
    each_way(&slot(l, h), -h, |contour, distance, placing| {
        let offset = trim(contour, distance).unwrap_or_else(|error| panic!("{error:?}"));
        let length: f64 = offset.loops.iter().map(|ring| ring.length).sum();
        assert!((length - 2.0 * l).abs() < BAR * l, "{length}");
        let ends = [at(0.0, 0.0), at(l, 0.0)].map(|p| placing.point(p));
        for piece in offset.loops.iter().flat_map(|ring| &ring.pieces) {
            for end in [piece.start, piece.end] {
                assert!(ends.iter().any(|p| (*p - end).norm() < BAR * l), "{end:?} is not among {ends:?}");
            }
        }
        for ring in &offset.loops {
            assert!(ring.area.abs() < BAR * l * l, "{}", ring.area);
        }
    });
    for d in [1.5 * (1.0 + 1e-6), 1.6, 4.0] {
        assert_empty(&slot(l, h), -d, h);
    }
}

/// One arc of a whole turn.
#[test]
fn disc() {
    let r = 3.0;
    let disc = Chain::at(at(r, 0.0)).turn(at(0.0, 0.0), TAU).closed_as_it_is();
    for d in [0.5, 2.9, -1.0, -100.0] {
        let left = r - d;
        assert_rings(&disc, -d, &ring(TAU * left, PI * left * left, vec![at(left, 0.0)]));
        assert_undercuts(&disc, -d, 0.0, &[]);
    }
    for d in [3.000_001, 5.0] {
        assert_empty(&disc, -d, r);
    }
    assert_reaching(&disc, -1.0, r);
    assert_reaching(&disc, 1.0, f64::INFINITY);
}

/// An L of 6 by 5 with legs 2 wide, and a fillet in its concave corner at (2, 2).
fn rounded_l(fillet: f64) -> Contour {
    Chain::through(&[at(0.0, 0.0), at(6.0, 0.0), at(6.0, 2.0), at(2.0 + fillet, 2.0)])
        .turn(at(2.0 + fillet, 2.0 + fillet), -FRAC_PI_2)
        .line(at(2.0, 5.0))
        .line(at(0.0, 5.0))
        .close()
}

/// The ends of the fill arcs at the five convex corners.
fn rounded_l_corners(d: f64) -> Vec<Complex<f64>> {
    let corners = [
        (0.0, 0.0, -1.0, -1.0),
        (6.0, 0.0, 1.0, -1.0),
        (6.0, 2.0, 1.0, 1.0),
        (2.0, 5.0, 1.0, 1.0),
        (0.0, 5.0, -1.0, 1.0),
    ];
    corners.iter().flat_map(|(x, y, dx, dy)| [at(x + dx * d, *y), at(*x, y + dy * d)]).collect()
}

/// A tool that is smaller than the fillet rolls through it.
#[test]
fn rounded_l_with_a_wide_fillet() {
    for (f, d) in [(1.0, 0.4), (1.0, 0.999_999), (2.5, 2.0)] {
        let length = 22.0 - 2.0 * f + FRAC_PI_2 * f;
        let area = 18.0 + f * f * (1.0 - 0.25 * PI);
        let mut points = rounded_l_corners(d);
        points.extend([at(2.0 + f, 2.0 + d), at(2.0 + d, 2.0 + f)]);
        assert_rings(&rounded_l(f), d, &ring(length + TAU * d, area + length * d + PI * d * d, points));
        assert_undercuts(&rounded_l(f), d, 0.0, &[]);
        assert_reaching(&rounded_l(f), 1.0, f);
    }
}

/// A tool of the fillet's radius turns on the spot; a larger one stays out of it.
#[test]
fn rounded_l_with_a_narrow_fillet() {
    for (f, d) in [(1.0, 1.0), (1.0, 1.000_001), (0.3, 1.5)] {
        let mut points = rounded_l_corners(d);
        points.push(at(2.0 + d, 2.0 + d));
        let area = 18.0 + 22.0 * d - d * d + 1.25 * PI * d * d;
        assert_rings(&rounded_l(f), d, &ring(22.0 - 2.0 * d + 2.5 * PI * d, area, points));
        let corner = at(2.0 + f, 2.0 + f) - at(f, f) * (0.5 * SQRT_2);
        if d - f > 0.1 {
            assert_undercuts(&rounded_l(f), d, (SQRT_2 - 1.0) * (d - f), &[corner]);
        }
    }
}

/// A regular star with five points, `r` the radius of its inner corners.
fn star(r: f64) -> Contour {
    let corner = |k: u32| unit(f64::from(k) * PI / 5.0) * if k.is_multiple_of(2) { 1.0 } else { r };
    Chain::through(&(0..10).map(corner).collect::<Vec<_>>()).close()
}

/// Half the angles at the points and, seen from inside, at the inner corners; the length of an edge.
fn star_angles(r: f64) -> (f64, f64, f64) {
    let (sin, cos) = (PI / 5.0).sin_cos();
    let alpha = (r * sin).atan2(1.0 - r * cos);
    (alpha, PI - alpha - PI / 5.0, (1.0 - r * cos).hypot(r * sin))
}

/// Where the fill arcs at corners of the radius `r` and with the angle `half` to their edges begin and end.
fn star_fills(radius: f64, half: f64, d: f64, shift: f64) -> impl Iterator<Item = Complex<f64>> {
    (0..5_u32).flat_map(move |k| {
        let out = unit((2.0 * f64::from(k) + shift) * PI / 5.0);
        // The edges leave backwards at `half`; their normals stand square on them, on the other side of the axis.
        let sense = if half > FRAC_PI_2 { -1.0 } else { 1.0 };
        [1.0, -1.0].map(|side| out * radius + out * unit(side * (FRAC_PI_2 - half)) * (d * sense))
    })
}

#[test]
fn star_inside() {
    let (r, d) = (0.45, 0.06);
    let (alpha, beta, edge) = star_angles(r);
    let cut = d / alpha.tan();
    assert!(cut < edge);
    let fills = 2.0 * beta - PI;
    let length = 10.0 * (edge - cut) + 5.0 * d * fills;
    let area = 5.0 * r * (PI / 5.0).sin() - 10.0 * edge * d + 5.0 * d * cut - 2.5 * d * d * fills;
    let tips = (0..5_u32).map(|k| unit(f64::from(2 * k) * PI / 5.0) * (1.0 - d / alpha.sin()));
    let points = tips.chain(star_fills(r, beta, d, 1.0)).collect();
    assert_rings(&star(r), -d, &ring(length, area, points));
    let points = (0..5_u32).map(|k| unit(f64::from(2 * k) * PI / 5.0)).collect::<Vec<_>>();
    assert_undercuts(&star(r), -d, d / alpha.sin() - d, &points);
    // What is larger than all walls leave touches the inner corners alone, and those up to their distance from the centre.
    assert_empty(&star(r), -0.46, r);
}

#[test]
fn star_outside() {
    let r = 0.45;
    let (alpha, beta, edge) = star_angles(r);
    let gamma = PI - beta;
    for d in [0.05, 0.5] {
        let cut = d / gamma.tan();
        assert!(cut < edge);
        let fills = PI - 2.0 * alpha;
        let length = 10.0 * (edge - cut) + 5.0 * d * fills;
        let area = 5.0 * r * (PI / 5.0).sin() + 10.0 * edge * d - 5.0 * d * cut + 2.5 * d * d * fills;
        let inner = (0..5_u32).map(|k| unit(f64::from(2 * k + 1) * PI / 5.0) * (r + d / gamma.sin()));
        let points = inner.chain(star_fills(1.0, alpha, d, 0.0)).collect();
        assert_rings(&star(r), d, &ring(length, area, points));
    }
}

/// A thick ring with a mouth of the half angle `phi`: outside, a tool that does not pass the mouth has an outer loop and a void.
#[test]
fn ring_with_a_mouth() {
    let (outer, inner, phi) = (10.0, 6.0, 0.2_f64);
    let chain = Chain::at(unit(phi) * outer).turn(at(0.0, 0.0), TAU - 2.0 * phi).line(unit(-phi) * inner);
    let figure = chain.turn(at(0.0, 0.0), 2.0 * phi - TAU).close();
    let (sin, cos) = phi.sin_cos();
    for d in [2.05, 3.0, 5.5] {
        assert!(d > outer * sin);
        // Outside the fill arcs of the outer corners meet on the axis.
        let tip = outer * cos + (d * d - (outer * sin).powi(2)).sqrt();
        let fill = phi + (outer * sin / d).asin();
        let outside = Ring {
            length: (outer + d) * (TAU - 2.0 * phi) + 2.0 * d * fill,
            area: Some((outer + d).powi(2) * (PI - phi) + tip * outer * sin + d * d * fill),
            points: vec![unit(phi) * (outer + d), unit(-phi) * (outer + d), at(tip, 0.0)],
        };
        // Inside those of the inner corners do.
        let tip = inner * cos - (d * d - (inner * sin).powi(2)).sqrt();
        let fill = (inner * sin / d).asin() - phi;
        let void = Ring {
            length: (inner - d) * (TAU - 2.0 * phi) + 2.0 * d * fill,
            area: Some(-((inner - d).powi(2) * (PI - phi) + tip * inner * sin - d * d * fill)),
            points: vec![unit(phi) * (inner - d), unit(-phi) * (inner - d), at(tip, 0.0)],
        };
        assert_rings(&figure, d, &[outside, void]);
        each_way(&figure, d, |contour, distance, _| {
            let offset = trim(contour, distance).unwrap_or_else(|error| panic!("{error:?}"));
            let [a, b] = &offset.loops[..] else { panic!("{} loops", offset.loops.len()) };
            let (outside, void, around) = if a.length > b.length { (a, b, 0) } else { (b, a, 1) };
            assert_eq!((outside.depth, outside.parent), (0, None));
            assert_eq!((void.depth, void.parent), (1, Some(around)));
        });
    }
}

#[test]
fn open_bend() {
    let bend = Chain::through(&[at(0.0, 0.0), at(4.0, 0.0), at(4.0, 3.0)]).open();
    let d = 1.25;
    let points = vec![at(0.0, -d), at(4.0, -d), at(4.0 + d, 0.0), at(4.0 + d, 3.0)];
    assert_rings(&bend, d, &[Ring { length: 7.0 + FRAC_PI_2 * d, area: None, points }]);
    let points = vec![at(0.0, d), at(4.0 - d, d), at(4.0 - d, 3.0)];
    assert_rings(&bend, -d, &[Ring { length: 7.0 - 2.0 * d, area: None, points }]);
    assert_undercuts(&bend, -d, (SQRT_2 - 1.0) * d, &[at(4.0, 0.0)]);
    // A disc that touches the start from above passes the other end up to the radius r with 4^2 + (r - 3)^2 = r^2.
    assert_empty(&bend, -4.5, 25.0 / 6.0);
    assert_reaching(&bend, 1.0, f64::INFINITY);
    assert_reaching(&bend, -1.0, 0.0);
}

/// Up, down, up, down: 1 in x and 2 in y each.
fn zigzag() -> Contour {
    Chain::through(&[at(0.0, 0.0), at(1.0, 2.0), at(2.0, 0.0), at(3.0, 2.0), at(4.0, 0.0)]).open()
}

#[test]
fn zigzag_with_a_small_tool() {
    let edge = 5.0_f64.sqrt();
    // Half the angle at every corner, and the right normal of an edge that goes up.
    let half = 0.5_f64.atan();
    let right = at(2.0, -1.0) * (1.0 / edge);
    let d = 0.2;
    let [cut, fill] = [d / half.tan(), PI - 2.0 * half];
    let mirrored = |z: Complex<f64>| at(4.0 - z.re, z.im);
    // Right of travel are the insides of both tops and the outside of the bottom.
    let top = at(1.0, 2.0 - d / half.sin());
    let low = at(2.0, 0.0) + at(-right.re, right.im) * d;
    let points = vec![right * d, top, low, mirrored(low), mirrored(top), mirrored(right * d)];
    assert_rings(&zigzag(), d, &[Ring { length: 4.0 * (edge - cut) + d * fill, area: None, points }]);
    assert_undercuts(&zigzag(), d, d / half.sin() - d, &[at(1.0, 2.0), at(3.0, 2.0)]);
    // Left of travel the other way round.
    let left = -right;
    let (before, after) = (at(1.0, 2.0) + left * d, at(1.0, 2.0) + at(right.re, -right.im) * d);
    let bottom = at(2.0, d / half.sin());
    let points = vec![left * d, before, after, bottom, mirrored(after), mirrored(before), mirrored(left * d)];
    assert_rings(&zigzag(), -d, &[Ring { length: 4.0 * edge - 2.0 * cut + 2.0 * d * fill, area: None, points }]);
    assert_undercuts(&zigzag(), -d, d / half.sin() - d, &[at(2.0, 0.0)]);
}

/// A tool that does not enter between the tops passes over both: two fill arcs meet, nothing of the inner edges is left.
#[test]
fn zigzag_with_a_large_tool() {
    let edge = 5.0_f64.sqrt();
    let left = at(-2.0, 1.0) * (1.0 / edge);
    for d in [1.2, 1.5, 20.0] {
        let meeting = at(2.0, 2.0 + (d * d - 1.0_f64).sqrt());
        // From the normal of the first edge to the direction of the meeting point.
        let fill = left.arg() - (1.0 / d).acos();
        let before = at(1.0, 2.0) + left * d;
        let mirrored = |z: Complex<f64>| at(4.0 - z.re, z.im);
        let points = vec![left * d, before, meeting, mirrored(before), mirrored(left * d)];
        assert_rings(&zigzag(), -d, &[Ring { length: 2.0 * (edge + d * fill), area: None, points }]);
    }
}

/// A straight stroke has two sides and no ends: the offset is cut square.
#[test]
fn stroke() {
    let stroke = Chain::through(&[at(0.0, 0.0), at(5.0, 0.0)]).open();
    for d in [1e-3, 1.0, 400.0] {
        assert_rings(&stroke, d, &[Ring { length: 5.0, area: None, points: vec![at(0.0, -d), at(5.0, -d)] }]);
    }
}

#[test]
fn no_distance_is_no_offset() {
    for d in [0.0, f64::NAN, f64::INFINITY] {
        assert_eq!(trim(&rectangle(2.0, 1.0), d), Err(OffsetError::Distance));
    }
}

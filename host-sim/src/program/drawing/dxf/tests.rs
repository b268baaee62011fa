//! Small drawings whose measures are known.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use proptest::prelude::*;

use super::{Settings, read};
use crate::input::InputError;
use crate::program::drawing::Seen;
use crate::program::item::{Arc, Nurbs};
use crate::program::{Action, Motion};

/// Pairs of codes and values, as they stand in a file: `0 LINE 10 1.5 …`.
fn pairs(text: &str) -> String {
    let words: Vec<&str> = text.split_whitespace().collect();
    words.chunks(2).map(|pair| format!("{:>3}\n{}\n", pair[0], pair[1])).collect()
}

fn drawing(unit: &str, entities: &str) -> String {
    // The last pair of a header's variable is its value.
    pairs(&format!(
        "0 SECTION 2 HEADER 9 $ACADVER 1 AC1024 9 $INSUNITS 70 {unit} 0 ENDSEC 0 SECTION 2 ENTITIES {entities} 0 ENDSEC 0 EOF"
    ))
}

/// The motions of a drawing as text, and what it came to.
fn told(text: &str) -> (Vec<String>, Result<Seen, InputError>) {
    let mut told = Vec::new();
    let result = read("part.dxf", text.as_bytes(), &Settings::default(), &mut |item| {
        let Action::Motion(motion) = item.action else { return Ok(()) };
        let [x, y, z] = motion.to().unwrap().map(|x| (x * 1e6).round() / 1e6 + 0.0);
        told.push(match motion {
            Motion::Rapid { .. } => format!("rapid {x} {y} {z}"),
            Motion::Line { .. } => format!("line {x} {y} {z}"),
            Motion::Arc(Arc { centre: [u, v], sweep, .. }) => {
                let [u, v] = [u, v].map(|x| (x * 1e6).round() / 1e6 + 0.0);
                format!("arc {x} {y} {z} about {u} {v} by {:.6}", sweep)
            }
            Motion::Nurbs(curve) => format!("nurbs {} {x} {y} {z}", curve.points.len()),
            Motion::Bezier { .. } => "bezier".to_string(),
        });
        Ok(())
    });
    (told, result)
}

fn check(text: &str, expected: &[&str]) {
    let (told, seen) = told(text);
    assert_eq!(told, expected, "{seen:?}");
    assert!(seen.is_ok_and(|seen| seen.warnings.is_empty()));
}

/// Three sides of a square in any order and direction, and the fourth apart by more than the tolerance.
#[test]
fn ends_that_meet_make_a_chain() {
    check(
        &drawing(
            "4",
            "0 LINE 10 1 20 0 11 1 21 1 0 LINE 10 5 20 5 11 6 21 5 0 LINE 10 0.0000002 20 0 11 1 21 0 0 LINE 10 0 20 1 11 1 21 1 \
             0 LINE 10 0 20 0.9999 11 0 21 0",
        ),
        &["rapid 0 0.9999 0", "line 0 0 0", "line 1 0 0", "line 1 1 0", "line 0 1 0", "rapid 5 5 0", "line 6 5 0"],
    );
}

#[test]
fn arcs_and_circles_turn_left_and_seen_from_below_right() {
    let arc = "0 ARC 10 1 20 2 40 3 50 90 51 0";
    check(&drawing("1", arc), &["rapid 25.4 127 0", "arc 101.6 50.8 0 about 25.4 50.8 by 4.712389"]);
    check(&drawing("0", &format!("{arc} 230 -1")), &["rapid -1 5 0", "arc -4 2 0 about -1 2 by -4.712389"]);
    check(&drawing("5", "0 CIRCLE 10 0 20 0 30 0.5 40 1"), &["rapid 10 0 5", "arc 10 0 5 about 0 0 by 6.283185"]);
}

/// A bulge of 1 is half a circle, of tan(22.5 degrees) a quarter; to the left if it is positive.
#[test]
fn bulges_are_arcs() {
    let quarter = (FRAC_PI_2 / 4.0).tan();
    check(
        &drawing(
            "4",
            &format!("0 LWPOLYLINE 90 4 70 1 38 3 10 0 20 0 42 1 10 2 20 0 10 2 20 1 42 -{quarter} 10 1 20 2"),
        ),
        &[
            "rapid 0 0 3",
            "arc 2 0 3 about 1 0 by 3.141593",
            "line 2 1 3",
            "arc 1 2 3 about 2 2 by -1.570796",
            "line 0 0 3",
        ],
    );
    check(
        &drawing(
            "4",
            "0 POLYLINE 66 1 70 0 0 VERTEX 10 0 20 0 42 1 0 VERTEX 10 2 20 0 0 VERTEX 10 2 20 5 0 SEQEND 0 LINE 10 9 20 9 11 9 21 8",
        ),
        &["rapid 0 0 0", "arc 2 0 0 about 1 0 by 3.141593", "line 2 5 0", "rapid 9 9 0", "line 9 8 0"],
    );
}

/// All points of the NURBS lie on the ellipse, by its equation; a quarter ends at the end of the minor axis.
#[test]
fn ellipses_are_exact() {
    for (end, points, last) in [(TAU, 9, [4.0, 1.0]), (FRAC_PI_2, 3, [1.0, 3.0]), (PI, 5, [-2.0, 1.0])] {
        let text = drawing("4", &format!("0 ELLIPSE 10 1 20 1 11 3 21 0 31 0 40 0.6666666666666666 41 0 42 {end}"));
        let mut found = false;
        let result = read("part.dxf", text.as_bytes(), &Settings::default(), &mut |item| {
            let Action::Motion(Motion::Nurbs(curve)) = item.action else { return Ok(()) };
            found = true;
            assert_eq!(curve.points.len(), points);
            let [x, y, _] = curve.points[points - 1];
            assert!((x - last[0]).abs() < 1e-12 && (y - last[1]).abs() < 1e-12, "{x} {y}");
            for part in 0..(points - 1) / 2 {
                for u in [0.1, 0.5, 0.7] {
                    let [x, y] = conic(&curve, 2 * part, u);
                    let off = ((x - 1.0) / 3.0).powi(2) + ((y - 1.0) / 2.0).powi(2) - 1.0;
                    assert!(off.abs() < 1e-14, "{off}");
                }
            }
            Ok(())
        });
        assert!(found && result.is_ok(), "{result:?}");
    }
}

/// A point of the rational parabola of three control points.
fn conic(curve: &Nurbs<'_>, first: usize, u: f64) -> [f64; 2] {
    let basis = [(1.0 - u) * (1.0 - u), 2.0 * u * (1.0 - u), u * u];
    let parts: Vec<f64> = (0..3).map(|k| basis[k] * curve.weights[first + k]).collect();
    let whole: f64 = parts.iter().sum();
    std::array::from_fn(|axis| (0..3).map(|k| parts[k] * curve.points[first + k][axis]).sum::<f64>() / whole)
}

#[test]
fn splines_keep_weights_and_knots() {
    let spline = "0 SPLINE 70 8 71 2 72 7 73 4 74 0 40 0 40 0 40 0 40 0.25 40 1 40 1 40 1 41 1 41 2 41 1 41 1 10 0 20 0 30 0 10 1 20 0 \
                  30 0 10 1 20 1 30 1 10 0 20 1 30 0";
    let mut found = None;
    let text = drawing("4", spline);
    let result = read("part.dxf", text.as_bytes(), &Settings::default(), &mut |item| {
        if let Action::Motion(Motion::Nurbs(curve)) = item.action {
            found = Some((curve.order, curve.weights.to_vec(), curve.knots.to_vec(), curve.points.to_vec()));
        }
        Ok(())
    });
    let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 1.0], [0.0, 1.0, 0.0]];
    let expected = (3, vec![1.0, 2.0, 1.0, 1.0], vec![0.0, 0.0, 0.0, 0.25, 1.0, 1.0, 1.0], points);
    assert_eq!(found, Some(expected), "{result:?}");
}

#[test]
fn what_is_left_out_is_named() {
    let (told, seen) = told(&drawing(
        "4",
        "0 TEXT 10 0 20 0 1 a 0 WIPEOUT 10 0 0 LINE 10 0 20 0 11 1 21 0 0 LINE 10 3 20 3 11 3 21 3 0 CIRCLE 10 0 20 0 40 1 210 1 220 0 \
         230 0 0 LINE 67 1 10 3 20 3 11 3 21 4 0 TEXT 10 0 20 0 1 b 0 NEWTHING 10 0",
    ));
    assert_eq!(told, ["rapid 0 0 0", "line 1 0 0"]);
    let warnings: Vec<String> = seen.unwrap().warnings.iter().map(ToString::to_string).collect();
    assert_eq!(
        warnings,
        [
            "1 × CIRCLE (in a plane that is not XY) left out",
            "1 × LINE (in the paper space) left out",
            "1 × LINE (of no length) left out",
            "1 × NEWTHING left out",
            "2 × TEXT left out",
            "1 × WIPEOUT left out",
        ]
    );
}

#[test]
fn faults_are_named() {
    let fault = |text: &str| told(text).1.unwrap_err().to_string();
    assert!(fault("no drawing").starts_with("part.dxf: is no DXF text with a section ENTITIES"));
    assert!(fault(&drawing("4", "0 LINE 10 a")).starts_with("part.dxf: "));
    assert!(fault(&drawing("18", "0 LINE 10 0 11 1")).starts_with("part.dxf: has a unit in $INSUNITS"));
    assert_eq!(
        fault(&drawing("4", "0 LINE 10 0 11 1e300")),
        "part.dxf: a number of a curve is none, or too large for a machine"
    );
}

/// Entities to be spoiled.
const ENTITIES: &str = "0 LINE 8 0 62 7 10 0 20 0 11 1 21 1 0 ARC 10 1 20 1 40 1 50 0 51 90 0 CIRCLE 10 1 20 1 40 2 0 LWPOLYLINE 90 2 70 1 10 0 \
    20 0 42 0.5 10 1 20 1 0 POLYLINE 66 1 70 8 0 VERTEX 10 0 20 0 0 VERTEX 10 2 20 0 0 SEQEND 0 SPLINE 71 2 72 6 73 3 40 0 40 0 40 0 \
    40 1 40 1 40 1 10 0 20 0 10 1 20 0 10 1 20 1 0 ELLIPSE 10 1 20 1 11 3 21 0 40 0.5 41 0 42 3 0 INSERT 2 B 10 0 66 1 0 ATTRIB 1 a 0 \
    SEQEND 0 TEXT 1 a 0 DIMENSION 70 1 0 MTEXT 1 a";

proptest! {
    #[test]
    fn a_spoiled_drawing_ends_in_a_result(
        spoils in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..5), 0..6),
    ) {
        let mut text = drawing("4", ENTITIES).into_bytes();
        for (place, byte, kind) in spoils {
            let at = place.index(text.len());
            match kind {
                0 => text[at] = byte,
                1 => text.insert(at, byte),
                2 => text[at] = b"0123456789.-+e\n"[usize::from(byte) % 15],
                // Something is left for the spoils behind it.
                3 => text.truncate(at.max(6)),
                _ => { text.remove(at); }
            }
        }
        let result = read("part.dxf", &text[..], &Settings::default(), &mut |item| {
            if let Action::Motion(motion) = item.action {
                assert!(motion.to().unwrap().iter().chain(&item.from).all(|x| x.is_finite()));
            }
            Ok(())
        });
        prop_assert!(result.is_ok() || result.is_err_and(|error| !error.message.is_empty()));
    }

    #[test]
    fn any_bytes_end_in_a_result(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let result = read("part.dxf", &bytes[..], &Settings::default(), &mut |_| Ok(()));
        prop_assert!(result.is_err());
    }
}

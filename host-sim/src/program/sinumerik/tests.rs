//! Small programs whose results are known by other means.

use std::f64::consts::{FRAC_PI_2, TAU};

use proptest::prelude::*;

use super::{Settings, read};
use crate::program::{Action, Feed, Motion, Plane};

/// A program's motions as text, each `line:column` and what it is, its error last.
fn told(program: &str) -> Vec<String> {
    let mut told = Vec::new();
    let result = read("part.mpf", program.as_bytes(), &Settings::default(), &mut |item| {
        let text = match item.action {
            Action::Motion(Motion::Rapid { to }) => format!("rapid {to:?}"),
            Action::Motion(Motion::Line { to }) => format!("line {to:?}"),
            Action::Motion(Motion::Arc(arc)) => format!("arc {:?} {:?} {:.9}", arc.centre, arc.to, arc.sweep),
            Action::Motion(Motion::Nurbs(curve)) => {
                assert_eq!(curve.points[0], item.from);
                format!("nurbs {} {:?} {:?} {:?}", curve.order, &curve.points[1..], curve.weights, curve.knots)
            }
            other => format!("{other:?}"),
        };
        told.push(format!("{}:{} {text}", item.line, item.column));
        Ok(())
    });
    told.extend(result.err().map(|error| error.to_string()));
    told
}

/// Intervals left out but for one, and all of them given. Knots by the rule in the module's documentation, worked out by hand.
#[test]
fn knots_follow_the_rule() {
    let told = told(
        "N10 G1 X0 Y0 F300 G64\nN20 BSPLINE\nN30 X10 Y20 PW=2\nN40 X20 Y40\nN50 X30 Y30 PW=0.5\nN60 X40 Y45 PL=2.5\nN70 X50 Y0\n\
         N80 BSPLINE SD=2 X51 PL=0\nX52 Z1 PL=.25\nX53 PL=0\nX54 PL=1EX-1\nG1 X0 Y0 Z0",
    );
    assert_eq!(
        told[2..],
        [
            "3:5 nurbs 4 [[10.0, 20.0, 0.0], [20.0, 40.0, 0.0], [30.0, 30.0, 0.0], [40.0, 45.0, 0.0], [50.0, 0.0, 0.0]] \
             [1.0, 2.0, 1.0, 0.5, 1.0, 1.0] [0.0, 0.0, 0.0, 0.0, 1.0, 3.5, 4.5, 4.5, 4.5, 4.5]",
            "8:18 nurbs 3 [[51.0, 0.0, 0.0], [52.0, 0.0, 1.0], [53.0, 0.0, 1.0], [54.0, 0.0, 1.0]] \
             [1.0, 1.0, 1.0, 1.0, 1.0] [0.0, 0.0, 0.0, 0.25, 0.25, 0.35, 0.35, 0.35]",
            "12:4 line [0.0, 0.0, 0.0]",
            "12:1 End",
        ]
    );
}

#[test]
fn events_stand_before_and_behind_a_spline() {
    let told = told(
        "%_N_PART_MPF\n;$PATH=/_N_WKS_DIR\nMSG(\"a (part)\") G17G90G710G54 FFWON SOFT\nT3 D1 M6\nS600M3 G0X0Y0\nBSPLINE\nX1 F60 M8\n\
         Y1\n(x)",
    );
    assert_eq!(
        told[..6],
        [
            "4:1 ToolSelect(3)",
            "4:7 ToolChange(3)",
            "5:5 Spindle(Spindle { turning: Clockwise, speed: Turns(10.0) })",
            "5:10 rapid [0.0, 0.0, 0.0]",
            "7:8 Coolant(Coolant { mist: false, flood: true })",
            "part.mpf:9:1: no word begins with `(`\n    (x)\n    ^",
        ]
    );
}

#[test]
fn an_event_ends_a_spline_and_bspline_begins_another() {
    let told = told("G0 X0 F60\nBSPLINE X1\nX2\nX3\nM5\nBSPLINE X4\nX5\nX6\nBSPLINE SD=2 X7\nX8\nG4 F2\nM30\nX9");
    let kinds: Vec<&str> = told.iter().map(|line| line.split([' ', '(']).take(3).last().unwrap()).collect();
    assert_eq!(told.len(), 7, "{told:?}");
    assert_eq!(kinds[1], "4", "{told:?}");
    assert!(
        told[2].starts_with("5:1 Spindle") && told[3].starts_with("6:9 nurbs 4") && told[4].starts_with("9:14 nurbs 3")
    );
    assert_eq!(told[5..], ["11:1 Dwell(2.0)", "12:1 End"]);
}

#[test]
fn arcs_are_about_a_point_from_the_start() {
    let arc = |block: &str| {
        let mut found = None;
        let program = format!("G1 X1 Y0 F60\n{block}");
        read("part.mpf", program.as_bytes(), &Settings::default(), &mut |item| {
            if let Action::Motion(Motion::Arc(arc)) = item.action {
                found = Some(arc);
            }
            Ok(())
        })
        .unwrap();
        found.unwrap()
    };
    for (block, plane, centre, sweep) in [
        ("G3 X0 Y1 I-1 J0", Plane::Xy, [0.0, 0.0], FRAC_PI_2),
        ("G3 X0 Y1 CR=1", Plane::Xy, [0.0, 0.0], FRAC_PI_2),
        ("G2 X0 Y1 I-1", Plane::Xy, [0.0, 0.0], -3.0 * FRAC_PI_2),
        ("G2 X0 Y1 CR=-1", Plane::Xy, [0.0, 0.0], -3.0 * FRAC_PI_2),
        ("G3 I-1 Z5 TURN=2", Plane::Xy, [0.0, 0.0], 3.0 * TAU),
        ("G91 G3 X-1 Y1 I-1", Plane::Xy, [0.0, 0.0], FRAC_PI_2),
        ("G18 G3 X0 Z-1 I-1", Plane::Zx, [0.0, 0.0], FRAC_PI_2),
    ] {
        let arc = arc(block);
        assert_eq!(arc.plane, plane, "{block}");
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(
            near(arc.sweep, sweep) && near(arc.centre[0], centre[0]) && near(arc.centre[1], centre[1]),
            "{block}: {arc:?}"
        );
    }
}

#[test]
fn inches_are_of_lengths_and_g700_of_feeds_too() {
    for (program, to, rate) in
        [("G70 G1 X1 F60", 25.4, 1.0), ("G700 G1 X1 F60", 25.4, 25.4), ("G71 G1 X1 F60", 1.0, 1.0)]
    {
        let mut checked = false;
        let result = read("part.mpf", program.as_bytes(), &Settings::default(), &mut |item| {
            if let Action::Motion(motion) = item.action {
                checked = motion.to() == Some([to, 0.0, 0.0]) && item.feed == Feed::Rate(rate);
            }
            Ok(())
        });
        assert!(checked && result == Ok(1), "{program}");
    }
}

#[test]
fn each_fault_has_its_place_and_its_sentence() {
    for (program, expected) in [
        ("ORIWKS", "1:1: ORIWKS is not supported"),
        ("N10 TRAORI(1)", "1:5: TRAORI is not supported"),
        ("G1 X1 A3=0.5 F1", "1:7: A3 is not supported"),
        ("CYCLE832_OF_A_LONG_NAME", "1:1: CYCLE832_OF_A_L… is not supported"),
        ("G33 Z1", "1:1: G33 is not supported"),
        ("M123", "1:1: M123 is not supported"),
        ("G1 G2", "1:4: G2 contradicts another word of this block"),
        ("X1 X2", "1:4: X stands twice in this block"),
        ("G1 X=R1 F1", "1:4: X needs a number; expressions are not supported"),
        ("X1", "1:1: there is no motion yet; G0, G1, G2, G3 or BSPLINE would do"),
        ("G1 X1", "1:4: there is no feed yet; put F before this motion"),
        ("G93 G1 F2 X1\nX2", "2:1: with G93 every block that cuts needs its own F"),
        ("G93 BSPLINE F2 X1", "1:16: G93 means nothing to the motion of this block"),
        ("G54\nG55", "2:1: the coordinate system changes; one of G54 to G57 and G500 all through would do"),
        ("G4", "1:1: G4 needs F with seconds; turns of the spindle are not supported"),
        ("G1 F1 X1 PL=1", "1:10: PL or PW means nothing to the motion of this block"),
        ("F1 BSPLINE SD=4", "1:12: SD has another number than it can have"),
        ("F1 BSPLINE X1\nX2 SD=2", "2:4: SD stands before the first point of a spline"),
        ("F1 BSPLINE X1 PL=1", "1:15: the first 2 points behind the start have no interval; PL=0 would do"),
        (
            "F1 BSPLINE X0 PL=0\nX1 PL=0\nX2 PL=0",
            "3:4: the first interval belongs to point 3 behind the start and is longer than 0 (the start is where the tool is \
             and is not written again)",
        ),
        (
            "F1 BSPLINE X0\nX1\nX2\nX3 PL=0\nX4 PL=0\nX5 PL=0",
            "6:4: 3 intervals of 0 in a row tear a spline of degree 3; at most 2 would do",
        ),
        ("F1 BSPLINE X0\nX1\nX2\nX3 PL=0\nM30", "4:1: the interval of a spline's last point is longer than 0"),
        ("F1 BSPLINE X0\nX1 PL=-1", "2:4: an interval of the parameter is not shorter than 0"),
        ("F1 BSPLINE X0 PW=0", "1:15: the weight of a point is more than 0"),
        ("F1 BSPLINE X0\nX1", "2:1: a spline of 3 points with its start; its degree needs 4 or more"),
        (
            "F1 BSPLINE X0\nX1 M8",
            "2:4: M within a spline; it can stand before the second point or behind the end, a spline is one motion",
        ),
        (
            "F1 BSPLINE X0\nX1\nX2\nM8\nX3",
            "5:1: the block before has ended the spline; another one begins with BSPLINE",
        ),
        ("MSG(\"", "1:4: this has no closing bracket in its line"),
    ] {
        let told = told(program);
        let said = told.last().and_then(|line| line.lines().next()).map(|line| line.trim_start_matches("part.mpf:"));
        assert_eq!(said, Some(expected), "{program}");
    }
}

proptest! {
    #[test]
    fn any_text_ends_in_a_result(
        program in "((G[0-9]{1,3}|BSPLINE|SD=[23]|PL=|PW=|F|[XYZIJK]|CR=|TURN=|M[0-9]|[A-Z]{1,6})[= \n]?(-?[0-9.EX\n]){0,6}){0,20}",
    ) {
        let finite = |values: &[f64]| values.iter().all(|x| x.is_finite());
        let result = read("part.mpf", program.as_bytes(), &Settings::default(), &mut |item| {
            if let Action::Motion(Motion::Nurbs(curve)) = item.action {
                let whole = curve.knots.len() == curve.points.len() + curve.order && finite(curve.knots);
                return if whole { Ok(()) } else { Err("knots".to_string()) };
            }
            if finite(&item.from) { Ok(()) } else { Err("place".to_string()) }
        });
        if let Err(error) = result {
            prop_assert!(error.position.is_some() && error.message != "knots" && error.message != "place", "{}", error);
        }
    }

    #[test]
    fn any_bytes_end_in_a_result(program in proptest::collection::vec(any::<u8>(), 0..300)) {
        let result = read("part.mpf", &program[..], &Settings::default(), &mut |_| Ok(()));
        prop_assert!(result.is_ok() || result.is_err_and(|error| error.position.is_some()));
    }
}

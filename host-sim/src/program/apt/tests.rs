//! Small files whose results are known by other means.

use std::f64::consts::{FRAC_PI_2, TAU};

use proptest::prelude::*;

use super::read;
use crate::program::item::{Coolant, Speed, Spindle, Turning};
use crate::program::{Action, Arc, Feed, Item, Motion, Plane};
use crate::units::Units;

/// The items of a file, none of which borrows: there are no splines here. And its error.
fn all(file: &str) -> (Vec<(Item<'static>, [f64; 3])>, Option<String>) {
    let mut items = Vec::new();
    let result = read("part.apt", file.as_bytes(), Units::Mm, &mut |item| {
        let Item { line, column, from, feed, .. } = *item;
        let (action, end) = match item.action {
            Action::Motion(Motion::Rapid { to }) => (Action::Motion(Motion::Rapid { to }), to),
            Action::Motion(Motion::Line { to }) => (Action::Motion(Motion::Line { to }), to),
            Action::Motion(Motion::Arc(arc)) => (Action::Motion(Motion::Arc(arc)), arc.to),
            Action::Spindle(spindle) => (Action::Spindle(spindle), from),
            Action::Coolant(coolant) => (Action::Coolant(coolant), from),
            Action::Compensation(side) => (Action::Compensation(side), from),
            Action::ToolSelect(tool) => (Action::ToolSelect(tool), from),
            Action::ToolChange(tool) => (Action::ToolChange(tool), from),
            Action::Dwell(seconds) => (Action::Dwell(seconds), from),
            Action::Stop { optional } => (Action::Stop { optional }, from),
            _ => (Action::End, from),
        };
        items.push((Item { line, column, from, feed, action }, end));
        Ok(())
    });
    (items, result.err().map(|error| error.to_string()))
}

fn actions(file: &str) -> Vec<Action<'static>> {
    let (items, error) = all(file);
    assert_eq!(error, None, "{file}");
    items.into_iter().map(|(item, _)| item.action).collect()
}

#[test]
fn motions_begin_where_the_last_one_ended() {
    let (items, error) = all(
        "PARTNO bracket, rev. 2 (a text!)\nTOOL PATH/CONTOUR,TOOL,MILL\nUNITS/INCHES\nFROM/0.,0.,1.\nRAPID\n\
         GOTO/1,0,1 $$ above\nFEDRAT/600,MMPM\nGOTO/ 1.0, 0.0, $\n  -1.0E0,0,0,1\nGODLTA/0,1,0\nGODLTA/2\nFINI\nGOTO/9,9,9",
    );
    assert_eq!(error, None);
    let inch = |ends: [f64; 3]| ends.map(|c| c * 25.4);
    let ends: Vec<_> = items.iter().map(|&(item, to)| (item.line, item.from, to)).collect();
    let [a, b, c, d, e] =
        [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [1.0, 1.0, -1.0], [1.0, 1.0, 1.0]].map(inch);
    assert_eq!(ends, [(6, a, b), (9, b, c), (10, c, d), (11, d, e), (12, e, e)]);
    assert!(matches!(items[0].0.action, Action::Motion(Motion::Rapid { .. })));
    assert_eq!(items[1].0.feed, Feed::Rate(10.0));
}

#[test]
fn arcs_turn_left_about_their_axis() {
    let arc = |text: &str| match actions(text)[0] {
        Action::Motion(Motion::Arc(arc)) => arc,
        other => panic!("{other:?}"),
    };
    let check = |text: &str, plane: Plane, centre: [f64; 2], sweep: f64| {
        let Arc { plane: found, centre: at, sweep: angle, .. } = arc(text);
        assert_eq!((found, at), (plane, centre), "{text}");
        assert!((angle - sweep).abs() < 1e-12, "{text}: {angle}");
    };
    check("FEDRAT/1\nFROM/1,0,0\nCIRCLE/0,0,0,0,0,1,1\nGOTO/0,1,0", Plane::Xy, [0.0; 2], FRAC_PI_2);
    check("FEDRAT/1\nFROM/1,0,0\nCIRCLE/0,0,0,0,0,-1,1,.01,.5,2,0\nGOTO/0,1,0", Plane::Xy, [0.0; 2], -3.0 * FRAC_PI_2);
    check("FEDRAT/1\nFROM/2,1,0\nCIRCLE/1,1,0,0,0,1,1\nGOTO/2,1,5", Plane::Xy, [1.0, 1.0], TAU);
    check("FEDRAT/1\nFROM/0,1,0\nCIRCLE/0,0,0,1,0,0,1\nGOTO/0,0,1", Plane::Yz, [0.0; 2], FRAC_PI_2);
    check("FEDRAT/1\nFROM/0,0,1\nCIRCLE/0,0,0,0,1,0,1\nGOTO/1,0,0", Plane::Zx, [0.0; 2], FRAC_PI_2);
}

#[test]
fn events_keep_their_order() {
    let turning = |turning, turns| Action::Spindle(Spindle { turning, speed: Speed::Turns(turns) });
    assert_eq!(
        actions("LOADTL/3\nSPINDL/RPM,600,CLW\nCOOLNT/MIST\nCOOLNT/OFF\nDELAY/1.5\nSPINDL/OFF\nOPSTOP\nSTOP\nEND"),
        [
            Action::ToolSelect(3),
            Action::ToolChange(3),
            turning(Turning::Clockwise, 10.0),
            Action::Coolant(Coolant { mist: true, flood: false }),
            Action::Coolant(Coolant::default()),
            Action::Dwell(1.5),
            turning(Turning::Off, 10.0),
            Action::Stop { optional: true },
            Action::Stop { optional: false },
            Action::End,
        ]
    );
}

#[test]
fn each_fault_has_its_place_and_its_sentence() {
    for (file, expected) in [
        ("GOTO/1,2,3", "1:1: there is no feed yet; put FEDRAT before this motion"),
        ("\n GOTO/1,2", "2:2: this statement takes three numbers, and three more for an upright tool"),
        ("GOTO/1,2,3,0,1,0", "1:1: the tool is not upright; only an axis of 0, 0, 1 can be run"),
        ("GOTO/1,2,*", "1:10: `*` belongs to no word; names, numbers and commas would do"),
        ("GOTO/1,2,3-4", "1:10: this is no number that a machine could use"),
        ("GOTO/1,2,1E99", "1:10: this is no number that a machine could use"),
        ("GOTO/1,$\nA,3", "2:1: this word means nothing in this statement"),
        ("GOTO/1,$\n2", "1:1: this statement takes three numbers, and three more for an upright tool"),
        ("3,4", "1:1: a statement begins with its name, as in GOTO/1,2,3"),
        (
            "TLRGT,GOFWD/L1",
            "1:1: this statement is not supported; motions are FROM, GOTO, GODLTA, RAPID and CIRCLE with a GOTO behind it",
        ),
        ("FEDRAT/10,IPR", "1:11: feeds for each turn of the spindle are not supported; use MMPM or IPM"),
        ("CIRCLE/0,0,0,0,1,1,1", "1:1: the axis of this circle is none of X, Y and Z; only such arcs can be run"),
        ("CIRCLE/0,0,0,0,0,1,1\nRAPID", "2:1: behind CIRCLE stands the GOTO to the end of its arc"),
        ("CIRCLE/0,0,0,0,0,1,1", "1:1: behind CIRCLE stands the GOTO to the end of its arc"),
        (
            "FEDRAT/1\nFROM/1,0,0\nCIRCLE/0,0,0,0,0,1,1\nGOTO/2,0,0",
            "4:1: the start is 1 from the centre and the end 2; both are on one circle",
        ),
    ] {
        let (_, error) = all(file);
        let said = error.unwrap_or_else(|| "no error".to_string());
        assert_eq!(said.lines().next().map(|line| line.trim_start_matches("part.apt:")), Some(expected), "{file}");
    }
}

proptest! {
    #[test]
    fn any_text_ends_in_a_result(file in "((GOTO|FROM|FEDRAT|CIRCLE|RAPID|UNITS|SPINDL|[A-Z]{1,6})[/,$ \n]?(-?[0-9.E,$/\n]){0,30}){0,8}") {
        let (_, error) = all(&file);
        prop_assert!(error.is_none_or(|error| matches!(error.lines().count(), 1 | 3)));
    }
}

//! Coordinate systems, shifts, lengths and the machine's places: in the one frame of the program.

use super::{ends, ends_with, good, good_with};
use crate::program::Action;
use crate::program::rs274::Settings;

#[test]
fn g92_shifts_without_moving() {
    // At 10 the program counts 3 from here on: its 5 is 12.
    let expected = [[10.0, 0.0, 0.0], [12.0, 0.0, 0.0]];
    assert_eq!(ends("g0 x10\ng92 x3\ng0 x5"), expected);
    for (codes, end) in [("g92.1", 5.0), ("g92.2", 5.0), ("g92.2\ng92.3", 12.0), ("g92.1\ng92.3", 5.0)] {
        assert_eq!(ends(&format!("g0 x10\ng92 x3\n{codes}\ng0 x5"))[1], [end, 0.0, 0.0], "{codes}");
    }
    // A second one replaces the first one, and incremental distances know of none.
    assert_eq!(ends("g0 x10\ng92 x3\ng92 x0\ng0 x5")[1], [15.0, 0.0, 0.0]);
    assert_eq!(ends("g0 x10\ng92 x3\ng91 g0 x5")[1], [15.0, 0.0, 0.0]);
}

#[test]
fn systems_are_brought_into_the_frame_of_the_first_one() {
    let mut settings = Settings::default();
    settings.systems[0] = [100.0, 0.0, 0.0];
    settings.systems[1] = [130.0, 0.0, 0.0];
    settings.systems[8] = [0.0, 7.0, 0.0];
    assert_eq!(
        ends_with("g0 x1\ng55 x1\ng54 x1\ng59.3 x1 y1", &settings),
        [[1.0, 0.0, 0.0], [31.0, 0.0, 0.0], [1.0, 0.0, 0.0], [-99.0, 8.0, 0.0]]
    );
    // The machine's 120 is the frame's 20.
    assert_eq!(ends_with("g53 g0 x120\ng0 x1", &settings), [[20.0, 0.0, 0.0], [1.0, 0.0, 0.0]]);
    for (number, code) in ["g54", "g55", "g56", "g57", "g58", "g59", "g59.1", "g59.2", "g59.3"].into_iter().enumerate()
    {
        let program = format!("g10 l2 p{} x{}\n{code} g0 x0", number + 1, number + 1);
        assert_eq!(ends(&program), [[number as f64 + 1.0, 0.0, 0.0]], "{program}");
    }
}

#[test]
fn g10_moves_systems() {
    assert_eq!(ends("g10 l2 p1 x5 y6\ng0 x1 y1"), [[6.0, 7.0, 0.0]]);
    assert_eq!(ends("g10 l2 p0 x5\ng91\ng10 l2 p0 x6\ng90 g0 x1"), [[7.0, 0.0, 0.0]]);
    // L20: here it is to count 3, also with a shift in force, and also in a system that is not active.
    assert_eq!(ends("g0 x10\ng10 l20 p1 x3\ng0 x5")[1], [12.0, 0.0, 0.0]);
    assert_eq!(ends("g0 x10\ng92 x1\ng10 l20 p0 x3\ng0 x5")[1], [12.0, 0.0, 0.0]);
    assert_eq!(ends("g0 x10\ng10 l20 p2 x3\ng0 x5\ng55 x5")[1..], [[5.0, 0.0, 0.0], [12.0, 0.0, 0.0]]);
    assert_eq!(ends("g20 g10 l2 p1 x1\ng0 x1"), [[50.8, 0.0, 0.0]]);
}

#[test]
fn lengths_move_the_tip_and_not_the_machine() {
    let items = good("g0 z50\ng43.1 z20\ng0 z50\ng53 g0 z50\ng49\ng0 z1");
    let froms: Vec<f64> = items.iter().map(|item| item.from[2]).collect();
    // With 20 mm more in the spindle the tip of a machine at 50 is at 30; G53 takes the machine to 50 again.
    assert_eq!(froms, [0.0, 30.0, 30.0, 50.0, 50.0, 50.0]);
    assert_eq!(items[1].got, super::Got::Event(Action::ToolLength([0.0, 0.0, 20.0])));
    let settings = Settings { lengths: [(4, 17.0)].into(), ..Settings::default() };
    for program in ["g43 h4", "t4 m6 g43", "t4 m6\ng43"] {
        let items = good_with(&format!("{program}\ng53 g0 z17"), &settings);
        assert_eq!(items.last().map(|item| item.got.clone()), Some(super::Got::Rapid([0.0; 3])), "{program}");
    }
}

#[test]
fn homes_are_reached_by_way_of_a_place() {
    let settings = Settings { homes: [[1.0, 2.0, 3.0], [7.0, 8.0, 9.0]], ..Settings::default() };
    let at = |program: &str| ends_with(program, &settings);
    assert_eq!(at("g0 x50 z40\ng28")[1..], [[1.0, 2.0, 3.0]]);
    assert_eq!(at("g0 x50 z40\ng30 z45")[1..], [[50.0, 0.0, 45.0], [50.0, 0.0, 9.0]]);
    assert_eq!(at("g0 x50 z40\ng91 g28 z0")[1..], [[50.0, 0.0, 40.0], [50.0, 0.0, 3.0]]);
    assert_eq!(at("g0 x5 y5\ng28.1\ng0 x9\ng28 x9")[1..], [[9.0, 5.0, 0.0], [9.0, 5.0, 0.0], [5.0, 5.0, 0.0]]);
}

//! Small drawings whose measures are known.

use std::f64::consts::TAU;

use proptest::prelude::*;

use super::read;
use crate::program::{Action, Motion};

/// `f32` on a drawing of 100 mm.
const CLOSE: f64 = 5e-5;

/// The motions of a drawing, each as its kind, its start and its end.
fn motions(text: &str) -> Vec<(char, [f64; 2], [f64; 2])> {
    let mut found = Vec::new();
    let result = read("part.svg", text.as_bytes(), &mut |item| {
        if let Action::Motion(motion) = item.action {
            let kind = match motion {
                Motion::Rapid { .. } => 'r',
                Motion::Line { .. } => 'l',
                Motion::Arc(arc) => {
                    if arc.sweep > 0.0 {
                        '+'
                    } else {
                        '-'
                    }
                }
                Motion::Bezier { .. } => 'b',
                Motion::Nurbs(_) => 'n',
            };
            let [[x, y, _], [u, v, _]] = [item.from, motion.to().unwrap()];
            found.push((kind, [x, y], [u, v]));
        }
        Ok(())
    });
    assert!(result.is_ok(), "{result:?}");
    found
}

fn check(text: &str, expected: &[(char, [f64; 2])]) {
    let found = motions(text);
    let near = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).abs() < CLOSE && (p[1] - q[1]).abs() < CLOSE;
    let same = found.iter().zip(expected).all(|((kind, _, to), (other, end))| kind == other && near(*to, *end));
    assert!(found.len() == expected.len() && same, "{found:?}");
    assert!(found.windows(2).all(|pair| pair[0].2 == pair[1].1), "{found:?}");
}

/// A unit is 2 mm, the group is moved and turned by 90 degrees: (x, y) stands at (50 - y, 10 + x) from above, in units.
#[test]
fn units_and_transforms_are_applied() {
    check(
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="80mm" viewBox="0 0 50 40">
           <g transform="translate(50 10) rotate(90)" fill="none" stroke="black">
           <path d="M0 0 L10 0 l0 5 z M20 20 h1 q 1 0 1 1"/></g></svg>"#,
        &[
            ('r', [100.0, 60.0]),
            ('l', [100.0, 40.0]),
            ('l', [90.0, 40.0]),
            ('l', [100.0, 60.0]),
            ('r', [60.0, 20.0]),
            ('l', [60.0, 18.0]),
            ('b', [58.0, 16.0]),
        ],
    );
}

#[test]
fn without_units_an_inch_has_96_px() {
    let text = r#"<svg xmlns="http://www.w3.org/2000/svg" width="192" height="96"><rect x="0" y="0" width="96" height="48"/></svg>"#;
    check(
        text,
        &[('r', [0.0, 25.4]), ('l', [25.4, 25.4]), ('l', [25.4, 12.7]), ('l', [0.0, 12.7]), ('l', [0.0, 25.4])],
    );
    let text =
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="1in" height="1in"><path stroke="red" d="M0 72 H72"/></svg>"#;
    check(text, &[('r', [0.0, 6.35]), ('l', [19.05, 6.35])]);
}

/// A circle of 40 mm about (50, 50), clockwise on paper: its arcs have the length of a whole turn, and the round corner of a
/// rectangle and the arc of a path are arcs too. A flattened circle has none.
#[test]
fn circles_are_arcs() {
    let svg = |body: &str| {
        format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100">{body}</svg>"#
        )
    };
    let mut turned = 0.0;
    let text = svg(r#"<circle cx="50" cy="50" r="40"/>"#);
    read("part.svg", text.as_bytes(), &mut |item| {
        if let Action::Motion(Motion::Arc(arc)) = item.action {
            turned += arc.sweep;
            assert!(arc.centre.iter().all(|x| (x - 50.0).abs() < CLOSE), "{arc:?}");
        }
        Ok(())
    })
    .unwrap();
    assert!((turned + TAU).abs() < 1e-5, "{turned}");
    let kinds = |text: &str| motions(&svg(text)).iter().map(|(kind, ..)| *kind).collect::<String>();
    assert_eq!(kinds(r#"<rect x="10" y="10" width="50" height="30" rx="5"/>"#), "rl-l-l-l-");
    assert_eq!(kinds(r#"<path d="M10 10 A 20 20 0 0 0 30 30" stroke="red" fill="none"/>"#), "r+");
    assert_eq!(kinds(r#"<ellipse cx="50" cy="50" rx="40" ry="20"/>"#), "rbbbb");
    assert_eq!(kinds(r#"<path d="M10 10 C 20 10 30 20 30 30" stroke="red" fill="none"/>"#), "rb");
}

#[test]
fn what_is_no_curve_is_named() {
    let text = r#"<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"><text>a</text><text>b</text>
        <image href="secret.png"/><path d="M0 0 H1" visibility="hidden" stroke="red"/></svg>"#;
    let seen = read("part.svg", text.as_bytes(), &mut |_| Ok(())).unwrap();
    assert_eq!(seen.chains, 0);
    let warnings: Vec<String> = seen.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(warnings, ["1 × image left out", "2 × text left out"]);
}

#[test]
fn faults_are_named() {
    let fault = |text: &str| read("part.svg", text.as_bytes(), &mut |_| Err("no".to_string())).unwrap_err().to_string();
    assert!(fault("<svg>\n<a></b></svg>").starts_with("part.svg:2:4: is no XML"), "{}", fault("<svg>\n<a></b></svg>"));
    assert!(fault("<html/>").starts_with("part.svg: is no SVG"), "{}", fault("<html/>"));
    let path = r#"<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"><path d="M0 0 H1" stroke="red"/></svg>"#;
    assert_eq!(fault(path), "part.svg:1:1: no");
}

/// Elements in elements far beyond any drawing end in an error, not at the end of the stack.
#[test]
fn depth_is_bounded() {
    for depth in [500, 5000, 200_000] {
        let text = format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9">{}<path d="M0 0H1" stroke="red"/>{}</svg>"#,
            "<g opacity='0.5'>".repeat(depth),
            "</g>".repeat(depth)
        );
        let result = read("part.svg", text.as_bytes(), &mut |_| Ok(()));
        assert!(result.is_ok() == (depth < 1000), "{depth}: {result:?}");
    }
}

/// A drawing to be spoiled.
const DRAWING: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="80mm" viewBox="0 0 50 40"><style>g{fill:red}</style>
    <defs><path id="a" d="M0 0H9"/><clipPath id="c"><circle r="5"/></clipPath></defs><g transform="matrix(1 .2 .3 1 5 5)">
    <path d="M0 0 L10 0 C1 2 3 4 5 6 S 7 8 9 0 Q 1 1 2 2 T 5 5 A 3 4 30 0 1 8 8 z m 3 3 v-1"/><rect width="5" height="4" rx="1"/>
    <use href="#a" x="3" stroke="blue" stroke-dasharray="1 2"/><polygon points="0,0 3,1 2,5"/><ellipse rx="3" ry="2"/></g></svg>"##;

proptest! {
    #[test]
    fn a_spoiled_drawing_ends_in_a_result(
        spoils in prop::collection::vec((any::<prop::sample::Index>(), any::<char>(), 0..4), 0..8),
    ) {
        let mut text: Vec<char> = DRAWING.chars().collect();
        for (place, character, kind) in spoils {
            let at = place.index(text.len());
            match kind {
                0 => text[at] = character,
                1 => text.insert(at, character),
                2 => text[at] = char::from(b' ' + character as u8 % 90),
                _ => { text.remove(at); }
            }
        }
        let text: String = text.into_iter().collect();
        let result = read("part.svg", text.as_bytes(), &mut |item| {
            if let Action::Motion(motion) = item.action {
                assert!(motion.to().unwrap().iter().chain(&item.from).all(|x| x.is_finite()));
            }
            Ok(())
        });
        prop_assert!(result.is_ok() || result.is_err());
    }

    #[test]
    fn any_path_ends_in_a_result(path in "([MmLlHhVvCcSsQqTtAaZz]( ?-?[0-9.e]{1,5}){0,7}){0,20}") {
        let text = format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9"><path stroke="red" d="{path}"/></svg>"#);
        prop_assert!(read("part.svg", text.as_bytes(), &mut |_| Ok(())).is_ok_and(|seen| seen.warnings.is_empty()));
    }
}

//! `hodograph offset` and the motion that follows from it, as a person and a program meet them.

#![allow(clippy::unwrap_used, reason = "a failed test says where")]

mod common;

use std::f64::consts::{FRAC_PI_2, SQRT_2};
use std::path::PathBuf;

use common::{nowhere, run};
use serde_json::Value;

fn example(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../examples").join(name)
}

fn json(verb: &str, name: &str, options: &[&str]) -> Value {
    let mut all = vec!["--json", "-"];
    all.extend(options);
    let output = run(verb, &example(name), &all);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Closed forms of the bracket, an L of 80 x 60 mm with a leg of 24 x 30 mm less, a round notch, three rounded corners, and a
/// tool of radius 3 mm outside.
#[test]
fn bracket_has_the_offset_that_geometry_gives() {
    let value = json("offset", "bracket.toml", &["--check"]);
    assert_eq!((&value["units"], &value["distance"]), (&"mm".into(), &3.0.into()));
    let [found] = value["loops"].as_array().unwrap().as_slice() else { panic!("one loop") };
    let number = |value: &Value| value.as_f64().unwrap();
    let near = |value: &Value, expected: f64| {
        assert!((number(value) - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{value} beside {expected}");
    };
    // Straight parts: 60 + 20 below and right, 24 - 3 and 30 - 3 beside the trimmed corner, 12 + 18 above, 40 left; quarters of
    // radius 13 at three corners and of radius 3 at two, half a turn of radius 5 in the notch and a quarter at each end of it.
    let straight = 60.0 + 20.0 + 21.0 + 27.0 + 12.0 + 18.0 + 40.0;
    near(&found["length"], straight + FRAC_PI_2 * (3.0 * 13.0 + 2.0 * 3.0 + 2.0 * 5.0 + 2.0 * 3.0));
    assert_eq!((&found["closed"], &found["orientation"]), (&true.into(), &"ccw".into()));
    assert_eq!((&found["depth"], &found["parent"]), (&0.into(), &Value::Null));
    let pieces = found["pieces"].as_array().unwrap();
    let corners: Vec<&Value> = pieces.iter().filter(|piece| piece["end_corner"] == true).collect();
    let [corner] = corners.as_slice() else { panic!("one corner") };
    near(&corner["to"], 1.0 - 3.0 / 24.0);
    near(&corner["angle"], -FRAC_PI_2);
    near(&corner["end"][0], 59.0);
    near(&corner["end"][1], 33.0);
    assert!(pieces.iter().filter(|piece| piece["end_corner"] == false).all(|piece| piece["angle"] == 0.0));
    assert_eq!(pieces.iter().filter(|piece| piece["kind"] == "fill").count(), 4);
    let [undercut] = value["undercuts"].as_array().unwrap().as_slice() else { panic!("one undercut") };
    near(&undercut["depth"], 3.0 * (SQRT_2 - 1.0));
    near(&undercut["deepest"][0], 56.0);
    assert_eq!(value["largest_reaching_tool"], 0.0, "the corner of the L is sharp");
    assert_eq!(value["sharp_corners"][0]["node"], 3);
    assert_eq!(value["check"]["holds"], true);
}

/// The trimmed bracket is what stood in its file before it was trimmed: node by node, parameter by parameter.
#[test]
fn bracket_has_the_pieces_that_it_once_gave() {
    let segment = |number: usize, from: f64, to: f64| ("segment", number, from, to);
    let fill = |node: usize| ("fill", node, 0.0, 1.0);
    let whole = |number: usize| segment(number, 0.0, 1.0);
    let given = [
        whole(0),
        whole(1),
        whole(2),
        fill(2),
        segment(3, 0.0, 0.875),
        segment(4, 0.1, 1.0),
        fill(4),
        whole(5),
        fill(5),
        whole(6),
        fill(6),
        whole(7),
        whole(8),
        whole(9),
        whole(10),
    ];
    let value = json("offset", "bracket.toml", &[]);
    let found = value["loops"][0]["pieces"].as_array().unwrap();
    assert_eq!(found.len(), given.len());
    for (found, (kind, number, from, to)) in found.iter().zip(given) {
        assert_eq!((&found["kind"], &found["segment"]), (&kind.into(), &number.into()));
        let off = |key: &str, expected: f64| (found[key].as_f64().unwrap() - expected).abs();
        assert!(off("from", from) < 1e-9 && off("to", to) < 1e-9, "{found}");
    }
}

/// A job without its pieces moves as the same job with them: trimmed or given, the setpoints are the same, to the last bit.
#[test]
fn published_job_moves_alike_trimmed_and_given() {
    let text = std::fs::read_to_string(example("farouki2018.toml")).unwrap();
    let (contour, _) = text.split_once("[[piece]]").unwrap();
    let untrimmed = common::file("farouki2018-untrimmed.toml", contour);
    let output = run("simulate", &untrimmed, &["--json", "-"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let trimmed: Value = serde_json::from_slice(&output.stdout).unwrap();
    let given = json("simulate", "farouki2018.toml", &[]);
    assert_eq!(trimmed["setpoint_hash"], given["setpoint_hash"]);
}

/// A file that gives no feed will do; the picture is one SVG; and the text tells of loops, corners and what is left.
#[test]
fn text_and_picture_tell_of_the_pocket() {
    let svg = nowhere("pocket.svg");
    let output = run("offset", &example("pocket.toml"), &["--svg", svg.to_str().unwrap()]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success());
    for words in
        ["2 loops at distance -4 mm", "material stays between segment 7", "(31, 59)", "sharp corner at node 12, (0, 0)"]
    {
        assert!(text.contains(words), "{text:?} lacks {words:?}");
    }
    let picture = std::fs::read_to_string(svg).unwrap();
    assert!(picture.starts_with("<svg") && picture.ends_with("</svg>"));
    for words in ["contour C", "untrimmed offset", "trimmed offset", "trim point", "material left", "tool"] {
        assert!(picture.contains(words), "the picture has no {words:?}");
    }
}

/// `auto` at right angles is the published f = 0.25; the bracket's only corner is one, so both motions are the same.
#[test]
fn auto_reduction_at_a_right_angle_is_a_quarter() {
    let hash = |options: &[&str]| json("simulate", "bracket.toml", options)["setpoint_hash"].clone();
    assert_eq!(hash(&["--reduction", "auto"]), hash(&["--reduction", "0.25"]));
    assert_ne!(hash(&["--reduction", "auto"]), hash(&["--reduction", "0.3"]));
}

/// The shape that a tool's path has inside a pocket is closed; along an open contour it is open, and runs to both ends.
#[test]
fn open_contour_has_an_open_path() {
    let text = "units = \"mm\"\nclosed = false\n[offset]\ndistance = 2.0\n[feed]\nrate = 600.0\n\
        [[segment]]\nline = { start = [0.0, 0.0], to = [30.0, 0.0] }\n[[segment]]\nline = { to = [30.0, 40.0] }\n";
    let path = common::file("open.toml", text);
    let output = run("offset", &path, &["--json", "-"]);
    let value: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&value["loops"][0]["closed"], &value["loops"][0]["orientation"]), (&false.into(), &Value::Null));
    let output = run("simulate", &path, &["--json", "-"]);
    let value: Value = serde_json::from_slice(&output.stdout).unwrap();
    let length = value["centre_length"].as_f64().unwrap();
    assert!((length - (70.0 + 2.0 * FRAC_PI_2)).abs() < 1e-9, "{length}");
}

/// The pictures in `docs/` are those that the command beside them draws.
#[test]
fn documentation_pictures_are_the_programs() {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..");
    for (example, picture) in [("farouki2018", "trimming"), ("pocket", "pocket")] {
        let drawn = nowhere(&format!("{picture}.svg"));
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_hodograph"))
            .current_dir(&root)
            .args(["offset", &format!("examples/{example}.toml"), "--svg"])
            .arg(&drawn)
            .output()
            .unwrap();
        assert!(output.status.success());
        let [drawn, kept] = [drawn, root.join(format!("docs/{picture}.svg"))].map(|p| std::fs::read(p).unwrap());
        assert!(
            drawn == kept,
            "docs/{picture}.svg: draw it again with `hodograph offset examples/{example}.toml --svg`"
        );
    }
}

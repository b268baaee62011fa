//! Contours that have no offset, and distances that leave none: one sentence with the place, exit status 2, nothing written.

#![allow(clippy::unwrap_used, reason = "a failed test says where")]

mod common;

use common::{file, run, says};

/// A square of 20 mm, anticlockwise, of four lines.
const SQUARE: &str = r#"units = "mm"
closed = true
[offset]
distance = -3.0
[[segment]]
line = { start = [0.0, 0.0], to = [20.0, 0.0] }
[[segment]]
line = { to = [20.0, 20.0] }
[[segment]]
line = { to = [0.0, 20.0] }
[[segment]]
line = { to = [0.0, 0.0] }
"#;

const FEED: &str = "[feed]\nrate = 600.0\n";

fn refused(name: &str, text: &str, options: &[&str]) -> String {
    common::refused("offset", "--json", name, text, options)
}

#[test]
fn the_good_contour_has_an_offset() {
    let output = run("offset", &file("square.toml", SQUARE), &[]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// A change of the square, and what its error must say.
#[test]
fn each_fault_has_its_place_and_its_sentence() {
    let cases: &[(&str, &str, &str, &[&str])] = &[
        // The second and the third corner are exchanged: the lines 1 and 3 cross in the middle.
        (
            "crossing",
            "to = [20.0, 20.0] }\n[[segment]]\nline = { to = [0.0, 20.0] }",
            "to = [0.0, 20.0] }\n[[segment]]\nline = { to = [20.0, 20.0] }",
            &["job.toml:7:1: the contour crosses itself: segments 1 and 3 meet at (10, 10);"],
        ),
        ("zero", "distance = -3.0", "distance = 0.0", &["job.toml:4:12:", "zero", "give the radius"]),
        ("nan", "distance = -3.0", "distance = nan", &["job.toml:4:12:", "not a number"]),
        ("none", "[offset]\ndistance = -3.0\n", "", &["job.toml: ", "no [offset]", "--distance"]),
        (
            "open",
            "to = [0.0, 0.0] }",
            "to = [0.0, 5.0] }",
            &["job.toml:2:10: the contour is called closed, but ends 5 mm away from its start", "closed = false"],
        ),
        (
            "duplicate-node",
            "line = { to = [0.0, 20.0] }",
            "line = { to = [20.0, 20.0] }\n[[segment]]\nline = { to = [0.0, 20.0] }",
            &["job.toml:9:1: segment 2: it has no length (0 mm); leave it out"],
        ),
        (
            "arc-without-radius",
            "line = { to = [20.0, 20.0] }",
            "arc = { to = [20.0, 20.0], centre = [20.0, 0.0], ccw = true }",
            &["job.toml:7:1: segment 1:", "not at one distance from its centre: 0 and 20 mm"],
        ),
        (
            "arc-of-a-point",
            "line = { to = [20.0, 20.0] }",
            "arc = { to = [20.0, 0.0], centre = [20.0, 0.0], ccw = true }",
            &["job.toml:7:1: segment 1: the arc has no radius"],
        ),
        (
            "arc-off-its-circle",
            "line = { to = [20.0, 20.0] }",
            "arc = { to = [20.0, 20.0], centre = [20.0, 11.0], ccw = true }",
            &["job.toml:7:1: segment 1:", "11 and 9 mm"],
        ),
        (
            "hermite-without-direction",
            "line = { to = [20.0, 20.0] }",
            "hermite = { to = [20.0, 20.0], d0 = [0.0, 0.0], d1 = [1.0, 0.0] }",
            &["job.toml:7:1: segment 1:", "direction"],
        ),
        (
            "there-and-back",
            "line = { to = [20.0, 20.0] }",
            "line = { to = [30.0, 0.0] }\n[[segment]]\nline = { to = [25.0, 0.0] }\n[[segment]]\nline = { to = [20.0, 20.0] }",
            &["job.toml:7:1: at node 1", "goes back the way it came"],
        ),
        ("no-segments", &SQUARE[SQUARE.find("[[segment]]").unwrap()..], "", &["the contour has no segments"]),
        (
            "empty",
            "distance = -3.0",
            "distance = -12.0",
            &["job.toml:4:12: no path is left at distance -12 mm:", "9.9999 mm"],
        ),
    ];
    for (name, from, to, words) in cases {
        assert!(SQUARE.contains(from), "{name}");
        says(name, &refused(&format!("contour-{name}"), &SQUARE.replacen(from, to, 1), &[]), words);
    }
}

#[test]
fn a_distance_from_the_command_line_is_named() {
    for (value, words) in [
        ("0", ["--distance: the offset distance is zero", "give the radius"]),
        ("inf", ["--distance: the offset distance is zero or not a number", "give the radius"]),
        (
            "-10.5",
            ["--distance: no path is left at distance -10.5 mm", "the largest tool that fits has radius 9.9999 mm"],
        ),
    ] {
        says(value, &refused("distance", SQUARE, &["--distance", value]), &words);
    }
}

/// A single curve may cross itself, and stand still.
#[test]
fn a_faulty_curve_is_named() {
    let curve =
        |w: &str| format!("units = \"mm\"\nclosed = false\n[[segment]]\nph = {{ start = [0.0, 0.0], w = {w} }}\n");
    let error = refused("self-crossing", &curve("[[1.0, 2.0], [-5.0, 5.1], [1.0, -2.0]]"), &["--distance", "1"]);
    says("self-crossing", &error, &["job.toml:3:1: the contour crosses itself: segment 0 does at ("]);
    let error = refused("cusp", &curve("[[1.0, 0.0], [0.0, 0.0], [-1.0, 0.0]]"), &["--distance", "1"]);
    says("cusp", &error, &["job.toml:3:1: segment 0 stands still inside"]);
}

/// The tool that an error names does fit, in the file's own unit.
#[test]
fn the_tool_that_is_named_fits() {
    // A triangle with the sides 3, 4 and 5: its inscribed circle has radius 1, at which nothing is left but a point; and one
    // with the sides 2, 3 and sqrt 13, of radius (5 - sqrt 13)/2 = 0.697224.
    for (legs, radius) in [([4.0, 3.0], "0.99999 in"), ([3.0, 2.0], "0.69722 in")] {
        let [a, b] = legs;
        let text = format!(
            "units = \"inch\"\nclosed = true\n[[segment]]\nline = {{ start = [0.0, 0.0], to = [{a:?}, 0.0] }}\n\
             [[segment]]\nline = {{ to = [0.0, {b:?}] }}\n[[segment]]\nline = {{ to = [0.0, 0.0] }}\n"
        );
        let error = refused("triangle", &text, &["--distance", "-2"]);
        let named = error.rsplit("radius ").next().unwrap();
        assert_eq!(named, radius, "{error}");
        let distance = format!("-{}", named.trim_end_matches(" in"));
        let output = run("offset", &file("triangle-fits.toml", &text), &["--distance", &distance]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

/// What has no offset has no motion either, and `simulate` says so in the same words.
#[test]
fn simulate_refuses_the_same() {
    let text = format!("{}{FEED}", SQUARE.replace("distance = -3.0", "distance = -12.0"));
    let error = common::refused("simulate", "--setpoints", "no-motion", &text, &[]);
    says("no-motion", &error, &["job.toml:4:12: no path is left at distance -12 mm:"]);
}

/// Two chambers with a neck between them that the tool cannot pass: a run is one of two loops.
#[test]
fn several_loops_need_a_choice() {
    let pocket = include_str!("../../examples/pocket.toml");
    let unchosen: String =
        pocket.lines().filter(|line| !line.starts_with("loop")).map(|line| format!("{line}\n")).collect();
    let simulate =
        |name: &str, text: &str, options: &[&str]| common::refused("simulate", "--setpoints", name, text, options);
    let error = simulate("unchosen", &unchosen, &[]);
    says("unchosen", &error, &["has 2 loops", "--loop", "`loop` under [offset]", "from 0 to 1"]);
    let error = simulate("too-high", &unchosen, &["--loop", "2"]);
    says("too-high", &error, &["--loop: there is no loop 2", "2 loops, numbered from 0 to 1"]);
    let place = pocket.lines().position(|line| line.starts_with("loop")).unwrap() + 1;
    let error = simulate("too-high-in-file", &pocket.replace("loop = 0", "loop = 7"), &[]);
    says("too-high-in-file", &error, &[&format!("job.toml:{place}:8: there is no loop 7")]);
    for (text, options) in [(pocket, &[][..]), (unchosen.as_str(), &["--loop", "1"]), (pocket, &["--loop", "1"])] {
        let output = run("simulate", &file("chosen.toml", text), options);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

/// An open spline through some points, and a curve by its control points; the segment stands in line 5.
fn spline(segment: &str) -> String {
    format!("units = \"mm\"\nclosed = false\n{FEED}[[segment]]\n{segment}\n")
}

/// What is wrong with a spline is said with its place, and nothing moves.
#[test]
fn faulty_splines_have_their_sentence() {
    let through = |points: &str| spline(&format!("spline = {{ start = [0.0, 0.0], points = [{points}] }}"));
    let bezier = |points: &str| spline(&format!("bezier = {{ start = [0.0, 0.0], points = [{points}] }}"));
    let cases = [
        ("two-points", through("[1.0, 0.0]"), "has 2 points, and it takes 3"),
        (
            "repeated",
            through("[1.0, 0.0], [1.0, 0.0], [2.0, 3.0]"),
            "point 2 of the spline stands where the one before",
        ),
        ("nan", through("[1.0, nan], [1.0, 0.0], [2.0, 3.0]"), "point 1 of the spline has a coordinate that is not a"),
        ("cusp", bezier("[10.0, 10.0], [0.0, 10.0], [10.0, 0.0]"), "the spline stands still inside the piece"),
        ("still-start", bezier("[0.0, 0.0], [5.0, 10.0], [10.0, 0.0]"), "the spline stands still inside the piece"),
        ("four-points", bezier("[5.0, 10.0], [10.0, 0.0]"), "has 2 points behind its start; it needs 3"),
        (
            "degree",
            spline("spline = { start = [0.0, 0.0], degree = 4, points = [[1.0, 0.0], [1.0, 2.0]] }"),
            "degree 3 or 5",
        ),
        (
            "no-start",
            spline("bezier = { points = [[1.0, 0.0], [1.0, 2.0], [3.0, 3.0]] }"),
            "the first segment needs a `start`",
        ),
    ];
    for (name, text, words) in cases {
        let error = common::refused("simulate", "--trace", &format!("spline-{name}"), &text, &[]);
        says(name, &error, &["job.toml:5:1: segment 0", words]);
    }
    let offset = through("[1.0, 0.0], [1.0, 2.0]") + "[offset]\ndistance = 1.0\n";
    let error = common::refused("simulate", "--trace", "spline-offset", &offset, &[]);
    says("offset", &error, &["job.toml:5:1: segment 0 is a polynomial spline, which has no exact offset"]);
    let parts = offset.replace(FEED, "") + "[[piece]]\nsegment = 0\n" + FEED;
    let error = common::refused("simulate", "--trace", "spline-pieces", &parts, &[]);
    says("pieces", &error, &["is a polynomial spline, which has no exact offset"]);
}

/// A spline among other segments, and one that is cut where its feed would fluctuate, both run.
#[test]
fn good_splines_run() {
    for segment in [
        "line = { start = [0.0, 0.0], to = [5.0, 0.0] }\n[[segment]]\nspline = { points = [[9.0, 1.0], [9.0, 6.0], [2.0, 7.0]], degree = 5, parameter = \"arc\", correction = \"ninth\" }",
        // So near a cusp that the whole of it has no correction.
        "bezier = { start = [0.0, 0.0], points = [[9.9, 10.0], [0.0, 10.0], [10.0, 0.0]] }",
    ] {
        let output = run("simulate", &file("good-spline.toml", &spline(segment)), &["--json", "-"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let fed = result["max_feed"].as_f64().unwrap();
        assert!((fed / 600.0 - 1.0).abs() < 2e-3, "{fed}");
        assert!(result["max_contour_error"].as_f64().unwrap() < 2e-5);
    }
}

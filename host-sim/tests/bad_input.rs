//! Bad input, as a person meets it: one sentence with the place, exit status 2, nothing written.

#![allow(clippy::unwrap_used, reason = "a failed test says where")]

mod common;

use std::path::Path;
use std::process::Output;

use common::{file, run, says};

const GOOD: &str = r#"units = "mm"
closed = true
[offset]
distance = 2.0
[feed]
rate = 600.0
weight = 0.5
reduction = 0.5
ramp = 0.25
[[segment]]
line = { start = [0.0, 0.0], to = [40.0, 0.0] }
[[segment]]
arc = { to = [40.0, 20.0], centre = [40.0, 10.0], ccw = true }
[[segment]]
line = { to = [0.0, 20.0] }
[[segment]]
arc = { to = [0.0, 0.0], centre = [0.0, 10.0], ccw = true }
[[piece]]
segment = 0
[[piece]]
segment = 1
[[piece]]
segment = 2
[[piece]]
segment = 3
"#;

fn simulate(job: &Path, options: &[&str]) -> Output {
    run("simulate", job, options)
}

fn refused(name: &str, text: &str, options: &[&str]) -> String {
    common::refused("simulate", "--setpoints", name, text, options)
}

#[test]
fn the_good_job_runs() {
    let output = simulate(&file("good.toml", GOOD), &[]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// A change of the good job, and what its error must say: the place, and the words that let a person act.
#[test]
fn each_fault_has_its_place_and_its_sentence() {
    let cases: &[(&str, &str, &str, &[&str])] = &[
        ("weight", "weight = 0.5", "weight = 1.5", &["job.toml:7:10:", "1.5", "within 0"]),
        ("negative-weight", "weight = 0.5", "weight = -0.1", &["job.toml:7:10:", "-0.1"]),
        ("reduction-zero", "reduction = 0.5", "reduction = 0.0", &["job.toml:8:13:", "never reached"]),
        ("reduction-large", "reduction = 0.5", "reduction = 1.01", &["job.toml:8:13:", "at most 1"]),
        ("feed-zero", "rate = 600.0", "rate = 0.0", &["job.toml:6:8:", "above zero"]),
        ("feed-negative", "rate = 600.0", "rate = -5.0", &["job.toml:6:8:", "-5"]),
        ("feed-nan", "rate = 600.0", "rate = nan", &["job.toml:6:8:", "NaN"]),
        ("ramp-range", "ramp = 0.25", "ramp = 1.25", &["job.toml:9:8:", "1.25"]),
        (
            "ramps",
            "[[piece]]\nsegment = 0",
            "[[piece]]\nsegment = 0\nstart_corner = true\nstart_ramp = 0.7\nend_corner = true\nend_ramp = 0.7",
            &["job.toml:18:1:", "piece 0", "1.4", "at most 1"],
        ),
        (
            "zero-length",
            "line = { to = [0.0, 20.0] }",
            "line = { to = [40.0, 20.0] }\n[[segment]]\nline = { to = [0.0, 20.0] }",
            &["job.toml:14:1:", "segment 2", "no length"],
        ),
        (
            "gap",
            "line = { to = [0.0, 20.0] }",
            "line = { start = [39.0, 20.0], to = [0.0, 20.0] }",
            &["job.toml:14:1:", "segment 2", "starts 1 mm away", "(40, 20)"],
        ),
        ("reversed", "segment = 3\n", "segment = 3\nfrom = 0.6\nto = 0.4\n", &["piece 3", "0.6 to 0.4"]),
        ("outside", "segment = 3\n", "segment = 3\nto = 1.5\n", &["piece 3", "0 to 1.5"]),
        ("no-segment", "segment = 3\n", "segment = 9\n", &["job.toml:24:1:", "no segment 9"]),
        ("missing-piece", "[[piece]]\nsegment = 2\n", "", &["piece 2", "begins", "mm away"]),
        ("open-path", "[[piece]]\nsegment = 3\n", "", &["called closed", "mm away"]),
        ("cusp", "distance = 2.0", "distance = -10.0", &["piece 1", "1 + kappa d"]),
        ("unknown-key", "weight = 0.5", "wieght = 0.5", &["job.toml:7:1:", "wieght"]),
        ("not-toml", "units = \"mm\"", "units = mm\"", &["job.toml:1:"]),
        ("rest", "closed = true", "closed = true\nrest = 1", &["job.toml:3:8:", "expected a boolean"]),
        ("arc-centre", "centre = [40.0, 10.0]", "centre = [40.0, 11.0]", &["segment 1", "centre"]),
        ("reduction-word", "reduction = 0.5", "reduction = \"fast\"", &["job.toml:8:13:", "\"fast\"", "`auto`"]),
        ("reduction-list", "reduction = 0.5", "reduction = [0.5]", &["job.toml:8:13:", "\"auto\""]),
        (
            "no-feed",
            "[feed]\nrate = 600.0\nweight = 0.5\nreduction = 0.5\nramp = 0.25\n",
            "",
            &["job.toml:", "no [feed]"],
        ),
        ("fill-range", "segment = 3\n", "fill = { node = 3, from = 0.5, to = 1.5 }\n", &["piece 3", "0.5 to 1.5"]),
        ("no-choice", "distance = 2.0", "distance = 2.0\nloop = 0", &["job.toml:5:8:", "no loop to choose"]),
    ];
    for (name, from, to, words) in cases {
        assert!(GOOD.contains(from), "{name}");
        let error = refused(name, &GOOD.replacen(from, to, 1), &[]);
        says(name, &error, words);
    }
}

/// A contour that is called closed and is not says by how much.
#[test]
fn an_open_contour_is_not_closed() {
    let text = GOOD.replacen("line = { to = [0.0, 20.0] }", "line = { to = [1.0, 20.0] }", 1).replacen(
        "arc = { to = [0.0, 0.0], centre = [0.0, 10.0], ccw = true }",
        "line = { to = [0.0, 3.0] }",
        1,
    );
    let error = refused("not-closed", &text, &[]);
    says("not-closed", &error, &["job.toml:2:10:", "ends 3 mm away", "closed = false"]);
}

#[test]
fn faulty_options_name_themselves() {
    for (option, value, word) in [
        ("--weight", "2", "within 0"),
        ("--reduction", "0", "never reached"),
        ("--ramp", "-1", "-1"),
        ("--feed", "0", "above zero"),
        ("--feed", "nan", "NaN"),
        ("--loop", "0", "no loop to choose"),
        ("--plant", "no-such-plant.toml", "cannot be read"),
    ] {
        let error = refused("options", GOOD, &[option, value]);
        assert!(error.contains(word) && (error.contains(option) || option == "--plant"), "{error:?}");
    }
}

/// A fault in a plant is told as one in a job is.
#[test]
fn a_faulty_plant_has_its_place() {
    let mill = include_str!("../../examples/farouki2018-mill.toml");
    let plant = file("plant.toml", &mill.replace("lead = 5.08", "lead = -5.08"));
    let error = refused("plant-job", GOOD, &["--plant", plant.to_str().unwrap()]);
    let line = mill.lines().position(|line| line.starts_with("lead")).unwrap() + 1;
    assert!(error.contains(&format!("plant.toml:{line}:")) && error.contains("-5.08"), "{error:?}");
    assert!(!error.trim_end().ends_with(':'), "{error:?}");
}

#[test]
fn a_missing_file_and_a_foreign_one_are_named() {
    let output = simulate(std::path::Path::new("no-such-file.toml"), &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).starts_with("no-such-file.toml: cannot be read"));
    let output = simulate(&file("drawing.step", ""), &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("TOML"));
}

/// `--json -` writes JSON and nothing else.
#[test]
fn json_on_standard_output_is_alone() {
    let output = simulate(&file("json.toml", GOOD), &["--json", "-"]);
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    for key in [
        "ticks",
        "time_s",
        "contact_length",
        "centre_length",
        "max_feed",
        "max_acceleration",
        "max_contour_error",
        "rms_contour_error",
        "setpoint_hash",
        "units",
    ] {
        assert!(value.get(key).is_some(), "{key}");
    }
    // A stadium, 40 mm long with ends of radius 10 mm, and the tool 2 mm outside: closed forms.
    let turn = std::f64::consts::TAU;
    assert!((value["contact_length"].as_f64().unwrap() - (80.0 + 10.0 * turn)).abs() < 1e-9);
    assert!((value["centre_length"].as_f64().unwrap() - (80.0 + 12.0 * turn)).abs() < 1e-9);
    // V = 10 mm/s along lines; on the arcs w = 1/2 gives the contact V (1/2 + 1/2 / 1.2).
    let time = 8.0 + turn / (0.5 + 0.5 / 1.2);
    assert!((value["time_s"].as_f64().unwrap() - time).abs() < 1e-4);
}

//! `hodograph fit` as a person runs it: a program becomes a contour that runs, and programs that are read back; bad input is a sentence.

#![allow(clippy::unwrap_used, reason = "a failed test says where")]

mod common;

use common::{file, nowhere, run, says};
use serde_json::Value;

const HEART: &str = include_str!("../../examples/heart.ngc");

fn found(output: &std::process::Output) -> Value {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The example's 720 lines are a contour of a few PH curves, whose simulation is as long as the lines.
#[test]
fn the_example_becomes_a_contour_that_runs() {
    let program = file("fit-heart.ngc", HEART);
    let contour = nowhere("fit-heart.toml");
    let options = ["--tolerance", "0.01", "-o", contour.to_str().unwrap(), "--json", "-"];
    let fitted = found(&run("fit", &program, &options));
    let number = |key: &str| fitted[key].as_f64().unwrap();
    assert!(number("segments") < 40.0 && number("lines") > 700.0, "{fitted}");
    assert!(number("max_deviation") <= 0.01 && number("max_curvature_jump") < 1e-6, "{fitted}");
    let simulated = found(&run("simulate", &contour, &["--json", "-"]));
    let length = simulated["contact_length"].as_f64().unwrap();
    // The lines' own length.
    let mut at: Option<[f64; 2]> = None;
    let mut lines = 0.0;
    for line in HEART.lines().filter(|line| line.contains('X') && !line.contains("G0")) {
        let word = |letter: char| {
            let text = line.split(letter).nth(1).unwrap();
            text.split(' ').next().unwrap().parse::<f64>().unwrap()
        };
        let next = [word('X'), word('Y')];
        if let Some(at) = at {
            lines += (next[0] - at[0]).hypot(next[1] - at[1]);
        }
        at = Some(next);
    }
    assert!((length / lines - 1.0).abs() < 1e-3, "{length} {lines}");
    // The program itself is all of its motions, those in the air too.
    let whole = found(&run("simulate", &program, &["--json", "-"]));
    // The tick is on the path everywhere, where only z moves too.
    assert!(whole["max_contour_error"].as_f64().unwrap() < 1e-4, "{whole}");
    assert!(whole["rms_contour_error"].as_f64().unwrap() < 1e-4, "{whole}");
    let whole = whole["centre_length"].as_f64().unwrap();
    let (mut at, mut motions) = ([0.0_f64; 3], 0.0);
    for line in HEART.lines().filter(|line| !line.starts_with('(')) {
        let mut next = at;
        for (coordinate, letter) in next.iter_mut().zip(['X', 'Y', 'Z']) {
            if let Some(text) = line.split(letter).nth(1) {
                *coordinate = text.split(' ').next().unwrap().parse().unwrap();
            }
        }
        motions += (0..3).map(|axis| (next[axis] - at[axis]).powi(2)).sum::<f64>().sqrt();
        at = next;
    }
    assert!((whole / motions - 1.0).abs() < 1e-3 && whole > length + 10.0, "{whole} {motions}");
}

/// G64 P of a program is its tolerance: a tighter one keeps nearer to the lines, so it needs more pieces. A program may hold
/// several contours, and a cut without a feed is told with its line.
#[test]
fn a_program_is_a_job() {
    let pieces = |name: &str, tolerance: &str| {
        let program = file(name, &HEART.replace("G90 G17", &format!("G90 G17 G64 P{tolerance}")));
        let machine = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/machine.toml");
        let options = ["--machine", machine, "--zero", "200,200,-20", "--json", "-"];
        found(&run("plan", &program, &options))["pieces"].as_u64().unwrap()
    };
    assert!(pieces("job-tight.ngc", "0.002") > pieces("job-loose.ngc", "0.05"));
    let two = file("job-two.ngc", "G21 F100\nG1 X10\nG0 X20\nG1 Y10\n");
    let length = found(&run("simulate", &two, &["--json", "-"]))["contact_length"].as_f64().unwrap();
    assert!((length - 30.0).abs() < 1e-6, "{length}");
    // A machine that has no z is none for it.
    let flat = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/mill-servos.toml");
    let heart = file("job-heart.ngc", HEART);
    for options in [&["--machine", flat][..], &["--machine", flat, "--plan"]] {
        let output = run("simulate", &heart, options);
        assert_eq!(output.status.code(), Some(2));
        says("flat", &String::from_utf8(output.stderr).unwrap(), &["mill-servos.toml", "no third axis"]);
    }
    let slow = file("job-slow.ngc", "G21\nG1 X10\n");
    let output = run("simulate", &slow, &[]);
    assert_eq!(output.status.code(), Some(2));
    says("slow", &String::from_utf8(output.stderr).unwrap(), &["job-slow.ngc:2:", "feed", "F word"]);
}

/// What is written is read back: the same number of curves from it, none of them fitted again, and no less smooth.
#[test]
fn programs_are_read_back() {
    let program = file("fit-back.ngc", HEART);
    for (curve, ending) in
        [("bezier", "nc"), ("bezier", "mpf"), ("bspline", "mpf"), ("bspline", "ngc"), ("arc", "nc"), ("arc", "mpf")]
    {
        let name = format!("fit-back-{curve}.{ending}");
        let written = nowhere(&name);
        let options = ["--tolerance", "0.01", "--curve", curve, "-o", written.to_str().unwrap(), "--json", "-"];
        let output = run("fit", &program, &options);
        let fitted = found(&output);
        // The spindle comes along.
        let text = std::fs::read_to_string(&written).unwrap();
        assert!(text.contains("M3 S12000") && text.contains("M5") && output.stderr.is_empty(), "{name}");
        let back = found(&run("fit", &written, &["--tolerance", "0.01", "--json", "-"]));
        let lines = back["lines"].as_u64().unwrap();
        assert!(lines <= 4 && back["other_motions"].as_u64().unwrap() > 2, "{name}: {back} of {fitted}");
        assert!(!nowhere(&format!("{name}.part")).exists());
    }
}

/// Arcs go to the contour form as arcs, and the contour is as long as that of PH curves.
#[test]
fn arcs_are_a_contour() {
    let program = file("fit-arcs.ngc", HEART);
    let lengths = ["arc", "ph"].map(|curve| {
        let contour = nowhere(&format!("fit-arcs-{curve}.toml"));
        let options = ["--tolerance", "0.01", "--curve", curve, "-o", contour.to_str().unwrap(), "--json", "-"];
        let fitted = found(&run("fit", &program, &options));
        assert!(fitted["max_deviation"].as_f64().unwrap() <= 0.01, "{fitted}");
        let arcs = std::fs::read_to_string(&contour).unwrap().matches("\narc = {").count();
        assert!(if curve == "arc" { arcs > 20 } else { arcs == 0 }, "{curve}: {arcs} arcs");
        let simulated = found(&run("simulate", &contour, &["--json", "-"]));
        simulated["contact_length"].as_f64().unwrap()
    });
    assert!((lengths[0] / lengths[1] - 1.0).abs() < 1e-3, "{lengths:?}");
}

/// The picture says how many lines became how many curves; the plunge, seen from above, is a point. A C2 spline goes to the contour form.
#[test]
fn a_fit_is_drawn() {
    let program = file("fit-drawn.ngc", HEART);
    for (curve, words) in [("ph", "18 PH curves, within 0.01 mm"), ("arc", "lines and arcs"), ("ph-c2", "PH curves")] {
        let picture = nowhere(&format!("fit-drawn-{curve}.svg"));
        let contour = nowhere(&format!("fit-drawn-{curve}.toml"));
        let files = [&picture, &contour].map(|path| path.to_str().unwrap());
        let options = ["--tolerance", "0.01", "--curve", curve, "--svg", files[0], "-o", files[1], "--json", "-"];
        found(&run("fit", &program, &options));
        let text = std::fs::read_to_string(&picture).unwrap();
        assert!(text.starts_with("<svg") && text.contains("720 lines") && text.contains(words), "{curve}");
        found(&run("simulate", &contour, &["--json", "-"]));
    }
}

/// Lines along a circle and along a helix are one arc each, written as G3 and read back as one.
#[test]
fn a_circle_and_a_helix_are_one_arc() {
    for (name, rise) in [("circle", 0.0), ("helix", 3.0)] {
        let mut text = "G21 G90 G17 F600\nG0 X10 Y0 Z0\n".to_string();
        for k in 1..=500 {
            let t = f64::from(k) / 500.0;
            let (sin, cos) = (t * std::f64::consts::TAU).sin_cos();
            text += &format!("G1 X{:.4} Y{:.4} Z{:.4}\n", 10.0 * cos, 10.0 * sin, rise * t);
        }
        let program = file(&format!("fit-{name}.ngc"), &text);
        for ending in ["nc", "mpf"] {
            let written = nowhere(&format!("fit-{name}-back.{ending}"));
            let options = ["--tolerance", "0.005", "--curve", "arc", "-o", written.to_str().unwrap(), "--json", "-"];
            let fitted = found(&run("fit", &program, &options));
            assert_eq!(fitted["segments"], 1, "{name}: {fitted}");
            let text = std::fs::read_to_string(&written).unwrap();
            assert_eq!(text.matches("G3 ").count(), 1, "{text}");
            let back = found(&run("fit", &written, &["--tolerance", "0.005", "--json", "-"]));
            // The rapid to the start, and the arc.
            assert_eq!((&back["lines"], &back["other_motions"]), (&0.into(), &2.into()), "{name}: {back}");
        }
    }
}

/// The path beside a contour is written, and read back as what it is: a square of 20 mm with a tool of 6 mm on its left, by a table.
#[test]
fn a_tools_path_is_written() {
    let square = "G21 G90 F300\nG0 X-10 Y0\nG41 D2\nG1 X0 Y0\nX20\nY20\nX0\nY0\nG40\nG0 X-10 Y0\n";
    let program = file("fit-beside-square.ngc", square);
    let table = file("fit-tools.tbl", "T1 P1 D3.0\nT2 P2 Z10 D6.0 ;the one that is meant\n");
    let written = nowhere("fit-beside-written.ngc");
    let options =
        ["--tolerance", "0.01", "--curve", "arc", "--tools", table.to_str().unwrap(), "-o", written.to_str().unwrap()];
    assert!(run("fit", &program, &options).status.success());
    // Inside on its left: the sides less the tool's width.
    let text = std::fs::read_to_string(&written).unwrap();
    assert!(text.contains("X17") && text.contains("Y17") && text.contains("Y3"), "{text}");
    let missing = run("simulate", &program, &[]);
    assert_eq!(missing.status.code(), Some(2));
    says("missing", &String::from_utf8(missing.stderr).unwrap(), &["tool 2", "--tools"]);
    let found = found(&run("simulate", &program, &["--tools", table.to_str().unwrap(), "--json", "-"]));
    assert!(found["contact_length"].as_f64().unwrap() > 70.0);
    // A slot that is narrower than the tool is left out with a word, and refused where that is wanted.
    let slot = "G21 G90 F300\nG0 X-20 Y-10\nG42.1 D6\nG1 X0 Y-10\nX10\nY-2\nX12\nY-10\nX30\nG40\nG0 Y-20\n";
    let slot = file("fit-slot.ngc", slot);
    let trimmed = run("simulate", &slot, &[]);
    assert!(trimmed.status.success(), "{}", String::from_utf8_lossy(&trimmed.stderr));
    says("slot", &String::from_utf8(trimmed.stderr).unwrap(), &["warning", "fit-slot.ngc"]);
    assert_eq!(run("simulate", &slot, &["--gouge", "error"]).status.code(), Some(2));
}

#[test]
fn bad_input_is_a_sentence() {
    let heart = file("fit-bad.ngc", HEART);
    let broken = file("fit-broken.ngc", "G21\nF100\nG1 X1\nG1 X2 Y(oh\n");
    let two = file("fit-two.ngc", "G21 F100\nG1 X10\nG0 X20\nG1 Y10\n");
    let part = file("fit-part.xyz", "G1 X1\n");
    let rise = file("fit-rise.ngc", "G21 F100\nG2 X2 Y0 I1 Z5\n");
    let beside = file("fit-beside.ngc", "G21 F100\nG41 D6\nG1 X10\nG1 Y10\n");
    let toml = nowhere("fit-bad.toml");
    let toml = toml.to_str().unwrap();
    let mpf = nowhere("fit-bad.mpf");
    let mpf = mpf.to_str().unwrap();
    let cases: [(&str, &std::path::Path, &[&str], &[&str]); 10] = [
        ("tolerance", &heart, &["--tolerance", "0", "-o", toml], &["--tolerance", "above zero"]),
        ("negative", &heart, &["--tolerance", "-0.1", "-o", toml], &["-0.1", "above zero"]),
        ("ending", &part, &["--tolerance", "0.01", "-o", toml], &["fit-part.xyz", "xyz", ".ngc"]),
        ("result", &heart, &["--tolerance", "0.01", "-o", "heart.step"], &["heart.step", ".toml"]),
        ("words", &heart, &["--tolerance", "0.01", "--curve", "ph", "-o", mpf], &["PH", ".toml", "bspline"]),
        ("block", &broken, &["--tolerance", "0.01", "--curve", "bspline", "-o", mpf], &["fit-broken.ngc:4:"]),
        ("contours", &two, &["--tolerance", "0.01", "-o", toml], &["2 contours", "--contour 0 to 1"]),
        ("compensated", &beside, &["--tolerance", "0.01", "-o", toml], &["fit-beside.ngc:2:", "tool 6", "--tools"]),
        ("compensated program", &beside, &["--tolerance", "0.01", "--curve", "bezier", "-o", mpf], &["tool 6"]),
        ("height", &rise, &["--tolerance", "0.01", "-o", toml], &["fit-rise.ngc:2:", "height"]),
    ];
    for (name, input, options, words) in cases {
        let output = run("fit", input, options);
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{name}: {errors}");
        says(name, &errors, words);
        for written in [toml, mpf, &format!("{mpf}.part")] {
            assert!(!std::path::Path::new(written).exists(), "{name}: something was written");
        }
    }
}

//! What `hodograph simulate --machine` says of a run.
#![allow(clippy::unwrap_used, missing_docs, reason = "a failed test says where")]

mod common;

use common::{file, run};

const ROUTER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/machine.toml");

/// A circle of 10 mm within the router's travel, at so many mm/min, from rest to rest.
fn circle(name: &str, rate: f64) -> std::path::PathBuf {
    let text = format!(
        "units = \"mm\"\nclosed = true\nrest = true\n[feed]\nrate = {rate}\n[[segment]]\n\
         arc = {{ start = [110.0, 100.0], to = [110.0, 100.0], centre = [100.0, 100.0], ccw = true }}\n"
    );
    file(name, &text)
}

#[test]
fn a_run_is_laid_beside_the_machine() {
    // 20 mm/s ask for 40 mm/s2 across; the start and the end for what --acceleration leaves them.
    let slow = circle("demand-slow.toml", 1200.0);
    let output = run("simulate", &slow, &["--machine", ROUTER, "--acceleration", "300", "--json", "-"]);
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let demand = &result["demand"];
    for axis in demand["axes"].as_array().unwrap() {
        for (quantity, limit) in [("velocity", 80.0), ("acceleration", 400.0)] {
            assert_eq!(axis[quantity]["limit"].as_f64(), Some(limit));
            assert_eq!(axis[quantity]["verdict"], "kept", "{axis}");
        }
        assert!((axis["velocity"]["peak"].as_f64().unwrap() / 20.0 - 1.0).abs() < 5e-3, "{axis}");
    }
    let (least, own) = (demand["least_time_s"].as_f64().unwrap(), result["time_s"].as_f64().unwrap());
    assert!(least < own && least > 0.9 * own, "{least} {own}");

    let fast = circle("demand-fast.toml", 6000.0);
    let text = String::from_utf8(run("simulate", &fast, &["--machine", ROUTER]).stdout).unwrap();
    for words in ["x velocity ", "of 80.0 mm/s, 125 %", "MORE THAN IT BEARS", "least time"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    let without = String::from_utf8(run("simulate", &fast, &[]).stdout).unwrap();
    assert!(!without.contains("asked of the machine"));
}

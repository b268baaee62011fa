//! `hodograph reproduce feed-correction` as a person runs it.
#![allow(clippy::unwrap_used, missing_docs, reason = "a failed test says where")]

mod common;

use std::path::Path;

use common::{file, nowhere, run};

#[test]
fn tables_and_pictures_are_written() {
    let report = nowhere("feed-correction.html");
    let output = run("reproduce", Path::new("feed-correction"), &["--json", "-", "--report", report.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    for row in result["rows"].as_array().unwrap() {
        assert!(row["name"].is_string() && row["published"].is_number() && row["measured"].is_number());
    }
    let html = std::fs::read_to_string(report).unwrap();
    // Both curves, and every run but the iterative ones, which depart by rounding only.
    let methods = result["runs"].as_array().unwrap().iter().map(|run| run["method"].as_str().unwrap());
    assert_eq!(html.matches("<svg").count(), 2 + methods.filter(|method| *method != "iterative").count());
    let text = run("reproduce", Path::new("feed-correction"), &[]);
    let text = String::from_utf8(text.stdout).unwrap();
    for words in ["fan: mean M", "seventh order, two samples", "84 M + 7", "the rule's nodes"] {
        assert!(text.contains(words), "{words}");
    }
}

#[test]
fn faulty_airfoils_are_told() {
    let line = "0.5 0.1\n";
    for (name, text, said) in [
        ("letters", "NAME\n1 0\n0.5 x\n".to_string(), ":3: \"0.5 x\" is no pair of coordinates"),
        ("few", "NAME\n1 0\n0.5 0.1\n".to_string(), "it has 2 points, and 48 segments take 49"),
        ("repeated", format!("NAME\n{}", line.repeat(60)), "stands where the one before it does"),
    ] {
        let path = file(&format!("airfoil-{name}.dat"), &text);
        let output = run("reproduce", Path::new("feed-correction"), &["--airfoil", path.to_str().unwrap()]);
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{errors}");
        assert!(errors.contains(said) && errors.trim_end().lines().count() == 1, "{errors}");
    }
    let output = run("reproduce", Path::new("farouki2018"), &["--airfoil", "none.dat"]);
    assert_eq!(output.status.code(), Some(2));
}

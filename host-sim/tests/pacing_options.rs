//! Starts, stops and overrides as a person gives them on the command line.

#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use std::path::PathBuf;
use std::process::{Command, Output};

/// 100 mm at 50 mm/s in two parts, there and back: two corners, at which the feed is a quarter.
const JOB: &str = r#"units = "mm"
closed = true
[feed]
rate = 3000.0
reduction = 0.25
[[segment]]
line = { start = [0.0, 0.0], to = [50.0, 0.0] }
[[segment]]
line = { to = [100.0, 0.0] }
[[segment]]
line = { to = [50.0, 0.0] }
[[segment]]
line = { to = [0.0, 0.0] }
"#;

fn file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("pacing-{name}"))
}

fn simulate(name: &str, text: &str, options: &[&str]) -> Output {
    let job = file(&format!("{name}.toml"));
    std::fs::write(&job, text).unwrap();
    Command::new(env!("CARGO_BIN_EXE_hodograph")).arg("simulate").arg(job).args(options).output().unwrap()
}

/// The result and the lines of the trace.
fn run(name: &str, text: &str, options: &[&str]) -> (serde_json::Value, Vec<Vec<String>>) {
    let trace = file(&format!("{name}.csv"));
    let mut all = options.to_vec();
    all.extend(["--json", "-", "--trace", trace.to_str().unwrap()]);
    let output = simulate(name, text, &all);
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    let trace = std::fs::read_to_string(trace).unwrap();
    let lines = trace.lines().map(|line| line.split(',').map(str::to_string).collect()).collect();
    (serde_json::from_slice(&output.stdout).unwrap(), lines)
}

fn column(trace: &[Vec<String>], name: &str) -> Vec<String> {
    let index = trace[0].iter().position(|head| head == name).unwrap();
    trace[1..].iter().map(|line| line[index].clone()).collect()
}

#[test]
fn the_documented_columns_come_first() {
    let (_, trace) = run("columns", JOB, &[]);
    let documented = "tick,piece,xi,u,feed,x_cmd,y_cmd,z_cmd,x_act,y_act,z_act,contour_error,pace,state";
    assert_eq!(trace[0].join(","), documented);
    assert!(column(&trace, "pace").iter().all(|pace| pace == "1"), "from feed to feed");
}

#[test]
fn a_job_from_rest_to_rest() {
    let (plain, _) = run("plain", JOB, &[]);
    let rest = JOB.replace("closed = true", "closed = true\nrest = true");
    let (by_job, trace) = run("rest-job", &rest, &[]);
    let (by_option, _) = run("rest-option", JOB, &["--rest"]);
    assert_eq!(by_job["setpoint_hash"], by_option["setpoint_hash"]);
    assert!(by_job["time_s"].as_f64() > plain["time_s"].as_f64());
    let pace: Vec<f64> = column(&trace, "pace").iter().map(|pace| pace.parse().unwrap()).collect();
    assert!(pace[0] < 0.01 && pace.contains(&1.0) && pace[pace.len() - 1] == 0.0);
    let state = column(&trace, "state");
    assert_eq!(state.last().map(String::as_str), Some("finished"));
    assert!(state.contains(&"braking".to_string()));
}

#[test]
fn what_happens_is_in_trace_and_result() {
    let script = ["--at", "1=hold", "--at", "2.5=resume", "--at", "4=override:50", "--at", "0.5=override:150"];
    let (result, trace) = run("script", JOB, &script);
    let pace = column(&trace, "pace");
    assert_eq!((pace[1000].as_str(), pace[2000].as_str()), ("1.5", "0"));
    assert!(pace.contains(&"0.5".to_string()));
    let state = column(&trace, "state");
    assert_eq!((state[1100].as_str(), state[2500].as_str()), ("holding", "held"));
    let carried = result["script"].as_array().unwrap();
    let ticks: Vec<u64> = carried.iter().map(|entry| entry["tick"].as_u64().unwrap()).collect();
    assert_eq!(ticks, [513, 1025, 2561, 4097]);
    assert!(carried.iter().all(|entry| entry["refused"].is_null()));
    assert_eq!(result["state"], "finished");
}

#[test]
fn a_run_may_end_before_its_path() {
    for (at, state) in [("1=hold", "held"), ("1=cancel", "cancelled"), ("0=block:on", "held")] {
        let (result, _) = run(state, JOB, &["--at", at]);
        assert_eq!(result["state"], state, "{at}");
        assert!(result["time_s"].as_f64().unwrap() < 4.0);
    }
}

/// With two pieces and then none for a while the motion waits where the second one ends.
#[test]
fn a_silent_host() {
    let (result, trace) = run("starved", JOB, &["--queue", "1", "--at", "0.1=starve:5"]);
    assert_eq!(result["state"], "finished");
    let (state, x) = (column(&trace, "state"), column(&trace, "x_cmd"));
    let starved: Vec<usize> = (0..state.len()).filter(|&tick| state[tick] == "starved").collect();
    assert!(starved.len() > 512 && starved.iter().all(|&tick| x[tick] == "100"));
}

#[test]
fn what_the_axes_bear() {
    // The ramps ask for some 200 mm/s2.
    let (result, trace) = run("bears", JOB, &["--rest", "--acceleration", "1000", "--override", "200"]);
    let most = column(&trace, "pace").iter().map(|pace| pace.parse::<f64>().unwrap()).fold(0.0, f64::max);
    assert!(most > 1.2 && most <= 2.0, "{most}");
    assert_eq!(result["state"], "finished");
    let x: Vec<f64> = column(&trace, "x_cmd").iter().map(|x| x.parse().unwrap()).collect();
    let piece = column(&trace, "piece");
    let worst = x
        .windows(3)
        .zip(piece.windows(3))
        // At a corner the velocity turns round, from a quarter of the feed.
        .filter(|(_, piece)| piece[0] == piece[2])
        .map(|(x, _)| (x[2] - 2.0 * x[1] + x[0]).abs() * 1024.0 * 1024.0)
        .fold(0.0, f64::max);
    // Four roundings of a setpoint, 4 nm each, on top.
    assert!(worst < 1000.0 + 17.0 && worst > 500.0, "{worst}");
}

#[test]
fn faulty_options_are_refused() {
    let cases: &[(&[&str], &str)] = &[
        (&["--acceleration", "0"], "--acceleration: the limit is 0"),
        (&["--acceleration", "500", "--jerk", "-1"], "--jerk: the limit is -1"),
        (&["--acceleration", "20"], "lower the feed or raise --acceleration"),
        (&["--jerk", "100"], "--acceleration"),
        (&["--override", "0"], "1 and 200"),
        (&["--override", "x"], "1 and 200"),
        (&["--at", "hold"], "2.5=hold"),
        (&["--at", "1=stop"], "give hold"),
        (&["--at", "x=hold"], "give seconds"),
        (&["--queue", "0"], "--queue"),
    ];
    for (options, said) in cases {
        let output = simulate("faulty", JOB, options);
        let errors = String::from_utf8_lossy(&output.stderr).to_string();
        assert_eq!(output.status.code(), Some(2), "{options:?}: {errors}");
        assert!(errors.contains(said), "{options:?}: {errors}");
        assert!(output.stdout.is_empty());
    }
}

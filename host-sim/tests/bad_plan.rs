//! What cannot be planned, as a person meets it: one sentence with the place, exit status 2, nothing written.

#![allow(clippy::unwrap_used, reason = "a failed test says where")]

mod common;

use common::{file, nowhere, refused, run, says};

const ROUTER: &str = include_str!("../../examples/machine.toml");

/// A square with a side of 20 mm, 40 mm within the router's travel.
const GOOD: &str = "units = \"mm\"\nclosed = true\n[feed]\nrate = 3000.0\n\
    [[segment]]\nline = { start = [40.0, 40.0], to = [60.0, 40.0] }\n[[segment]]\nline = { to = [60.0, 60.0] }\n\
    [[segment]]\nline = { to = [40.0, 60.0] }\n[[segment]]\nline = { to = [40.0, 40.0] }\n";

/// The sentence for a machine's file with this text; the file is named machine.toml in it.
fn of_machine(name: &str, machine: &str) -> String {
    let machine = file(&format!("{name}-machine.toml"), machine);
    let machine = machine.to_str().unwrap();
    refused("plan", "--report", name, GOOD, &["--machine", machine]).replace(machine, "machine.toml")
}

/// The sentence for options beside the router's file.
fn of_options(name: &str, options: &[&str]) -> String {
    let machine = file(&format!("{name}-machine.toml"), ROUTER);
    let machine = machine.to_str().unwrap();
    refused("plan", "--report", name, GOOD, &[&["--machine", machine], options].concat())
        .replace(machine, "machine.toml")
}

/// The line of the first axis that begins so, from 1.
fn line_of(text: &str, start: &str) -> usize {
    text.lines().position(|line| line.starts_with(start)).unwrap() + 1
}

/// Without limits there is no plan: each of an axis is needed, and is a number within a range.
#[test]
fn an_axis_without_limits_has_its_place() {
    for (key, least) in [("velocity", "0.001"), ("acceleration", "4"), ("jerk", "4")] {
        let line = line_of(ROUTER, key);
        let at = ROUTER.lines().nth(line - 1).unwrap();
        for value in ["0.0", "-400.0", "nan"] {
            let name = format!("plan-{key}-{value}");
            let error = of_machine(&name, &ROUTER.replacen(at, &format!("{key} = {value}"), 1));
            let shown = value.trim_end_matches(".0").replace("nan", "NaN");
            let column = key.len() + 4;
            says(
                &name,
                &error,
                &[&format!("machine.toml:{line}:{column}: axis x: {key} is {shown}; it must be {least} to ")],
            );
        }
        let error = of_machine(&format!("plan-no-{key}"), &ROUTER.replacen(at, "", 1));
        says(
            key,
            &error,
            &[&format!("machine.toml:{}:1: ", line_of(ROUTER, "[[axis]]")), &format!("missing field `{key}`")],
        );
    }
}

/// The table of the path: numbers above zero, and steps at corners that may be none.
#[test]
fn a_faulty_path_table_has_its_place() {
    let line = ROUTER.lines().count() + 2;
    for (key, value, said) in [
        ("feed", "0.0", "path.feed is 0; it must be a number above zero"),
        ("feed", "-50.0", "path.feed is -50; it must be a number above zero"),
        ("centripetal", "0.0", "path.centripetal is 0; it must be a number above zero"),
        ("centripetal", "inf", "path.centripetal is inf; it must be a number above zero"),
        ("contour_error", "0.0", "path.contour_error is 0; it must be a number above zero"),
        ("contour_error", "nan", "path.contour_error is NaN; it must be a number above zero"),
        ("corner_step", "[1.0, -2.0]", "path.corner_step is -2; it must be a number, zero or above"),
    ] {
        let name = format!("plan-path-{key}");
        let error = of_machine(&name, &format!("{ROUTER}[path]\n{key} = {value}\n"));
        assert_eq!(error, format!("machine.toml:{line}:{}: {said}", key.len() + 4));
    }
    let error = of_machine("plan-path-word", &format!("{ROUTER}[path]\ncorner = [1.0, 1.0]\n"));
    says("plan-path-word", &error, &[&format!("machine.toml:{line}:1: "), "corner", "corner_step"]);
}

#[test]
fn feeds_at_the_ends_can_be_met() {
    for option in ["--start-feed", "--end-feed"] {
        for (value, said) in [("-1", "the feed is -1; "), ("nan", "the feed is NaN; "), ("inf", "the feed is inf; ")] {
            let error = of_options("plan-ends", &[option, value]);
            assert_eq!(error, format!("{option}: {said}it must be a number, zero or above"));
        }
        // The job's own feed is 3000.
        let error = of_options("plan-ends", &[option, "1e5"]);
        let does = if option == "--start-feed" { "begin" } else { "end" };
        says(option, &error, &[&format!("{option}: within the limits of machine.toml the path can {does} at ")]);
        let most: f64 = error.split(" at ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        assert!(most > 2900.0 && most <= 3000.0, "{error}");
    }
}

/// The part that is outside is named, and by how much.
#[test]
fn a_job_outside_the_travel_says_where() {
    let error = of_options("plan-outside", &["--zero", "545,0"]);
    says("plan-outside", &error, &["job.toml:5:1: ", "the travel of axis x by 5 mm at its high end"]);
    let error = of_options("plan-outside", &["--zero", "0,-45.5"]);
    says("plan-outside", &error, &["job.toml:5:1: ", "the travel of axis y by 5.5 mm at its low end"]);
}

#[test]
fn a_budget_is_above_zero() {
    for (value, shown) in [("0", "0"), ("-0.01", "-0.01"), ("nan", "NaN"), ("inf", "inf")] {
        let error = of_options("plan-budget", &["--contour-error", value]);
        assert_eq!(error, format!("--contour-error: the budget is {shown}; it must be a number above zero"));
    }
    let error = of_options("plan-no-plant", &["--contour-error", "0.01", "--plant", "no-such-plant.toml"]);
    says("plan-no-plant", &error, &["no-such-plant.toml: cannot be read"]);
}

/// The mill's encoders do not see a tenth of a micrometre. What was found is said, and it is what a slow job is off by.
#[test]
fn a_budget_below_the_plants_own_error_says_what_is_possible() {
    let least = |error: &str| -> f64 {
        let (_, rest) = error.split_once("keeps 0.0001 mm on this path, ").unwrap();
        rest.split_once(" mm at the least; ").unwrap().0.parse().unwrap()
    };
    let error = of_options("plan-tight", &["--contour-error", "0.0001"]);
    says("plan-tight", &error, &["--contour-error: ", "the plant farouki2018-mill", "allow more"]);
    assert!(least(&error) > 1e-4 && least(&error) < 3e-3, "{error}");
    // A budget of the machine's file has its name.
    let error = of_machine("plan-tight-file", &format!("{ROUTER}[path]\ncontour_error = 0.0001\n"));
    says("plan-tight-file", &error, &["machine.toml: no plan was found"]);
}

/// A plan needs a machine, and says so wherever a job may be planned.
#[test]
fn a_plan_needs_a_machine() {
    let error = refused("plan", "--json", "plan-alone", GOOD, &[]);
    assert_eq!(error, "--machine: a plan needs the limits of a machine; name its file");
    let error = refused("plan", "--json", "plan-lost", GOOD, &["--machine", "no-such-machine.toml"]);
    says("plan-lost", &error, &["no-such-machine.toml: cannot be read"]);
    for (verb, writes) in [("simulate", "--setpoints"), ("prepare", "-o")] {
        let (job, written) = (file("plan-verb.toml", GOOD), nowhere("plan-verb.out"));
        let output = run(verb, &job, &["--plan", writes, written.to_str().unwrap()]);
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{verb}: {errors}");
        assert!(errors.contains("--machine") && output.stdout.is_empty() && !written.exists(), "{verb}: {errors}");
    }
}

//! `hodograph stream`, `monitor` and `machine` against a controller on a TCP port of this process.
#![allow(clippy::unwrap_used, missing_docs, reason = "a failed test says where")]

use std::io::{ErrorKind, Read, Write};
use std::net::TcpListener;
use std::process::{Command, Output};
use std::thread;

use host_sim::controller::{Controller, Settings};
use host_sim::machine::{from_toml, read};
use shared::machine::MachineSettings;

/// A file among the examples.
macro_rules! example {
    ($name:literal) => {
        concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/", $name)
    };
}

/// Switches that no job here comes to.
const FAR: [f64; 3] = [1e6; 3];

/// A controller of the router on a port of its own, which runs as fast as it can; it serves so many connections, one after another. With a fault, a drive has reported one that is gone.
fn controller(connections: usize, fault: bool) -> String {
    controller_of(Some(read(example!("machine.toml")).unwrap()), connections, fault, FAR)
}

/// The same of any machine, with switches so far below x and y and above z, in mm.
fn controller_of(machine: Option<MachineSettings>, connections: usize, fault: bool, switches: [f64; 3]) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = format!("tcp:{}", listener.local_addr().unwrap());
    thread::spawn(move || {
        let mut controller = Controller::new(Settings::new(machine)).unwrap();
        if fault {
            controller.rig().pins.drive_fault ^= 0b010;
            controller.tick();
            controller.rig().pins.drive_fault ^= 0b010;
            // An input counts as released after some time of rest; nobody may ask before it has passed.
            for _ in 0..1024 {
                controller.tick();
            }
        }
        for stream in listener.incoming().take(connections) {
            let mut stream = stream.unwrap();
            stream.set_read_timeout(Some(std::time::Duration::from_micros(200))).unwrap();
            let mut buffer = [0; 1024];
            loop {
                match stream.read(&mut buffer) {
                    Ok(0) => break,
                    Ok(count) => controller.receive(&buffer[..count]),
                    Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {}
                    Err(_) => break,
                }
                for _ in 0..20 {
                    let [x, y, z] = controller.rig().axes.map(|axis| axis.place());
                    controller.rig().pins.low = u8::from(x <= -switches[0]) | u8::from(y <= -switches[1]) << 1;
                    controller.rig().pins.high = u8::from(z >= switches[2]) << 2;
                    controller.tick();
                }
                if stream.write_all(&controller.take_output()).is_err() {
                    break;
                }
            }
        }
    });
    port
}

fn hodograph(arguments: &[&str]) -> Output {
    let job = example!("farouki2018.toml");
    let arguments = arguments.iter().map(|&argument| if argument == "JOB" { job } else { argument });
    Command::new(env!("CARGO_BIN_EXE_hodograph")).args(arguments).output().unwrap()
}

fn json(output: &Output) -> serde_json::Value {
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The controller does to the last bit what the simulator does. At the paper's feed the router's drives could not follow.
#[test]
fn a_job_arrives_and_runs_as_simulated() {
    let port = controller(1, false);
    let streamed = json(&hodograph(&["stream", "JOB", "--port", &port, "--from-here", "--feed", "120", "--json", "-"]));
    let simulated = json(&hodograph(&["simulate", "JOB", "--rest", "--feed", "120", "--json", "-"]));
    assert_eq!(streamed["setpoint_hash"], simulated["setpoint_hash"]);
    assert_eq!(streamed["ticks"], simulated["ticks"]);
    assert_eq!(streamed["sent"], streamed["acknowledged"]);
    assert_eq!(streamed["resent"], 0);
}

/// So it does with a plan, which is within what the router's drives bear, and begins and ends at rest by itself. All of it is queued before it
/// starts: this controller runs faster than pieces come, and would have to slow down.
#[test]
fn a_planned_job_runs_as_simulated() {
    let text = "units = \"mm\"\nclosed = false\n[feed]\nrate = 3000.0\n\
        [[segment]]\nline = { start = [100.0, 100.0], to = [140.0, 100.0] }\n\
        [[segment]]\narc = { to = [140.0, 120.0], centre = [140.0, 110.0], ccw = true }\n";
    let file = std::path::PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("planned.toml");
    std::fs::write(&file, text).unwrap();
    let common = [file.to_str().unwrap(), "--machine", example!("machine.toml"), "--json", "-"];
    let port = controller(1, false);
    let streamed = json(&hodograph(&[&["stream", "--plan", "--port", &port, "--from-here"], &common[..]].concat()));
    let simulated = json(&hodograph(&[&["simulate", "--plan"], &common[..]].concat()));
    for key in ["setpoint_hash", "ticks", "time_s"] {
        assert_eq!(streamed[key], simulated[key], "{key}");
    }
    assert_eq!((&streamed["sent"], &streamed["resent"]), (&streamed["acknowledged"], &0.into()));
    // What ran is the plan.
    let plan = json(&hodograph(&[&["plan"], &common[..]].concat()));
    let (ran, time) = (streamed["time_s"].as_f64().unwrap(), plan["time_s"].as_f64().unwrap());
    assert!((ran - time).abs() < 1e-3, "{ran} {time}");
    let [pieces, planned] = ["pieces", "planned_pieces"].map(|key| plan[key].as_u64().unwrap());
    assert!(planned > pieces && planned < 63, "{pieces} {planned}");
}

#[test]
fn a_monitor_sees_the_controller() {
    let port = controller(1, true);
    let output = hodograph(&["monitor", "--port", &port, "--json", "--count", "2", "--every", "20"]);
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<serde_json::Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(lines.len(), 2);
    assert_eq!(
        (&lines[1]["state"], &lines[1]["fault"]),
        (&"fault".into(), &"the drive of axis 1 reports a fault".into())
    );
}

/// One sentence, and the status that says whose fault it is.
#[test]
fn what_cannot_be_is_said_in_one_sentence() {
    // A port that was free a moment ago: nobody listens there.
    let free = format!("tcp:{}", TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap());
    let faulty = controller(1, true);
    for (port, status, said) in [
        (free.as_str(), 2, "cannot be opened"),
        ("tcp:nowhere", 2, "cannot be opened"),
        ("no-such-port", 2, "there is no such port"),
        (
            faulty.as_str(),
            1,
            "the drive of axis 1 reports a fault; mend its cause and acknowledge it (hodograph monitor",
        ),
    ] {
        let output = hodograph(&["stream", "JOB", "--port", port]);
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(status), "{port}: {errors}");
        assert!(errors.contains(said) && errors.trim_end().lines().count() == 1, "{port}: {errors}");
    }
}

/// After a fault nothing runs before somebody has taken notice; then the job does.
#[test]
fn a_fault_is_acknowledged_from_the_command_line() {
    let port = controller(3, true);
    let refused = hodograph(&["stream", "JOB", "--port", &port, "--from-here", "--feed", "120"]);
    assert_eq!(refused.status.code(), Some(1));
    let asked = hodograph(&["monitor", "--port", &port, "--act", "acknowledge", "--act", "override=50"]);
    assert!(asked.status.success(), "{}", String::from_utf8_lossy(&asked.stderr));
    assert_eq!(String::from_utf8(asked.stdout).unwrap(), "acknowledge: done\noverride=50: done\n");
    json(&hodograph(&["stream", "JOB", "--port", &port, "--from-here", "--feed", "120", "--json", "-"]));
}

/// The first refusal ends a row of actions, in one sentence with status 1; what is no action never reaches the controller.
#[test]
fn a_refused_action_ends_the_row() {
    let port = controller(1, false);
    let output =
        hodograph(&["monitor", "--port", &port, "--act", "override=90", "--act", "hold", "--act", "acknowledge"]);
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{errors}");
    assert_eq!(String::from_utf8(output.stdout).unwrap(), "override=90: done\n");
    assert!(
        errors.contains("hold was refused: the machine is in state idle") && errors.trim_end().lines().count() == 1
    );
    for action in ["override=0", "jump"] {
        let output = hodograph(&["monitor", "--port", "tcp:nowhere", "--act", action]);
        assert_eq!(output.status.code(), Some(2));
    }
}

fn machine(port: &str, arguments: &[&str]) -> Output {
    let router = example!("machine.toml");
    let arguments: Vec<&str> = arguments.iter().map(|&word| if word == "ROUTER" { router } else { word }).collect();
    hodograph(&[&["machine", "--port", port], arguments.as_slice()].concat())
}

/// A machine's file goes to the controller and comes back as a file that says the same.
#[test]
fn a_machine_goes_there_and_back() {
    let port = controller(3, false);
    let written = machine(&port, &["ROUTER", "--write"]);
    let text = String::from_utf8(written.stdout).unwrap();
    assert!(written.status.success(), "{}", String::from_utf8_lossy(&written.stderr));
    assert!(text.starts_with("three-axis router: 3 axes") && text.ends_with("the controller keeps it\n"), "{text}");
    let found = machine(&port, &["--read"]);
    assert!(found.status.success(), "{}", String::from_utf8_lossy(&found.stderr));
    let back = from_toml("back", &String::from_utf8(found.stdout).unwrap()).unwrap();
    let sent = example!("machine.toml");
    assert_eq!(back, read(sent).unwrap());
    let file = std::path::PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("router-read.toml");
    let found = machine(&port, &["--read", "-o", file.to_str().unwrap()]);
    assert!(found.status.success() && found.stdout.is_empty());
    assert_eq!(read(file.to_str().unwrap()).unwrap(), back);
}

/// A controller that keeps no machine, one that refuses it, and one that is not there: one sentence each. A file that will not do
/// never reaches it.
#[test]
fn a_machine_that_does_not_get_there_is_said_in_one_sentence() {
    let empty = controller_of(None, 1, false, FAR);
    let refusing = controller(1, false);
    // An axis that no path moves.
    let turned = std::path::PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("turned.toml");
    let text = std::fs::read_to_string(example!("machine.toml")).unwrap().replace("name = \"z\"", "name = \"a\"");
    std::fs::write(&turned, text).unwrap();
    for (port, arguments, status, said) in [
        (empty.as_str(), &["--read"][..], 1, "the controller keeps no machine"),
        (&refusing, &[turned.to_str().unwrap(), "--write"], 1, "the machine was refused: "),
        ("tcp:nowhere", &["ROUTER", "--write"], 2, "cannot be opened"),
        ("tcp:nowhere", &["no-such-file.toml", "--write"], 2, "no-such-file.toml: cannot be read"),
    ] {
        let output = machine(port, arguments);
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(status), "{port}: {errors}");
        assert!(errors.contains(said) && errors.trim_end().lines().count() == 1, "{port}: {errors}");
        assert!(output.stdout.is_empty());
    }
    // Both ways at a time, a port without a way, a way without a port: the options say so themselves.
    for arguments in [&["ROUTER", "--read"][..], &["--read", "--write"], &["ROUTER"], &["--write"]] {
        assert_eq!(machine("tcp:nowhere", arguments).status.code(), Some(2));
    }
    assert_eq!(hodograph(&["machine", "--read"]).status.code(), Some(2));
}

/// Before homing a job in machine coordinates is refused; the search for home is one action; after it the job is refused where the
/// machine does not stand at its start, and run where it does.
#[test]
fn homing_and_machine_coordinates() {
    let router = read(example!("machine.toml")).unwrap();
    let port = controller_of(Some(router), 6, false, [7.3, 3.1, 4.2]);
    let refused = |job: &str, said: &str| {
        let output = hodograph(&["stream", job, "--port", &port]);
        let errors = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{errors}");
        assert!(errors.contains(said) && errors.trim_end().lines().count() == 1, "{errors}");
    };
    let line = |x: f64| {
        let file = std::path::PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("line-{x}.toml"));
        let text = format!(
            "units = \"mm\"\nclosed = false\nrest = true\n[feed]\nrate = 1200.0\n\
             [[segment]]\nline = {{ start = [{x:.1}, 2.0], to = [22.0, 12.0] }}\n"
        );
        std::fs::write(&file, text).unwrap();
        file.to_str().unwrap().to_owned()
    };
    refused(&line(2.0), "the position of axis 0 is unknown; home it");
    let asked = hodograph(&["monitor", "--port", &port, "--act", "home"]);
    assert!(asked.status.success(), "{}", String::from_utf8_lossy(&asked.stderr));
    refused(&line(5.0), "axis 0 does not stand where the job begins");
    let ran = json(&hodograph(&["stream", &line(2.0), "--port", &port, "--json", "-"]));
    assert_eq!(ran["sent"], ran["acknowledged"]);
    refused(&line(2.0), "axis 0 does not stand where the job begins");
    let ran = json(&hodograph(&["stream", &line(5.0), "--port", &port, "--approach", "1200", "--json", "-"]));
    assert_eq!(ran["sent"], ran["acknowledged"]);
}

//! `hodograph stream`, `monitor` and `machine` against a controller on a TCP port of this process.
#![allow(clippy::unwrap_used, missing_docs, reason = "a failed test says where")]

use std::io::{ErrorKind, Read, Write};
use std::net::TcpListener;
use std::process::{Command, Output};
use std::thread;

use host_sim::controller::{Controller, Settings};
use shared::safety::Fault;

const FAULT: Option<Fault> = Some(Fault::FollowingError { axis: 1 });

/// A controller on a port of its own, which runs as fast as it can; it serves so many connections, one after another.
fn controller(connections: usize, fault: Option<Fault>) -> String {
    controller_with(Settings::default(), connections, fault)
}

fn controller_with(settings: Settings, connections: usize, fault: Option<Fault>) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = format!("tcp:{}", listener.local_addr().unwrap());
    thread::spawn(move || {
        let mut controller = Controller::new(settings);
        controller.set_fault(fault);
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
    let job = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/farouki2018.toml");
    let arguments = arguments.iter().map(|&argument| if argument == "JOB" { job } else { argument });
    Command::new(env!("CARGO_BIN_EXE_hodograph")).args(arguments).output().unwrap()
}

fn json(output: &Output) -> serde_json::Value {
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The controller does to the last bit what the simulator does.
#[test]
fn a_job_arrives_and_runs_as_simulated() {
    let port = controller(1, None);
    let streamed = json(&hodograph(&["stream", "JOB", "--port", &port, "--json", "-"]));
    let simulated = json(&hodograph(&["simulate", "JOB", "--json", "-"]));
    assert_eq!(streamed["setpoint_hash"], simulated["setpoint_hash"]);
    assert_eq!(streamed["ticks"], simulated["ticks"]);
    assert_eq!(streamed["sent"], streamed["acknowledged"]);
    assert_eq!(streamed["resent"], 0);
}

#[test]
fn a_monitor_sees_the_controller() {
    let port = controller(1, FAULT);
    let output = hodograph(&["monitor", "--port", &port, "--json", "--count", "2", "--every", "20"]);
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<serde_json::Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(lines.len(), 2);
    assert_eq!(
        (&lines[1]["state"], &lines[1]["fault"]),
        (&"fault".into(), &"axis 1 is too far from its setpoint".into())
    );
}

/// One sentence, and the status that says whose fault it is.
#[test]
fn what_cannot_be_is_said_in_one_sentence() {
    // A port that was free a moment ago: nobody listens there.
    let free = format!("tcp:{}", TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap());
    let faulty = controller(1, FAULT);
    for (port, status, said) in [
        (free.as_str(), 2, "cannot be opened"),
        ("tcp:nowhere", 2, "cannot be opened"),
        ("no-such-port", 2, "there is no such port"),
        (
            faulty.as_str(),
            1,
            "axis 1 is too far from its setpoint; mend its cause and acknowledge it (hodograph monitor",
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
    let port = controller(3, FAULT);
    let refused = hodograph(&["stream", "JOB", "--port", &port, "--from-here"]);
    assert_eq!(refused.status.code(), Some(1));
    let asked = hodograph(&["monitor", "--port", &port, "--act", "acknowledge", "--act", "override=150"]);
    assert!(asked.status.success(), "{}", String::from_utf8_lossy(&asked.stderr));
    assert_eq!(String::from_utf8(asked.stdout).unwrap(), "acknowledge: done\noverride=150: done\n");
    json(&hodograph(&["stream", "JOB", "--port", &port, "--json", "-"]));
}

/// The first refusal ends a row of actions, in one sentence with status 1; what is no action never reaches the controller.
#[test]
fn a_refused_action_ends_the_row() {
    let port = controller(1, None);
    let output =
        hodograph(&["monitor", "--port", &port, "--act", "override=90", "--act", "hold", "--act", "acknowledge"]);
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{errors}");
    assert_eq!(String::from_utf8(output.stdout).unwrap(), "override=90: done\n");
    assert!(errors.contains("hold was refused: nothing is in motion") && errors.trim_end().lines().count() == 1);
    for action in ["override=0", "jump"] {
        let output = hodograph(&["monitor", "--port", "tcp:nowhere", "--act", action]);
        assert_eq!(output.status.code(), Some(2));
    }
}

fn machine(port: &str, arguments: &[&str]) -> Output {
    let router = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/machine.toml");
    let arguments: Vec<&str> = arguments.iter().map(|&word| if word == "ROUTER" { router } else { word }).collect();
    hodograph(&[&["machine", "--port", port], arguments.as_slice()].concat())
}

/// A machine's file goes to the controller and comes back as a file that says the same.
#[test]
fn a_machine_goes_there_and_back() {
    let port = controller(3, None);
    let written = machine(&port, &["ROUTER", "--write"]);
    let text = String::from_utf8(written.stdout).unwrap();
    assert!(written.status.success(), "{}", String::from_utf8_lossy(&written.stderr));
    assert!(text.starts_with("three-axis router: 3 axes") && text.ends_with("the controller keeps it\n"), "{text}");
    let read = machine(&port, &["--read"]);
    assert!(read.status.success(), "{}", String::from_utf8_lossy(&read.stderr));
    let back = host_sim::machine::from_toml("back", &String::from_utf8(read.stdout).unwrap()).unwrap();
    let sent = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/machine.toml");
    assert_eq!(back, host_sim::machine::read(sent).unwrap());
    let file = std::path::PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("router-read.toml");
    let read = machine(&port, &["--read", "-o", file.to_str().unwrap()]);
    assert!(read.status.success() && read.stdout.is_empty());
    assert_eq!(host_sim::machine::read(file.to_str().unwrap()).unwrap(), back);
}

/// A controller that keeps no machine, one that refuses it, and one that is not there: one sentence each. A file that will not do
/// never reaches it.
#[test]
fn a_machine_that_does_not_get_there_is_said_in_one_sentence() {
    let empty = controller(1, None);
    let refusing = controller_with(Settings { keeps_image: false, ..Settings::default() }, 2, None);
    for (port, arguments, status, said) in [
        (empty.as_str(), &["--read"][..], 1, "the controller keeps no machine"),
        (&refusing, &["ROUTER", "--write"], 1, "the machine was refused: this controller cannot do that"),
        (&refusing, &["--read"], 1, "the machine was refused: this controller cannot do that"),
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

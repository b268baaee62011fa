//! `hodograph monitor`: what a controller is doing, and actions beside a job.

use std::cell::RefCell;
use std::time::Duration;

use clap::Args;
use host_sim::monitor::{Sight, Want, monitor};
use host_sim::session::Session;
use host_sim::transport::{self, Transport};
use serde::Serialize;
use shared::link::Telemetry;
use shared::safety::State;

use super::Failure;
use super::act::{Act, carry_out, refused};
use super::keys::{Keys, Press};

/// Show what a controller is doing, without disturbing it; or ask it for something
///
/// On a terminal: h or space holds, r or space resumes, + and - change the override by 10 %, b runs piece by piece or not, c cancels, g
/// homes, a acknowledges a fault, q ends the look
#[derive(Args)]
#[command(after_help = "Examples:
  hodograph monitor --port tcp:localhost:4750 --json
  hodograph monitor --port tcp:localhost:4750 --act acknowledge --act home")]
pub struct Monitor {
    /// The controller: a serial port, a file that is a line, or `tcp:HOST:PORT`
    #[arg(long)]
    port: String,
    /// Bits per second of a serial port
    #[arg(long, default_value_t = 921_600)]
    baud: u32,
    /// Print one line of JSON for each report
    #[arg(long)]
    json: bool,
    /// End after so many reports; never without it
    #[arg(long, value_name = "N")]
    count: Option<u64>,
    /// Ask so often, in ms
    #[arg(long, value_name = "MS", default_value_t = 100)]
    every: u64,
    /// Ask for this and end when it is done; again and again for one after another: hold, resume, cancel, override=PERCENT,
    /// single-block=on, single-block=off, home, acknowledge
    #[arg(long, value_name = "ACTION", conflicts_with_all = ["json", "count", "every"])]
    act: Vec<Act>,
}

/// A report as JSON; lengths in mm.
#[derive(Serialize)]
struct Line {
    state: &'static str,
    machine: &'static str,
    fault: Option<String>,
    unknown_axes: Vec<u8>,
    tick: u32,
    pieces: u32,
    queued: u16,
    position_mm: [f64; 3],
    actual_mm: [f64; 3],
    feed_mm_per_s: f32,
    percent: u8,
    cycles: u32,
    worst_cycles: u32,
    stack_bytes: u32,
    broken_frames: u32,
}

impl From<&Telemetry> for Line {
    fn from(telemetry: &Telemetry) -> Self {
        Self {
            state: telemetry.state.name(),
            machine: telemetry.machine.name(),
            fault: telemetry.fault.map(|fault| fault.to_string()),
            unknown_axes: telemetry.unknown_axes().collect(),
            tick: telemetry.tick,
            pieces: telemetry.pieces,
            queued: telemetry.queued,
            position_mm: telemetry.setpoint.map(|coordinate| coordinate.to_mm()),
            actual_mm: telemetry.actual.map(|coordinate| coordinate.to_mm()),
            feed_mm_per_s: telemetry.speed,
            percent: telemetry.percent,
            cycles: telemetry.cycles,
            worst_cycles: telemetry.worst_cycles,
            stack_bytes: telemetry.stack,
            broken_frames: telemetry.broken_frames,
        }
    }
}

/// A report in one line: where the machine is, what is wrong, and which positions are unknown.
pub fn status(telemetry: &Telemetry) -> String {
    let [x, y, z] = telemetry.setpoint.map(|coordinate| coordinate.to_mm());
    // The state of the motion says nothing of an emergency stop.
    let state = if telemetry.machine == State::EStop { State::EStop.name() } else { telemetry.state.name() };
    let mut line = format!(
        "{state}: {x:.3} {y:.3} {z:.3} mm, {:.1} mm/s, {} %, {} queued",
        telemetry.speed, telemetry.percent, telemetry.queued
    );
    if let Some(fault) = telemetry.fault {
        line.push_str(&format!("; {fault}"));
    }
    let unknown: Vec<String> = telemetry.unknown_axes().map(|axis| axis.to_string()).collect();
    match &unknown[..] {
        [] => {}
        [axis] => line.push_str(&format!("; the position of axis {axis} is unknown")),
        axes => line.push_str(&format!("; the positions of axes {} are unknown", axes.join(", "))),
    }
    line
}

impl Monitor {
    /// Looks on until there is nothing to see, or acts.
    pub fn run(self) -> Result<(), Failure> {
        let mut line = transport::open(&self.port, self.baud)?;
        let outcome = if self.act.is_empty() { self.look_on(&mut *line) } else { self.act(&mut *line) };
        outcome.map_err(|error| Failure::Run(format!("{}: {error}", self.port)))
    }

    fn act(&self, line: &mut dyn Transport) -> Result<(), String> {
        let mut session = Session::open(line).map_err(|error| error.to_string())?;
        carry_out(&mut session, &self.act, |name| println!("{name}: done"))
    }

    fn look_on(&self, line: &mut dyn Transport) -> Result<(), String> {
        let mut left = self.count;
        let bar = (!self.json).then(|| super::spinner("waiting for the controller"));
        // One closure shows what the controller says, the other reads keys, which go on from it.
        let keys = RefCell::new(if self.json { Keys::none() } else { Keys::new() });
        let tell = |text: &str| match &bar {
            Some(bar) => bar.suspend(|| eprintln!("{text}\r")),
            None => eprintln!("{text}"),
        };
        let look = |sight: Sight<'_>| {
            let telemetry = match sight {
                Sight::Telemetry(telemetry) => telemetry,
                Sight::Done(action, outcome) => {
                    if let Err(reason) = outcome {
                        tell(&refused(&action, &reason));
                    }
                    return true;
                }
                Sight::Refused(error) => {
                    tell(&error.to_string());
                    return true;
                }
            };
            keys.borrow_mut().percent_is(telemetry.percent);
            match &bar {
                Some(bar) => bar.set_message(status(telemetry)),
                None => match serde_json::to_string(&Line::from(telemetry)) {
                    Ok(line) => println!("{line}"),
                    Err(_) => return false,
                },
            }
            if let Some(left) = &mut left {
                *left = left.saturating_sub(1);
            }
            left != Some(0)
        };
        let want = || match keys.borrow_mut().press() {
            None => Want::Nothing,
            Some(Press::Act(action)) => Want::Act(action),
            Some(Press::Quit | Press::Interrupt) => Want::Leave,
        };
        monitor(line, Duration::from_millis(self.every), look, want).map_err(|error| error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use shared::safety::{Fault, ResetCause};

    use super::*;

    #[test]
    fn what_is_wrong_and_what_is_unknown_is_said() {
        let mut telemetry = Telemetry { axes: 0b111, known: 0b111, percent: 100, ..Telemetry::default() };
        assert_eq!(status(&telemetry), "idle: 0.000 0.000 0.000 mm, 0.0 mm/s, 100 %, 0 queued");
        telemetry.known = 0b101;
        assert!(status(&telemetry).ends_with("0 queued; the position of axis 1 is unknown"));
        let fault = Some(Fault::Reset { cause: ResetCause::Watchdog });
        telemetry = Telemetry { machine: State::EStop, fault, known: 0b100, ..telemetry };
        let said = status(&telemetry);
        assert!(said.starts_with("e-stop: "), "{said}");
        assert!(
            said.ends_with("; the watchdog restarted the controller; the positions of axes 0, 1 are unknown"),
            "{said}"
        );
    }
}

//! `hodograph monitor`: what a controller is doing.

use std::time::Duration;

use clap::Args;
use host_sim::stream::{StreamError, monitor};
use host_sim::transport;
use serde::Serialize;
use shared::link::Telemetry;

use super::Failure;

/// Show what a controller is doing, without disturbing it
#[derive(Args)]
#[command(after_help = "Example:\n  hodograph monitor --port tcp:localhost:4750 --json")]
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
}

/// A report as JSON; lengths in mm.
#[derive(Serialize)]
struct Line {
    state: &'static str,
    tick: u32,
    pieces: u32,
    queued: u16,
    position_mm: [f64; 3],
    feed_mm_per_s: f32,
    percent: u8,
    fault: u8,
    cycles: u32,
    worst_cycles: u32,
    stack_bytes: u32,
    broken_frames: u32,
}

impl From<&Telemetry> for Line {
    fn from(telemetry: &Telemetry) -> Self {
        Self {
            state: telemetry.state.name(),
            tick: telemetry.tick,
            pieces: telemetry.pieces,
            queued: telemetry.queued,
            position_mm: telemetry.setpoint.map(|coordinate| coordinate.to_mm()),
            feed_mm_per_s: telemetry.speed,
            percent: telemetry.percent,
            fault: telemetry.fault,
            cycles: telemetry.cycles,
            worst_cycles: telemetry.worst_cycles,
            stack_bytes: telemetry.stack,
            broken_frames: telemetry.broken_frames,
        }
    }
}

/// A report in one line.
pub fn status(telemetry: &Telemetry) -> String {
    let [x, y, z] = telemetry.setpoint.map(|coordinate| coordinate.to_mm());
    format!(
        "{}: {x:.3} {y:.3} {z:.3} mm, {:.1} mm/s, {} %, {} queued",
        telemetry.state.name(),
        telemetry.speed,
        telemetry.percent,
        telemetry.queued
    )
}

impl Monitor {
    /// Looks on until there is nothing to see.
    pub fn run(self) -> Result<(), Failure> {
        let mut line = transport::open(&self.port, self.baud)?;
        let mut left = self.count;
        let bar = (!self.json).then(|| super::spinner("waiting for the controller"));
        let look = |telemetry: &Telemetry| {
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
        let outcome = monitor(&mut *line, Duration::from_millis(self.every), look);
        outcome.map_err(|error: StreamError| Failure::Run(format!("{}: {error}", self.port)))
    }
}

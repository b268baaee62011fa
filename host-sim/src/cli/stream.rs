//! `hodograph stream`: sends a job to a controller.

use std::cell::RefCell;
use std::fs::File;
use std::io::Write;
use std::time::Instant;

use clap::Args;
use host_sim::approach;
use host_sim::input::InputError;
use host_sim::path::Path;
use host_sim::session::Session;
use host_sim::stream::{Happening, StreamError, Wish, stream};
use host_sim::transport::{self, Transport};
use indicatif::ProgressBar;
use shared::link::{Action, Refusal, SenderError};
use shared::motion::MotionCommand;
use shared::piece::Piece;
use shared::safety::{Coordinates, Refused, State};

use super::Failure;
use super::act::refused;
use super::keys::{Keys, Press};
use super::motion::Motion;
use super::output::{failed, json};

/// Send a job to a controller and run it, with progress
///
/// A job begins and ends at rest. It begins where the machine stands: its first point, or anywhere with --from-here.
///
/// On a terminal: h or space holds, r or space resumes, + and - change the override by 10 %, b runs piece by piece or not, c cancels, g
/// homes, a acknowledges a fault, q stops at once
#[derive(Args)]
#[command(after_help = "Example:\n  hodograph stream examples/farouki2018.toml --port tcp:localhost:4750 --json -")]
pub struct Stream {
    #[command(flatten)]
    motion: Motion,
    /// Run the job from where the machine stands; otherwise its coordinates are the machine's, every axis of which has to know where it is
    #[arg(long)]
    from_here: bool,
    /// Go to where the job begins first, in a straight line at this feed in the job's units a minute; z stays where it is
    #[arg(long, value_name = "FEED", conflicts_with = "from_here")]
    approach: Option<f64>,
    /// The controller: a serial port, a file that is a line, or `tcp:HOST:PORT`
    #[arg(long)]
    port: String,
    /// Bits per second of a serial port
    #[arg(long, default_value_t = 921_600)]
    baud: u32,
    /// Write what happened and when
    #[arg(long, value_name = "FILE")]
    log: Option<String>,
    /// Write the result as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<String>,
}

impl Stream {
    /// Sends, and shows how it goes.
    pub fn run(self) -> Result<(), Failure> {
        if self.motion.is_elsewhere() && !self.from_here {
            return Err(InputError::new(
                "--zero",
                "a job is sent in the machine's coordinates; move its zero with --from-here, which begins where the machine stands",
            )
            .into());
        }
        let (job, mut path) = self.motion.path(None)?;
        // A plan is at rest at its ends by itself.
        path.header.rest = !path.is_planned();
        let pieces: Vec<Piece<f32>> = path.wire().collect();
        let mut log = Log::create(self.log.as_deref())?;
        let mut line = transport::open(&self.port, self.baud)?;
        if let Some(feed) = self.approach {
            self.go_to_start(&mut *line, &path, feed * job.units.mm() / 60.0)?;
        }
        let bar = super::progress_of(pieces.len() as u64, "{pos} of {len} pieces, {msg}");
        let coordinates = if self.from_here { Coordinates::Relative } else { Coordinates::Machine };
        // One closure shows what the controller says, the other reads keys, which go on from it.
        let keys = RefCell::new(Keys::new());
        let look = |happening| {
            if let Happening::Progress(_, telemetry) = &happening {
                keys.borrow_mut().percent_is(telemetry.percent);
            }
            show(&bar, &happening);
            log.write(&happening);
        };
        let (transfer, outcome) =
            stream(&mut *line, &path.header, &pieces, coordinates, look, || wish(&mut keys.borrow_mut()));
        drop(keys);
        bar.finish_and_clear();
        log.end(&format!("{transfer:?} {outcome:?}")).map_err(|error| failed("--log", error))?;
        if let Some(name) = &self.json {
            json(name, &transfer)?;
        }
        outcome.map_err(|error| self.failure(&error))?;
        if self.json.as_deref() != Some("-") {
            println!("sent {}, acknowledged {}, resent {}", transfer.sent, transfer.acknowledged, transfer.resent);
            if let (Some(ticks), Some(time), Some(hash)) = (transfer.ticks, transfer.time_s, transfer.setpoint_hash) {
                println!("{time:.3} s ({ticks} ticks), setpoints {hash:016x}");
            }
        }
        Ok(())
    }
}

impl Stream {
    /// Has the machine go to the first point of `path` at so many mm/s.
    fn go_to_start(&self, line: &mut dyn Transport, path: &Path, feed: f64) -> Result<(), Failure> {
        if !(feed > 0.0 && feed.is_finite()) {
            return Err(InputError::new("--approach", "the feed must be a number above zero").into());
        }
        let position =
            Session::open(line).and_then(|mut session| session.look()).map_err(|error| self.failure(&error))?;
        let [x, y, _] = path.start();
        let Some((header, piece)) = approach::line(position.setpoint, [x, y], feed) else { return Ok(()) };
        let mut keys = Keys::new();
        let (_, outcome) = stream(line, &header, &[piece], Coordinates::Machine, |_| {}, || wish(&mut keys));
        outcome.map_err(|error| self.failure(&error))
    }

    fn failure(&self, error: &StreamError) -> Failure {
        if error.is_input() {
            return InputError::new(&self.port, error).into();
        }
        Failure::Run(format!("{}: {error}{}", self.port, remedy(error, &self.port)))
    }
}

/// What would help, where it is a command of this program.
fn remedy(error: &StreamError, port: &str) -> String {
    let StreamError::Sender(SenderError::Refused { reason, .. }) = error else { return String::new() };
    match reason {
        Refusal::Stopped
        | Refusal::Fault(_)
        | Refusal::Machine(Refused::State { state: State::Fault | State::EStop }) => {
            format!(" (hodograph monitor --port {port} --act acknowledge)")
        }
        Refusal::Machine(Refused::PositionUnknown { .. }) => {
            format!(" (hodograph monitor --port {port} --act home), or run it --from-here")
        }
        Refusal::Machine(Refused::Away { .. }) => String::from(" (--approach FEED, or --from-here)"),
        _ => String::new(),
    }
}

fn wish(keys: &mut Keys) -> Option<Wish> {
    Some(match keys.press()? {
        Press::Act(action) => Wish::Act(action),
        // Who presses ctrl-C wants rest, not a jolt.
        Press::Interrupt => Wish::Act(Action::Motion(MotionCommand::Cancel)),
        Press::Quit => Wish::Abort,
    })
}

fn show(bar: &ProgressBar, happening: &Happening) {
    match happening {
        Happening::Hello(identity) => {
            let [major, minor, patch] = identity.firmware;
            bar.set_message(format!("firmware {major}.{minor}.{patch}, {} axes", identity.axes));
        }
        Happening::Progress(_, telemetry) => {
            bar.set_position(u64::from(telemetry.pieces));
            bar.set_message(super::monitor::status(telemetry));
        }
        Happening::Done(action, Err(reason)) => bar.suspend(|| eprintln!("{}\r", refused(action, reason))),
        Happening::Done(_, Ok(_)) => {}
    }
}

/// The log file, if one was asked for.
struct Log {
    file: Option<File>,
    start: Instant,
}

impl Log {
    fn create(name: Option<&str>) -> Result<Self, InputError> {
        let create = |name: &str| {
            File::create(name).map_err(|error| InputError::new(name, format_args!("cannot be written: {error}")))
        };
        Ok(Self { file: name.map(create).transpose()?, start: Instant::now() })
    }

    fn write(&mut self, happening: &Happening) {
        let line = match happening {
            Happening::Progress(taken, telemetry) => format!("taken {taken}, {}", super::monitor::status(telemetry)),
            other => format!("{other:?}"),
        };
        // A log that cannot be written is told at the end; the motion goes on.
        let _ = self.end(&line);
    }

    fn end(&mut self, line: &str) -> std::io::Result<()> {
        let time = self.start.elapsed().as_secs_f64();
        self.file.as_mut().map_or(Ok(()), |file| writeln!(file, "{time:10.3} {line}"))
    }
}

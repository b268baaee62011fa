//! `hodograph stream`: sends a job to a controller.

use std::fs::File;
use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

use clap::Args;
use crossterm::event::{self, Event, KeyCode, KeyEventKind, KeyModifiers};
use crossterm::terminal::{disable_raw_mode, enable_raw_mode};
use host_sim::input::InputError;
use host_sim::stream::{Happening, Wish, stream};
use host_sim::transport;
use indicatif::ProgressBar;
use shared::link::Action;
use shared::motion::MotionCommand;
use shared::piece::Piece;

use super::Failure;
use super::motion::Motion;
use super::output::{failed, json};

/// Send a job to a controller and run it, with progress
///
/// On a terminal: h or space holds, r or space resumes, + and - change the override by 10 %, c cancels, q stops at once
#[derive(Args)]
#[command(after_help = "Example:\n  hodograph stream examples/farouki2018.toml --port tcp:localhost:4750 --json -")]
pub struct Stream {
    #[command(flatten)]
    motion: Motion,
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
        let (_, path) = self.motion.path()?;
        let pieces: Vec<Piece<f32>> = path.wire().collect();
        let mut log = Log::create(self.log.as_deref())?;
        let mut line = transport::open(&self.port, self.baud)?;
        let bar = super::progress_of(pieces.len() as u64, "{pos} of {len} pieces, {msg}");
        let mut keys = Keys::new();
        let look = |happening| {
            show(&bar, &happening);
            log.write(&happening);
        };
        let (transfer, outcome) = stream(&mut *line, &path.header, &pieces, look, || keys.wish());
        drop(keys);
        bar.finish_and_clear();
        log.end(&format!("{transfer:?} {outcome:?}")).map_err(|error| failed("--log", error))?;
        if let Some(name) = &self.json {
            json(name, &transfer)?;
        }
        if let Err(error) = outcome {
            return Err(if error.is_input() {
                InputError::new(&self.port, error).into()
            } else {
                Failure::Run(format!("{}: {error}", self.port))
            });
        }
        if self.json.as_deref() != Some("-") {
            println!("sent {}, acknowledged {}, resent {}", transfer.sent, transfer.acknowledged, transfer.resent);
            if let (Some(ticks), Some(time), Some(hash)) = (transfer.ticks, transfer.time_s, transfer.setpoint_hash) {
                println!("{time:.3} s ({ticks} ticks), setpoints {hash:016x}");
            }
        }
        Ok(())
    }
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
        Happening::Done(_, Err(reason)) => bar.suspend(|| eprintln!("refused: {reason}")),
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

/// The keyboard, where there is one; raw as long as this lives.
struct Keys {
    raw: bool,
    held: bool,
    percent: u8,
}

impl Keys {
    fn new() -> Self {
        let raw = std::io::stdin().is_terminal() && std::io::stderr().is_terminal() && enable_raw_mode().is_ok();
        Self { raw, held: false, percent: 100 }
    }

    fn wish(&mut self) -> Option<Wish> {
        if !self.raw || !event::poll(Duration::ZERO).unwrap_or(false) {
            return None;
        }
        let Ok(Event::Key(key)) = event::read() else { return None };
        if key.kind == KeyEventKind::Release {
            return None;
        }
        let interrupted = key.code == KeyCode::Char('c') && key.modifiers.contains(KeyModifiers::CONTROL);
        self.meaning(key.code, interrupted)
    }

    fn meaning(&mut self, key: KeyCode, interrupted: bool) -> Option<Wish> {
        let command = match key {
            // Who presses ctrl-C wants rest, not a jolt.
            KeyCode::Char('c') | KeyCode::Char('C') => MotionCommand::Cancel,
            _ if interrupted => MotionCommand::Cancel,
            KeyCode::Char('q') => return Some(Wish::Abort),
            KeyCode::Char('h') => self.hold(true),
            KeyCode::Char('r') => self.hold(false),
            KeyCode::Char(' ') => self.hold(!self.held),
            KeyCode::Char('+') => self.change(self.percent.saturating_add(10)),
            KeyCode::Char('-') => self.change(self.percent.saturating_sub(10)),
            _ => return None,
        };
        Some(Wish::Act(Action::Motion(command)))
    }

    fn hold(&mut self, held: bool) -> MotionCommand {
        self.held = held;
        if held { MotionCommand::Hold } else { MotionCommand::Resume }
    }

    fn change(&mut self, percent: u8) -> MotionCommand {
        self.percent = percent.clamp(10, 200);
        MotionCommand::Override { percent: self.percent }
    }
}

impl Drop for Keys {
    fn drop(&mut self) {
        if self.raw {
            // Nothing better can be done with a terminal that is gone.
            let _ = disable_raw_mode();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_mean_what_the_help_says() {
        let mut keys = Keys { raw: false, held: false, percent: 100 };
        let mut press = |key| keys.meaning(KeyCode::Char(key), false);
        let act = |command| Some(Wish::Act(Action::Motion(command)));
        assert_eq!(press(' '), act(MotionCommand::Hold));
        assert_eq!(press(' '), act(MotionCommand::Resume));
        assert_eq!(press('+'), act(MotionCommand::Override { percent: 110 }));
        assert_eq!(press('c'), act(MotionCommand::Cancel));
        assert_eq!(press('q'), Some(Wish::Abort));
        assert_eq!(press('x'), None);
        for _ in 0..30 {
            press('-');
        }
        assert_eq!(press('-'), act(MotionCommand::Override { percent: 10 }));
    }
}

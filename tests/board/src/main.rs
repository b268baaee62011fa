//! The virtual board as a command: runs a prepared job on an image, measures an image, or serves hosts. `cargo xtask` is what a person uses.
#![forbid(unsafe_code)]

use std::fs::File;
use std::io::{BufWriter, Write};
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use board::Error;
use board::budget::{measure, measure_steps, median};
use board::image::Image;
use board::machine::Mounting;
use board::probe::{EXCEPTION_FRAME, Tick};
use board::run::run_job;
use board::serve::{Pace, Served, serve};
use clap::{Args, Parser, Subcommand};
use serde::Serialize;
use shared::piece::{Header, Piece};

/// The flashed image on an emulated STM32H743
#[derive(Parser)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    Run(Run),
    Budget(Budget),
    Serve(Serve),
}

/// Send a job to the image over its serial link and run it to its end
#[derive(Args)]
struct Run {
    /// The image
    #[arg(long, value_name = "ELF")]
    elf: PathBuf,
    /// The machine that the board is told
    #[arg(long, value_name = "MACHINE.toml")]
    machine: String,
    /// What `hodograph prepare` wrote
    job: PathBuf,
    /// Write the result as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the integers that every tick put out
    #[arg(long, value_name = "FILE.csv")]
    setpoints: Option<PathBuf>,
}

/// Measure instructions, stack and memory of the image
#[derive(Args)]
struct Budget {
    /// The image
    #[arg(long, value_name = "ELF")]
    elf: PathBuf,
    /// A machine of servo axes
    #[arg(long, value_name = "MACHINE.toml")]
    servos: String,
    /// A machine of three step axes
    #[arg(long, value_name = "MACHINE.toml")]
    steps: String,
}

/// Let hosts speak to the image over TCP
#[derive(Args)]
struct Serve {
    /// The image
    #[arg(long, value_name = "ELF")]
    elf: PathBuf,
    /// The machine that the board is told
    #[arg(long, value_name = "MACHINE.toml")]
    machine: String,
    /// Where to listen
    #[arg(long, value_name = "HOST:PORT")]
    listen: String,
    /// Go as fast as it goes, not as the clock on the wall
    #[arg(long)]
    fast: bool,
    /// End after so many seconds
    #[arg(long, value_name = "N", value_parser = seconds_from)]
    seconds: Option<Duration>,
}

/// The result of `run`.
#[derive(Serialize)]
struct RunResult {
    ticks: u32,
    time_s: f64,
    setpoint_hash: String,
    instructions: Instructions,
    stack_bytes: u32,
    program_stack_bytes: u32,
    flash_bytes: u32,
    ram_bytes: u32,
    resent: u32,
}

#[derive(Serialize)]
struct Instructions {
    tick_max: u32,
    tick_median: u32,
}

fn main() -> ExitCode {
    let outcome = match Cli::parse().verb {
        Verb::Run(run) => run.run(),
        Verb::Budget(budget) => budget.run(),
        Verb::Serve(serve) => serve.run(),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(1)
        }
    }
}

impl Run {
    fn run(self) -> Result<(), Error> {
        let image = Image::read(&self.elf)?;
        let bytes = std::fs::read(&self.job).map_err(|error| failed(&self.job, &error))?;
        let (header, pieces): (Header<f32>, Vec<Piece<f32>>) =
            postcard::from_bytes(&bytes).map_err(|error| failed(&self.job, &error))?;
        let seconds = board::jobs::expected_seconds(&header, &pieces);
        let run = run_job(&image, &mounting(&self.machine)?, header, pieces, seconds, |_| {})?;
        if let Some(path) = &self.setpoints {
            write_setpoints(path, &run.seen.ticks).map_err(|error| failed(path, &error))?;
        }
        let (ticks, residual, hash) = run.finished;
        let sizes = image.sizes();
        let result = RunResult {
            ticks,
            time_s: f64::from(ticks) * f64::from(shared::TICK) - f64::from(residual),
            setpoint_hash: format!("{hash:016x}"),
            instructions: Instructions {
                tick_max: run.seen.ticks.iter().map(|tick| tick.instructions).max().unwrap_or(0),
                tick_median: median(run.seen.ticks.iter().map(|tick| tick.instructions)),
            },
            stack_bytes: run.seen.handler_stack + EXCEPTION_FRAME,
            program_stack_bytes: run.stack,
            flash_bytes: sizes.flash,
            ram_bytes: sizes.ram,
            resent: run.resent,
        };
        match &self.json {
            Some(path) if path.as_os_str() == "-" => print_json(&result),
            Some(path) => {
                write_json(path, &result).map_err(|error| failed(path, &error))?;
                print(&result);
                Ok(())
            }
            None => {
                print(&result);
                Ok(())
            }
        }
    }
}

impl Budget {
    fn run(self) -> Result<(), Error> {
        let image = Image::read(&self.elf)?;
        let progress = |name: &str| eprintln!("  measuring {name}");
        let mut budget = measure(&image, &mounting(&self.servos)?, progress)?;
        budget.instructions.extend(measure_steps(&image, &mounting(&self.steps)?, progress)?);
        print_json(&budget)
    }
}

impl Serve {
    fn run(self) -> Result<(), Error> {
        let image = Image::read(&self.elf)?;
        let refused = |error: std::io::Error| Error::new(format!("{}: {error}", self.listen));
        let listener = TcpListener::bind(&self.listen).map_err(refused)?;
        let ended = Arc::new(AtomicBool::new(false));
        signal_hook::flag::register(signal_hook::consts::SIGINT, ended.clone()).map_err(refused)?;
        println!("listening at {}", listener.local_addr().map_err(refused)?);
        // Whoever waits for this line waits for all of it.
        std::io::stdout().flush().map_err(refused)?;
        let pace = if self.fast { Pace::Fast } else { Pace::Real };
        let Served { traffic, virtual_s, real_s } =
            serve(&image, &mounting(&self.machine)?, listener, pace, self.seconds, ended)?;
        println!(
            "{} hosts, {} bytes from them and {} to them; {virtual_s:.3} s of the board in {real_s:.3} s",
            traffic.hosts, traffic.from_hosts, traffic.to_hosts
        );
        Ok(())
    }
}

/// A duration in s, above 0.
fn seconds_from(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    seconds.filter(|seconds| !seconds.is_zero()).ok_or_else(|| format!("`{text}` is no time; give seconds above 0"))
}

fn print(result: &RunResult) {
    println!("ticks               {}", result.ticks);
    println!("time                {:.6} s", result.time_s);
    println!("setpoint hash       {}", result.setpoint_hash);
    println!(
        "instructions        {} at most, {} in the middle",
        result.instructions.tick_max, result.instructions.tick_median
    );
    println!("interrupt's stack   {} bytes", result.stack_bytes);
    println!("flash, RAM          {} and {} bytes", result.flash_bytes, result.ram_bytes);
}

fn print_json(result: &impl Serialize) -> Result<(), Error> {
    let text = serde_json::to_string_pretty(result).map_err(|error| Error::new(error.to_string()))?;
    println!("{text}");
    Ok(())
}

fn write_json(path: &Path, result: &impl Serialize) -> std::io::Result<()> {
    let mut out = BufWriter::new(File::create(path)?);
    serde_json::to_writer_pretty(&mut out, result)?;
    writeln!(out)?;
    out.flush()
}

fn write_setpoints(path: &Path, ticks: &[Tick]) -> std::io::Result<()> {
    let mut out = BufWriter::new(File::create(path)?);
    out.write_all(board::run::setpoints_csv(ticks).as_bytes())?;
    out.flush()
}

/// The machine of a file.
fn mounting(name: &str) -> Result<Mounting, Error> {
    Mounting::new(&host_sim::machine::read(name).map_err(|error| Error::new(error.to_string()))?)
}

fn failed(path: &Path, error: &dyn std::fmt::Display) -> Error {
    Error::new(format!("{}: {error}", path.display()))
}

//! The virtual board as a command: runs a prepared job on an image, or measures an image. `cargo xtask` is what a person uses.
#![forbid(unsafe_code)]

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use board::Error;
use board::budget::{measure, measure_steps, median};
use board::image::Image;
use board::mounting::Mounting;
use board::probe::{EXCEPTION_FRAME, Tick};
use board::run::run_job;
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
    Sizes(Sizes),
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

/// Measure the memory that an image takes, of any board
#[derive(Args)]
struct Sizes {
    /// The image
    #[arg(long, value_name = "ELF")]
    elf: PathBuf,
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
        Verb::Sizes(sizes) => sizes.run(),
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

impl Sizes {
    fn run(self) -> Result<(), Error> {
        print_json(&Image::read(&self.elf)?.sizes())
    }
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

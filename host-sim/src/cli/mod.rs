//! The command line: one module a verb, each a thin reader of a result that the library computes.

mod act;
mod fit;
mod keys;
mod machine;
mod monitor;
mod motion;
mod offset;
mod output;
mod pacing;
mod plan;
mod planning;
mod prepare;
mod reproduce;
mod simulate;
mod stream;
mod tooling;

use std::fmt;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use host_sim::input::{InputError, Source};
use host_sim::plant::Plant;
use indicatif::{ProgressBar, ProgressFinish, ProgressStyle};

/// The whole command line.
#[derive(Parser)]
#[command(
    name = "hodograph",
    version,
    about = "A motion controller that follows the curve you drew: prepares and simulates its jobs"
)]
pub struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    Simulate(simulate::Simulate),
    Offset(offset::OffsetVerb),
    Fit(fit::FitVerb),
    Plan(plan::PlanVerb),
    Reproduce(reproduce::Reproduce),
    Prepare(prepare::Prepare),
    Stream(stream::Stream),
    Monitor(monitor::Monitor),
    Machine(machine::MachineVerb),
}

impl Cli {
    /// Runs the verb.
    pub fn run(self) -> Result<(), Failure> {
        match self.verb {
            Verb::Simulate(verb) => verb.run(),
            Verb::Offset(verb) => verb.run(),
            Verb::Fit(verb) => verb.run(),
            Verb::Plan(verb) => verb.run(),
            Verb::Reproduce(verb) => verb.run(),
            Verb::Prepare(verb) => verb.run(),
            Verb::Stream(verb) => verb.run(),
            Verb::Monitor(verb) => verb.run(),
            Verb::Machine(verb) => verb.run(),
        }
    }
}

/// Why a command ends without its result.
#[derive(Debug)]
pub enum Failure {
    /// Something in a file or an option cannot be used: status 2.
    Input(InputError),
    /// The run itself failed: status 1.
    Run(String),
}

impl Failure {
    /// The exit status that says so.
    pub fn code(&self) -> ExitCode {
        match self {
            Self::Input(_) => ExitCode::from(2),
            Self::Run(_) => ExitCode::FAILURE,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(error) => write!(f, "{error}"),
            Self::Run(message) => write!(f, "{message}"),
        }
    }
}

impl From<InputError> for Failure {
    fn from(error: InputError) -> Self {
        Self::Input(error)
    }
}

/// Reads a plant from TOML, or takes the one that is built in. Errors name file, line and column.
fn read_plant(name: &str) -> Result<Plant, InputError> {
    if name == "farouki2018-mill" {
        return Plant::default_mill(f64::from(shared::TICK)).map_err(|error| InputError::new(name, error));
    }
    let source = Source::read(name)?;
    Plant::from_toml(&source.text, f64::from(shared::TICK)).map_err(|error| InputError {
        position: Some((error.place().line, error.place().column)),
        ..InputError::new(name, error.message())
    })
}

/// A bar on standard error over `seconds` of simulated time; hidden where nobody looks.
fn progress(seconds: f64) -> ProgressBar {
    progress_of(seconds as u64, "{pos} of {len} s simulated")
}

/// A bar over `length` steps with this text.
fn progress_of(length: u64, text: &str) -> ProgressBar {
    let bar = ProgressBar::new(length);
    // The template is a constant of the source; a bar without it would do as well.
    if let Ok(style) = ProgressStyle::with_template(&format!("{{bar:40}} {text}")) {
        bar.set_style(style);
    }
    bar
}

/// Shows that work of unknown length goes on, and what it is; hidden where nobody looks.
fn spinner(text: &str) -> ProgressBar {
    let bar = ProgressBar::new_spinner().with_message(text.to_string()).with_finish(ProgressFinish::AndClear);
    bar.enable_steady_tick(std::time::Duration::from_millis(100));
    bar
}

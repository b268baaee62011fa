//! `hodograph prepare`: the pieces of a job as the controller gets them, for whoever sends them.

use clap::Args;
use host_sim::prepare::prepare;

use super::Failure;
use super::motion::Motion;
use super::output::{failed, write};

/// Write a job's pieces in the form in which they go over the link
#[derive(Args)]
#[command(after_help = "Example:\n  hodograph prepare examples/farouki2018.toml -o farouki2018.job")]
pub struct Prepare {
    #[command(flatten)]
    motion: Motion,
    /// The file to write
    #[arg(short, long, value_name = "FILE")]
    output: String,
}

impl Prepare {
    /// Reads, checks and writes.
    pub fn run(self) -> Result<(), Failure> {
        let (_, path) = self.motion.path(None)?;
        let bytes = prepare(&path).map_err(|error| failed(&self.output, error))?;
        write(&self.output, &bytes)
    }
}

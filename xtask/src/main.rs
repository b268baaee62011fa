//! `cargo xtask`: everything that is done with the whole tree, one module a verb.
#![forbid(unsafe_code)]

mod board;
mod budget;
mod build;
mod ci;
mod emulate;
mod flash;
mod test;
mod tools;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Builds, flashes, emulates, budgets and tests Hodograph
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    Build(build::Build),
    Flash(flash::Flash),
    Emulate(Box<emulate::Emulate>),
    Board(board::Board),
    Budget(budget::Budget),
    Test(test::Test),
    Ci(ci::Ci),
}

fn main() -> ExitCode {
    let outcome = match Cli::parse().verb {
        Verb::Build(verb) => verb.run(),
        Verb::Flash(verb) => verb.run(),
        Verb::Emulate(verb) => verb.run(),
        Verb::Board(verb) => verb.run(),
        Verb::Budget(verb) => verb.run(),
        Verb::Test(verb) => verb.run(),
        Verb::Ci(verb) => verb.run(),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            if !failure.text.is_empty() {
                eprintln!("error: {}", failure.text);
            }
            ExitCode::from(failure.status)
        }
    }
}

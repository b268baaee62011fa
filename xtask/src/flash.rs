//! `cargo xtask flash`: the image onto a board, through probe-rs.

use std::process::Command;

use clap::{Args, ValueEnum};

use crate::build::{Axes, firmware};
use crate::tools::{Failure, Outcome, run};

/// Build the firmware and flash it onto a board
#[derive(Args)]
#[command(after_help = "Example:\n  cargo xtask flash --board nucleo-h743zi2")]
pub struct Flash {
    /// The board at the debug probe
    #[arg(long, value_enum)]
    board: Board,
    /// What it moves
    #[arg(long, value_enum, default_value_t)]
    axes: Axes,
}

/// A board that the firmware knows.
#[derive(Clone, Copy, ValueEnum)]
enum Board {
    /// ST's NUCLEO-H743ZI2, by its own ST-Link
    #[value(name = "nucleo-h743zi2")]
    NucleoH743Zi2,
}

impl Board {
    /// The name of its part in probe-rs.
    fn chip(self) -> &'static str {
        match self {
            Self::NucleoH743Zi2 => "STM32H743ZITx",
        }
    }
}

impl Flash {
    /// Builds, flashes and starts.
    pub fn run(self) -> Outcome {
        if Command::new("probe-rs").arg("--version").output().is_err() {
            return Err(Failure::new(
                "probe-rs, which speaks to the debug probe, is not installed; run `cargo install probe-rs-tools --locked`",
            ));
        }
        let image = firmware(self.axes)?;
        let chip = self.board.chip();
        run(Command::new("probe-rs").args(["download", "--chip", chip]).arg(&image))?;
        run(Command::new("probe-rs").args(["reset", "--chip", chip]))
    }
}

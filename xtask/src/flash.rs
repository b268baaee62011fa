//! `cargo xtask flash`: the image onto a board, through probe-rs.

use std::process::Command;

use clap::Args;

use crate::build::{Board, firmware};
use crate::tools::{Failure, Outcome, run};

/// Build the firmware and flash it onto a board
#[derive(Args)]
#[command(after_help = "Example:\n  cargo xtask flash --board nucleo-h743zi2")]
pub struct Flash {
    /// The board at the debug probe
    #[arg(long, value_enum)]
    board: Board,
}

/// The name of a board's part in probe-rs.
fn chip(board: Board) -> &'static str {
    match board {
        Board::NucleoH743zi2 => "STM32H743ZITx",
        Board::NucleoF446re => "STM32F446RETx",
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
        let image = firmware(self.board)?;
        let chip = chip(self.board);
        run(Command::new("probe-rs").args(["download", "--chip", chip]).arg(&image))?;
        run(Command::new("probe-rs").args(["reset", "--chip", chip]))
    }
}

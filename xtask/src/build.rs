//! `cargo xtask build`: the image that is flashed.

use std::path::PathBuf;
use std::process::Command;

use clap::{Args, ValueEnum};

use crate::tools::{Outcome, TARGET, cargo, require_target, run, target_dir};

/// Build the firmware
#[derive(Args)]
#[command(after_help = "Example:\n  cargo xtask build --board nucleo-h743zi2")]
pub struct Build {
    /// For which board
    #[arg(long, value_enum, default_value_t)]
    board: Board,
}

impl Build {
    /// Builds, and says where the image is.
    pub fn run(self) -> Outcome {
        println!("{}", firmware(self.board)?.display());
        Ok(())
    }
}

/// The boards.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Board {
    /// ST's NUCLEO-H743ZI2; the virtual board has its part.
    #[default]
    NucleoH743zi2,
    /// ST's NUCLEO-F446RE; it waits for hardware.
    NucleoF446re,
}

impl Board {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::NucleoH743zi2, Self::NucleoF446re];

    /// The feature of the firmware.
    pub fn feature(self) -> &'static str {
        match self {
            Self::NucleoH743zi2 => "nucleo-h743zi2",
            Self::NucleoF446re => "nucleo-f446re",
        }
    }

    /// The profile that it is built with, and the folder of its image.
    fn profile(self) -> &'static str {
        match self {
            Self::NucleoH743zi2 => "firmware",
            Self::NucleoF446re => "nucleo-f446re",
        }
    }

    /// A cargo command about the firmware for this board: `arguments`, and which package, target and features.
    pub fn cargo(self, arguments: &[&str]) -> Command {
        let mut command = cargo(arguments);
        command.args(["--quiet", "--package", "firmware", "--target", TARGET]);
        command.args(["--no-default-features", "--features", self.feature()]);
        command
    }
}

/// Builds the firmware and returns where its image is.
pub fn firmware(board: Board) -> Outcome<PathBuf> {
    require_target(true)?;
    run(board.cargo(&["build"]).args(["--profile", board.profile()]))?;
    Ok(target_dir().join(TARGET).join(board.profile()).join("firmware"))
}

//! `cargo xtask build`: the image that is flashed.

use std::path::PathBuf;

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
}

impl Board {
    /// All of them.
    pub const ALL: [Self; 1] = [Self::NucleoH743zi2];

    /// The feature of the firmware.
    fn feature(self) -> &'static str {
        match self {
            Self::NucleoH743zi2 => "nucleo-h743zi2",
        }
    }
}

/// Builds the firmware and returns where its image is.
pub fn firmware(board: Board) -> Outcome<PathBuf> {
    require_target(true)?;
    let mut build = cargo(&["build", "--quiet"]);
    build.args(["--package", "firmware", "--profile", "firmware", "--target", TARGET]);
    run(build.args(["--no-default-features", "--features", board.feature()]))?;
    Ok(target_dir().join(TARGET).join("firmware").join("firmware"))
}

//! `cargo xtask build`: the image that is flashed.

use std::path::PathBuf;

use clap::Args;

use crate::tools::{Outcome, TARGET, cargo, require_target, run, target_dir};

/// Build the firmware
#[derive(Args)]
#[command(after_help = "Example:\n  cargo xtask build")]
pub struct Build {}

impl Build {
    /// Builds, and says where the image is.
    pub fn run(self) -> Outcome {
        println!("{}", firmware()?.display());
        Ok(())
    }
}

/// Builds the firmware and returns where its image is.
pub fn firmware() -> Outcome<PathBuf> {
    require_target(true)?;
    run(cargo(&["build", "--quiet"]).args(["--package", "firmware", "--profile", "firmware", "--target", TARGET]))?;
    Ok(target_dir().join(TARGET).join("firmware/firmware"))
}

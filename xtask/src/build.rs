//! `cargo xtask build`: the image that is flashed.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::tools::{Failure, Outcome, TARGET, cargo, require_target, run, target_dir};

/// Build the firmware
#[derive(Args)]
#[command(after_help = "Example:\n  cargo xtask build --axes steps")]
pub struct Build {
    /// What it moves
    #[arg(long, value_enum, default_value_t)]
    axes: Axes,
}

impl Build {
    /// Builds, and says where the image is.
    pub fn run(self) -> Outcome {
        println!("{}", firmware(self.axes)?.display());
        Ok(())
    }
}

/// What the firmware moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Axes {
    /// Two servo axes.
    #[default]
    Servos,
    /// Three step axes.
    Steps,
    /// Three step axes, the third of which is a second motor on x.
    Tandem,
}

impl Axes {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Servos, Self::Steps, Self::Tandem];

    /// The feature of the firmware, and the name of the image.
    fn feature(self) -> Option<&'static str> {
        match self {
            Self::Servos => None,
            Self::Steps => Some("steps"),
            Self::Tandem => Some("tandem"),
        }
    }
}

/// Builds the firmware and returns where its image is. Each kind of axes has an image of its own beside the others.
pub fn firmware(axes: Axes) -> Outcome<PathBuf> {
    require_target(true)?;
    let mut build = cargo(&["build", "--quiet"]);
    build.args(["--package", "firmware", "--profile", "firmware", "--target", TARGET]);
    let folder = target_dir().join(TARGET).join("firmware");
    let image = match axes.feature() {
        None => folder.join("firmware-servos"),
        Some(feature) => {
            build.args(["--features", feature]);
            folder.join(format!("firmware-{feature}"))
        }
    };
    run(&mut build)?;
    // Cargo has one place for all of them.
    std::fs::copy(folder.join("firmware"), &image)
        .map_err(|error| Failure::new(format!("{}: {error}", image.display())))?;
    Ok(image)
}

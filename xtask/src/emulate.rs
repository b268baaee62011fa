//! `cargo xtask emulate`: a job on the image that is flashed, on the virtual board.

use std::path::PathBuf;

use clap::Args;

use crate::build::{Board, firmware};
use crate::tools::{Failure, Outcome, board_cargo, cargo, check_board_compiler, run, target_dir};

/// Run a job on the firmware's own image, on the virtual board
///
/// The options that change the motion mean what they mean for `hodograph simulate`, and are read by the same code.
#[derive(Args)]
#[command(after_help = "Example:\n  cargo xtask emulate examples/farouki2018.toml --weight 0.5 --setpoints target.csv")]
pub struct Emulate {
    /// The job
    job: String,
    /// The machine that the board is told; with step axes every word of every slot is played, which takes some twenty times the job's own
    /// time
    #[arg(long, value_name = "MACHINE.toml", default_value = "examples/mill-servos.toml")]
    machine: String,
    /// w: 0 keeps the feed of the contact point, 1 that of the tool's centre
    #[arg(long, value_name = "W", allow_hyphen_values = true)]
    weight: Option<String>,
    /// f: what is left of the feed at a corner, or `auto`: by the angle of each corner
    #[arg(long, value_name = "F|auto", allow_hyphen_values = true)]
    reduction: Option<String>,
    /// lambda: the part of a piece on which the feed changes at a corner
    #[arg(long, value_name = "LAMBDA", allow_hyphen_values = true)]
    ramp: Option<String>,
    /// Which loop of the trimmed offset to run
    #[arg(long = "loop", value_name = "N")]
    chosen: Option<String>,
    /// V in the job's units a minute
    #[arg(long, value_name = "V", allow_hyphen_values = true)]
    feed: Option<String>,
    /// How a tick integrates the feed law: 1, 2, 3 or exact
    #[arg(long, value_name = "ORDER")]
    order: Option<String>,
    /// Plan the feed within the limits of --machine
    #[arg(long)]
    plan: bool,
    /// Where on the machine the zero of a planned job stands, in the job's units, as 100,50
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, requires = "plan")]
    zero: Option<String>,
    /// Where a planned job rests: continuous, exact-path or exact-stop
    #[arg(long, value_name = "MODE", requires = "plan")]
    mode: Option<String>,
    /// The largest contour error of a planned job on the built-in mill, in the job's units
    #[arg(long, value_name = "ERROR", allow_hyphen_values = true, requires = "plan")]
    contour_error: Option<String>,
    /// Write the result as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the integers that every tick put out
    #[arg(long, value_name = "FILE.csv")]
    setpoints: Option<PathBuf>,
}

impl Emulate {
    /// Prepares the job, builds the image, and runs it.
    pub fn run(self) -> Outcome {
        let image = firmware(Board::default())?;
        let job = self.prepare()?;
        check_board_compiler()?;
        let mut board = board_cargo(&["run", "--release", "--quiet"])?;
        board.arg("--").arg("run").arg("--elf").arg(image).arg("--machine").arg(&self.machine).arg(&job);
        if let Some(json) = &self.json {
            board.arg("--json").arg(json);
        }
        if let Some(setpoints) = &self.setpoints {
            board.arg("--setpoints").arg(setpoints);
        }
        let outcome = run(&mut board);
        // What is left behind in the target folder does no harm.
        let _ = std::fs::remove_file(&job);
        outcome
    }

    /// Has the job read, checked and cut into pieces by `hodograph`, and returns where they are.
    fn prepare(&self) -> Outcome<PathBuf> {
        let folder = target_dir().join("emulate");
        std::fs::create_dir_all(&folder).map_err(|error| Failure::new(format!("{}: {error}", folder.display())))?;
        // One file a process: two emulations may run side by side.
        let prepared = folder.join(format!("{}.job", std::process::id()));
        let mut hodograph = cargo(&["run", "--release", "--quiet"]);
        hodograph.args(["--package", "host-sim", "--bin", "hodograph", "--", "prepare"]).arg(&self.job);
        let options = [
            ("--weight", &self.weight),
            ("--reduction", &self.reduction),
            ("--ramp", &self.ramp),
            ("--loop", &self.chosen),
            ("--feed", &self.feed),
            ("--order", &self.order),
            ("--zero", &self.zero),
            ("--mode", &self.mode),
            ("--contour-error", &self.contour_error),
        ];
        for (name, value) in options {
            if let Some(value) = value {
                hodograph.arg(format!("{name}={value}"));
            }
        }
        if self.plan {
            hodograph.arg("--plan").arg("--machine").arg(&self.machine);
        }
        run(hodograph.arg("--output").arg(&prepared))?;
        Ok(prepared)
    }
}

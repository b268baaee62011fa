//! `cargo xtask budget`: what the image costs, beside what it may cost.
//!
//! The figures stand in `budget.toml`. A figure that has grown by more than 5 % fails; one that has shrunk is for `--accept`. They
//! belong to one compiler: under another they are shown, and growth is reported without failing. The bars always hold.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;
use serde::{Deserialize, Serialize};

use crate::build::{Board, firmware};
use crate::tools::{Failure, Outcome, board_cargo, check_board_compiler, compiler, output, root};

/// The part by which a figure may grow unseen.
const GROWTH: f64 = 0.05;

/// Instructions by which one stage may grow unseen: the border between two stages is no sharper (`tests/board/src/stages.rs`).
const STAGE_BLUR: u32 = 4;

/// Instructions of the whole interrupt with three step axes, at most: row, column, and bar.
const STEP_BARS: [(&str, &str, u32); 3] =
    [("steps 3 x 900000/s", "most", 36_000), ("steps 3 x 100000/s", "most", 6_000), ("steps at rest", "median", 1_500)];

/// Instructions of curve, feed law and position on an offset PH piece, at most.
const PIECE_BAR: u32 = 180;

/// The same on a polynomial spline piece, at most: its point is a polynomial of a polynomial, the feed correction, and takes more
/// multiplications; but the tick has no root, no second division, and nothing that is repeated until it is good enough.
const SPLINE_BAR: u32 = 250;

/// The stages that these bars are about: the point and the rate, the factor of the ramp, and the step of equation (22).
const PIECE_STAGES: [&str; 3] = ["curve", "feed law", "interpolator"];

/// Instructions that move two servo axes at order 1, at most: the whole interrupt but what watches over it.
const MOTION_BAR: u32 = 800;

/// The stages that watch over it.
const WATCH_STAGES: [&str; 2] = ["safety", "control"];

/// Instructions of the whole interrupt with two servo axes at order 1, at a node too, at most: the 1 500 that three step axes may take
/// at rest, and what the profile beside the ramps takes of a piece.
const INTERRUPT_BAR: u32 = 1_525;

/// The same along a profile, where the time is sought by Newton's method: as order 2 takes along a ramp, it may take more.
const PROFILE_BAR: u32 = 1_650;

/// The machines in which it is measured.
const SERVOS: &str = "examples/mill-servos.toml";
const STEPS: &str = "examples/mill-steps.toml";

/// Measure the image on the virtual board and compare it with budget.toml
#[derive(Args)]
#[command(after_help = "Example:\n  cargo xtask budget --accept")]
pub struct Budget {
    /// Write the figures into budget.toml
    #[arg(long)]
    accept: bool,
    /// Write the figures as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// The figures of one image.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
struct Figures {
    compiler: String,
    stack_bytes: u32,
    flash_bytes: u32,
    ram_bytes: u32,
    instructions: BTreeMap<String, BTreeMap<String, u32>>,
    /// Of the boards that cannot be emulated: the memory that their images take, in bytes.
    images: BTreeMap<String, BTreeMap<String, u32>>,
    /// Of a measurement only: functions that the tick reaches and must not.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    forbidden: Vec<String>,
    /// Of a measurement only: calls that cannot be followed.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    indirect: Vec<String>,
    /// Of a measurement only: everything that the tick reaches.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    reached: Vec<String>,
}

impl Budget {
    /// Measures, prints, and compares or accepts.
    pub fn run(self) -> Outcome {
        let figures = measure()?;
        let quiet = self.json.as_ref().is_some_and(|path| path.as_os_str() == "-");
        if let Some(path) = &self.json {
            let text = serde_json::to_string_pretty(&figures).map_err(|error| Failure::new(error.to_string()))?;
            if quiet {
                println!("{text}");
            } else {
                std::fs::write(path, text).map_err(|error| Failure::new(format!("{}: {error}", path.display())))?;
            }
        }
        if !quiet {
            print!("{}", figures.table());
        }
        if self.accept {
            write(&figures)?;
        }
        judge(&figures)
    }
}

/// Measures the image, and compares it with what was accepted.
pub fn check() -> Outcome {
    let figures = measure()?;
    print!("{}", figures.table());
    judge(&figures)
}

fn measure() -> Outcome<Figures> {
    let image = firmware(Board::default())?;
    check_board_compiler()?;
    let mut board = board_cargo(&["run", "--release", "--quiet"])?;
    board.args(["--", "budget", "--elf"]).arg(image);
    board.arg("--servos").arg(root().join(SERVOS)).arg("--steps").arg(root().join(STEPS));
    let text = output(&mut board)?;
    let mut figures: Figures =
        serde_json::from_str(&text).map_err(|error| Failure::new(format!("the virtual board's figures: {error}")))?;
    for board in Board::ALL.into_iter().filter(|&board| board != Board::default()) {
        figures.images.insert(board.feature().to_owned(), sizes(board)?);
    }
    figures.compiler = compiler()?.name;
    Ok(figures)
}

/// The memory that a board's image takes.
fn sizes(board: Board) -> Outcome<BTreeMap<String, u32>> {
    let image = firmware(board)?;
    let text = output(board_cargo(&["run", "--release", "--quiet"])?.args(["--", "sizes", "--elf"]).arg(image))?;
    serde_json::from_str(&text).map_err(|error| Failure::new(format!("the sizes of an image: {error}")))
}

fn file() -> PathBuf {
    root().join("budget.toml")
}

fn write(figures: &Figures) -> Outcome {
    std::fs::write(file(), figures.toml()).map_err(|error| Failure::new(format!("budget.toml: {error}")))
}

fn judge(figures: &Figures) -> Outcome {
    let mut faults = figures.broken_bars();
    let text = std::fs::read_to_string(file())
        .map_err(|error| Failure::new(format!("budget.toml: {error}; `cargo xtask budget --accept` writes it")))?;
    let accepted: Figures = toml::from_str(&text).map_err(|error| Failure::new(format!("budget.toml: {error}")))?;
    let growth = figures.growth_over(&accepted);
    if accepted.compiler == figures.compiler {
        faults.extend(growth);
    } else {
        println!(
            "budget.toml was written with {}, and this is {}: growth is shown only.",
            accepted.compiler, figures.compiler
        );
        growth.iter().for_each(|line| println!("  {line}"));
    }
    if faults.is_empty() {
        return Ok(());
    }
    Err(Failure::new(format!("the image costs more than it may:\n  {}", faults.join("\n  "))))
}

impl Figures {
    /// A table for people.
    fn table(&self) -> String {
        let mut text = String::new();
        let stages = ["executor", "interpolator", "feed law", "curve", "servo", "rest"];
        let whole = ["roots", "checks", "median", "start", "node", "most"];
        let columns: Vec<&str> = stages
            .into_iter()
            .chain(whole)
            .filter(|column| self.instructions.values().any(|row| row.contains_key(*column)))
            .collect();
        let _ = write!(text, "{:<20}", "instructions");
        columns.iter().for_each(|column| {
            let _ = write!(text, "{column:>13}");
        });
        text.push('\n');
        for (name, row) in &self.instructions {
            let _ = write!(text, "{name:<20}");
            for column in &columns {
                let _ = write!(text, "{:>13}", row.get(*column).map_or_else(String::new, u32::to_string));
            }
            text.push('\n');
        }
        let _ = writeln!(
            text,
            "the interrupt's stack {} bytes, flash {} bytes, RAM {} bytes",
            self.stack_bytes, self.flash_bytes, self.ram_bytes
        );
        for (board, sizes) in &self.images {
            let sizes: Vec<String> = sizes.iter().map(|(memory, bytes)| format!("{memory} {bytes} bytes")).collect();
            let _ = writeln!(text, "{board}: {}", sizes.join(", "));
        }
        let _ = writeln!(
            text,
            "the tick reaches {} functions, {} of them forbidden",
            self.reached.len(),
            self.forbidden.len()
        );
        text
    }

    /// What is written into `budget.toml`.
    fn toml(&self) -> String {
        let mut text = String::from(
            "# What the firmware costs, written by `cargo xtask budget --accept`. Instructions are exact counts of the image on the virtual\n\
             # board: per stage in the middle of a ramp, `median` and `most` of the whole interrupt; by kind of piece and order. A fit is what\n\
             # loading a spline piece takes beside, outside the tick. Images are those of other boards, in bytes.\n",
        );
        let _ = writeln!(text, "compiler = {:?}", self.compiler);
        for (name, bytes) in [("stack", self.stack_bytes), ("flash", self.flash_bytes), ("ram", self.ram_bytes)] {
            let _ = writeln!(text, "{name}_bytes = {bytes}");
        }
        for (title, rows) in [("instructions", &self.instructions), ("images", &self.images)] {
            let _ = writeln!(text, "\n[{title}]");
            for (name, row) in rows {
                let row: Vec<String> = row.iter().map(|(figure, count)| format!("{figure:?} = {count}")).collect();
                let _ = writeln!(text, "{name:?} = {{ {} }}", row.join(", "));
            }
        }
        text
    }

    /// The bars of the project that this image does not keep.
    fn broken_bars(&self) -> Vec<String> {
        let mut faults = Vec::new();
        for (name, kind, bar) in
            [("ph 1", "an offset PH piece", PIECE_BAR), ("spline 1", "a polynomial spline piece", SPLINE_BAR)]
        {
            let row = self.instructions.get(name);
            let piece = row.map_or(u32::MAX, |row| PIECE_STAGES.iter().filter_map(|stage| row.get(*stage)).sum());
            if piece > bar {
                faults.push(format!(
                    "curve, feed law and position of {kind} take {piece} instructions; {bar} are allowed"
                ));
            }
        }
        let bars = [
            ("ph 1", INTERRUPT_BAR),
            ("line 1", INTERRUPT_BAR),
            ("arc 1", INTERRUPT_BAR),
            ("spline 1", INTERRUPT_BAR),
            ("ph profile", PROFILE_BAR),
            ("line profile", PROFILE_BAR),
        ];
        for (kind, bar) in bars {
            let most = self.instructions.get(kind).and_then(|row| row.get("most")).copied().unwrap_or(u32::MAX);
            if most > bar {
                faults.push(format!("the interrupt takes {most} instructions on {kind}; {bar} are allowed"));
            }
            let row = self.instructions.get(kind);
            let watch = row.map_or(0, |row| WATCH_STAGES.iter().filter_map(|stage| row.get(*stage)).sum());
            let motion = row.and_then(|row| row.get("median")).map_or(u32::MAX, |median| median.saturating_sub(watch));
            if motion > MOTION_BAR {
                faults.push(format!("motion takes {motion} instructions on {kind}; {MOTION_BAR} are allowed"));
            }
        }
        for (name, column, bar) in STEP_BARS {
            let found = self.instructions.get(name).and_then(|row| row.get(column)).copied().unwrap_or(u32::MAX);
            if found > bar {
                faults.push(format!("the interrupt takes {found} instructions on {name}; {bar} are allowed"));
            }
        }
        faults.extend(self.forbidden.iter().map(|name| format!("the tick can reach {name}")));
        faults.extend(self.indirect.iter().map(|call| format!("the tick calls through a register, in {call}")));
        faults
    }

    /// What has grown by too much since `accepted`.
    fn growth_over(&self, accepted: &Self) -> Vec<String> {
        let mut faults = Vec::new();
        let mut compare = |name: String, before: Option<u32>, now: u32, blur: u32| {
            let Some(before) = before else {
                faults.push(format!("{name} is new; accept it"));
                return;
            };
            let allowed = (f64::from(before) * (1.0 + GROWTH)) as u32;
            if now > allowed.max(before + blur) {
                faults.push(format!("{name} has grown from {before} to {now}"));
            }
        };
        for (name, row) in &self.instructions {
            let before = accepted.instructions.get(name);
            for (stage, &now) in row {
                let is_whole = matches!(stage.as_str(), "median" | "most" | "start" | "node");
                let blur = if is_whole { 0 } else { STAGE_BLUR };
                compare(format!("{name}, {stage}"), before.and_then(|row| row.get(stage)).copied(), now, blur);
            }
        }
        for (board, row) in &self.images {
            for (memory, &now) in row {
                let before = accepted.images.get(board).and_then(|row| row.get(memory)).copied();
                compare(format!("{board}, {memory}"), before, now, 0);
            }
        }
        for (name, before, now) in [
            ("the interrupt's stack", accepted.stack_bytes, self.stack_bytes),
            ("flash", accepted.flash_bytes, self.flash_bytes),
            ("RAM", accepted.ram_bytes, self.ram_bytes),
        ] {
            compare(name.to_owned(), Some(before), now, 0);
        }
        faults
    }
}

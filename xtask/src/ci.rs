//! `cargo xtask ci`: all that CI runs, and nothing else does.

use std::path::{Path, PathBuf};
use std::process::Command;

use clap::Args;

use crate::build::Board;
use crate::test::{Tally, all};
use crate::tools::{Outcome, board_cargo, cargo, root, run, target_dir};

/// The version of cargo-deny that is installed where there is none.
const CARGO_DENY: &str = "0.20.2";

/// Check format, lints, docs and dependencies, and run every test
#[derive(Args)]
#[command(after_help = "Example:\n  cargo xtask ci")]
pub struct Ci {}

impl Ci {
    /// Runs it all, and says at the end how much passed.
    pub fn run(self) -> Outcome {
        let mut tally = Tally::default();
        tally.step("format", || run(cargo(&["fmt", "--all"]).args(["--", "--check"])));
        tally.step("format of the virtual board", || run(board_cargo_plain(&["fmt"]).args(["--", "--check"])));
        tally.step("lints", || {
            let packages = ["--workspace", "--exclude", "firmware", "--all-targets", "--quiet", "--", "-D", "warnings"];
            run(cargo(&["clippy"]).args(packages))
        });
        for board in Board::ALL {
            tally.step(&format!("lints of the firmware for {}", board.feature()), || {
                run(board.cargo(&["clippy"]).args(["--profile", "firmware", "--", "-D", "warnings"]))
            });
        }
        tally.step("lints of the virtual board", || {
            run(board_cargo(&["clippy", "--release", "--all-targets", "--quiet"])?.args(["--", "-D", "warnings"]))
        });
        tally.step("docs", || {
            run(strict(&mut cargo(&["doc", "--no-deps", "--quiet", "--workspace", "--exclude", "firmware"])))
        });
        for board in Board::ALL {
            tally.step(&format!("docs of the firmware for {}", board.feature()), || {
                run(strict(board.cargo(&["doc"]).args(["--no-deps", "--document-private-items"])))
            });
        }
        tally.step("docs of the virtual board", || {
            run(strict(&mut board_cargo(&["doc", "--no-deps", "--quiet", "--release"])?))
        });
        tally.step("dependencies", || deny(&root().join("Cargo.toml")));
        tally.step("dependencies of the virtual board", || deny(&root().join("tests/board/Cargo.toml")));
        all(&mut tally, true)?;
        tally.close()
    }
}

/// A cargo command for the virtual board's workspace that builds nothing.
fn board_cargo_plain(arguments: &[&str]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(arguments).arg("--manifest-path").arg(root().join("tests/board/Cargo.toml"));
    command
}

/// With documentation's warnings as errors.
fn strict(command: &mut Command) -> &mut Command {
    command.env("RUSTDOCFLAGS", "-D warnings")
}

/// Bans, licences and sources of a workspace's dependencies.
fn deny(manifest: &Path) -> Outcome {
    let tool = cargo_deny()?;
    let config = root().join("deny.toml");
    let mut check = Command::new(tool);
    check.arg("--manifest-path").arg(manifest).arg("--config").arg(config);
    run(check.args(["check", "bans", "licenses", "sources"]))
}

/// Where cargo-deny is: on the path, or in the target folder, where it is installed if it is missing.
fn cargo_deny() -> Outcome<PathBuf> {
    if Command::new("cargo-deny").arg("--version").output().is_ok() {
        return Ok("cargo-deny".into());
    }
    let tools = target_dir().join("tools");
    let tool = tools.join("bin/cargo-deny");
    if !tool.is_file() {
        eprintln!("cargo-deny is missing; installing it into {}, which takes some minutes.", tools.display());
        let mut install = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        run(install
            .args(["install", "cargo-deny", "--quiet", "--locked", "--version", CARGO_DENY, "--root"])
            .arg(&tools))?;
    }
    Ok(tool)
}

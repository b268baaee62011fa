//! `cargo xtask test`: every test there is.

use std::process::Command;

use clap::Args;

use crate::budget;
use crate::build::{Board, firmware};
use crate::tools::{Failure, Outcome, TARGET, board_cargo, cargo, check_board_compiler, require_target, run, watch};

/// Run every test: on the host, the build for the target, on the virtual board, the budgets
#[derive(Args)]
#[command(after_help = "Example:\n  cargo xtask test --no-install")]
pub struct Test {
    /// Only say what is missing, and install nothing
    #[arg(long)]
    no_install: bool,
}

/// What passed and what failed. A step without tests of its own counts as one.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    passed: u32,
    failed: u32,
}

impl Tally {
    /// Runs a step that either passes or fails.
    pub fn step(&mut self, name: &str, step: impl FnOnce() -> Outcome) {
        println!("\n== {name}");
        match step() {
            Ok(()) => self.passed += 1,
            Err(failure) => {
                self.failed += 1;
                eprintln!("error: {name}: {}", if failure.text.is_empty() { "failed" } else { &failure.text });
            }
        }
    }

    /// Runs a command that runs tests, and counts them.
    pub fn tests(&mut self, name: &str, command: &mut Command) {
        println!("\n== {name}");
        let (mut passed, mut failed) = (0, 0);
        let finished = watch(command, |line| {
            if let Some((p, f)) = counts(line) {
                passed += p;
                failed += f;
            }
        });
        if !matches!(finished, Ok(true)) && failed == 0 {
            // Not a test that failed, but the build or the runner.
            failed = 1;
            eprintln!("error: {name}: failed");
        }
        self.passed += passed;
        self.failed += failed;
    }

    /// The last line, and the outcome.
    pub fn close(self) -> Outcome {
        println!("\n{} passed, {} failed", self.passed, self.failed);
        if self.failed > 0 { Err(Failure::new(String::new())) } else { Ok(()) }
    }
}

/// The numbers of a line such as `test result: ok. 12 passed; 0 failed; ..`.
fn counts(line: &str) -> Option<(u32, u32)> {
    let rest = line.trim_start().strip_prefix("test result: ")?;
    let number = |word: &str| {
        let before = rest.split(word).next()?;
        before.split_whitespace().last()?.parse().ok()
    };
    Some((number(" passed")?, number(" failed")?))
}

impl Test {
    /// Runs them all, and says at the end how many passed.
    pub fn run(self) -> Outcome {
        let mut tally = Tally::default();
        all(&mut tally, !self.no_install)?;
        tally.close()
    }
}

/// Every test, into `tally`.
pub fn all(tally: &mut Tally, install: bool) -> Outcome {
    require_target(install)?;
    check_board_compiler()?;
    tally.tests("tests on the host", &mut cargo(&["test", "--quiet"]));
    tally.step("shared without a standard library, for the target", || {
        run(&mut cargo(&["build", "--quiet", "--package", "shared", "--target", TARGET]))
    });
    for board in Board::ALL {
        tally.step(&format!("the firmware for {}", board.feature()), || firmware(board).map(|_| ()));
    }
    tally.tests("tests on the virtual board", &mut board_cargo(&["test", "--release", "--quiet"])?);
    tally.step("budgets", budget::check);
    Ok(())
}

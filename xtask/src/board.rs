//! `cargo xtask board`: the virtual board on a TCP port, for everything that speaks to a board.

use std::path::Path;
use std::process::Command;

use clap::Args;

use crate::build::{Board as Target, firmware};
use crate::tools::{Outcome, board_cargo, check_board_compiler};

/// Run the firmware on the virtual board, and let hosts speak to it over TCP
///
/// One host at a time; the board goes on when it leaves, and ends with Ctrl-C. With step axes it is some twenty times slower than a
/// real one: every word of every slot is played.
#[derive(Args)]
#[command(
    after_help = "Example:\n  cargo xtask board --listen localhost:4750\n  cargo hodograph stream examples/farouki2018.toml --port tcp:localhost:4750"
)]
pub struct Board {
    /// Where to listen; port 0 takes any that is free
    #[arg(long, value_name = "HOST:PORT")]
    listen: String,
    /// The machine that the board is told
    #[arg(long, value_name = "MACHINE.toml", default_value = "examples/mill-servos.toml")]
    machine: String,
    /// Go as fast as it goes, not as the clock on the wall
    #[arg(long)]
    fast: bool,
    /// End after so many seconds
    #[arg(long, value_name = "N")]
    seconds: Option<String>,
}

impl Board {
    /// Builds the image and the board, and serves.
    pub fn run(self) -> Outcome {
        let image = firmware(Target::default())?;
        check_board_compiler()?;
        become_child(&mut self.command(&image)?)
    }

    fn command(&self, image: &Path) -> Outcome<Command> {
        let mut board = board_cargo(&["run", "--release", "--quiet"])?;
        board.arg("--").arg("serve").arg("--elf").arg(image).arg("--machine").arg(&self.machine);
        board.arg("--listen").arg(&self.listen);
        if self.fast {
            board.arg("--fast");
        }
        if let Some(seconds) = &self.seconds {
            board.arg(format!("--seconds={seconds}"));
        }
        Ok(board)
    }
}

/// Runs `command` in this process' place where that is possible: Ctrl-C then ends one process, which says its last line before the
/// prompt comes back.
#[cfg(unix)]
fn become_child(command: &mut Command) -> Outcome {
    use std::os::unix::process::CommandExt;
    let error = command.exec();
    // Only a command that cannot be started comes back.
    Err(crate::tools::not_started(command, &error))
}

#[cfg(not(unix))]
fn become_child(command: &mut Command) -> Outcome {
    crate::tools::run(command)
}

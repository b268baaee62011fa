//! Places, commands, and what this machine has.

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The target that any Cortex-M4F or M7 runs.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// The oldest compiler that the virtual board's emulator accepts, as (major, minor).
pub const BOARD_COMPILER: (u32, u32) = (1, 98);

/// Why a verb failed: one sentence, and the exit status. An empty sentence says that a tool has said it already.
#[derive(Debug)]
pub struct Failure {
    /// The sentence.
    pub text: String,
    /// 2 for bad input, 1 for a failed run.
    pub status: u8,
}

impl Failure {
    /// A failed run.
    pub fn new(text: impl Into<String>) -> Self {
        Self { text: text.into(), status: 1 }
    }
}

/// What a verb returns.
pub type Outcome<T = ()> = Result<T, Failure>;

/// The top-level directory.
pub fn root() -> PathBuf {
    // Cargo says where the package is that it runs; a binary that is started by hand remembers it.
    let package =
        std::env::var_os("CARGO_MANIFEST_DIR").map_or_else(|| env!("CARGO_MANIFEST_DIR").into(), PathBuf::from);
    package.parent().map_or_else(|| PathBuf::from("."), Path::to_path_buf)
}

/// Where the main workspace is built.
pub fn target_dir() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

/// A cargo command for the main workspace; the caller's directory stays the current one, so that files are found where a person
/// says they are.
pub fn cargo(arguments: &[&str]) -> Command {
    cargo_in(&root(), arguments)
}

/// A cargo command for the workspace of the virtual board.
pub fn board_cargo(arguments: &[&str]) -> Outcome<Command> {
    let mut command = cargo_in(&root().join("tests/board"), arguments);
    if compiler()?.version < BOARD_COMPILER {
        // It may still build: the bound is the emulator's promise, not ours.
        command.arg("--ignore-rust-version");
    }
    Ok(command)
}

fn cargo_in(workspace: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    let (verb, rest) = arguments.split_first().map_or(("", arguments), |(verb, rest)| (*verb, rest));
    command.arg(verb).arg("--manifest-path").arg(workspace.join("Cargo.toml")).args(rest);
    command
}

/// Runs a command that speaks for itself.
pub fn run(command: &mut Command) -> Outcome {
    let status = command.status().map_err(|error| not_started(command, &error))?;
    if status.success() {
        return Ok(());
    }
    // A tool's own exit status says whether the input was bad.
    Err(Failure { text: String::new(), status: status.code().and_then(|code| u8::try_from(code).ok()).unwrap_or(1) })
}

/// Runs a command and returns what it wrote to standard output.
pub fn output(command: &mut Command) -> Outcome<String> {
    let output = command.stderr(Stdio::inherit()).output().map_err(|error| not_started(command, &error))?;
    if !output.status.success() {
        return Err(Failure::new(String::new()));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Runs a command, shows each line it writes to standard output as it comes, and hands it to `line`. Returns whether it succeeded.
pub fn watch(command: &mut Command, mut line: impl FnMut(&str)) -> Outcome<bool> {
    let mut child = command.stdout(Stdio::piped()).spawn().map_err(|error| not_started(command, &error))?;
    if let Some(pipe) = child.stdout.take() {
        for text in BufReader::new(pipe).lines().map_while(Result::ok) {
            println!("{text}");
            // A reader that has gone is no reason to stop.
            let _ = std::io::stdout().flush();
            line(&text);
        }
    }
    let status = child.wait().map_err(|error| not_started(command, &error))?;
    Ok(status.success())
}

/// A command that cannot be run.
pub fn not_started(command: &Command, error: &std::io::Error) -> Failure {
    Failure::new(format!("{} cannot be run: {error}", command.get_program().to_string_lossy()))
}

/// A compiler.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Compiler {
    /// All that it says of itself, such as `rustc 1.98.0 (88d9e12ae 2026-08-18)`.
    pub name: String,
    /// Major and minor version.
    pub version: (u32, u32),
}

/// The compiler in use.
pub fn compiler() -> Outcome<Compiler> {
    let name = output(Command::new("rustc").arg("--version").current_dir(root()))?.trim().to_owned();
    let mut numbers = name.split(|c: char| !c.is_ascii_digit()).filter_map(|number| number.parse().ok());
    let version = (numbers.next().unwrap_or(0), numbers.next().unwrap_or(0));
    Ok(Compiler { name, version })
}

/// Makes sure that the compiler can build for the controller; `install` says whether it may be taught to.
pub fn require_target(install: bool) -> Outcome {
    let mut question = Command::new("rustc");
    let libraries = output(question.args(["--print", "target-libdir", "--target", TARGET]).current_dir(root()))?;
    if Path::new(libraries.trim()).is_dir() {
        return Ok(());
    }
    let remedy = format!("rustup target add {TARGET}");
    if !install {
        return Err(Failure::new(format!("the compiler has no libraries for {TARGET}; run `{remedy}`")));
    }
    eprintln!("The compiler has no libraries for {TARGET}; running `{remedy}`.");
    run(Command::new("rustup").args(["target", "add", TARGET]).current_dir(root()))
        .map_err(|_| Failure::new(format!("the libraries for {TARGET} could not be installed; run `{remedy}`")))
}

/// Says aloud where the compiler is older than the virtual board's emulator wants.
pub fn check_board_compiler() -> Outcome {
    let Compiler { name, version } = compiler()?;
    if version < BOARD_COMPILER {
        let (major, minor) = BOARD_COMPILER;
        eprintln!(
            "The virtual board asks for a compiler of {major}.{minor} or later and this is {name}; trying all the same. \
             `rustup toolchain install {major}.{minor}.0` brings the one that rust-toolchain.toml names."
        );
    }
    Ok(())
}

//! Where results go: a file, or standard output where its name is `-`.

use std::fs::File;
use std::io::{self, BufWriter, Write};

use host_sim::input::InputError;
use serde::Serialize;

use super::Failure;

/// Opens `name` for writing; `-` is standard output.
pub fn create(name: &str) -> Result<Box<dyn Write>, Failure> {
    if name == "-" {
        return Ok(Box::new(io::stdout().lock()));
    }
    let file = File::create(name).map_err(|e| InputError::new(name, format_args!("cannot be written: {e}")))?;
    Ok(Box::new(BufWriter::new(file)))
}

/// Writes `result` as JSON to `name`.
pub fn json(name: &str, result: &impl Serialize) -> Result<(), Failure> {
    let mut out = create(name)?;
    serde_json::to_writer_pretty(&mut out, result).map_err(|e| failed(name, e))?;
    writeln!(out).and_then(|()| out.flush()).map_err(|e| failed(name, e))
}

/// Writes `bytes` to `name`, to the last one.
pub fn write(name: &str, bytes: &[u8]) -> Result<(), Failure> {
    let mut out = create(name)?;
    out.write_all(bytes).and_then(|()| out.flush()).map_err(|e| failed(name, e))
}

/// The failure of a write that had begun.
pub fn failed(name: &str, error: impl std::fmt::Display) -> Failure {
    Failure::Run(format!("{name}: {error}"))
}

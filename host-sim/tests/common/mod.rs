//! The command as a person runs it.

#![allow(clippy::unwrap_used, reason = "a failed test says where")]
#![allow(dead_code, reason = "each test file needs a part of it")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A place for a file of this name; nothing is there.
pub fn nowhere(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_file(&path);
    path
}

/// A file of this name with this text.
pub fn file(name: &str, text: &str) -> PathBuf {
    let path = nowhere(name);
    std::fs::write(&path, text).unwrap();
    path
}

/// `hodograph VERB FILE OPTIONS`.
pub fn run(verb: &str, job: &Path, options: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hodograph")).arg(verb).arg(job).args(options).output().unwrap()
}

/// The sentence with which a text is refused: one on standard error, with status 2, and nothing written; `output` is the option
/// that would write. The file is named job.toml in it.
pub fn refused(verb: &str, output: &str, name: &str, text: &str, options: &[&str]) -> String {
    let path = file(&format!("{name}.toml"), text);
    let written = nowhere(&format!("{name}.out"));
    let mut all = options.to_vec();
    all.extend([output, written.to_str().unwrap()]);
    let output = run(verb, &path, &all);
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{name}: {errors}");
    assert!(output.stdout.is_empty() && !written.exists(), "{name}: something was written");
    assert_eq!(errors.trim_end().lines().count(), 1, "{name}: {errors}");
    errors.trim_end().replace(path.to_str().unwrap(), "job.toml")
}

/// Asserts that `error` says all of these words.
pub fn says(name: &str, error: &str, words: &[&str]) {
    for word in words {
        assert!(error.contains(word), "{name}: {error:?} lacks {word:?}");
    }
}

//! A program as a job: any bytes come to finite strokes and a path, whatever becomes of lines, or are refused in one sentence.
#![no_main]

use std::sync::LazyLock;

use host_sim::compensation::Gouge;
use host_sim::strokes::Tooling;
use libfuzzer_sys::fuzz_target;
use tests::program_strokes::{LINES, hold, tooling};

static TOOLING: LazyLock<Tooling> = LazyLock::new(|| tooling(Gouge::Trim));

fuzz_target!(|bytes: &[u8]| {
    for lines in LINES {
        let _ = hold(bytes, lines, &TOOLING);
    }
});

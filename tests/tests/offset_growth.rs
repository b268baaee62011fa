//! How the time of trimming grows with the number of segments, as a ratio of times in one run.
#![allow(clippy::panic, reason = "a failed test says where")]

#[path = "../../host-sim/benches/fingers/mod.rs"]
mod fingers;

use std::hint::black_box;
use std::time::Instant;

use fingers::fingers;
use host_sim::offset::trim;
use tests::properties::check_offset;
use tests::simple::crossing;

/// The tool of the benchmark.
const TOOL: f64 = 1.2;
/// Runs of which the fastest counts.
const RUNS: u32 = 3;

/// The project's bar: from 1 000 to 10 000 segments no worse than n log n by a factor of 2, on both sides.
#[test]
fn time_grows_as_n_log_n() {
    for tool in [TOOL, -TOOL] {
        let [small, large] = [1_000, 10_000].map(|count| {
            let contour = fingers(count);
            let run = || {
                let start = Instant::now();
                let offset = trim(black_box(&contour), tool).unwrap_or_else(|error| panic!("{count}: {error:?}"));
                assert!(!offset.loops.is_empty());
                start.elapsed().as_secs_f64()
            };
            (0..RUNS).map(|_| run()).fold(f64::INFINITY, f64::min)
        });
        let law = 10.0 * 10_000_f64.ln() / 1_000_f64.ln();
        println!("d = {tool}: {:.1} ms, {:.1} ms: x {:.2} beside {law:.2}", small * 1e3, large * 1e3, large / small);
        assert!(large / small < 2.0 * law, "d = {tool}: time grows by {:.2}, n log n by {law:.2}", large / small);
    }
}

/// What is timed is right.
#[test]
fn fingers_are_simple_and_their_offsets_right() {
    let contour = fingers(1_000);
    assert_eq!(crossing(&contour), None);
    for tool in [TOOL, -TOOL] {
        let offset = trim(&contour, tool).unwrap_or_else(|error| panic!("{error:?}"));
        if let Err(failure) = check_offset(&contour, tool, &offset, 6) {
            panic!("d = {tool}: {failure}");
        }
    }
}

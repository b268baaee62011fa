//! The time that work takes: of the processor where the system tells it, so that other work on the machine counts for little. It is told
//! in steps of some ms: what is measured should take a hundred.

use std::fs;
use std::time::Instant;

/// Begins when it is made.
#[derive(Debug)]
pub struct Stopwatch {
    start: Instant,
    busy: Option<u64>,
}

impl Stopwatch {
    /// Begins now.
    pub fn start() -> Self {
        Self { start: Instant::now(), busy: busy() }
    }

    /// The seconds since then in which this thread had the processor; on systems without `/proc` those of the clock.
    pub fn seconds(&self) -> f64 {
        match (self.busy, busy()) {
            (Some(start), Some(now)) => now.saturating_sub(start) as f64 * 1e-9,
            _ => self.start.elapsed().as_secs_f64(),
        }
    }
}

/// Nanoseconds on the processor.
fn busy() -> Option<u64> {
    fs::read_to_string("/proc/thread-self/schedstat").ok()?.split_whitespace().next()?.parse().ok()
}

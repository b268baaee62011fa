//! The tick comes 1024 times a second, exactly.

mod common;

use board::jobs::{Kind, job};
use board::run::run_job;
use common::{image, servos};
use shared::piece::Order;

/// 2^-10 s is 976 562.5 ns: n ticks after the first, the handler is entered within one instruction of n times that, plus what the task
/// it interrupts needs for its last instruction.
#[test]
fn ticks_are_2_to_the_minus_10_s_apart() {
    let (header, pieces) = job(Kind::Line, Order::First);
    let run = run_job(&image(), &servos(), header, pieces, 1.0, |_| {}).unwrap();
    let entries = &run.seen.entries;
    assert!(entries.len() > 500);
    for (n, &at) in entries.iter().enumerate() {
        let exact = entries[0] as f64 + n as f64 * 1e9 / 1024.0;
        assert!((at as f64 - exact).abs() < 200.0, "tick {n} at {at} ns instead of {exact}");
    }
}

//! The image that is flashed and the simulator put out the same bits: the setpoints of every tick, and their hash.

mod common;

use board::run::run_job;
use common::{image, root, servos};
use host_sim::job::{FeedOverride, Job, Reduction};
use host_sim::path::Path;
use host_sim::simulate;
use shared::piece::Order;

/// Runs `job` on both and compares every tick. Returns the number of ticks.
fn compare(job: &Job, order: Order, name: &str) -> usize {
    let path = Path::new(job, order).unwrap();
    let mut host = Vec::new();
    let outcome = simulate::run(&path, |_, executor| host.push(executor.setpoint().map(|axis| axis.0))).unwrap();
    let target = run_job(&image(), &servos(), path.header, path.wire().collect(), outcome.time, |_| {}).unwrap();

    let found: Vec<_> = target.seen.ticks.iter().map(|tick| tick.setpoint).collect();
    let first = host.iter().zip(&found).position(|(host, target)| host != target);
    assert_eq!(first, None, "{name}: the first tick that differs");
    assert_eq!(found.len(), host.len(), "{name}: ticks");
    let (ticks, residual, hash) = target.finished;
    assert_eq!((u64::from(ticks), hash), (outcome.ticks, outcome.hash.value()), "{name}: ticks and hash as reported");
    let time = f64::from(ticks) * f64::from(shared::TICK) - f64::from(residual);
    assert_eq!(time, outcome.time, "{name}: time");
    assert_eq!(target.resent, 0, "{name}: commands sent twice over a good line");
    host.len()
}

/// The twelve runs of the published experiment.
fn published_runs(order: Order) {
    let name = root().join("examples/farouki2018.toml");
    for weight in [0.0, 0.5, 1.0] {
        for reduction in [0.25, 0.5, 0.75, 1.0] {
            let by = FeedOverride {
                weight: Some(weight),
                reduction: Some(Reduction::Fixed(reduction)),
                ..FeedOverride::default()
            };
            let job = Job::read(name.to_str().unwrap()).unwrap().with_feed(by).unwrap();
            let ticks = compare(&job, order, &format!("w = {weight}, f = {reduction}, {order:?}"));
            // Some ten seconds of motion: an empty comparison would prove nothing.
            assert!(ticks > 5_000, "{ticks}");
        }
    }
}

#[test]
fn published_runs_at_order_1() {
    published_runs(Order::First);
}

#[test]
fn published_runs_at_order_2() {
    published_runs(Order::Second);
}

#[test]
fn published_runs_at_order_3() {
    published_runs(Order::Third);
}

#[test]
fn published_runs_at_order_exact() {
    published_runs(Order::Exact);
}

/// A bracket: lines and arcs both ways round, offset, with its fill arcs.
#[test]
fn lines_and_arcs() {
    let name = root().join("examples/bracket.toml");
    let job = Job::read(name.to_str().unwrap()).unwrap();
    for order in [Order::First, Order::Second, Order::Third, Order::Exact] {
        assert!(compare(&job, order, &format!("bracket, {order:?}")) > 1_000);
    }
}

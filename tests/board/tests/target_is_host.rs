//! The image that is flashed and the simulator put out the same bits: the setpoints of every tick, and their hash.

mod common;

use board::jobs::{profiles, splines};
use board::run::run_job;
use common::{image, root, servos, start_of};
use host_sim::job::{FeedOverride, Job, Reduction};
use host_sim::path::Path;
use host_sim::simulate;
use host_sim::simulate::Queue;
use shared::executor::{Executor, State};
use shared::fixed::Fixed;
use shared::hash::SetpointHash;
use shared::piece::{Header, Order, Piece};

/// Runs `job` on both and compares every tick. Returns the number of ticks.
fn compare(job: &Job, order: Order, name: &str) -> usize {
    let path = Path::new(job, order).unwrap();
    let mut host = Vec::new();
    let outcome = simulate::run(&path, |_, executor| host.push(executor.setpoint().map(|axis| axis.0))).unwrap();
    let hash = outcome.hash.value();
    compare_with(&Host { setpoints: host, hash, time: outcome.time }, path.header, path.wire().collect(), name)
}

/// What the host made of a path: the setpoint of every tick, their hash, and the time in s.
struct Host {
    setpoints: Vec<[i32; 3]>,
    hash: u64,
    time: f64,
}

/// Runs the pieces of a path on the target and compares every tick. Returns the number of ticks.
fn compare_with(host: &Host, header: Header<f32>, pieces: Vec<Piece<f32>>, name: &str) -> usize {
    let Host { setpoints: host, hash: expected, time: expected_time } = host;
    let target = run_job(&image(), &servos(), header, pieces, *expected_time, |_| {}).unwrap();

    let found: Vec<_> = target.seen.ticks.iter().map(|tick| tick.setpoint).collect();
    let first = host.iter().zip(&found).position(|(host, target)| host != target);
    assert_eq!(first, None, "{name}: the first tick that differs");
    assert_eq!(found.len(), host.len(), "{name}: ticks");
    let (ticks, residual, hash) = target.finished;
    assert_eq!((ticks as usize, hash), (host.len(), *expected), "{name}: ticks and hash as reported");
    let time = f64::from(ticks) * f64::from(shared::TICK) - f64::from(residual);
    assert_eq!(time, *expected_time, "{name}: time");
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

/// A program: rapids, the way down, and the curves in the place of its lines.
#[test]
fn a_program_with_its_heights() {
    let job = Job::read(root().join("examples/heart.ngc").to_str().unwrap()).unwrap();
    assert!(compare(&job, Order::First, "heart") > 5_000);
}

/// The executor over pieces that no job has, all of them at hand from the start.
fn on_host(header: &Header<f32>, pieces: &[Piece<f32>]) -> Host {
    let mut queue = Queue::new(header, pieces.iter().copied(), usize::MAX).unwrap();
    queue.fill();
    let [x, y, _] = start_of(header, pieces);
    let z = pieces[0].further.unwrap().from[0];
    let mut executor = Executor::new(shared::TICK, [x, y, z]);
    executor.begin(queue.motion());
    let (mut hash, mut setpoints) = (SetpointHash::new(), Vec::new());
    while executor.state() != State::Finished {
        let setpoint = executor.tick(&mut queue);
        hash.add(setpoint);
        setpoints.push(setpoint.map(|axis| axis.0));
    }
    let time = setpoints.len() as f64 * f64::from(shared::TICK) - f64::from(executor.spare_time());
    Host { setpoints, hash: hash.value(), time }
}

/// Polynomial splines, each fitted where it is loaded, on the host and on the target: cubics and quintics of the orders five, seven and
/// nine, in the plane and in space, beside a line and a PH curve.
#[test]
fn polynomial_splines() {
    for order in [Order::First, Order::Second, Order::Third, Order::Exact] {
        let (header, pieces) = splines(order);
        let host = on_host(&header, &pieces);
        // z rises from 1 to 3.5 mm by a bow that goes beyond, and comes back to 2 mm.
        let z = |of: fn(f64, f64) -> f64| {
            host.setpoints.iter().map(|setpoint| Fixed(setpoint[2]).to_mm()).reduce(of).unwrap()
        };
        assert!(z(f64::min) >= 1.0 && z(f64::max) > 3.6, "{} to {} mm", z(f64::min), z(f64::max));
        assert_eq!(host.setpoints.last().unwrap()[2], Fixed::from_mm(2.0).0);
        let ticks = compare_with(&host, header, pieces, &format!("splines, {order:?}"));
        assert!(ticks > 1_000, "{ticks}");
    }
}

/// Pieces of every shape with a feed over time, from rest to rest, on the host and on the target.
#[test]
fn feeds_over_time() {
    for order in [Order::First, Order::Exact] {
        let (header, pieces) = profiles(order);
        assert_eq!(pieces.len(), 5);
        let host = on_host(&header, &pieces);
        // From rest, and to rest: the first tick and the last one go less than a micrometre.
        let far = |pair: &[[i32; 3]]| (0..3).map(|axis| (pair[1][axis] - pair[0][axis]).abs()).max().unwrap();
        let [x, y, _] = start_of(&header, &pieces);
        let first = [[x.0, y.0, Fixed::from_mm(1.0).0], host.setpoints[0]];
        let last = host.setpoints.last_chunk::<2>().unwrap();
        assert!(far(&first) < 262 && far(last) < 262, "{} and {} units", far(&first), far(last));
        let ticks = compare_with(&host, header, pieces, &format!("profiles, {order:?}"));
        assert!(ticks > 1_000, "{ticks}");
    }
}

//! The board behind a TCP port: a host streams a job to it as to a real one.

mod common;

use std::net::TcpListener;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use board::serve::{Pace, serve};
use common::{image, root, servos};
use host_sim::job::Job;
use host_sim::monitor::{Sight, Want, monitor};
use host_sim::path::Path;
use host_sim::stream::stream;
use host_sim::{simulate, transport};
use shared::link::MotionState;
use shared::piece::Order;
use shared::safety::Coordinates;

/// A job over the port: its setpoints are the simulator's. The board goes on when the host has left, for the next one.
#[test]
fn a_job_over_tcp_is_the_simulators() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = format!("tcp:{}", listener.local_addr().unwrap());
    let ended = Arc::new(AtomicBool::new(false));
    let board = {
        let (image, ended) = (image(), ended.clone());
        // Where something hangs, the board ends all the same.
        std::thread::spawn(move || {
            serve(&image, &servos(), listener, Pace::Fast, Some(Duration::from_secs(120)), ended)
        })
    };

    let job = Job::read(root().join("examples/bracket.toml").to_str().unwrap()).unwrap();
    let path = Path::new(&job, Order::First).unwrap();
    let simulated = simulate::run(&path, |_, _| {}).unwrap();
    let pieces: Vec<_> = path.wire().collect();
    for round in 0..2 {
        let mut line = transport::open(&port, 921_600).unwrap();
        let (transfer, outcome) = stream(&mut *line, &path.header, &pieces, Coordinates::Relative, |_| {}, || None);
        assert_eq!(outcome.map_err(|error| error.to_string()), Ok(()), "round {round}");
        assert_eq!(transfer.setpoint_hash, Some(simulated.hash.value()), "round {round}");
        assert_eq!(transfer.ticks.map(u64::from), Some(simulated.ticks), "round {round}");
        assert_eq!(transfer.time_s, Some(simulated.time), "round {round}");
    }

    let mut line = transport::open(&port, 921_600).unwrap();
    let mut seen = None;
    let look = |sight: Sight<'_>| {
        if let Sight::Telemetry(telemetry) = sight {
            seen = Some((telemetry.state, telemetry.setpoint));
        }
        seen.is_none()
    };
    let outcome = monitor(&mut *line, Duration::from_millis(20), look, || Want::Nothing);
    assert!(outcome.is_ok());
    let (state, [x, y, _]) = seen.unwrap();
    assert_eq!(state, MotionState::Finished);
    // The bracket is closed: the end is where the machine stood at the start.
    assert!(x.to_mm().abs() < 1e-3 && y.to_mm().abs() < 1e-3, "{x:?} {y:?}");

    ended.store(true, Ordering::Relaxed);
    let served = board.join().unwrap().unwrap();
    assert_eq!(served.traffic.hosts, 3);
}

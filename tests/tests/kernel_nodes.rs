//! What nodes do to the motion: nothing; what the end of the queue does: stop there.
#![allow(clippy::unwrap_used, reason = "clippy.toml allows it in tests, which leaves out their helpers")]

use shared::active::ActivePiece;
use shared::complex::Complex;
use shared::executor::{Executor, Pieces, State};
use shared::fixed::{Fixed, UNITS_PER_MM};
use shared::piece::{Header, Order};
use tests::Draft;
use tests::draft::{arc, curves, line, pieces, smooth_path};
use tests::run::{Feeder, ORDERS, Scalar, TICK, header, load, mm, run};

/// A curve, a line, an arc and a curve that follow each other smoothly, 280 mm at an offset of 3 mm. Only the curvature jumps.
fn path() -> Vec<Draft> {
    let segments = [curves(90.0)[0], line(40.0, -30.0), arc(0.0, 40.0, 2.0), curves(70.0)[2]];
    smooth_path(&segments, Complex::new(-31.25, 77.125), 3.0, 84.0)
}

/// The same path with `count` nodes more, anywhere.
fn cut(path: &[Draft], count: usize) -> Vec<Draft> {
    // Knuth's linear congruential generator: arbitrary, and the same in every run.
    let mut seed = 2018_u64;
    let mut marks: Vec<f64> = (0..count)
        .map(|_| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 * path.len() as f64
        })
        .collect();
    marks.extend((0..=path.len()).map(|k| k as f64));
    marks.sort_by(f64::total_cmp);
    marks
        .windows(2)
        .map(|ends| {
            let of = ends[0].floor();
            path[of as usize].part(ends[0] - of, ends[1] - of)
        })
        .collect()
}

/// The farthest that the setpoints of the same tick are apart, in mm, and the difference of the times in ticks.
fn changed_by_cuts<T: Scalar>(weight: f64, order: Order) -> [f64; 2] {
    let whole = path();
    let cut = cut(&whole, 1000);
    assert_eq!(cut.len(), 1000 + whole.len());
    let (whole, cut) = (run::<T>(&whole, weight, order).unwrap(), run::<T>(&cut, weight, order).unwrap());
    assert!(whole.finished && cut.finished && whole.setpoints.len() > 2500);
    let apart = whole.setpoints.iter().zip(&cut.setpoints).map(|(a, b)| (mm(*a) - mm(*b)).norm()).fold(0.0, f64::max);
    [apart, (whole.time - cut.time).abs() / TICK]
}

/// At order "exact" a path without ramps moves the same however it is cut: 0.1 um at every tick.
#[test]
fn extra_nodes_change_nothing_at_order_exact() {
    for weight in [0.0, 0.5, 1.0] {
        for (scalar, [apart, late]) in [
            ("f32", changed_by_cuts::<f32>(weight, Order::Exact)),
            ("f64", changed_by_cuts::<f64>(weight, Order::Exact)),
        ] {
            println!("1000 nodes, exact, w {weight}, {scalar}: {:.4} um apart, {late:.1e} ticks", apart * 1e3);
            assert!(apart < 1e-4 && late < 0.01, "w {weight}, {scalar}: {apart} mm, {late} ticks");
        }
    }
}

/// At the other orders the time stays the same within a tick.
#[test]
fn extra_nodes_keep_the_time_at_every_order() {
    for order in ORDERS {
        for (scalar, [apart, late]) in
            [("f32", changed_by_cuts::<f32>(0.5, order)), ("f64", changed_by_cuts::<f64>(0.5, order))]
        {
            println!("1000 nodes, order {order:?}, {scalar}: {:.3} um apart, {late:.1e} ticks", apart * 1e3);
            assert!(late < 1.0, "{order:?}, {scalar}: {late} ticks");
        }
    }
}

/// The last setpoint is the last point that the job states, to the unit, and rests there; the node before it is nothing special.
#[test]
fn a_path_ends_exactly_at_its_last_point() {
    for order in ORDERS {
        let path = path();
        let last = path[path.len() - 1].last();
        let active = load(&header::<f32>(0.0, order), &pieces(&path), TICK).unwrap();
        let mut executor = Executor::new(TICK as f32, [Fixed(0), Fixed(0), Fixed(77)]);
        executor.start(order);
        let mut feeder = Feeder { rest: active.into_iter(), taken: 0 };
        for _ in 0..4000 {
            executor.tick(&mut feeder);
        }
        let [x, y, _] = last;
        assert_eq!(executor.state(), State::Finished);
        assert_eq!(executor.setpoint(), [x, y, Fixed(77)], "{order:?}: an axis without a path stays where it is");
    }
}

/// A closed path ends where it started.
#[test]
fn a_closed_path_comes_back() {
    let circle = Draft::whole(arc(-30.0, 10.0, core::f64::consts::TAU), 0.0, 80.0);
    let halves = [circle.part(0.0, 0.5), circle.part(0.5, 1.0)];
    let header = Header { closed: true, ..header::<f32>(0.0, Order::First) };
    let active = load(&header, &pieces(&halves), TICK).unwrap();
    let mut executor = Executor::new(TICK as f32, [Fixed(0); 3]);
    executor.start(Order::First);
    let mut feeder = Feeder { rest: active.into_iter(), taken: 0 };
    while executor.state() != State::Finished {
        executor.tick(&mut feeder);
    }
    // The circle starts at the origin; the last point is rounded to the unit.
    assert!(mm(executor.setpoint()).norm() < 1.0 / UNITS_PER_MM);
}

/// A queue that somebody fills while the executor runs.
struct Valve {
    pieces: Vec<ActivePiece<f32>>,
    open: bool,
}

impl Pieces<f32> for Valve {
    fn next_piece(&mut self, place: &mut Option<ActivePiece<f32>>) -> bool {
        let flows = self.open && !self.pieces.is_empty();
        if flows {
            *place = Some(self.pieces.remove(0));
        }
        flows
    }
}

/// A starved queue stops at the node where it ran dry, as long as it takes, and then goes on as from rest at that node.
#[test]
fn a_starved_queue_stops_at_its_node_and_goes_on() {
    for order in ORDERS {
        let path = path();
        let active = load(&header::<f32>(0.0, order), &pieces(&path), TICK).unwrap();
        let (first, rest) = active.split_at(1);
        let node = path[0].centre(1.0);

        let mut valve = Valve { pieces: first.to_vec(), open: false };
        let start = [Fixed(5), Fixed(-7), Fixed(0)];
        let mut executor = Executor::new(TICK as f32, start);
        assert_eq!((executor.tick(&mut valve), executor.state()), (start, State::Idle));
        executor.start(order);
        assert_eq!((executor.tick(&mut valve), executor.state()), (start, State::Starved), "nothing has come yet");
        valve.open = true;
        let mut ticks = 0;
        loop {
            executor.tick(&mut valve);
            if executor.state() != State::Run {
                break;
            }
            ticks += 1;
        }
        assert_eq!(executor.state(), State::Starved);
        // 90 mm at 84 mm/s; Euler's method is late or early by less than a tick here.
        assert!((f64::from(ticks) - 90.0 / 84.0 / TICK).abs() < 2.0, "{order:?}: {ticks}");
        for _ in 0..100 {
            let at = executor.tick(&mut valve);
            // f32 at 45 mm from the frame is good for 10 nm.
            assert!((mm(at) - node).norm() < 2e-5, "{order:?}: rests {} mm off its node", (mm(at) - node).norm());
            assert_eq!(executor.state(), State::Starved);
        }

        valve.pieces = rest.to_vec();
        let mut fresh = Executor::new(TICK as f32, [Fixed(0); 3]);
        fresh.start(order);
        let mut feeder = Feeder { rest: rest.iter().copied(), taken: 0 };
        while fresh.state() != State::Finished {
            assert_eq!(executor.tick(&mut valve), fresh.tick(&mut feeder), "{order:?}: goes on as from rest");
        }
        assert_eq!(executor.state(), State::Finished);
        assert_eq!(executor.setpoint(), path[path.len() - 1].last());
    }
}

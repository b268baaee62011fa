//! Feeds and pieces at both ends of what a machine may be asked for.
#![allow(clippy::unwrap_used, reason = "clippy.toml allows it in tests, which leaves out their helpers")]

use shared::curve::Segment;
use shared::executor::NODES_PER_TICK;
use shared::fixed::UNITS_PER_MM;
use shared::piece::{Order, Piece};
use tests::Draft;
use tests::draft::{arc, curves, line, pieces};
use tests::run::{ORDERS, Run, TICK, header, load, mm, walk};

/// The bar of the issue for times, relative.
const BAR: f64 = 1e-4;

/// 0.01 mm/s on 100 mm: ten million ticks, each a two-hundredth of what a single f32 could add to a parameter near 1.
fn slow(name: &str, segment: Segment<f64>, order: Order) {
    let draft = Draft::whole(segment, 0.0, 0.01);
    let active = load(&header::<f32>(0.0, order), &pieces(&[draft]), TICK).unwrap();
    let exact = draft.duration(0.0);
    let (mut before, mut rest, mut longest_rest) = (None, 0, 0);
    let run = walk(active.into_iter(), order, TICK, (1.1 * exact / TICK) as u64, |executor| {
        rest = if before == Some(executor.setpoint()) { rest + 1 } else { 0 };
        longest_rest = longest_rest.max(rest);
        before = Some(executor.setpoint());
    });
    let error = run.time / exact - 1.0;
    println!("{name}, order {order:?}: {} ticks, time {error:.1e} off, at rest for {longest_rest} ticks", run.ticks);
    assert!(run.finished && error.abs() < BAR, "{name}: {error}");
    // A tick is 9.8 nm. Rounding of the parameter and of the point are 6 nm each at the ends of a 100 mm piece, so that a step can
    // vanish now and then, but never two in a row.
    assert!(longest_rest <= 1, "{name}: stalls for {longest_rest} ticks");
}

#[test]
fn a_slow_feed_on_a_line() {
    slow("line", line(100.0, 0.0), Order::First);
}

#[test]
fn a_slow_feed_on_an_arc() {
    slow("arc", arc(0.0, 50.0, 2.0), Order::First);
}

#[test]
fn a_slow_feed_on_a_curve() {
    slow("PH curve", curves(100.0)[1], Order::First);
}

#[test]
fn a_slow_feed_at_order_exact() {
    slow("line", line(100.0, 0.0), Order::Exact);
}

/// A segment of 200 mm in equal parts.
fn parts(segment: Segment<f64>, count: u32, feed: f64) -> Vec<Piece<f32>> {
    let draft = Draft::whole(segment, 0.0, feed);
    let share = |k: u32| f64::from(k) / f64::from(count);
    let path: Vec<Draft> = (0..count).map(|k| draft.part(share(k), share(k + 1))).collect();
    pieces(&path)
}

fn run_parts(pieces: &[Piece<f32>], order: Order, mut visit: impl FnMut([f64; 2])) -> Run<f32> {
    let active = load(&header::<f32>(0.0, order), pieces, TICK).unwrap();
    walk(active.into_iter(), order, TICK, 2 * pieces.len() as u64, |executor| {
        let at = mm(executor.setpoint());
        visit([at.re, at.im]);
    })
}

/// 100 000 pieces of 2 um at 10 mm/s, 4.9 of them in a tick: as fast as one long piece, and never beyond the loop's bound.
#[test]
fn dense_pieces_take_their_time() {
    for (name, segment) in [("line", line(120.0, -160.0)), ("arc", arc(0.0, 80.0, 2.5)), ("PH curve", curves(200.0)[0])]
    {
        let pieces = parts(segment, 100_000, 10.0);
        for order in ORDERS {
            let run = run_parts(&pieces, order, |_| {});
            let error = run.time / 20.0 - 1.0;
            println!(
                "dense {name}, order {order:?}: time {error:.1e} off, {} pieces in a tick at most",
                run.most_taken
            );
            assert!(run.finished && error.abs() < BAR, "{name}, {order:?}: {error}");
            // A tick covers 9.77 um: five nodes, or more on the PH curve, whose parts are equal in parameter and not in length.
            assert!((5..=8).contains(&run.most_taken), "{} pieces in a tick", run.most_taken);
        }
    }
}

/// 0.2 um at 10 mm/s would be 49 nodes a tick: the tick takes the sixteen that it may, and the motion is as slow as that makes it.
#[test]
fn more_nodes_than_a_tick_may_cross_slow_the_motion_down() {
    // One more than a multiple of sixteen, so that the last tick moves too.
    let count = 50_001_u32;
    let pieces = parts(line(10.0, 0.0), count, 10.0);
    for order in ORDERS {
        let (mut before, mut ticks) = (None, 0);
        let run = run_parts(&pieces, order, |[x, y]| {
            ticks += 1;
            if let Some(before) = before {
                // Sixteen pieces of 0.2 um, two units of rounding.
                let step: f64 = x - before;
                assert!(
                    step > 0.0 && step <= 16.0 * 2e-4 + 2.0 / UNITS_PER_MM,
                    "{order:?}: tick {ticks} moves {step} mm"
                );
            }
            assert_eq!(y, 0.0);
            before = Some(x);
        });
        assert!(run.finished);
        assert_eq!(run.most_taken, NODES_PER_TICK as usize, "{order:?}");
        assert_eq!(run.ticks, u64::from(count.div_ceil(NODES_PER_TICK)), "{order:?}");
    }
}

/// A whole path within one tick: ends in it, exactly at its last point.
#[test]
fn a_path_shorter_than_a_tick_ends_in_its_first() {
    for order in ORDERS {
        let draft = Draft::whole(line(1e-3, 2e-3), 0.0, 50.0);
        let active = load(&header::<f32>(0.0, order), &pieces(&[draft]), TICK).unwrap();
        let mut last = None;
        let run = walk(active.into_iter(), order, TICK, 10, |executor| last = Some(executor.setpoint()));
        assert!(run.finished && run.ticks == 1);
        assert_eq!(last, Some(draft.last()));
        // sqrt(5) um at 50 mm/s, in f32.
        assert!((run.time / (5_f64.sqrt() * 1e-3 / 50.0) - 1.0).abs() < 1e-4, "{order:?}: {}", run.time);
    }
}

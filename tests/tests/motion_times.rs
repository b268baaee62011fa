//! Starts and stops against their closed forms; durations of pieces against the integral.
#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use shared::duration;
use shared::executor::{Executor, State};
use shared::fixed::{Fixed, UNITS_PER_MM};
use shared::motion::MotionCommand;
use shared::pace::PaceLimits;
use shared::piece::{Header, Order};
use tests::Draft;
use tests::draft::{arc, curves, line, pieces};
use tests::run::{ORDERS, Scalar, TICK, header, mm};
use tests::stock::{Stock, prepare};

const SLOPE: f64 = 5.0;
const BEND: f64 = 100.0;

/// The time from rest to q = 1 or back at |q'| <= R, |q''| <= J.
fn ramp_time() -> f64 {
    1.0 / SLOPE + SLOPE / BEND
}

fn rest_header<T: Scalar>(order: Order) -> Header<T> {
    let pace = PaceLimits { slope: T::lit(SLOPE), bend: T::lit(BEND), most: T::TWO };
    Header { rest: true, pace, ..header::<T>(0.0, order) }
}

/// A line of 50 mm at 50 mm/s takes a second at its feed; a start and a stop take half of their time more each. A stop at the end relies
/// on 7/8 of its way: it takes 8/7 as long at most. A dozen ticks for rounding the limits to steps, and for the last steps.
fn rest_to_rest<T: Scalar>() {
    let drafts = [Draft::whole(line(30.0, 40.0), 0.0, 50.0)];
    for order in ORDERS {
        let (motion, active) = prepare(&rest_header::<T>(order), &pieces(&drafts)).unwrap();
        let mut stock = Stock::full(&active);
        let mut executor = Executor::new(T::lit(TICK), [Fixed(0); 3]);
        executor.begin(&motion);
        let mut ticks = 0;
        while executor.state() != State::Finished {
            executor.tick(&mut stock);
            ticks += 1;
            assert!(ticks < 10_000);
        }
        let time = f64::from(ticks) * TICK;
        let [least, most] = [1.0, 8.0 / 7.0].map(|stop| 1.0 + 0.5 * (1.0 + stop) * ramp_time());
        assert!(time > least && time < most + 12.0 * TICK, "{order:?}: {time} s instead of {least} to {most}");
        assert_eq!(executor.setpoint(), drafts[0].last());
    }
}

#[test]
fn rest_to_rest_takes_its_closed_form() {
    rest_to_rest::<f32>();
    rest_to_rest::<f64>();
}

/// A hold on a line at 50 mm/s stops in (1/R + R/J) and half of that times the feed, wherever it begins.
#[test]
fn a_hold_takes_its_closed_form() {
    let drafts = [Draft::whole(line(300.0, 400.0), 0.0, 50.0)];
    let (motion, active) = prepare(&rest_header::<f32>(Order::First), &pieces(&drafts)).unwrap();
    for at in [400, 1000, 3333] {
        let mut stock = Stock::full(&active);
        let mut executor = Executor::new(shared::TICK, [Fixed(0); 3]);
        executor.begin(&motion);
        for _ in 0..at {
            executor.tick(&mut stock);
        }
        let from = mm(executor.setpoint());
        executor.command(MotionCommand::Hold).unwrap();
        let mut ticks = 0;
        while executor.state() != State::Held {
            executor.tick(&mut stock);
            ticks += 1;
            assert!(ticks < 1000);
        }
        let (time, way) = (f64::from(ticks) * TICK, (mm(executor.setpoint()) - from).norm());
        assert!((time / ramp_time() - 1.0).abs() < 0.03, "{time} s instead of {}", ramp_time());
        assert!((way / (25.0 * ramp_time()) - 1.0).abs() < 0.03, "{way} mm");
        // And rests.
        let held = executor.setpoint();
        for _ in 0..50 {
            assert_eq!(executor.tick(&mut stock), held);
        }
    }
}

/// An override of 40 % makes the same path last 2.5 times as long, and no setpoint leaves the line.
#[test]
fn an_override_stretches_time() {
    let drafts = [Draft::whole(line(30.0, 40.0), 0.0, 50.0)];
    let header = Header { rest: false, ..rest_header::<f32>(Order::First) };
    let (motion, active) = prepare(&header, &pieces(&drafts)).unwrap();
    let mut stock = Stock::full(&active);
    let mut executor = Executor::new(shared::TICK, [Fixed(0); 3]);
    executor.command(MotionCommand::Override { percent: 40 }).unwrap();
    executor.begin(&motion);
    let mut ticks = 0_u32;
    while executor.state() != State::Finished {
        executor.tick(&mut stock);
        ticks += 1;
        let at = mm(executor.setpoint());
        assert!((at.re * 0.8 - at.im * 0.6).abs() < 2.0 / UNITS_PER_MM, "{at:?}");
    }
    // From q = 1, at which it begins, in the ramp from there to 0.4.
    let down = 0.6 / SLOPE + SLOPE / BEND;
    let closed = (1.0 - down * 0.7) / 0.4 + down;
    let time = f64::from(ticks) * TICK - f64::from(executor.spare_time());
    assert!((time / closed - 1.0).abs() < 0.01, "{time} s instead of {closed}");
}

/// Durations are the integral of (21): within a thousandth of a tick on 1 s in f32, and to 2e-10 in f64.
#[test]
fn durations_are_the_integral() {
    let mut worst = [0.0_f64; 2];
    for (number, segment) in curves(80.0).into_iter().chain([line(60.0, -80.0), arc(0.0, 30.0, -2.0)]).enumerate() {
        for factor in [1.0, 0.25, 0.05] {
            for (offset, weight) in [(0.0, 0.0), (1.5, 0.5), (1.5, 1.0), (1.5, 0.0)] {
                let draft = Draft::whole(segment, offset, 80.0).ramped(0.2, factor);
                let exact = draft.duration(weight);
                let single = prepare(&header::<f32>(weight, Order::First), &pieces(&[draft])).unwrap().1;
                let double = prepare(&header::<f64>(weight, Order::First), &pieces(&[draft])).unwrap().1;
                let off = [f64::from(duration::of(&single[0])) / exact - 1.0, duration::of(&double[0]) / exact - 1.0];
                worst = [worst[0].max(off[0].abs()), worst[1].max(off[1].abs())];
                assert!(off[0].abs() < 1e-6 && off[1].abs() < 2e-10, "curve {number}, f {factor}, d {offset}: {off:?}");
            }
        }
    }
    println!("durations: f32 {:.1e} and f64 {:.1e} off the integral", worst[0], worst[1]);
}

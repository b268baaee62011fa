//! The time of a piece against the published closed form.
#![allow(clippy::unwrap_used, reason = "clippy.toml allows it in tests, which leaves out their helpers")]

use shared::piece::Order;
use tests::draft::{Draft, curves};
use tests::oracle::ramp_integral;
use tests::run::{ORDERS, Scalar, TICK, run};

/// Design section 4, to the four decimals that are printed there.
#[test]
fn the_ramp_integral_has_its_published_values() {
    for (factor, published) in [(0.25, 2.0647), (0.5, 1.4256), (0.75, 1.1563), (1.0, 1.0)] {
        assert!((ramp_integral(factor) - published).abs() < 0.5e-4, "I({factor}) = {}", ramp_integral(factor));
    }
}

/// (time - (ds/V)(1 - 2 lambda + 2 lambda I(f))) in ticks for every curve and ramp, with ln(rate at the end / rate at the start).
/// The offset is there, but at w = 0 it may not matter.
fn misses<T: Scalar>(order: Order) -> Vec<(f64, f64)> {
    let mut misses = vec![];
    for segment in curves(60.0) {
        for lambda in [0.1, 0.2, 0.3, 0.4, 0.5] {
            for factor in [0.25, 0.5, 0.75, 1.0] {
                let draft = Draft::whole(segment, 1.5, 200.0 * 25.4 / 60.0).ramped(lambda, factor);
                let expected =
                    draft.length(0.0, 1.0) / draft.feed * (1.0 - 2.0 * lambda + 2.0 * lambda * ramp_integral(factor));
                let run = run::<T>(&[draft], 0.0, order).unwrap();
                assert!(run.finished);
                misses.push(((run.time - expected) / TICK, (draft.sigma(0.0) / draft.sigma(1.0)).ln()));
            }
        }
    }
    misses
}

/// One PH piece with both ramps at w = 0, for every order and both scalars.
#[test]
fn both_ramps_take_the_closed_form_time() {
    for order in ORDERS {
        for (scalar, misses) in [("f32", misses::<f32>(order)), ("f64", misses::<f64>(order))] {
            // Euler's method is half a tick times the growth of ln(rate) late, whatever lies between [Hairer, Norsett & Wanner,
            // II.3]: the bar of one tick can hold only where the rate changes by less than e^2 from end to end.
            let within = misses.iter().filter(|(_, growth)| growth.abs() < 2.0).map(|(miss, _)| miss.abs());
            let worst = within.fold(0.0, f64::max);
            println!("closed form, order {order:?}, {scalar}: at most {worst:.1e} ticks off");
            assert!(worst < 1.0, "order {order:?}, {scalar}: {worst} ticks");
            let beyond = misses
                .iter()
                .map(|(miss, growth)| (miss - if order == Order::First { growth / 2.0 } else { 0.0 }).abs());
            let worst = beyond.fold(0.0, f64::max);
            // What is left is of the next order in tick/ramp time, 1/70 at the shortest ramp; at orders that leave nothing, f32
            // adds up some 600 roundings of a tick.
            let bar = if matches!(order, Order::First | Order::Second) { 0.05 } else { 1e-3 };
            println!("  and {worst:.1e} ticks off the expected delay");
            assert!(worst < bar, "order {order:?}, {scalar}: {worst} ticks beside the expected delay");
        }
    }
}

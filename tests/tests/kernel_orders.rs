//! What the orders of the interpolator promise: 1, 2 and 3 their power of the tick, "exact" the integral itself.
#![allow(clippy::unwrap_used, reason = "clippy.toml allows it in tests, which leaves out their helpers")]

use proptest::prelude::*;
use shared::feed::Ramp;
use shared::piece::Order;
use tests::draft::{Draft, arc, curves, line, ph};
use tests::run::{TICK, run, run_at};

/// The root mean square over the curve of the feed error: by how much the time that (21) gives for a tick's step differs from
/// the tick, relative to it. The last step is left out, it ends where the curve does.
fn feed_error(draft: Draft, weight: f64, order: Order, tick: f64) -> f64 {
    let run = run_at::<f64>(&[draft], weight, order, tick).unwrap();
    let mut sum = 0.0;
    let mut from = draft.interval[0];
    let steps = &run.places[..run.places.len() - 1];
    for place in steps {
        let to = draft.xi(place.tau);
        sum += (draft.time(from, to, weight) / tick - 1.0).powi(2);
        from = to;
    }
    (sum / steps.len() as f64).sqrt()
}

/// On a PH curve the feed error grows by 2, 4, 8 when the tick doubles; the 10 % are for the next term of the series, at ticks of
/// a 3200th to an 800th of the curve.
#[test]
fn the_feed_error_has_the_order_that_is_asked_for() {
    for (order, growth) in [(Order::First, 2.0), (Order::Second, 4.0), (Order::Third, 8.0)] {
        let mut found = [f64::MAX, 0.0_f64];
        for (number, segment) in curves(100.0).into_iter().enumerate() {
            for (offset, weight) in [(0.0, 0.0), (2.0, 0.5), (1.0, 1.0)] {
                let draft = Draft::whole(segment, offset, 100.0);
                let errors = [3200.0, 1600.0, 800.0].map(|ticks| feed_error(draft, weight, order, 1.0 / ticks));
                for (fine, coarse) in [(errors[0], errors[1]), (errors[1], errors[2])] {
                    let ratio = coarse / fine;
                    found = [found[0].min(ratio), found[1].max(ratio)];
                    assert!((ratio / growth - 1.0).abs() < 0.1, "{order:?}, curve {number}, d {offset}: {ratio}");
                }
            }
        }
        println!("feed error when the tick doubles, order {order:?}: times {:.3} to {:.3}", found[0], found[1]);
    }
}

/// The largest difference between the time that (21) gives for where a tick ended and the time of that tick, relative to it;
/// and the same of the whole piece.
fn integration_error(draft: Draft, weight: f64) -> f64 {
    let run = run::<f64>(&[draft], weight, Order::Exact).unwrap();
    let (mut elapsed, mut from, mut worst) = (0.0, draft.interval[0], 0.0_f64);
    for (place, count) in run.places[..run.places.len() - 1].iter().zip(1_u32..) {
        let to = draft.xi(place.tau);
        elapsed += draft.time(from, to, weight);
        from = to;
        worst = worst.max((elapsed / (f64::from(count) * TICK) - 1.0).abs());
    }
    elapsed += draft.time(from, draft.interval[1], weight);
    worst.max((run.time / elapsed - 1.0).abs())
}

fn unit() -> impl Strategy<Value = (f64, f64)> {
    (-1.0..1.0, -1.0..1.0)
}

/// lambda from 0.05, f from 0.01 on.
fn ramp() -> impl Strategy<Value = Option<Ramp<f64>>> {
    prop::option::of((0.05..0.5, -2.0..0.0).prop_map(|(length, power)| Ramp { length, factor: 10_f64.powf(power) }))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 192, max_global_rejects: 65_536, failure_persistence: None, ..ProptestConfig::default() })]

    /// "Exact" integrates (21) to 1e-9, whatever the curve, w, ramps and feed, down to ten ticks for a piece.
    ///
    /// The range, found by a sweep of 30 000 such pieces: parametric speed within 1:20, |1 + kappa d| at least 0.25. Beyond it the
    /// integrand has poles so near to the piece that a tick of a tenth of the piece would need more than the eight substeps that
    /// keep a tick bounded; at 30 ticks and more only cusps of 1:100 are left, at 100 ticks those of 1:10 000.
    #[test]
    fn exact_is_the_integral(
        w in [unit(), unit(), unit()], length in 2.0..200.0, offset in -10.0..10.0, ticks in 1.0..2.7,
        weight in prop_oneof![Just(0.0), Just(1.0), 0.0..1.0], start in ramp(), end in ramp(),
    ) {
        let ticks = 10_f64.powf(ticks);
        let feed = length / (ticks * TICK);
        let draft = Draft { start, end, ..Draft::whole(ph(w.map(|(re, im)| (re, im)), length), offset, feed) };
        let along = (0..=400).map(|k| f64::from(k) / 400.0);
        let (least, most) =
            along.clone().map(|xi| draft.sigma(xi)).fold((f64::MAX, 0.0_f64), |(a, b), s| (a.min(s), b.max(s)));
        prop_assume!(least > most / 20.0);
        let stretches: Vec<f64> = along.map(|xi| draft.stretch(xi)).collect();
        prop_assume!(stretches.iter().all(|s| *s > 0.25) || stretches.iter().all(|s| *s < -0.25));
        let error = integration_error(draft, weight);
        prop_assert!(error < 1e-9, "{error:e}");
    }
}

/// The same for the sharpest ramp on the plainest pieces, where everything is known to be easy: to f64 rounding.
#[test]
fn exact_is_exact_to_rounding_on_a_usual_piece() {
    let mut worst = 0.0_f64;
    for segment in curves(100.0).into_iter().chain([line(60.0, -80.0), arc(0.0, 50.0, -2.0)]) {
        for weight in [0.0, 0.5, 1.0] {
            for factor in [1.0, 0.25, 0.01] {
                worst = worst.max(integration_error(Draft::whole(segment, 2.0, 84.0).ramped(0.25, factor), weight));
            }
        }
    }
    println!("order exact against the integral: {worst:.1e}");
    // A thousand ticks of a few roundoffs each; in the flat of a ramp with f = 0.01 tau moves by 1e-5, of which a roundoff of
    // tau is 1e-11.
    assert!(worst < 1e-10, "{worst:e}");
}

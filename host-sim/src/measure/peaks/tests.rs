use std::f64::consts::FRAC_PI_4;

use proptest::prelude::*;
use shared::fixed::Fixed;
use shared::piece::Order;

use super::*;
use crate::job::Job;
use crate::path::Path;
use crate::simulate::run;

const UNLIMITED: Limits = Limits { velocity: f64::INFINITY, acceleration: f64::INFINITY, jerk: f64::INFINITY };

fn limits(velocity: f64, acceleration: f64, jerk: f64) -> Limits {
    Limits { velocity, acceleration, jerk }
}

fn sampled(count: usize, at: impl Fn(f64) -> [f64; 3]) -> Vec<Position> {
    (0..count).map(|k| at(k as f64 * PERIOD).map(Fixed::from_mm)).collect()
}

/// Position at `time` of phases of constant jerk (duration, acceleration at the start, jerk), from a velocity on.
fn phased(mut velocity: f64, phases: &[(f64, f64, f64)], time: f64) -> f64 {
    let (mut from, mut position) = (0.0, 0.0);
    for &(duration, a, j) in phases {
        let t = (time - from).clamp(0.0, duration);
        position += t * (velocity + t * (a / 2.0 + t * j / 6.0));
        velocity += t * (a + t * j / 2.0);
        from += duration;
    }
    position + velocity * (time - from).max(0.0)
}

/// The n-th difference of sin(omega t) is that of its derivative times (sin(x)/x)^n, x = omega h T / 2.
#[test]
fn a_circle_shows_v_and_its_powers() {
    let (radius, feed): (f64, f64) = (10.0, 50.0);
    let omega = feed / radius;
    let (acceleration, jerk) = (feed * omega, feed * omega * omega);
    let setpoints = sampled(2048, |t| [100.0 + radius * (omega * t).cos(), radius * (omega * t).sin(), -3.0]);
    let found = peaks(&setpoints, &[], &Standard::new([limits(feed, acceleration, jerk); 3]));
    let check = |peak: Peak, order, truth: f64| {
        let x = omega * peak.stride as f64 * PERIOD / 2.0;
        // The top may lie half a tick from the nearest sample.
        let slack = truth * (omega * PERIOD / 2.0).powi(2) / 2.0;
        let mean = truth * (x.sin() / x).powi(order);
        assert!((peak.measured - mean).abs() <= peak.noise + slack, "{peak:?} is not {mean}");
        assert!((peak.measured / truth - 1.0).abs() <= 0.0035, "{peak:?} is far from {truth}");
        assert!(peak.proven <= truth);
    };
    for axis in [found.axes[0], found.axes[1]] {
        for (order, peak, truth) in
            [(1, axis.velocity, feed), (2, axis.acceleration, acceleration), (3, axis.jerk, jerk)]
        {
            check(peak, order, truth);
            assert_eq!(peak.verdict, Verdict::Kept);
            assert!((peak.ratio() - 1.0).abs() <= 0.0035);
        }
    }
    let still = found.axes[2];
    assert_eq!([still.velocity, still.acceleration, still.jerk].map(|peak| peak.measured), [0.0; 3]);
    check(found.feed, 1, feed);
    check(found.centripetal, 2, acceleration);
    // y is fastest at t = 0 and after each half turn, x a quarter turn later.
    let turned = found.axes[0].velocity.tick as f64 * PERIOD * omega / (2.0 * FRAC_PI_4);
    assert!((turned % 2.0 - 1.0).abs() < 0.1, "{turned} quarter turns");
}

#[test]
fn an_s_curve_shows_its_jerk_acceleration_and_velocity() {
    let (velocity, acceleration, jerk) = (80.0, 500.0, 1e4);
    let ramp = acceleration / jerk;
    let hold = velocity / acceleration - ramp;
    let rise = [(ramp, 0.0, jerk), (hold, acceleration, 0.0), (ramp, acceleration, -jerk)];
    let fall = rise.map(|(duration, a, j)| (duration, -a, -j));
    let phases = [&[(0.0313, 0.0, 0.0)], &rise[..], &[(0.1777, 0.0, 0.0)], &fall[..]].concat();
    let setpoints = sampled(800, |t| [phased(0.0, &phases, t) - 1_234.567, 0.0, 0.0]);
    let found = peaks(&setpoints, &[], &Standard::new([limits(velocity, acceleration, jerk); 3])).axes[0];
    for (peak, truth, part) in
        [(found.velocity, velocity, 0.005), (found.acceleration, acceleration, 0.005), (found.jerk, jerk, 0.02)]
    {
        assert!((peak.measured / truth - 1.0).abs() <= part, "{peak:?} is not {truth}");
        assert!(peak.noise <= SHARE * peak.limit && peak.proven <= truth);
        assert_eq!((peak.verdict, peak.unjudged), (Verdict::Kept, 0));
    }
}

#[test]
fn a_slow_motion_is_not_blamed_for_its_rounding() {
    let slow = 0.1;
    let setpoints = sampled(2048, |t| [0.3 + slow * t, -slow * t / 3.0, 0.0]);
    let found = peaks(&setpoints, &[], &Standard::new([limits(slow, 1.0, 100.0); 3]));
    for (axis, truth) in found.axes.iter().zip([slow, slow / 3.0, 0.0]) {
        let Peak { measured, noise, stride, .. } = axis.velocity;
        assert!((measured - truth).abs() <= noise && noise <= SHARE * slow && stride == 16);
        for peak in [axis.acceleration, axis.jerk] {
            assert!(peak.measured <= peak.noise && peak.proven == 0.0 && peak.noise <= SHARE * peak.limit);
        }
        for peak in [axis.velocity, axis.acceleration, axis.jerk] {
            assert_eq!(peak.verdict, Verdict::Kept);
        }
    }
    assert!((found.feed.measured - slow * (10.0_f64 / 9.0).sqrt()).abs() <= found.feed.noise);
    assert_eq!(found.centripetal.proven, 0.0);
}

/// Braking along x into a corner between two setpoints, and away along y with z.
#[test]
fn a_corner_is_left_out_and_its_step_reported() {
    let (before, after, acceleration, instant) = (20.0, 7.0, 900.0, 0.0537);
    let at = |t: f64| {
        let (rest, past) = ((instant - t).max(0.0), (t - instant).max(0.0));
        let way = past * (after + acceleration / 2.0 * past);
        [-rest * (before + acceleration / 2.0 * rest), way, -way / 2.0]
    };
    let setpoints = sampled(120, at);
    let standard = Standard::new([limits(100.0, 1000.0, 1e6); 3]);
    let nearest = (instant / PERIOD).round() as usize;
    for corners in [vec![nearest], vec![nearest - 1], vec![nearest, nearest - 1, 5_000]] {
        let found = peaks(&setpoints, &corners, &standard);
        for (step, truth) in found.steps.axes.iter().zip([before, after, after / 2.0]) {
            // The phases are parabolas, so that rounding is all; of the instant it makes 2 us, and those 4 um/s.
            assert!((step.velocity - truth).abs() <= step.noise + 0.004, "{step:?} is not {truth}");
            assert!(step.noise < 0.04 && step.tick.abs_diff(nearest) <= 1);
        }
        assert_eq!(found.steps.unmeasured, 0);
        for axis in found.axes {
            assert_eq!([axis.acceleration, axis.jerk].map(|peak| peak.verdict), [Verdict::Kept; 2]);
            assert!(axis.acceleration.measured <= acceleration + axis.acceleration.noise);
        }
    }
    let blind = peaks(&setpoints, &[], &standard);
    assert_eq!(blind.axes[0].acceleration.verdict, Verdict::Exceeded);
    assert!(blind.axes[0].acceleration.tick.abs_diff(nearest) <= 2);
    // Corners that leave no three setpoints between them are owned up to, and so is the motion there.
    let crowded = peaks(&setpoints, &[nearest, nearest + 3, 119], &standard);
    assert_eq!((crowded.steps.unmeasured, crowded.axes[0].jerk.unjudged), (2, 2));
    assert_eq!(crowded.axes[0].jerk.verdict, Verdict::Open);
}

#[test]
fn one_percent_too_much_acceleration_for_twenty_milliseconds_is_found() {
    let limit = 1000.0;
    for (part, verdict) in [(1.0, Verdict::Kept), (1.01, Verdict::Exceeded)] {
        let phases = [(0.1003, 0.9 * limit, 0.0), (0.02, part * limit, 0.0), (0.1, 0.9 * limit, 0.0)];
        let setpoints = sampled(220, |t| [0.0, 0.0, phased(3.0, &phases, t)]);
        let standard = Standard::new([UNLIMITED, UNLIMITED, limits(1e3, limit, f64::INFINITY)]);
        let peak = peaks(&setpoints, &[], &standard).axes[2].acceleration;
        assert_eq!(peak.verdict, verdict, "{peak:?}");
        assert!((peak.measured - part * limit).abs() <= peak.noise);
        if verdict == Verdict::Exceeded {
            assert!((103..=123).contains(&peak.tick) && (103..=123).contains(&peak.proven_tick));
        }
    }
}

/// Four ticks of 2.5 times the jerk: the stencil of 27 ticks takes them for 0.8 of the limit, that of 12 does not.
#[test]
fn a_peak_too_short_for_the_stride_is_found_by_a_finer_one() {
    let phases = [(0.05, 0.0, 0.0), (4.0 * PERIOD, 0.0, 2.5e4), (1.0, 4.0 * PERIOD * 2.5e4, 0.0)];
    let setpoints = sampled(200, |t| [phased(1.0, &phases, t), 0.0, 0.0]);
    let jerk = peaks(&setpoints, &[], &Standard::new([limits(100.0, 1e3, 1e4); 3])).axes[0].jerk;
    assert!(jerk.stride == 9 && jerk.ratio() < 1.0 && jerk.proven > 1.5e4 && jerk.proven <= 2.5e4);
    assert_eq!(jerk.verdict, Verdict::Exceeded);
}

/// The table of the module, and the worst of roundings: halves that go up and down by turns.
#[test]
fn noise_and_strides_are_those_of_the_table() {
    assert_eq!([1, 2, 3].map(|order| noise(order, 1, ROUNDING)), [1.0 / 256.0, 8.0, 16_384.0]);
    let by_turns: Vec<Position> = (0..2000).map(|k| [Fixed(k % 2), Fixed(0), Fixed(0)]).collect();
    let motion = Motion::new(&by_turns, &[], SHARE);
    for (order, limit, stride) in [
        (1, 0.1, 16),
        (1, 1.0, 2),
        (1, 10.0, 1),
        (2, 100.0, 6),
        (2, 1e3, 2),
        (2, 1e4, 1),
        (3, 1e3, 19),
        (3, 1e4, 9),
        (3, 1e5, 5),
        (3, 1e6, 2),
    ] {
        assert_eq!(motion.stride(order, limit, ROUNDING), stride, "order {order}, limit {limit}");
    }
    for order in [1, 2, 3] {
        let off = difference(&by_turns, 0, order, 1, 5).abs();
        assert!((off / noise(order, 5, ROUNDING) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn short_inputs_and_odd_limits_are_no_trouble() {
    for count in 0..16 {
        let setpoints = sampled(count, |t| [5.0 * t, 0.0, 0.0]);
        for corners in [&[][..], &[0], &[2, 2, 9, 4], &[usize::MAX, 15]] {
            for limit in [f64::INFINITY, 1e3, 0.0, -1.0, f64::NAN] {
                let found = peaks(&setpoints, corners, &Standard::new([limits(limit, limit, limit); 3]));
                assert!(found.axes[0].jerk.measured <= found.axes[0].jerk.noise);
            }
        }
        let jerk = peaks(&setpoints, &[], &Standard::new([limits(10.0, 1e3, 1e3); 3])).axes[0].jerk;
        assert_eq!((jerk.verdict, jerk.unjudged), (Verdict::Open, if count < 4 { count } else { 0 }));
    }
}

/// Sixth differences of a smooth motion are all but noise, and with weights of 64 in sum they show the least that e can be.
#[test]
fn singles_show_on_long_pieces() {
    for (name, least, most) in
        [("bracket", 0.35, 0.5), ("pocket", 0.35, 0.5), ("fan", 0.35, 0.5), ("farouki2018", 0.5, 4.0)]
    {
        let file = format!("{}/../examples/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let job = Job::from_toml(name, &std::fs::read_to_string(file).unwrap()).unwrap();
        let mut all = Vec::new();
        run(&Path::new(&job, Order::Second).unwrap(), |_, executor| {
            all.push((executor.setpoint(), executor.place().map(|place| place.piece)));
        })
        .unwrap();
        // Inside a piece, whose nodes are no part of the smooth motion; the last tick ends between two setpoints.
        let inside = all[1..all.len() - 1].windows(9).filter(|ticks| ticks[0].1 == ticks[8].1);
        let errors = inside.flat_map(|ticks| {
            [0, 1].map(|axis| {
                let weighted = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0].iter().zip(&ticks[1..8]);
                weighted.map(|(w, (at, _))| w * f64::from(at[axis].0)).sum::<f64>().abs() / 64.0
            })
        });
        let error = errors.fold(0.0, f64::max);
        println!("{name}: e is {error:.2} units at least");
        assert!((least..=most).contains(&error), "{name}: {error}");
    }
}

proptest! {
    /// On polynomials of degree 3 the means are known: x' + (h T)^2 x'''/24, x'' and x'''. No stencil is off by more than its
    /// noise, and no peak.
    #[test]
    fn the_noise_is_a_bound(
        p in [-2000.0..2000.0_f64, -300.0..300.0, -3e3..3e3, -3e5..3e5],
        scale in 0.0..1.0_f64,
        count in 4..300_usize,
        exponent in -1.0..3.0_f64,
    ) {
        let [x, v, a, j] = [p[0], p[1] * scale, p[2] * scale, p[3] * scale];
        let setpoints = sampled(count, |t| [x + t * (v + t * (a / 2.0 + t * j / 6.0)), 0.0, 0.0]);
        let limit = 10_f64.powf(exponent);
        let axis = peaks(&setpoints, &[], &Standard::new([limits(limit, 10.0 * limit, 100.0 * limit); 3])).axes[0];
        // Positions in doubles are 2^-43 mm off.
        let exact = ROUNDING * (1.0 + 1e-6);
        for (order, peak) in [(1, axis.velocity), (2, axis.acceleration), (3, axis.jerk)] {
            let (stride, span) = (peak.stride, order as usize * peak.stride);
            let (mut most, mut greatest) = (0.0_f64, 0.0_f64);
            for start in 0..count - span {
                let t = (start as f64 + span as f64 / 2.0) * PERIOD;
                let bow = (stride as f64 * PERIOD).powi(2) * j / 24.0;
                let mean = [v + t * (a + t * j / 2.0) + bow, a + t * j, j][order as usize - 1];
                let off = (difference(&setpoints, 0, order, start, stride) - mean).abs();
                prop_assert!(off <= noise(order, stride, exact), "{off} is above the noise of order {order}, stride {stride}");
                most = most.max(mean.abs());
            }
            for k in 0..=10 * count {
                let t = k as f64 * PERIOD * (count - 1) as f64 / (10 * count) as f64;
                greatest = greatest.max([v + t * (a + t * j / 2.0), a + t * j, j][order as usize - 1].abs());
            }
            prop_assert!((peak.measured - most).abs() <= peak.noise * (1.0 + 1e-6));
            prop_assert!(peak.proven <= greatest + 1e-3 * peak.noise);
            prop_assert!(peak.tick < count && peak.unjudged == 0);
        }
    }
}

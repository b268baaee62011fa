extern crate std;

use std::vec::Vec;

use proptest::prelude::*;

use super::*;

const TICK: f64 = 1.0 / 1024.0;

/// Longer than any way that is asked for.
const FAR: f64 = 1e6;

fn pacer(slope: f64, bend: f64, most: f64) -> Pacer<f64> {
    Pacer::activate(&PaceLimits { slope, bend, most }, TICK).unwrap()
}

/// A step towards a level, with a way of `way` s that is known.
fn step(pacer: &Pacer<f64>, pace: &mut Pace, level: i32, way: f64) -> Stride {
    pacer.step(pace, &Target { level, ample: pacer.ample }, way, || way)
}

/// Runs to `target` from `pace` and returns levels tick by tick, the path time and the ticks that it took.
fn run(pacer: &Pacer<f64>, pace: &mut Pace, target: i32) -> (f64, u32) {
    let (mut time, mut ticks) = (0.0, 0);
    while (pace.level, pace.slope) != (target, 0) {
        time += pacer.time(step(pacer, pace, target, FAR));
        ticks += 1;
        assert!(ticks < 10_000, "never comes to {target}");
    }
    (time, ticks)
}

/// From q with |q'| <= R, |q''| <= J a stop takes q/R + R/J where the limit of q' is reached, 2 sqrt(q/J) where it is not;
/// and half of that times q of path time. Whole ticks: one at each of the three bends at most.
#[test]
fn starts_and_stops_have_their_closed_forms() {
    for (slope, bend, q) in [(4.0, 40.0, 1.0), (4.0, 40.0, 2.0), (10.0, 400.0, 0.5), (2.0, 8.0, 1.0), (50.0, 60.0, 1.0)]
    {
        let pacer = pacer(slope, bend, 2.0);
        let level = pacer.target((q * 100.0) as u8).level;
        let exact = if q * bend > slope * slope { q / slope + slope / bend } else { 2.0 * (q / bend).sqrt() };
        // The steps of the pace round both limits: slope by one step a tick, bend by one step in all of them.
        let rounding = exact * (TICK * bend / slope + 1.0 / f64::from(pacer.whole)) + 3.0 * TICK;
        let mut pace = Pace::REST;
        for (target, name) in [(level, "start"), (0, "stop")] {
            let (time, ticks) = run(&pacer, &mut pace, target);
            let took = f64::from(ticks) * TICK;
            assert!(took >= exact - 1e-9 && took <= exact + rounding, "{name} to {q}: {took} s instead of {exact}");
            let way = exact * q / 2.0;
            assert!((time - way).abs() <= rounding * q / 2.0 + TICK, "{name}: {time} s of path instead of {way}");
        }
    }
}

#[test]
fn a_pace_of_one_is_the_tick() {
    // Steps that do not divide a tick in binary.
    let pacer = pacer(4.0, 37.0, 2.0);
    let mut pace = pacer.unity();
    let stride = pacer.step(&mut pace, &pacer.target(100), FAR, || FAR);
    assert_eq!((pacer.time(stride), stride.short, pace), (TICK, false, pacer.unity()));
    assert_eq!(pacer.value(&pace), 1.0);
    let fixed = Pacer::fixed(TICK as f32);
    let mut pace = fixed.unity();
    for percent in [1, 100, 200] {
        let stride = fixed.step(&mut pace, &fixed.target(percent), 0.0, || 0.0);
        assert_eq!((fixed.time(stride), stride.short, fixed.is_fixed()), (TICK as f32, false, true));
    }
}

#[test]
fn overrides_are_their_per_cents() {
    let fine = pacer(4.0, 40.0, 2.0);
    let coarse = pacer(1e3, 1e6, 1.5);
    for percent in 1..=200 {
        for (pacer, most) in [(&fine, 2.0), (&coarse, 1.5)] {
            let q = pacer.value(&Pace { level: pacer.target(percent).level, slope: 0 });
            let wanted = f64::from(percent).min(most * 100.0) / 100.0;
            assert!((q - wanted).abs() <= 0.5 / FEWEST_STEPS && q > 0.0 && q <= most, "{percent} %: {q}");
        }
    }
    assert!(coarse.whole >= FEWEST_STEPS as i32 && fine.whole == 26_215);
}

#[test]
fn limits_out_of_range() {
    let activate = |slope, bend, most| Pacer::activate(&PaceLimits { slope, bend, most }, TICK as f32).err();
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(matches!(activate(bad, 40.0, 2.0), Some(PathError::Pace { .. })), "{bad}");
        assert!(matches!(activate(4.0, bad, 2.0), Some(PathError::Pace { .. })), "{bad}");
    }
    for most in [0.99, 2.01, f32::NAN] {
        assert!(matches!(activate(4.0, 40.0, most), Some(PathError::Pace { .. })), "{most}");
    }
    for (slope, bend) in [(0.4, 40.0), (4.0, 3.0), (1e-30, 1e30), (1e30, 1e-30)] {
        assert_eq!(activate(slope, bend, 2.0), Some(PathError::SlowStop { slope, bend }));
    }
    // What the sentence of that error says is enough.
    for (slope, bend) in [(0.6, 6.0), (0.6, 1e30), (1e30, 6.0), (1e30, 1e30)] {
        assert_eq!(activate(slope, bend, 2.0), None, "{slope} {bend}");
    }
}

/// One tick of a script: a target in steps of an 8th of the largest level, and how much way there is beyond what a stop needs.
#[derive(Clone, Copy, Debug)]
struct Wish {
    ticks: u32,
    eighths: i32,
}

fn wishes() -> impl Strategy<Value = Vec<Wish>> {
    let wish = (1..120_u32, 0..=8).prop_map(|(ticks, eighths)| Wish { ticks, eighths });
    prop::collection::vec(wish, 1..30)
}

fn limits() -> impl Strategy<Value = PaceLimits<f64>> {
    ((0.0..2.0), (1.0..4.0), 1.0..=2.0).prop_map(|(slope, bend, most)| PaceLimits {
        slope: 10_f64.powf(slope),
        bend: 10_f64.powf(bend),
        most,
    })
}

/// What holds between two ticks, whatever is asked for.
fn check(pacer: &Pacer<f64>, limits: &PaceLimits<f64>, before: Pace, after: Pace) -> Result<(), TestCaseError> {
    prop_assert!((0..=pacer.most).contains(&after.level), "{after:?}");
    prop_assert!(
        (after.slope - before.slope).abs() <= 1 && after.slope.abs() <= pacer.steepest,
        "{before:?} {after:?}"
    );
    prop_assert_eq!(after.level - before.level, after.slope);
    let q = |pace: &Pace| pacer.value(pace);
    prop_assert!((q(&after) - q(&before)).abs() <= limits.slope * TICK * (1.0 + 1e-12));
    prop_assert!(
        f64::from(after.slope - before.slope).abs() / f64::from(pacer.whole)
            <= limits.bend * TICK * TICK * (1.0 + 1e-12)
    );
    prop_assert!(q(&after) <= limits.most);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any targets at any time: within all limits, and the last one is met in bounded time.
    #[test]
    fn any_wishes_keep_the_limits(limits in limits(), wishes in wishes(), rest: bool) {
        let pacer = Pacer::activate(&limits, TICK).unwrap();
        let mut pace = if rest { Pace::REST } else { pacer.unity() };
        let mut last = 0;
        for wish in wishes {
            last = pacer.most * wish.eighths / 8;
            for _ in 0..wish.ticks {
                let before = pace;
                let stride = step(&pacer, &mut pace, last, FAR);
                check(&pacer, &limits, before, pace)?;
                prop_assert_eq!(stride, Stride { steps: before.level + pace.level, short: false });
            }
        }
        let mut ticks = 0;
        while (pace.level, pace.slope) != (last, 0) {
            let before = pace;
            step(&pacer, &mut pace, last, FAR);
            check(&pacer, &limits, before, pace)?;
            ticks += 1;
            // To turn round and go all the way.
            prop_assert!(ticks <= 2 * LONGEST_STOP);
        }
    }

    /// A way that grows while the pace runs, as a queue does that is filled: never overrun, used up to five half steps, and the
    /// limits hold all along.
    #[test]
    fn a_stop_is_always_possible_within_the_way(
        limits in limits(), wishes in wishes(), refills in prop::collection::vec((1..200_u32, 0.0..0.5_f64), 0..12),
    ) {
        let pacer = Pacer::activate(&limits, TICK).unwrap();
        let mut pace = Pace::REST;
        // In half steps.
        let (mut way, mut ticks) = (i64::from(pacer.most), 0_u32);
        let mut refills = refills.into_iter();
        let mut refill = refills.next();
        let mut wishes = wishes.into_iter().flat_map(|wish| core::iter::repeat_n(wish.eighths, wish.ticks as usize));
        loop {
            if let Some((after, seconds)) = refill && ticks >= after {
                way += (seconds * pacer.per_second) as i64;
                (refill, ticks) = (refills.next(), 0);
            }
            let target = (pacer.most * wishes.next().unwrap_or(8) / 8).max(1);
            let before = pace;
            let stride = step(&pacer, &mut pace, target, way as f64 / pacer.per_second);
            check(&pacer, &limits, before, pace)?;
            way -= i64::from(stride.steps);
            ticks += 1;
            prop_assert!(way >= 0, "overrun by {way}");
            prop_assert!(ticks < 100_000);
            if stride.steps == 0 && refill.is_none() && pacer.is_nothing(way as f64 / pacer.per_second) {
                break;
            }
        }
    }
}

/// A way that turns out shorter than it was said to be: the pace falls as fast as it may.
#[test]
fn a_way_that_vanishes_is_met_at_the_limit() {
    let pacer = pacer(4.0, 40.0, 2.0);
    let mut pace = pacer.unity();
    let mut ticks = 0;
    while !pace.is_rest() {
        let stride = step(&pacer, &mut pace, pacer.target(100).level, 0.0);
        assert!(stride.short);
        ticks += 1;
    }
    let mut held = pacer.unity();
    assert_eq!(run(&pacer, &mut held, 0).1, ticks + 1, "as a hold, whose last tick only ends its slope");
}

//! Motions whose words can be written down.

extern crate std;

use std::vec::Vec;

use super::rig::{Rig, pin, plain};
use crate::fixed::Fixed;
use crate::steps::{Half, Pin, StepAxes, StepError, StepSettings, slots_in};

const MM: i32 = 262_144;

/// The slots in which the steps of the last tick began, within the tick.
fn slots<const AXES: usize, const PORTS: usize, const SLOTS: usize>(
    rig: &Rig<AXES, PORTS, SLOTS>,
    axis: usize,
) -> Vec<u64> {
    let start = rig.decoder.now() - SLOTS as u64;
    rig.steps.iter().filter(|step| step.axis == axis).map(|step| step.instant - start).collect()
}

/// Four steps in 1600 slots: crossings at (k + 1/2)/4 of the tick.
#[test]
fn steps_fall_where_the_line_crosses() {
    let mut rig: Rig<1, 1, 1600> = Rig::new([plain(0, 4.0)], [Fixed(0)]);
    rig.tick([Fixed(MM)]).unwrap();
    assert_eq!(slots(&rig, 0), [200, 600, 1000, 1400]);
    // Back again the direction comes first, at once: the last pulse is long past.
    rig.tick([Fixed(0)]).unwrap();
    assert_eq!(slots(&rig, 0), [200, 600, 1000, 1400]);
    assert_eq!(rig.least(0).setup, 200);
    assert_eq!(rig.state.position(0), Some(0));
    rig.drain();
    rig.check_times();
}

/// The words themselves: set in the low half, reset in the high one, the other way round where the pin is inverted.
#[test]
fn words_are_those_of_a_set_and_reset_register() {
    let inverted = |port, bit| Pin { inverted: true, ..pin(port, bit) };
    let settings = StepSettings { pulse: 3, step: inverted(1, 15), direction: inverted(0, 2), ..plain(0, 1.0) };
    let axes: StepAxes<1, 2, 16> = StepSettings::activate(&[settings]).unwrap();
    let mut state = axes.at_rest([Fixed(0)]);
    assert_eq!(axes.idle(), [1 << 18, 1 << 15]);
    // What the memory held before is cleared.
    let (mut a, mut b) = ([5; 16], [6; 16]);
    axes.fill(&mut state, [Fixed(-MM)], Half::First, [&mut a, &mut b]).unwrap();
    let mut expected = ([0; 16], [0; 16]);
    expected.0[0] = 1 << 2;
    expected.1[8] = 1 << 31;
    expected.1[11] = 1 << 15;
    assert_eq!((a, b), expected);
    // The same half again, at rest: cleared and nothing written. A clear half is left alone.
    axes.fill(&mut state, [Fixed(-MM)], Half::First, [&mut a, &mut b]).unwrap();
    assert_eq!((a, b), ([0; 16], [0; 16]));
    let (mut mark, mut other) = ([7; 16], [9; 16]);
    axes.fill(&mut state, [Fixed(-MM)], Half::Second, [&mut a, &mut b]).unwrap();
    axes.fill(&mut state, [Fixed(-MM)], Half::Second, [&mut mark, &mut other]).unwrap();
    axes.fill(&mut state, [Fixed(-MM)], Half::First, [&mut mark, &mut other]).unwrap();
    assert_eq!((mark, other), ([7; 16], [9; 16]));
}

/// A pulse that begins in the last slot ends in the next tick, at rest or not.
#[test]
fn a_pulse_crosses_the_end_of_a_tick() {
    for after in [MM, 2 * MM, 0] {
        let mut rig: Rig<1, 1, 1500> = Rig::new([StepSettings { pulse: 5, ..plain(0, 1.0) }], [Fixed(0)]);
        // The middle between two steps is all but at the end of the tick.
        rig.tick([Fixed(MM / 2 + 1)]).unwrap();
        assert_eq!(slots(&rig, 0), [1499]);
        rig.tick([Fixed(after)]).unwrap();
        assert_eq!(rig.least(0).pulse, 5);
        rig.drain();
        rig.check_times();
    }
}

/// Back and forth across a middle at the end of a tick: hold and setup move the step, and no more than they must.
#[test]
fn a_reversal_waits_for_hold_and_setup() {
    let settings = StepSettings { pulse: 5, hold: 11, setup: 20, ..plain(0, 1.0) };
    let mut rig: Rig<1, 1, 1500> = Rig::new([settings], [Fixed(0)]);
    rig.tick([Fixed(MM / 2 + 1)]).unwrap();
    rig.tick([Fixed(MM / 2 - 100_000)]).unwrap();
    // Pulse to 1504, hold to 1515, setup to 1535.
    assert_eq!(slots(&rig, 0), [35]);
    let least = rig.least(0);
    assert_eq!((least.pulse, least.hold, least.setup), (5, 11, 20));
    rig.drain();
    rig.check_times();
}

/// At a steady speed the distances of steps differ by one slot at most, also from tick to tick: 900 000 steps/s in every slot count.
#[test]
fn a_steady_speed_is_even_to_one_slot() {
    fn even<const SLOTS: usize>() {
        let per_tick = 900_000.0 / 1024.0;
        let mut rig: Rig<3, 1, SLOTS> = Rig::new([0, 1, 2].map(|k| plain(k, 1000.0)), [Fixed(0); 3]);
        let mut last = [None; 3];
        // The second axis has to turn first.
        rig.tick([Fixed(0), Fixed(-MM / 1000), Fixed(0)]).unwrap();
        for k in 1..300 {
            let x = |part: f64| Fixed((f64::from(k) * per_tick * part * f64::from(MM) / 1000.0) as i32);
            rig.tick([x(1.0), Fixed(x(-0.999).0 - MM / 1000), x(0.123)]).unwrap();
            assert_eq!(rig.state.owed(0), Some(0), "{SLOTS}");
            for step in &rig.steps {
                if let Some(before) = last[step.axis].replace(step.instant) {
                    let exact = SLOTS as f64 / per_tick / [1.0, 0.999, 0.123][step.axis];
                    // The setpoint is rounded to a unit of 1/262 step.
                    assert!((f64::from((step.instant - before) as u32) - exact).abs() < 1.05, "{SLOTS} {step:?}");
                }
            }
        }
        assert!(rig.earliest <= 1.0 && rig.latest < 1.0 / 64.0, "{SLOTS}: {} {}", rig.earliest, rig.latest);
        rig.drain();
        rig.check_times();
    }
    even::<1875>();
    even::<2500>();
    even::<3125>();
    even::<3750>();
}

/// Coordinates at both ends of the range, for the finest and the coarsest axis and ratios that no power of two divides.
#[test]
fn the_step_is_the_nearest_one_anywhere() {
    for steps_per_mm in [0.01, 1.0 / 3.0, 157.480_314_960_629_93, 640.0, 99_999.9, 131_072.0] {
        let axes: StepAxes<1, 1, 1500> = StepSettings::activate(&[plain(0, steps_per_mm)]).unwrap();
        let mut random = super::rig::Random(7);
        for _ in 0..20_000 {
            let units = (random.next() >> 33) as i32 - (1 << 30);
            let exact = f64::from(units) / 262_144.0 * steps_per_mm;
            let found = axes.at_rest([Fixed(units)]).position(0).unwrap();
            // Half a step; a double's own rounding is 2^-23 step here.
            assert!((f64::from(found) - exact).abs() < 0.5 + 1e-6, "{steps_per_mm} {units}");
        }
    }
}

/// Slots last at least as long as asked, and no slot is added by the rounding of a whole number of them.
#[test]
fn times_become_slots() {
    let slot = 1.0 / 1024.0 / 1875.0;
    for count in 1..400_u16 {
        assert_eq!(slots_in(f64::from(count) * slot, 1875), count);
        assert_eq!(slots_in((f64::from(count) + 0.001) * slot, 1875), count + 1);
    }
    assert_eq!((slots_in(0.0, 1875), slots_in(1.0, 1875), slots_in(f64::NAN, 1875)), (0, u16::MAX, 0));
}

/// What cannot be meant is refused, and the sentence says what would do.
#[test]
fn settings_are_checked() {
    let refused = |change: fn(&mut StepSettings)| {
        let mut second = plain(1, 640.0);
        change(&mut second);
        std::string::ToString::to_string(&StepSettings::activate::<2, 1, 1875>(&[plain(0, 640.0), second]).unwrap_err())
    };
    for (change, sentence) in [
        (
            (|one| one.steps_per_mm = f64::NAN) as fn(&mut StepSettings),
            "step axis 1 takes NaN steps/mm; it must be 0.01 to 131072",
        ),
        (|one| one.steps_per_mm = 131_073.0, "step axis 1 takes 131073 steps/mm; it must be 0.01 to 131072"),
        (|one| one.step.port = 1, "step axis 1 uses bit 2 of port 1; there are bits 0 to 15 of 1 ports from 0 on"),
        (
            |one| one.direction.bit = 16,
            "step axis 1 uses bit 16 of port 0; there are bits 0 to 15 of 1 ports from 0 on",
        ),
        (
            |one| one.direction.bit = 0,
            "step axis 1 uses bit 0 of port 0, which is in use; each output needs a pin of its own",
        ),
        (|one| one.pulse = 0, "pulse of step axis 1 is 0 slots; it must be 1 to 468"),
        (|one| one.gap = 469, "gap of step axis 1 is 469 slots; it must be 1 to 468"),
        (|one| one.setup = 0, "setup of step axis 1 is 0 slots; it must be 1 to 468"),
        (|one| one.hold = 500, "hold of step axis 1 is 500 slots; it must be 0 to 468"),
    ] {
        assert_eq!(refused(change), sentence);
    }
    assert!(matches!(
        StepSettings::activate::<1, 1, 1875>(&[StepSettings { direction: pin(0, 0), ..plain(0, 1.0) }]),
        Err(StepError::SharedPin { axis: 0, .. })
    ));
}

//! Properties over generated motions and settings; what fails is shrunk.

extern crate std;

use proptest::collection::vec;
use proptest::prelude::*;

use super::rig::{Rig, plain};
use crate::fixed::Fixed;
use crate::steps::StepSettings;

const SLOTS: usize = 1875;

fn settings() -> impl Strategy<Value = StepSettings> {
    let time = || prop_oneof![1..4_u16, 1..60_u16, Just(468)];
    (-6.6..17.0_f64, time(), time(), time(), prop_oneof![Just(0), time()], any::<[bool; 2]>()).prop_map(
        |(octave, pulse, gap, setup, hold, [step, direction])| {
            let mut one = StepSettings { pulse, gap, setup, hold, ..plain(0, libm::exp2(octave)) };
            (one.step.inverted, one.direction.inverted) = (step, direction);
            one
        },
    )
}

/// The units that make `part` of the most steps of a tick.
fn stride(one: &StepSettings, part: f64) -> f64 {
    let most = (SLOTS as f64 / f64::from(one.pulse + one.gap) / one.steps_per_mm * 262_144.0).min(4e8);
    part * (most - 1.0) * 0.999
}

/// Strides are cut where they would leave the machine.
fn walk(rig: &mut Rig<1, 1, SLOTS>, one: &StepSettings, parts: &[f64]) {
    let mut at = 0.0_f64;
    for part in parts {
        at = (at + stride(one, *part)).clamp(-1e9, 1e9);
        rig.tick([Fixed(libm::round(at) as i32)]).unwrap();
    }
}

proptest! {
    /// Whatever the motion: the position is exact at every tick and after it, and the drive sees the times it asks for.
    #[test]
    fn any_motion_is_exact_and_legal(one in settings(), parts in vec(-1.0..1.0_f64, 1..40)) {
        let mut rig = Rig::new([one], [Fixed(0)]);
        walk(&mut rig, &one, &parts);
        rig.drain();
        rig.check_times();
        prop_assert!(rig.earliest <= 1.0 + 1e-9, "early by {}", rig.earliest);
        prop_assert!(rig.latest <= rig.longest_delay(), "late by {}", rig.latest);
    }

    /// Without a change of direction, each step falls within one slot of the exact linear interpolation, at any speeds.
    #[test]
    fn one_direction_is_even_to_a_slot(one in settings(), parts in vec(0.0..1.0_f64, 1..40)) {
        let mut rig = Rig::new([one], [Fixed(0)]);
        walk(&mut rig, &one, &parts);
        rig.drain();
        rig.check_times();
        prop_assert!(rig.earliest <= 1.0 + 1e-9, "early by {}", rig.earliest);
        prop_assert!(rig.latest < 1.0 / 64.0, "late by {}", rig.latest);
    }

}

//! Asked for more than can be played.

use super::rig::{Rig, plain};
use crate::fixed::Fixed;
use crate::steps::{StepFault, StepSettings};

const MM: i32 = 262_144;

/// 1000 steps in a tick that holds 938: whole pulses at the highest rate, a fault, and the rest in the next tick.
#[test]
fn too_many_steps_are_a_fault_and_whole_pulses() {
    let mut rig: Rig<2, 1, 1875> = Rig::new([0, 1].map(|k| plain(k, 1000.0)), [Fixed(0); 2]);
    assert_eq!(rig.axes.most_steps(0), 937);
    assert_eq!(rig.tick([Fixed(MM / 2), Fixed(MM)]), Err(StepFault::TooFast { axis: 1, steps: 1000 }));
    assert_eq!((rig.state.position(0), rig.state.position(1), rig.state.owed(1)), (Some(500), Some(938), Some(62)));
    rig.drain();
    rig.check_times();
    // Both at once: the first is told. Far too many: time and words stay bounded.
    let far = Fixed(-1 << 30);
    assert!(matches!(rig.tick([far; 2]), Err(StepFault::TooFast { axis: 0, steps: 4_096_500.. })));
    assert_eq!(rig.steps.len(), 2 * 936);
    // What is owed stays a fault until it is given up or played.
    assert!(matches!(rig.tick([far; 2]), Err(StepFault::Late { axis: 0, .. })));
    rig.check_times();
}

/// A speed a little above what the slots hold: whole pulses, and a fault as soon as more is owed than a reversal would explain.
#[test]
fn a_speed_beyond_the_slots_is_found() {
    let mut rig: Rig<1, 1, 1875> = Rig::new([plain(0, 1000.0)], [Fixed(0)]);
    let mut fault = None;
    for k in 1..=40 {
        // 937.9 steps a tick; the slots hold 937.5.
        let result = rig.tick([Fixed((f64::from(k) * 0.9379 * f64::from(MM)) as i32)]);
        fault = fault.or(result.err().map(|fault| (k, fault)));
    }
    assert!(matches!(fault, Some((8..30, StepFault::Late { axis: 0, .. }))), "{fault:?}");
    rig.drain();
    rig.check_times();
}

/// What is owed can be given up where the machine stands.
#[test]
fn standing_elsewhere_gives_up_what_is_owed() {
    let settings = StepSettings { pulse: 300, gap: 100, ..plain(0, 1000.0) };
    let mut rig: Rig<1, 1, 1875> = Rig::new([settings], [Fixed(0)]);
    assert!(rig.tick([Fixed(MM)]).is_err());
    let (played, mut state) = (rig.state.position(0).unwrap(), rig.state);
    assert_eq!(played, 5);
    rig.axes.stand_at(&mut state, [Fixed(10 * MM)]);
    assert_eq!((state.position(0), state.owed(0)), (Some(10_000), Some(0)));
    // The pulse that was under way still ends.
    let mut words = [0; 1875];
    rig.axes.fill(&mut state, [Fixed(10 * MM)], crate::steps::Half::Second, [&mut words]).unwrap();
    assert_eq!(words.iter().filter(|word| **word != 0).count(), 1);
    assert_eq!(words.iter().position(|word| *word == 1 << 16), Some(1600 + 300 - 1875));
}

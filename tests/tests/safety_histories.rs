//! The machine's states under random histories: emergency stops, switches, drives and following errors at random ticks.
//!
//! The bar: outputs safe within the tick that sees it, the state reported, and a position that is called known only where it is. Whether it
//! is, is asked of a machine with positions: step axes without power are moved, encoders of drives at fault and of axes with a following
//! error lose counts.
#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use shared::safety::{Coordinates, Event, Fault, Levels, ResetCause, Safety, SafetyConfig, State};
use tests::random::Random;

const AXES: usize = 4;
const CONFIG: SafetyConfig = SafetyConfig {
    axes: 0b1111,
    encoders: 0b0110,
    homing: 0b1111,
    home_low: 0b0001,
    home_high: 0b0010,
    debounce: 3,
    release: 5,
};

/// Where an axis is, and where its controller takes it to be.
#[derive(Clone, Copy, Default)]
struct Axis {
    actual: i64,
    believed: i64,
}

fn bits(axes: u8) -> impl Iterator<Item = usize> {
    (0..AXES).filter(move |axis| axes >> axis & 1 != 0)
}

/// The next event, most of the time one that fits the state, so that a history gets somewhere.
fn event(random: &mut Random, state: State) -> Option<Event> {
    let axes = (random.bits() % 16) as u8;
    let axis = (random.bits() % AXES as u64) as u8;
    if random.unit() < 0.01 {
        return Some(Event::Trip(match random.bits() % 3 {
            0 => Fault::FollowingError { axis: 1 + axis % 2 },
            1 => Fault::Steps { axis: 3 * (axis % 2) },
            _ => Fault::SoftLimit { axis },
        }));
    }
    if random.unit() < 0.7 {
        return match state {
            State::Idle if random.unit() < 0.3 => Some(Event::Home { axes }),
            State::Idle => Some(Event::Start(Coordinates::Machine)),
            State::Homing if random.unit() < 0.3 => Some(Event::Homed),
            State::Homing => Some(Event::AxisHomed { axes }),
            State::Fault | State::EStop => Some(Event::Acknowledge),
            State::Run | State::Hold | State::Braking => None,
        };
    }
    Some(match random.bits() % 10 {
        0 => Event::Acknowledge,
        1 => Event::Home { axes: 0b1111 },
        2 => Event::Start(Coordinates::Relative),
        3 => Event::Start(Coordinates::Machine),
        4 => Event::Hold,
        5 => Event::Resume,
        6 => Event::Cancel,
        7 => Event::AtRest,
        8 => Event::End,
        _ => return None,
    })
}

#[test]
fn outputs_are_safe_at_once_and_positions_are_called_known_only_where_they_are() {
    const HISTORIES: u64 = 400;
    const TICKS: u32 = 5_000;
    let (mut stops, mut known, mut runs) = (0_u32, 0_u64, 0_u32);
    for seed in 0..HISTORIES {
        let mut random = Random::new(seed);
        let mut safety = Safety::after_reset(ResetCause::Ordinary);
        let mut axes: [Axis; AXES] = core::array::from_fn(|k| Axis { actual: 1 + k as i64, believed: 0 });
        let mut levels = Levels::default();
        let mut limit_ticks = [0_u32; 2 * AXES];
        let mut before = safety.step(&CONFIG, levels, None);
        for _ in 0..TICKS {
            // Levels hold for a while, as those of switches do.
            if random.unit() < 0.05 {
                let some = |random: &mut Random| if random.unit() < 0.05 { (random.bits() % 16) as u8 } else { 0 };
                levels = Levels {
                    estop: random.unit() < 0.05,
                    low: some(&mut random),
                    high: some(&mut random),
                    home: some(&mut random),
                    drive_fault: some(&mut random),
                };
            }
            let event = event(&mut random, safety.state());
            let out = safety.step(&CONFIG, levels, event);

            let tripped = matches!(event, Some(Event::Trip(_)));
            if levels.estop {
                assert_eq!(out.state, State::EStop);
            }
            if levels.estop || levels.drive_fault != 0 || tripped {
                assert!(!out.drives && !out.advance, "{event:?} {levels:?}");
                stops += u32::from(before.drives);
            }
            if levels.drive_fault != 0 || tripped {
                assert!(out.fault.is_some(), "a fault without its reason");
            }
            for (acted, level) in
                limit_ticks.iter_mut().zip((0..8).map(|bit| (levels.low | levels.high << 4) >> bit & 1))
            {
                *acted = if level != 0 { *acted + 1 } else { 0 };
            }
            if out.advance && out.state != State::Homing && before.advance && before.state != State::Homing {
                assert!(limit_ticks.iter().all(|&ticks| ticks < 3), "a motion goes on upon a limit switch");
            }
            assert_eq!(out.state == State::Fault, out.fault.is_some() && out.state != State::EStop);
            assert!(!out.advance || out.drives);
            if out.drives && !before.drives {
                assert_eq!((event, out.state), (Some(Event::Acknowledge), State::Idle));
                assert!(out.resume_from_encoders && !levels.estop && levels.drive_fault == 0);
            }
            if out.state == State::Run && before.state == State::Idle {
                assert!(event == Some(Event::Start(Coordinates::Relative)) || out.known == CONFIG.axes);
                runs += 1;
            }

            // The machine itself.
            if !out.drives {
                for axis in bits(!CONFIG.encoders) {
                    axes[axis].actual += 1;
                }
            }
            for axis in bits(levels.drive_fault) {
                axes[axis].actual += 1;
            }
            match event {
                Some(Event::Trip(Fault::FollowingError { axis })) => axes[usize::from(axis)].actual += 1,
                Some(Event::Home { axes: asked }) if out.refused.is_none() && out.state == State::Homing => {
                    bits(asked).for_each(|axis| axes[axis].believed = i64::MIN);
                }
                Some(Event::AxisHomed { axes: found }) if out.state == State::Homing => {
                    bits(found).for_each(|axis| axes[axis].believed = axes[axis].actual);
                }
                _ => {}
            }
            for axis in bits(out.known) {
                assert_eq!(axes[axis].believed, axes[axis].actual, "axis {axis} is not where it is said to be");
                known += 1;
            }
            before = out;
        }
    }
    // The histories are worth something only if they get about.
    assert!(stops > 2_000 && runs > 2_000 && known > 1_000_000, "{stops} stops, {runs} runs, {known} known");
}

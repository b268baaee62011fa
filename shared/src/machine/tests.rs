//! Every value in range or refused; images that come back whole or not at all.

use proptest::prelude::*;

use super::image::{IMAGE_SIZE, ImageError, decode, encode, whole};
use super::*;
use crate::servo::{DriveSettings, ServoSettings};

fn step_axis(name: AxisName) -> AxisSettings {
    AxisSettings {
        name,
        travel: [0.0, 600.0],
        velocity: 100.0,
        acceleration: 500.0,
        jerk: 10_000.0,
        drive: AxisDrive::Step(StepDrive {
            steps_per_mm: 640.0,
            pulse: 2.5e-6,
            gap: 2.5e-6,
            setup: 5e-6,
            hold: 5e-6,
            step_inverted: false,
            direction_inverted: true,
        }),
        enable: Some(Output { active_low: true }),
        drive_fault: Some(Input { active_low: true }),
        low_limit: Some(Input { active_low: true }),
        high_limit: Some(Input { active_low: false }),
        home_switch: Some(Input::default()),
        homing: Some(HomingSettings {
            switch: HomeSwitch::Limit,
            toward: End::Low,
            fast: 20.0,
            slow: 1.0,
            back_off: 3.0,
            pull_off: 2.0,
            position: 2.0,
            order: 1,
        }),
    }
}

fn servo_axis(name: AxisName) -> AxisSettings {
    let control = ServoSettings {
        counts_per_mm: 2_000.0,
        position_gain: 40.0,
        integral_gain: 10.0,
        velocity_feedforward: 1.0,
        acceleration_feedforward: 1.0,
        drive: DriveSettings::Velocity { lag: 0.002, limit: 500.0 },
    };
    let drive = ServoDrive { following_error: 0.5, encoder_inverted: false, command_inverted: false, control };
    AxisSettings { drive: AxisDrive::Servo(drive), ..step_axis(name) }
}

fn machine() -> MachineSettings {
    MachineSettings {
        name: "router".try_into().unwrap(),
        host_lost: HostLost::Finish,
        estop: Input { active_low: true },
        debounce: 0.005,
        release: 0.1,
        axes: [step_axis(AxisName::X), servo_axis(AxisName::Y), step_axis(AxisName::Z)].into_iter().collect(),
    }
}

#[test]
fn what_is_connected_is_what_the_tick_sees() {
    let machine = machine().activate().unwrap();
    assert_eq!((machine.safety.axes, machine.safety.encoders, machine.safety.home_low), (0b111, 0b010, 0b111));
    assert_eq!((machine.safety.debounce, machine.safety.release), (6, 103));
    assert!(machine.wiring.connected.estop && machine.wiring.active_low.estop);
    assert_eq!((machine.wiring.active_low.low, machine.wiring.active_low.high), (0b111, 0));
    assert_eq!((machine.enables, machine.enables_low), (0b111, 0b111));
}

#[test]
fn the_longest_settings_fit() {
    use AxisName::{A, B, C, X, Y, Z};
    let mut all = machine();
    all.name = "12345678901234567890123456789012".try_into().unwrap();
    all.axes = [X, Y, Z, A, B, C].into_iter().map(servo_axis).collect();
    let image = encode(&all).unwrap();
    assert!(image.len() < IMAGE_SIZE);
    assert_eq!(decode(&image), Ok(all));
}

#[test]
fn what_will_not_do_is_refused_by_name() {
    let refused = |change: fn(&mut MachineSettings)| {
        let mut settings = machine();
        change(&mut settings);
        let error = settings.check().unwrap_err();
        assert_eq!(encode(&settings), Err(ImageError::Settings(error)));
        error
    };
    let number = |axis, key, found| MachineError::Number { axis, key, found };
    assert_eq!(refused(|m| m.debounce = 0.2), number(None, Key::Debounce, 0.2));
    assert_eq!(refused(|m| m.axes[1].jerk = 0.0), number(Some(1), Key::Jerk, 0.0));
    assert_eq!(refused(|m| m.axes.clear()), MachineError::NoAxis);
    assert_eq!(refused(|m| m.axes[2].name = AxisName::X), MachineError::SameName { axis: 2 });
    assert_eq!(refused(|m| m.axes[0].travel = [1.0, 1.0]), MachineError::EmptyTravel { axis: 0 });
    assert!(matches!(refused(|m| m.axes[0].velocity = 400.0), MachineError::StepRate { axis: 0, .. }));
    assert!(matches!(
        refused(|m| m.axes[0].velocity = 10.0),
        MachineError::HomingVelocity { axis: 0, key: Key::HomingFast, .. }
    ));
    assert_eq!(refused(|m| m.axes[0].low_limit = None), MachineError::NoSwitch { axis: 0 });
    assert!(matches!(
        refused(|m| if let Some(h) = &mut m.axes[1].homing {
            h.position = 601.0
        }),
        MachineError::HomeOutside { axis: 1, .. }
    ));
    assert!(matches!(
        refused(|m| if let AxisDrive::Servo(d) = &mut m.axes[1].drive {
            d.control.position_gain = 0.0
        }),
        MachineError::Servo { axis: 1, .. }
    ));
}

/// Memory behind an image is no part of it, and less than an image is none.
#[test]
fn an_image_knows_its_end() {
    let image = encode(&machine()).unwrap();
    let mut memory = image.to_vec();
    memory.extend([0x5a; 100]);
    assert_eq!(whole(&memory), Some(&*image));
    assert_eq!((whole(&image[..image.len() - 1]), whole(&memory[1..])), (None, None));
}

#[test]
fn erased_flash_and_other_versions_are_told_apart_from_damage() {
    assert_eq!(decode(&[0xff; 64]), Err(ImageError::Empty));
    assert_eq!(decode(&[]), Err(ImageError::Empty));
    let mut image = encode(&machine()).unwrap();
    assert_eq!(decode(&image[..image.len() - 1]), Err(ImageError::Truncated));
    image[4] += 1;
    assert_eq!(decode(&image), Err(ImageError::Version { found: 2 }));
}

/// The image of any settings, with a checksum that fits, whatever the settings say.
fn sealed(body: &[u8]) -> std::vec::Vec<u8> {
    let mut image = encode(&machine()).unwrap().to_vec();
    image.truncate(12);
    image[6..8].copy_from_slice(&(body.len() as u16).to_le_bytes());
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
    let said: std::vec::Vec<u8> = image[4..8].iter().chain(body).copied().collect();
    image[8..12].copy_from_slice(&crc.checksum(&said).to_le_bytes());
    image.extend_from_slice(body);
    image
}

extern crate std;

proptest! {
    /// Any bytes at all: refused, and no panic.
    #[test]
    fn no_bytes_break_the_decoder(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        prop_assert!(decode(&bytes).is_err());
        let _ = decode(&sealed(&bytes));
    }

    /// One bit that is wrong is always found.
    #[test]
    fn a_wrong_bit_is_found(at in any::<prop::sample::Index>(), bit in 0..8_u8) {
        let mut image = encode(&machine()).unwrap();
        let at = at.index(image.len());
        image[at] ^= 1 << bit;
        prop_assert!(decode(&image).is_err());
    }

    /// Where the checksum fits, whatever is accepted is in range: asked here of the numbers that can hurt.
    #[test]
    fn nothing_out_of_range_is_accepted(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6)) {
        let mut body = encode(&machine()).unwrap()[12..].to_vec();
        for (at, byte) in changes {
            let at = at.index(body.len());
            body[at] = byte;
        }
        if let Ok(settings) = decode(&sealed(&body)) {
            prop_assert!((0.0..=0.1).contains(&settings.debounce) && (0.0..=0.2).contains(&settings.release));
            prop_assert!((1..=6).contains(&settings.axes.len()));
            for axis in &settings.axes {
                prop_assert!(axis.travel[0] >= -4_000.0 && axis.travel[0] < axis.travel[1] && axis.travel[1] <= 4_000.0);
                prop_assert!(axis.velocity > 0.0 && axis.velocity <= 1e4);
                prop_assert!(axis.acceleration >= 4.0 && axis.acceleration <= 1e6);
                prop_assert!(axis.jerk >= 4.0 && axis.jerk <= 1e9);
            }
            prop_assert!(settings.activate().is_ok());
        }
    }
}

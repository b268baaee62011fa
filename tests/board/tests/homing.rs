//! Homing at the pins: limit switches act where the decoded pulses have led, and the controller finds them.

mod common;

use board::line::{Visitors, lock, share};
use board::machine::Mounting;
use board::machine::step_drivers::StepDrivers;
use board::run::run;
use common::{image, root};
use shared::link::Action;
use shared::safety::State;

/// The router's drives.
const STEPS_PER_MM: f64 = 640.0;

/// The router of the examples, which looks for the switch faster and from less far, since every slot of every tick is played here: 4 mm/s
/// for 1 mm, where it takes 1 mm/s for 3 mm.
fn router() -> Mounting {
    let text = std::fs::read_to_string(root().join("examples/machine.toml")).unwrap();
    let text = text.replace("slow = 1.0 ", "slow = 4.0 ").replace("back_off = 3.0 ", "back_off = 1.0 ");
    Mounting::new(&host_sim::machine::from_toml("machine.toml", &text).unwrap()).unwrap()
}

/// The switches are 3 mm below x, 2 mm below y, and 2.5 mm above z where the machine is switched on. Home is 2 mm away from each, at
/// 2, 2 and -2 mm. It is found to the way of two ticks at 4 mm/s, 8 um, which is five steps: one until the switch is seen, one until the
/// axis is told.
#[test]
fn home_is_where_the_switches_are() {
    let visitors = share(Visitors::new([(15_000, vec![Action::Home])], 2_600_000));
    let (seen, machine) = run(&image(), &router(), visitors.clone(), 4.0, |probe| {
        probe.machine.step_drivers = Some(StepDrivers::default());
        let steps = |mm: f64| (mm * STEPS_PER_MM) as i64;
        probe.machine.ends.low(0, steps(-3.0));
        probe.machine.ends.low(1, steps(-2.0));
        probe.machine.ends.high(2, steps(2.5));
    })
    .unwrap();
    let telemetry = lock(&visitors).telemetry.unwrap();
    assert_eq!((telemetry.machine, telemetry.fault, telemetry.known), (State::Idle, None, 0b111), "{telemetry:?}");
    assert_eq!(seen.known, 0b111);
    let places = telemetry.setpoint.map(|axis| axis.to_mm());
    assert_eq!(places, [2.0, 2.0, -2.0]);
    let drivers = &machine.step_drivers.as_ref().unwrap().drivers;
    for ((driver, at), switch) in drivers.iter().zip([-1.0, 0.0, 0.5]).zip(&machine.switches.happened) {
        let off = driver.position() - (at * STEPS_PER_MM) as i64;
        assert!(off.abs() <= 6, "{off} steps beside {at} mm; {switch:?}");
    }
}

//! What a program does beside moving, in its order and at its place.

use super::{Got, events, good};
use crate::program::Action::{self, *};
use crate::program::item::{
    Compensation as Cutting, Coolant as Cooling, Cutter, PathMode as Mode, Side, Speed, Spindle as Spin, Turning,
};

fn spin(turning: Turning, turns_per_minute: f64) -> Action<'static> {
    Spindle(Spin { turning, speed: Speed::Turns(turns_per_minute / 60.0) })
}

#[test]
fn events_stand_between_the_motions_of_their_blocks() {
    let items = good("g0 x1\nm3 s600 m8 g0 x2 m1\nm5");
    let order: Vec<_> = items.iter().map(|item| item.got.clone()).collect();
    let cooling = Cooling { mist: false, flood: true };
    assert_eq!(
        order,
        [
            Got::Rapid([1.0, 0.0, 0.0]),
            Got::Event(spin(Turning::Clockwise, 600.0)),
            Got::Event(Coolant(cooling)),
            Got::Rapid([2.0, 0.0, 0.0]),
            Got::Event(Stop { optional: true }),
            Got::Event(spin(Turning::Off, 600.0)),
        ]
    );
    assert_eq!(items[1].from, [1.0, 0.0, 0.0]);
    assert_eq!(items[4].place, (2, 18));
}

#[test]
fn tools_spindle_and_coolant() {
    assert_eq!(
        events("m6 t3\nt4\nm0\nm60"),
        [ToolSelect(3), ToolChange(3), ToolSelect(4), Stop { optional: false }, Stop { optional: false }]
    );
    assert_eq!(
        events("s1000 m4\ns2000\nm3"),
        [spin(Turning::Anticlockwise, 1000.0), spin(Turning::Anticlockwise, 2000.0), spin(Turning::Clockwise, 2000.0)]
    );
    // 120 m/min are 2000 mm/s; 10 feet/min are 50.8 mm/s.
    let surface = |speed, most| Spindle(Spin { turning: Turning::Off, speed: Speed::Surface { speed, most } });
    assert_eq!(
        events("g96 s120 d3000\ns60\ng20 g96 s10"),
        [surface(2000.0, Some(50.0)), surface(1000.0, Some(50.0)), surface(50.8, None)]
    );
    let cooling = |mist, flood| Coolant(Cooling { mist, flood });
    assert_eq!(events("m7\nm8\nm9"), [cooling(true, false), cooling(true, true), cooling(false, false)]);
    // What only a person's hands concern is left out.
    assert_eq!(events("m48\nm49\nm50 p1\nm53 p0"), []);
}

#[test]
fn path_modes_and_compensation() {
    let blend = |tolerance, thinning| PathMode(Mode::Blend { tolerance, thinning });
    assert_eq!(
        events("g61\ng61.1\ng64\ng64 p0.5\ng20 g64 p1 q2"),
        [
            PathMode(Mode::Exact),
            PathMode(Mode::Stop),
            blend(None, None),
            blend(Some(0.5), Some(0.5)),
            blend(Some(25.4), Some(50.8))
        ]
    );
    let on = |side, cutter| Compensation(Cutting::On { side, cutter });
    assert_eq!(
        events("g41\ng40\ng42 d8\ng40\ng20 g41.1 d1\ng40\ng42.1 d0.5"),
        [
            on(Side::Left, Cutter::Loaded),
            Compensation(Cutting::Off),
            on(Side::Right, Cutter::Number(8)),
            Compensation(Cutting::Off),
            on(Side::Left, Cutter::Diameter(25.4)),
            Compensation(Cutting::Off),
            on(Side::Right, Cutter::Diameter(12.7)),
        ]
    );
}

#[test]
fn dwells_are_seconds() {
    assert_eq!(events("g4 p0.25\ng0 x1 g4 p2"), [Dwell(0.25), Dwell(2.0)]);
}

#[test]
fn further_axes_go_along_with_the_motion_behind_them() {
    let items = good("g20 f1 g1 x1 a90 u1\na90\ng91 c-45");
    let got: Vec<_> = items.into_iter().map(|item| item.got).collect();
    let further = |axis, to| Got::Event(Further { axis, to });
    let line = Got::Line([25.4, 0.0, 0.0]);
    assert_eq!(got, [further('A', 90.0), further('U', 25.4), line.clone(), line.clone(), further('C', -45.0), line]);
}

//! The whole tick under faults at random ticks of a job, on a machine of step axes and on one of servos.
//!
//! The bar: outputs safe within the tick that sees it (no power, no command, no pulse), the state and the fault reported, and a position that is
//! called known only where it is, asked of a machine that is turned while it has no power.
#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use host_sim::job::Job;
use host_sim::machine;
use host_sim::path::Path;
use host_sim::rig::{Axis, Rig};
use shared::control::{Directive, PathEnd, Start};
use shared::machine::MachineSettings;
use shared::motion::MotionCommand;
use shared::piece::{Header, Order, Piece};
use shared::safety::{Coordinates, End, Fault, State};
use tests::bench::{ask, load, rig};
use tests::random::Random;

const ROUTER: &str = include_str!("../../examples/machine.toml");
const SERVOS: &str = include_str!("../../examples/mill-servos.toml");

/// Random faults on each machine.
const FAULTS: usize = 2_000;

/// A square with round corners, run from rest to rest.
const JOB: &str = "units = \"mm\"\nclosed = false\nrest = true\n[feed]\nrate = 1800.0\n\
[[segment]]\nline = { start = [0.0, 0.0], to = [6.0, 0.0] }\n\
[[segment]]\narc = { to = [8.0, 2.0], centre = [6.0, 2.0], ccw = true }\n\
[[segment]]\nline = { to = [8.0, 6.0] }\n\
[[segment]]\narc = { to = [6.0, 8.0], centre = [6.0, 6.0], ccw = true }\n\
[[segment]]\nline = { to = [1.0, 8.0] }\n";

fn settings(text: &str) -> MachineSettings {
    machine::from_toml("machine.toml", text).unwrap()
}

fn path() -> (Header<f32>, Vec<Piece<f32>>) {
    let job = Job::from_toml("square.toml", JOB).unwrap();
    let path = Path::new(&job, Order::First).unwrap();
    (path.header, path.wire().collect())
}

/// A machine at rest, its job in the queue.
fn ready(settings: &MachineSettings) -> (Rig, Start) {
    let mut bench = rig(settings);
    bench.tick();
    let (header, pieces) = path();
    let start = load(&mut bench, &header, &pieces, Coordinates::Relative);
    (bench, start)
}

/// How many ticks the job takes.
fn length(settings: &MachineSettings) -> usize {
    let (mut bench, start) = ready(settings);
    ask(&mut bench, Directive::Start(start)).unwrap();
    let mut ticks = 0;
    while bench.status.path == PathEnd::Running {
        bench.tick();
        ticks += 1;
        assert!(ticks < 10_000, "{:?}", bench.status);
    }
    assert_eq!(bench.status.path, PathEnd::Finished);
    // It ends 1 mm right of and 8 mm above its start, by what the drives have done.
    for (axis, end) in [(0, 1.0), (1, 8.0)] {
        let resolution = match bench.axes[axis] {
            Axis::Step { per_mm, .. } | Axis::Servo { per_mm, .. } => 1.0 / per_mm,
        };
        for _ in 0..1_000 {
            bench.tick();
        }
        let place = bench.axes[axis].place();
        assert!((place - end).abs() <= resolution, "axis {axis} at {place}");
    }
    ticks
}

/// What goes wrong.
#[derive(Clone, Copy, Debug)]
enum Trouble {
    /// The emergency stop is pressed, and stays so.
    Stop,
    /// It is pressed between two ticks.
    ShortStop,
    /// A limit switch acts, and stays so.
    Limit(u8, End),
    /// A drive reports a fault.
    Drive(u8),
    /// A table is blocked: a servo's only, since nobody sees a step axis that stands.
    Blocked(u8),
    /// The tick is too late for its pulses.
    Late,
}

impl Trouble {
    fn any(random: &mut Random, servos: bool) -> Self {
        let axis = random.whole(0, 1) as u8;
        match random.whole(0, 4) {
            0 => Self::Stop,
            1 => Self::ShortStop,
            2 if servos => Self::Blocked(axis),
            2 => Self::Late,
            3 if servos => Self::Blocked(axis),
            3 => Self::Drive(axis),
            _ if servos => Self::Stop,
            _ => Self::Limit(axis, random.pick(&[End::Low, End::High])),
        }
    }

    fn happen(self, bench: &mut Rig) {
        match self {
            Self::Stop => bench.pins.estop = !bench.pins.estop,
            Self::ShortStop => bench.stopped = true,
            Self::Limit(axis, End::Low) => bench.pins.low ^= 1 << axis,
            Self::Limit(axis, End::High) => bench.pins.high ^= 1 << axis,
            Self::Drive(axis) => bench.pins.drive_fault ^= 1 << axis,
            Self::Blocked(axis) => bench.blocked |= 1 << axis,
            Self::Late => bench.be_late(true),
        }
    }

    fn end(self, bench: &mut Rig) {
        match self {
            Self::ShortStop => {}
            Self::Blocked(_) => bench.blocked = 0,
            Self::Late => bench.be_late(false),
            other => other.happen(bench),
        }
    }

    /// The fault that it is to be reported as; none for the stop, which is a state.
    fn fault(self) -> Option<Fault> {
        match self {
            Self::Stop | Self::ShortStop => None,
            Self::Limit(axis, end) => Some(Fault::Limit { axis, end }),
            Self::Drive(axis) => Some(Fault::Drive { axis }),
            Self::Blocked(axis) => Some(Fault::FollowingError { axis }),
            Self::Late => Some(Fault::LateTick),
        }
    }

    /// Ticks from the cause to the tick that must see it, that one not counted.
    fn delay(self, settings: &MachineSettings) -> usize {
        match self {
            // Bouncing is waited for, as configured; the tick in which it is over is the one that sees it.
            Self::Limit(..) => (settings.debounce * 1024.0).ceil() as usize - 1,
            // As long as it takes to be too far off at this feed: asked of the tables themselves.
            Self::Blocked(_) => usize::MAX,
            _ => 0,
        }
    }
}

fn at_random_ticks(text: &str, servos: bool) {
    let settings = settings(text);
    let ticks = length(&settings);
    let mut random = Random::new(7);
    for number in 0..FAULTS {
        let (mut bench, start) = ready(&settings);
        ask(&mut bench, Directive::Start(start)).unwrap();
        let known = bench.status.known;
        assert_eq!(known, 0, "nothing is known without homing");
        // The last tenth is left, so that every trouble comes in motion.
        for _ in 0..random.whole(0, ticks * 9 / 10) {
            bench.tick();
        }
        let trouble = Trouble::any(&mut random, servos);
        let context = format!("fault {number}, {trouble:?}");
        trouble.happen(&mut bench);
        let mut waited = 0;
        let outputs = loop {
            let before = bench.axes.map(|axis| axis.place());
            let outputs = bench.tick();
            if waited >= trouble.delay(&settings) || !outputs.drives {
                break outputs;
            }
            waited += 1;
            if let Trouble::Blocked(axis) = trouble {
                let axis = usize::from(axis);
                // While it is within its following error, nothing has to be seen; beyond it, the next tick sees it.
                let target = bench.status.position[axis].to_mm();
                let off = (target - before[axis]).abs();
                assert!(off < 2.1 + 0.2, "{context}: {off} mm and nobody sees it");
                if bench.status.path == PathEnd::Finished {
                    break bench.tick();
                }
            }
        };
        if let Trouble::Blocked(_) = trouble
            && bench.status.path == PathEnd::Finished
        {
            // Blocked for less than its following error, up to the end.
            continue;
        }
        let status = bench.status;
        assert!(!outputs.drives, "{context}: power");
        assert_eq!(outputs.commands.levels, [0.0; 3], "{context}");
        assert!(!bench.is_played() && bench.pulses == 0, "{context}: pulses");
        assert_eq!(status.fault, trouble.fault(), "{context}");
        let expected = if trouble.fault().is_some() { State::Fault } else { State::EStop };
        assert_eq!(status.machine, expected, "{context}");
        let end = trouble.fault().map_or(PathEnd::Stopped, PathEnd::Faulted);
        assert_eq!(status.path, end, "{context}");

        // Somebody moves the axes meanwhile; the encoders see it, and nobody else does.
        bench.axes[0].turn(1.25);
        for _ in 0..200 {
            let outputs = bench.tick();
            assert!(!outputs.drives && bench.pulses == 0, "{context}: it comes back by itself");
        }
        assert_eq!(
            ask(&mut bench, Directive::Acknowledge).is_ok(),
            matches!(trouble, Trouble::ShortStop | Trouble::Late | Trouble::Limit(..) | Trouble::Blocked(_)),
            "{context}"
        );
        trouble.end(&mut bench);
        for _ in 0..200 {
            bench.tick();
        }
        if bench.status.machine != State::Idle {
            assert_eq!(ask(&mut bench, Directive::Acknowledge), Ok(()), "{context}");
        }
        // Under power again nothing jumps: the axes stay where they are.
        let before = bench.axes.map(|axis| axis.place());
        for _ in 0..100 {
            let outputs = bench.tick();
            assert!(outputs.drives, "{context}: {:?}", bench.status);
        }
        for (before, axis) in before.into_iter().zip(&bench.axes) {
            let (Axis::Servo { per_mm, .. } | Axis::Step { per_mm, .. }) = *axis;
            assert!((axis.place() - before).abs() <= 1.5 / per_mm, "{context}: {before} {}", axis.place());
        }
    }
}

#[test]
fn faults_at_random_ticks_with_step_axes() {
    at_random_ticks(ROUTER, false);
}

#[test]
fn faults_at_random_ticks_with_servos() {
    at_random_ticks(SERVOS, true);
}

/// A hold in the middle stops on the path and keeps power; a cancel ends the path there, and the next one begins where the machine stands.
#[test]
fn hold_resume_and_cancel_through_the_whole_tick() {
    let settings = settings(ROUTER);
    let (mut bench, start) = ready(&settings);
    ask(&mut bench, Directive::Start(start)).unwrap();
    for _ in 0..150 {
        bench.tick();
    }
    ask(&mut bench, Directive::Motion(MotionCommand::Hold)).unwrap();
    for _ in 0..1_000 {
        bench.tick();
    }
    let held = bench.axes.map(|axis| axis.place());
    assert_eq!(bench.status.machine, State::Hold);
    for _ in 0..100 {
        assert!(bench.tick().drives);
        assert_eq!(bench.pulses, 0);
    }
    ask(&mut bench, Directive::Motion(MotionCommand::Resume)).unwrap();
    for _ in 0..50 {
        bench.tick();
    }
    assert!(bench.axes[0].place() > held[0]);
    ask(&mut bench, Directive::Motion(MotionCommand::Cancel)).unwrap();
    for _ in 0..1_000 {
        bench.tick();
    }
    assert_eq!((bench.status.machine, bench.status.path), (State::Idle, PathEnd::Cancelled));
    let left = bench.axes.map(|axis| axis.place());
    let (header, pieces) = path();
    let start = load(&mut bench, &header, &pieces, Coordinates::Relative);
    ask(&mut bench, Directive::Start(start)).unwrap();
    while bench.status.path == PathEnd::Running {
        bench.tick();
    }
    for _ in 0..3 {
        bench.tick();
    }
    for (axis, way) in [(0, 1.0), (1, 8.0)] {
        let place = bench.axes[axis].place();
        assert!((place - left[axis] - way).abs() <= 1.0 / 640.0, "axis {axis} from {} to {place}", left[axis]);
    }
}

/// A feed that the drive's pulses do not allow: the machine stops for it, instead of losing steps. 187 pulses of 5 us fit into a tick, so
/// x goes 300 mm/s at most.
#[test]
fn an_axis_that_cannot_keep_up_is_a_fault() {
    for (feed, keeps) in [(290.0, true), (310.0, false)] {
        let text =
            JOB.replace("rate = 1800.0", &format!("rate = {:.1}", feed * 60.0)).replace("[6.0, 0.0]", "[606.0, 0.0]");
        let text = text.split("[[segment]]\narc").next().unwrap();
        let job = Job::from_toml("fast.toml", text).unwrap();
        let path = Path::new(&job, Order::First).unwrap();
        let pieces: Vec<_> = path.wire().collect();
        let mut bench = rig(&settings(ROUTER));
        bench.tick();
        let start = load(&mut bench, &path.header, &pieces, Coordinates::Relative);
        ask(&mut bench, Directive::Start(start)).unwrap();
        while bench.status.path == PathEnd::Running {
            bench.tick();
        }
        let end = if keeps { PathEnd::Finished } else { PathEnd::Faulted(Fault::Steps { axis: 0 }) };
        assert_eq!(bench.status.path, end, "{feed} mm/s");
    }
}

/// The button's interrupt stops the pulses by itself, so the next tick finds the ring not played on: that is a stop and no fault.
#[test]
fn a_ring_that_a_stop_has_stopped_is_not_late() {
    let settings = settings(ROUTER);
    for ticks in [3, 50, 200] {
        let (mut bench, start) = ready(&settings);
        ask(&mut bench, Directive::Start(start)).unwrap();
        for _ in 0..ticks {
            bench.tick();
        }
        bench.stopped = true;
        bench.be_late(true);
        let outputs = bench.tick();
        assert!(!outputs.drives);
        let status = bench.status;
        assert_eq!((status.machine, status.fault, status.path), (State::EStop, None, PathEnd::Stopped));
    }
}

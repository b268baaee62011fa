//! Everything that takes the drives' power, at random instants in motion: the outputs at the pins, not what the controller says of them.

mod common;

use board::jobs::diagonal;
use board::line::{JobTalker, lock, share};
use board::machine::servo_axes::{MILL, ServoAxes};
use board::machine::step_drivers::{SLOTS, StepDrivers};
use board::machine::wiring::Fault as Cause;
use board::machine::{Machine, Mounting};
use board::probe::{Seen, Status};
use board::run::run;
use common::{image, machine_with, random, root, start_of};
use host_sim::job::Job;
use host_sim::path::Path;
use shared::control::PathEnd;
use shared::link::Ending;
use shared::piece::{Header, Order, Piece};
use shared::safety::{End, Fault, State};

/// A tick in ns, rounded up.
const TICK: u64 = 976_563;

/// An interrupt of the tick takes no longer than this, in ns: 36 000 instructions of 4 ns, `xtask/src/budget.rs`.
const INTERRUPT: u64 = 144_000;

/// The code of a converter for no command.
const NO_COMMAND: u16 = 2_048;

/// What an instant came to.
struct Stop {
    seen: Seen,
    machine: Machine,
    /// When it happened, in ns.
    at: u64,
    ended: Option<Ending>,
}

impl Stop {
    /// When all drives had lost their power, in ns after the cause.
    fn off_after(&self) -> u64 {
        self.machine.enables.off_since().expect("the drives have power") - self.at
    }

    /// When the controller said so, in ns after the cause, and what.
    fn told(&self) -> (u64, Status) {
        let wrong = |state: u32| state == State::Fault as u32 || state == State::EStop as u32;
        let told = self.seen.statuses.iter().find(|(_, at, status)| *at >= self.at && wrong(status.machine));
        let &(_, at, status) = told.expect("nothing is wrong");
        (at - self.at, status)
    }
}

/// A job in which something happens so many ns after its first tick; it is looked at for `more` ns after that.
fn stop(
    mounting: &Mounting,
    (header, pieces): (Header<f32>, Vec<Piece<f32>>),
    (after, cause): (u64, Cause),
    more: u64,
) -> Stop {
    let talker = share(JobTalker::new(header, pieces));
    let (seen, machine) = run(&image(), mounting, talker.clone(), 20.0, |probe| {
        match &mut probe.machine.servo_axes {
            Some(axes) => *axes = ServoAxes::new(MILL).unwrap().recording(),
            None => probe.machine.step_drivers = Some(StepDrivers::default()),
        }
        probe.inject_after(after, cause);
        probe.end_after(after + more);
    })
    .unwrap();
    let &[(at, happened, true)] = &*machine.switches.happened else { panic!("{after}: it did not happen") };
    assert_eq!(happened, cause);
    let ended = lock(&talker).ended;
    Stop { seen, machine, at, ended }
}

/// Step axes at 900 000 steps/s each, with all switches.
fn on_steps(after: u64, cause: Cause, more: u64) -> Stop {
    let stop = stop(&machine_with("mill-steps.toml"), diagonal(900_000.0), (after, cause), more);
    let drivers = stop.machine.step_drivers.as_ref().unwrap();
    let way: i64 = drivers.drivers.iter().map(|driver| driver.position().abs()).sum();
    // Three axes, less what was still to come: the first word is played a tick after the first setpoint.
    assert!(way as f64 > 2.6e-3 * after as f64 - 6_000.0, "{after}: {way} steps, in motion before");
    stop
}

/// The last pulse is past within a tick of the power's end.
fn pulses_end(stop: &Stop, after: u64) {
    let drivers = stop.machine.step_drivers.as_ref().unwrap();
    let &(off, false) = drivers.enabled.last().unwrap() else { panic!("{after}: still enabled") };
    let &(_, last, _) = drivers.steps.last().unwrap();
    assert!(last <= off + SLOTS, "{after}: off in slot {off}, last step in {last}");
}

/// Lines and arcs, some seconds long.
fn bracket() -> (Header<f32>, Vec<Piece<f32>>) {
    let job = Job::read(root().join("examples/bracket.toml").to_str().unwrap()).unwrap();
    let path = Path::new(&job, Order::First).unwrap();
    (path.header, path.wire().collect())
}

/// A bracket on the mill with servo drives, and all switches.
fn on_servos(after: u64, cause: Cause, more: u64) -> Stop {
    let stop = stop(&machine_with("mill-servos.toml"), bracket(), (after, cause), more);
    assert!(stop.seen.ticks.len() as u64 >= after / TICK, "in motion before");
    stop
}

/// The drives are commanded to nothing from the tick on that took note.
fn commands_are_zero(stop: &Stop) {
    let exchanges = stop.machine.servo_axes.as_ref().unwrap().exchanges.as_ref().unwrap();
    let (interrupt, ..) = stop.seen.statuses.last().unwrap();
    let rest = &exchanges[*interrupt as usize..];
    assert!(!rest.is_empty() && rest.iter().flatten().all(|exchange| exchange.code == NO_COMMAND), "{rest:?}");
}

/// The emergency stop takes the power 42 ns later, seen between two instructions, which is less than any interrupt takes to begin, and by no instruction: the program
/// notices in its next tick. The pulses end then.
#[test]
fn the_emergency_stop_needs_no_program() {
    for after in random(2_000_000..40_000_000).take(6) {
        let stop = on_steps(after, Cause::EmergencyStop, 3 * TICK);
        assert!(stop.off_after() <= 60, "{after}: off {} ns later", stop.off_after());
        pulses_end(&stop, after);
        let (told, status) = stop.told();
        assert!(told <= TICK + INTERRUPT, "{after}: {told} ns");
        assert_eq!((status.machine, status.path), (State::EStop as u32, PathEnd::Stopped), "{after}");
    }
    for after in random(2_000_000..1_000_000_000).take(6) {
        let stop = on_servos(after, Cause::EmergencyStop, 100 * TICK);
        assert!(stop.off_after() <= 60, "{after}: off {} ns later", stop.off_after());
        let (told, status) = stop.told();
        assert!(told <= TICK + INTERRUPT, "{after}: {told} ns");
        assert_eq!(status.path, PathEnd::Stopped, "{after}");
        commands_are_zero(&stop);
        // The host hears of it.
        assert_eq!(stop.ended, Some(Ending::Stopped), "{after}");
    }
}

/// The board's button takes the power a few instructions later, and the pulses with it.
#[test]
fn the_button_takes_a_few_instructions() {
    for after in random(2_000_000..40_000_000).take(6) {
        let stop = on_steps(after, Cause::Button, 3 * TICK);
        assert!(stop.off_after() <= 2_000, "{after}: off {} ns later", stop.off_after());
        pulses_end(&stop, after);
        let (told, status) = stop.told();
        assert!(told <= TICK + INTERRUPT, "{after}: {told} ns");
        assert_eq!((status.machine, status.path), (State::EStop as u32, PathEnd::Stopped), "{after}");
    }
}

/// A drive's fault acts in the tick that sees it.
#[test]
fn a_drives_fault_takes_a_tick() {
    for (after, axis) in random(2_000_000..40_000_000).zip(0..3) {
        let stop = on_steps(after, Cause::Drive(axis), 3 * TICK);
        assert!(stop.off_after() <= TICK + INTERRUPT, "{after}: off {} ns later", stop.off_after());
        pulses_end(&stop, after);
        let (told, status) = stop.told();
        assert!(told <= TICK + INTERRUPT, "{after}: {told} ns");
        let fault = Fault::Drive { axis: axis as u8 };
        assert_eq!((status.fault, status.path), (Some(fault), PathEnd::Faulted(fault)), "{after}");
    }
    for (after, axis) in random(2_000_000..1_000_000_000).zip([0, 1, 0, 1]) {
        let stop = on_servos(after, Cause::Drive(axis), 100 * TICK);
        assert!(stop.off_after() <= TICK + INTERRUPT, "{after}: off {} ns later", stop.off_after());
        commands_are_zero(&stop);
        assert_eq!(stop.ended, Some(Ending::Fault(Fault::Drive { axis: axis as u8 })), "{after}");
    }
}

/// A limit switch acts after its debounce of 5 ms, which is six ticks, and not before.
#[test]
fn a_limit_switch_acts_after_its_debounce() {
    let ends =
        [(Cause::LowLimit(0), 0, End::Low), (Cause::HighLimit(1), 1, End::High), (Cause::LowLimit(2), 2, End::Low)];
    for (after, (cause, axis, end)) in random(2_000_000..30_000_000).zip(ends) {
        let stop = on_steps(after, cause, 9 * TICK);
        let off = stop.off_after();
        assert!(off > 5 * (TICK - 1) && off <= 6 * TICK + INTERRUPT, "{after}: off {off} ns later");
        pulses_end(&stop, after);
        let (_, status) = stop.told();
        let fault = Fault::Limit { axis, end };
        assert_eq!((status.fault, status.path), (Some(fault), PathEnd::Faulted(fault)), "{after}");
    }
}

/// A screw that does not turn: the axis falls behind by its following error of 2 mm, and the tick that sees it takes the power.
#[test]
fn a_blocked_screw_is_a_following_error() {
    let mut found = 0;
    for (after, axis) in random(2_000_000..1_000_000_000).zip([0, 1, 0, 1, 0, 1]) {
        let stop = on_servos(after, Cause::Blocked(axis), 600 * TICK);
        // An axis that does not move at that time is not seen to be blocked.
        let Some(off) = stop.machine.enables.off_since() else { continue };
        found += 1;
        let (told, status) = stop.told();
        let (told, off) = (stop.at + told, off);
        assert!(off <= told && told - off <= INTERRUPT, "{after}: off at {off} ns, told at {told} ns");
        let fault = Fault::FollowingError { axis: axis as u8 };
        assert_eq!((status.fault, status.path), (Some(fault), PathEnd::Faulted(fault)), "{after}");
        assert_eq!(stop.ended, Some(Ending::Fault(fault)), "{after}");
        commands_are_zero(&stop);
        // The setpoint went on by 2 mm, or by less than a tick's way more, from where the encoder stands: at 100 mm/s that is 0.1 mm.
        let interrupt = stop.seen.statuses.iter().find(|(_, _, status)| status.fault.is_some()).unwrap().0;
        let exchanges = stop.machine.servo_axes.as_ref().unwrap().exchanges.as_ref().unwrap();
        let counter = f64::from(exchanges[interrupt as usize][axis].counter as i16) / 800.0;
        let first = i64::from(stop.seen.idle);
        let setpoint = |interrupt: i64| {
            let tick = &stop.seen.ticks[(interrupt - first) as usize];
            f64::from(tick.setpoint[axis]) / shared::fixed::UNITS_PER_MM
        };
        let (header, pieces) = bracket();
        let start = start_of(&header, &pieces)[axis].to_mm();
        let behind = |ticks: i64| (setpoint(i64::from(interrupt) - ticks) - start - counter).abs();
        assert!(behind(1) > 2.0 - 0.002 && behind(2) < 2.0 + 0.002, "{after}: {} and {} mm", behind(1), behind(2));
    }
    assert!(found >= 3, "{found} of 6 were in motion");
}

/// With all of it there and nothing wrong, a job runs.
#[test]
fn switches_at_rest_stop_nothing() {
    let (header, pieces) = board::jobs::job(board::jobs::Kind::Line, Order::First);
    let run = board::run::run_job(&image(), &machine_with("mill-servos.toml"), header, pieces, 2.0, |_| {}).unwrap();
    assert_eq!(run.machine.enables.on, [true, true, false]);
}

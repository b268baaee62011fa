//! Runs the tick over a path, in the controller's own precision, and measures what comes out.

mod outcome;
mod queue;
mod script;

pub use outcome::{Outcome, SETTLING_TICKS, Sample};
pub use queue::Queue;
pub use script::{Action, Carried, Entry, Script, percent_from};

use shared::executor::{Executor, State};
use shared::fixed::Position;
use shared::hash::SetpointHash;

use crate::job::Units;
use crate::path::Path;
use crate::plant::Measured;
use outcome::Gauge;

/// What a run tells of itself, whoever looks on.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Ticks until the last point, counting the one that reached it; or until nothing moves any more.
    pub ticks: u64,
    /// The time at which the last point was reached, in s: the ticks less what the last one did not need.
    pub time: f64,
    /// Of all setpoints.
    pub hash: SetpointHash,
    /// How it ended: finished, unless the script says otherwise.
    pub state: State,
    /// What was done of the script.
    pub carried: Vec<Carried>,
}

/// Runs the f32 tick over `path` and shows `look` the executor after every tick. Returns none where it never ends.
pub fn run(path: &Path, look: impl FnMut(u64, &Executor<f32>)) -> Option<Run> {
    run_script(path, &Script::default(), look)
}

/// The same while `script` happens. Ends where nothing moves and nothing is to happen any more.
pub fn run_script(path: &Path, script: &Script, mut look: impl FnMut(u64, &Executor<f32>)) -> Option<Run> {
    let mut queue = Queue::new(&path.header, path.wire(), script.queue.unwrap_or(usize::MAX))?;
    let mut executor = Executor::new(shared::TICK, path.start());
    let mut carried = Vec::new();
    let mut entries = script.entries.clone();
    entries.sort_by(|a, b| a.time.total_cmp(&b.time));
    let mut entries = entries.into_iter().peekable();
    let mut hash = SetpointHash::new();
    let (mut ticks, mut fed_from) = (0_u64, 0.0);
    executor.begin(queue.motion());
    loop {
        let now = ticks as f64 * f64::from(shared::TICK);
        while let Some(Entry { action, .. }) = entries.next_if(|entry| entry.time <= now) {
            let outcome = match action {
                Action::Command(command) => executor.command(command),
                Action::Starve(seconds) => {
                    fed_from = now + seconds;
                    Ok(())
                }
            };
            carried.push(Carried::new(ticks + 1, action, outcome));
        }
        if now >= fed_from {
            queue.fill();
        }
        let waits = entries.peek().is_some() || now < fed_from;
        let ends = match executor.state() {
            State::Finished | State::Cancelled => true,
            State::Starved => !waits && queue.is_complete(),
            state => !waits && !state.is_moving(),
        };
        if ends {
            break;
        }
        hash.add(executor.tick(&mut queue));
        ticks += 1;
        look(ticks, &executor);
    }
    let state = executor.state();
    let time = (ticks as f64) * f64::from(shared::TICK) - f64::from(executor.spare_time());
    (state != State::Starved).then_some(Run { ticks, time, hash, state, carried })
}

/// Simulates `path`: runs the tick, moves the axes by `drive`, and shows every sample to `look`.
///
/// `drive` gets each setpoint and returns what is to be seen at the end of its tick: [`Plant::advance`](crate::plant::Plant::advance),
/// or [`Measured::ideal`] for a machine that is always where its setpoint is. The first `settling` ticks are left
/// out of the maxima. Returns none where the path never ends.
pub fn simulate(
    path: &Path,
    units: Units,
    settling: u64,
    drive: impl FnMut(Position) -> Measured,
    look: impl FnMut(&Sample),
) -> Option<Outcome> {
    simulate_script(path, &Script::default(), units, settling, drive, look)
}

/// The same while `script` happens.
pub fn simulate_script(
    path: &Path,
    script: &Script,
    units: Units,
    settling: u64,
    mut drive: impl FnMut(Position) -> Measured,
    mut look: impl FnMut(&Sample),
) -> Option<Outcome> {
    let mut gauge = Gauge::new(path, settling);
    let run = run_script(path, script, |tick, executor| {
        let measured = drive(executor.setpoint());
        look(&gauge.measure(tick, executor, &measured));
    })?;
    Some(gauge.outcome(&run, units))
}

/// All setpoints of a path, as the controller puts them out.
pub fn setpoints(path: &Path) -> Option<Vec<Position>> {
    let mut all = Vec::new();
    run(path, |_, executor| all.push(executor.setpoint()))?;
    Some(all)
}

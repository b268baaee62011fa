//! Numbers for people: from the mailbox to a telemetry report.

use micromath::F32Ext;
use shared::executor::State;
use shared::fixed::{Position, UNITS_PER_MM};
use shared::link::{MotionState, Telemetry};

use crate::mailbox::{MAILBOX, Snapshot};
use crate::stack;

/// Remembers the position of the report before, for a speed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reporter {
    uptime: u32,
    setpoint: Position,
}

/// What the tick is about, as a host is told. `loading` is what only the link knows.
pub fn motion_state(snapshot: &Snapshot, loading: bool) -> MotionState {
    if MAILBOX.is_stopped() {
        return MotionState::Stopped;
    }
    let known = [
        State::Run,
        State::Starved,
        State::Braking,
        State::Holding,
        State::Held,
        State::Cancelling,
        State::Cancelled,
        State::Finished,
    ];
    match known.into_iter().find(|&state| state as u32 == snapshot.state) {
        None | Some(State::Finished | State::Cancelled) if loading => MotionState::Loading,
        None => MotionState::Idle,
        Some(state) => state.into(),
    }
}

impl Reporter {
    /// How it goes, without what the link knows.
    pub fn report(&mut self, snapshot: &Snapshot, loading: bool) -> Telemetry {
        let uptime = MAILBOX.uptime();
        let seconds = uptime.wrapping_sub(self.uptime).max(1) as f32 * shared::TICK;
        let mut square = 0.0;
        for (now, before) in snapshot.setpoint.into_iter().zip(self.setpoint) {
            let way = now.0.wrapping_sub(before.0) as f32 * (1.0 / UNITS_PER_MM) as f32;
            square += way * way;
        }
        *self = Self { uptime, setpoint: snapshot.setpoint };
        Telemetry {
            state: motion_state(snapshot, loading),
            tick: snapshot.ticks,
            pieces: snapshot.pieces,
            setpoint: snapshot.setpoint,
            // micromath's root is off by up to 6 %; it serves a display.
            speed: F32Ext::sqrt(square) / seconds,
            cycles: snapshot.cycles,
            worst_cycles: MAILBOX.worst_cycles(),
            stack: stack::high_water(),
            ..Telemetry::default()
        }
    }
}

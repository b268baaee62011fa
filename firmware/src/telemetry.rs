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
    match snapshot.state {
        state if state == State::Run as u32 => MotionState::Running,
        state if state == State::Starved as u32 => MotionState::Starved,
        _ if loading => MotionState::Loading,
        state if state == State::Finished as u32 => MotionState::Finished,
        _ => MotionState::Idle,
    }
}

impl Reporter {
    /// How it goes. `queued` is the number of pieces in the queue.
    pub fn report(&mut self, snapshot: &Snapshot, loading: bool, queued: u16, broken_frames: u32) -> Telemetry {
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
            queued,
            worst_cycles: MAILBOX.worst_cycles(),
            stack: stack::high_water(),
            broken_frames,
        }
    }
}

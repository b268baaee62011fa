//! Numbers for people: from the mailbox to a telemetry report.

use micromath::F32Ext;
use shared::control::Status;
use shared::fixed::{Position, UNITS_PER_MM};
use shared::link::Telemetry;

use crate::hardware::AXES;
use crate::mailbox::MAILBOX;
use crate::stack;

/// Remembers the position of the report before, for a speed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Reporter {
    uptime: u32,
    position: Position,
}

impl Reporter {
    /// How it goes, without what the endpoint knows.
    pub fn report(&mut self, status: &Status<AXES>, axes: u8, loading: bool) -> Telemetry {
        let uptime = MAILBOX.uptime();
        let seconds = uptime.wrapping_sub(self.uptime).max(1) as f32 * shared::TICK;
        let mut square = 0.0;
        for (now, before) in status.position.into_iter().zip(self.position) {
            let way = now.0.wrapping_sub(before.0) as f32 * (1.0 / UNITS_PER_MM) as f32;
            square += way * way;
        }
        *self = Self { uptime, position: status.position };
        let [cycles, worst_cycles] = MAILBOX.cycles();
        Telemetry {
            // micromath's root is off by up to 6 %, and not 0 of 0; it serves a display.
            speed: if square > 0.0 { F32Ext::sqrt(square) / seconds } else { 0.0 },
            cycles,
            worst_cycles,
            stack: stack::high_water(),
            ..status.telemetry(axes, loading)
        }
    }
}

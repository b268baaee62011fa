//! Servo axes: drives at the analog commands, motors and tables of [`host_sim::plant`], and encoders whose edges the timers count.
//!
//! A drive looks at its command where the controller has stored a new one, which it does once a tick, and holds it until the next:
//! the plant passes a tick for each. The way of that tick is shown by the encoder in single edges, evenly spread between the
//! store and the next tick. They go through the timer's own input filter and quadrature decoder, as the chip's do.
//!
//! Not modelled: noise on the analog line, the converter's settling time (3 us), and edges that are spread by the true velocity.

use std::collections::VecDeque;

use host_sim::plant::Plant;
use host_sim::plant::axis::{Axis, Command};
use rigless::device::Level;
use rigless::emulator::{Access, AccessKind};
use rigless::machine::stm32h743_bench::Stm32h743Bench;
use rigless::mcu::Mcu;
use rigless::soc::stm32h743::peripherals::tim::{Channel, General, TIMERS, Tim};
use rigless::time::VirtualNanos;

use super::wiring::{COMMANDS, ENCODERS, Encoder};
use crate::Error;

/// The mill that `examples/mill-servos.toml` is set for.
pub const MILL: &str = include_str!("mill-plant.toml");

/// The velocity that a drive takes the largest code for, in mm/s.
pub const FULL_COMMAND: f64 = 800.0;

/// The code for rest: half scale.
const ZERO: i32 = 2_048;

/// A tick, in ns.
const TICK: f64 = 976_562.5;

/// The last edge of a tick is past so long before the next one, in ns.
const MARGIN: f64 = 6_000.0;

/// What one tick had to do with an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Exchange {
    /// The counter as the controller read it.
    pub counter: u16,
    /// The code that the controller gave out then.
    pub code: u16,
}

/// The velocity that a drive takes a code for, in mm/s.
pub fn velocity(code: u16) -> f64 {
    f64::from(i32::from(code) - ZERO) * (FULL_COMMAND / 2_047.0)
}

/// One axis.
struct Wheel {
    wires: Encoder,
    axis: Box<dyn Axis + Send>,
    /// The encoder's counts at power-up, and as its lines show them since.
    datum: i32,
    shown: i32,
    /// Edges to come: when, and whether upwards.
    edges: VecDeque<(u64, bool)>,
    /// The place of the timer in the part; the spare stands there while the timer itself is driven.
    timer: usize,
    spare: Tim<General>,
    /// What was read since the last command.
    read: Option<u16>,
    /// Whether the screw is blocked.
    blocked: bool,
}

/// All servo axes of the machine.
pub struct ServoAxes {
    wheels: Vec<Wheel>,
    /// When the tick began, in ns.
    began: u64,
    /// Every tick's exchange with x and y, where they are kept: see [`ServoAxes::recording`].
    pub exchanges: Option<Vec<[Exchange; 2]>>,
}

impl ServoAxes {
    /// The axes of a machine in TOML, at rest at 0.
    pub fn new(plant: &str) -> Result<Self, Error> {
        let plant = Plant::from_toml(plant, f64::from(shared::TICK)).map_err(|error| Error::new(error.to_string()))?;
        let wheels = ENCODERS.iter().zip(plant.axes()).map(|(&wires, driven)| {
            let timer = TIMERS.iter().position(|timer| timer.instance == wires.timer);
            let timer = timer.ok_or_else(|| Error::new(format!("the part has no {}", wires.timer)))?;
            let mut axis = driven.detached();
            let datum = axis.rest_at(0.0).counts;
            let spare = Tim::new(TIMERS[timer]);
            Ok(Wheel { wires, axis, datum, shown: 0, edges: VecDeque::new(), timer, spare, read: None, blocked: false })
        });
        Ok(Self { wheels: wheels.collect::<Result<_, Error>>()?, began: 0, exchanges: None })
    }

    /// Keeps every tick's exchange, for a run that ends.
    pub fn recording(self) -> Self {
        Self { exchanges: Some(Vec::new()), ..self }
    }

    /// Blocks the screw of an axis, or lets it go.
    pub fn block(&mut self, axis: usize, is_blocked: bool) {
        if let Some(wheel) = self.wheels.get_mut(axis) {
            wheel.blocked = is_blocked;
            if is_blocked {
                wheel.edges.clear();
            }
        }
    }

    /// Takes note of an access of the core; the drives of `on` have power.
    pub fn see(&mut self, access: &Access, value: u64, on: [bool; 3]) {
        match access.kind {
            AccessKind::Write if access.address == COMMANDS => {
                self.command(access.value as u32, access.virtual_time.0, on);
            }
            AccessKind::Read => {
                for (nth, wheel) in self.wheels.iter_mut().enumerate() {
                    if access.address == wheel.wires.counter {
                        wheel.read = Some(value as u16);
                        if nth == 0 {
                            self.began = access.virtual_time.0;
                        }
                    }
                }
            }
            _ => {}
        }
    }

    /// The controller gives out new commands: the drives follow them for a tick. Before the first reading of an encoder nobody
    /// closes a loop, and nothing moves.
    fn command(&mut self, codes: u32, now: u64, on: [bool; 3]) {
        let mut exchange = [Exchange::default(); 2];
        for (nth, (wheel, exchange)) in self.wheels.iter_mut().zip(&mut exchange).enumerate() {
            let Some(counter) = wheel.read.take() else { return };
            *exchange = Exchange { counter, code: (codes >> (16 * nth)) as u16 & 0xfff };
            let asked = if on.get(nth) == Some(&true) { velocity(exchange.code) } else { 0.0 };
            if !wheel.blocked {
                wheel.turn(asked, now, self.began);
            }
        }
        if let Some(exchanges) = &mut self.exchanges {
            exchanges.push(exchange);
        }
    }

    /// When the next edge comes.
    pub fn next(&self) -> Option<u64> {
        self.wheels.iter().filter_map(|wheel| wheel.edges.front()).map(|&(at, _)| at).min()
    }

    /// Shows the edges that are due.
    pub fn act(&mut self, board: &mut Stm32h743Bench, now: VirtualNanos) {
        for wheel in &mut self.wheels {
            while let Some((_, up)) = wheel.edges.pop_front_if(|(at, _)| *at <= now.0) {
                wheel.show(board, now, up);
            }
        }
    }
}

impl Wheel {
    fn turn(&mut self, velocity: f64, now: u64, began: u64) {
        let counts = self.axis.advance(Command::Velocity(velocity), f64::from(shared::TICK)).counts;
        let pending: i32 = self.edges.iter().map(|&(_, up)| if up { 1 } else { -1 }).sum();
        let way = counts.wrapping_sub(self.datum).wrapping_sub(self.shown).wrapping_sub(pending);
        let left = began as f64 + TICK - MARGIN - now as f64;
        for k in 0..way.unsigned_abs() {
            let at = now as f64 + left * f64::from(k + 1) / f64::from(way.unsigned_abs());
            self.edges.push_back((at as u64, way > 0));
        }
    }

    /// One edge: one of both lines changes.
    fn show(&mut self, board: &mut Stm32h743Bench, now: VirtualNanos, up: bool) {
        let before = lines(self.shown);
        self.shown = self.shown.wrapping_add(if up { 1 } else { -1 });
        let after = lines(self.shown);
        for (nth, pad) in self.wires.pads.into_iter().enumerate() {
            if before[nth] == after[nth] {
                continue;
            }
            let function = pad.drive(board, now, after[nth]);
            // The part's models leave the way from a pin to its timer to the board.
            if function == Some(self.wires.function) {
                self.drive_timer(board, now, nth as u8 + 1, Level::from(after[nth]));
            }
        }
    }

    fn drive_timer(&mut self, board: &mut Stm32h743Bench, now: VirtualNanos, channel: u8, level: Level) {
        let (Some(channel), Some(slot)) = (Channel::new(channel), board.mcu.bus().slot_of(self.wires.timer)) else {
            return;
        };
        // Model and registers are both the part's, and only one of them can be borrowed from it.
        std::mem::swap(&mut board.mcu.tim[self.timer], &mut self.spare);
        let (registers, mut context) = board.mcu.bus_mut().drive(now, slot);
        self.spare.drive_input(channel, level, registers, &mut context);
        std::mem::swap(&mut board.mcu.tim[self.timer], &mut self.spare);
    }
}

/// Lines A and B at a count: A leads upwards.
fn lines(count: i32) -> [bool; 2] {
    let phase = count.rem_euclid(4);
    [phase == 1 || phase == 2, phase >= 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One line changes at a time, upwards A before B, and four counts are a period; so has every quadrature encoder.
    #[test]
    fn a_leads_upwards() {
        assert_eq!([0, 1, 2, 3].map(lines), [[false, false], [true, false], [true, true], [false, true]]);
        for count in -9..9 {
            let changed = (0..2).filter(|&line| lines(count)[line] != lines(count + 1)[line]).count();
            assert_eq!((changed, lines(count)), (1, lines(count + 4)));
        }
    }

    /// Half scale is rest, and the largest code the full command.
    #[test]
    fn codes_are_velocities() {
        assert_eq!((velocity(2_048), velocity(4_095), velocity(1)), (0.0, FULL_COMMAND, -FULL_COMMAND));
    }
}

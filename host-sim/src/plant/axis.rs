//! What every modelled axis does, whatever turns its screw.
//!
//! An axis knows no tick and no controller: it takes a command that is held for a duration, lets that time pass, and says what its
//! encoder and its table show at the end. A simulator calls it once a tick; a virtual board calls it whenever a pin changes, with
//! the time since the last change.

/// What is at the drive's input for the duration of a call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// A velocity in mm/s, for a drive that closes a velocity loop.
    Velocity(f64),
    /// An acceleration in mm/s^2, for a drive that makes torque; scaled by the nominal inertia of the axis.
    Acceleration(f64),
    /// So many step pulses, negative for the negative direction, evenly spread over the duration: the k-th of n stands at
    /// (k + 1/2)/n of it. With a duration of zero they come at once, so a pin's edge is `Steps(1)` for 0 s.
    Steps(i32),
}

/// What an axis shows at the end of a call.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// The encoder's counter; it wraps. Without an encoder, the whole microsteps of the rotor's true position.
    pub counts: i32,
    /// Where the table truly stands, in mm.
    pub position: f64,
    /// Whether the drive was at its limit of torque in this call.
    pub saturated: bool,
    /// Full steps by which a stepping motor has fallen away from its commands, since the start; a multiple of four once it settles.
    pub lost_steps: i32,
}

/// A drive, its motor, screw and table.
///
/// A command that the drive does not understand (steps for a servo drive, a velocity for a stepping one) leaves it without input:
/// a servo drive then sees the command 0, a stepping drive no pulse.
pub trait Axis {
    /// Puts the axis at rest at `position` mm, with nothing lost, no time owed and its counter counting from coordinate zero.
    fn rest_at(&mut self, position: f64) -> Reading;

    /// Holds `command` for `duration` seconds and returns what is to be seen then.
    fn advance(&mut self, command: Command, duration: f64) -> Reading;
}

/// An incremental encoder: whole counts from coordinate zero, rounded towards minus infinity as a quadrature counter does.
#[derive(Clone, Copy, Debug)]
pub struct Encoder {
    /// Counts per mm of travel.
    pub counts_per_mm: f64,
    /// Whether it sits on the table (a scale) or on the motor's shaft.
    pub on_table: bool,
}

impl Encoder {
    /// The counter at `position` mm; wraps beyond 32 bits, as hardware does.
    pub fn counts(&self, position: f64) -> i32 {
        whole_below(position * self.counts_per_mm) as i32
    }
}

/// Backlash without a spring: the nut carries the table along as soon as its play is used up, and the table keeps still otherwise.
#[derive(Clone, Copy, Debug)]
pub struct Play {
    /// Half of the play in mm.
    half: f64,
    /// Where the table stands.
    table: f64,
}

impl Play {
    /// A play of `width` mm; 0 for none.
    pub fn new(width: f64) -> Self {
        Self { half: width / 2.0, table: 0.0 }
    }

    /// Puts nut and table at `position`, in the middle of the play.
    pub fn rest_at(&mut self, position: f64) {
        self.table = position;
    }

    /// Where the table stands, in mm.
    pub fn position(&self) -> f64 {
        self.table
    }

    /// Moves the nut to `nut` mm; the table follows where it must.
    #[inline]
    pub fn carry(&mut self, nut: f64) {
        let (low, high) = (nut - self.half, nut + self.half);
        if self.table < low {
            self.table = low;
        } else if self.table > high {
            self.table = high;
        }
    }
}

/// The largest whole number that is not above `x`. The library's floor and round are calls on plain x86-64, and slow ones in the
/// innermost loop of a simulation.
#[inline]
pub(super) fn whole_below(x: f64) -> i64 {
    let whole = x as i64;
    whole - i64::from(x < whole as f64)
}

/// A duration cut into equal steps, none longer than a limit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps {
    duration: f64,
    /// How many.
    pub count: u32,
    /// How long each is, in s.
    pub time: f64,
}

impl Steps {
    /// Cuts `duration`, which is above 0. The tolerance keeps a multiple of `longest` that is rounded up from one step more.
    pub fn cut(duration: f64, longest: f64) -> Self {
        let count = (duration / longest * (1.0 - 1e-9)).ceil().max(1.0) as u32;
        Self { duration, count, time: duration / f64::from(count) }
    }

    /// Whether these steps are those of `duration`.
    #[inline]
    pub fn fill(&self, duration: f64) -> bool {
        self.duration == duration
    }
}

//! A servo drive with its motor, screw, and a table that hangs on the motor rigidly, with play, or by a spring.
//!
//! | part | model |
//! | --- | --- |
//! | drive | torque = gain (commanded - motor's velocity), or nominal inertia times commanded acceleration; cut off at the peak torque; refreshed every `sample_time` and held in between |
//! | motor and screw, table | one body or two, viscous and Coulomb friction each, a constant load on the table ([`super::friction`]) |
//! | spring | stiffness, damper, backlash as a dead zone; where it is loose it does not pull |
//! | encoder | whole counts, on the motor or on the table |
//!
//! Left out: the current loop (ten times faster than a tick), the motor's electrical time constant and cogging, the screw's pitch error.
//!
//! Integration. One body is solved exactly over every step, because its push is constant there: the only discretisation is the drive's
//! own sampling. Two bodies are integrated by the leapfrog with the spring taken at the middle of the step and the damper corrected
//! once: second order, and the spring neither gains nor loses energy by it, which an explicit Runge-Kutta method does not promise over
//! the minutes of a job (tests `two_bodies_keep_their_energy`, `halving_the_step_quarters_the_error`). Stable while the resonance is
//! below 1/(pi step) and the damper slower than the step; parameters must stay below half of that.

use super::axis::{Axis, Command, Encoder, Play, Reading, Steps};
use super::friction::{Body, Friction, Glide};

/// How the drive turns its input into a push on the motor's body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveLaw {
    /// Closes a velocity loop of this gain: mm/s^2 per mm/s, that is 1/s.
    Velocity(f64),
    /// Makes torque: this many mm/s^2 of the motor's body per mm/s^2 commanded.
    Torque(f64),
}

/// A spring with damper and dead zone between two bodies.
#[derive(Clone, Copy, Debug)]
pub struct Spring {
    /// N/mm.
    pub stiffness: f64,
    /// N s/mm.
    pub damping: f64,
    /// Width of the dead zone in mm.
    pub backlash: f64,
    /// Masses of the motor's side and of the table, in kg.
    pub masses: [f64; 2],
}

/// What hangs on the motor.
#[derive(Clone, Copy, Debug)]
enum Table {
    /// The table moves with the motor but for the play; its mass and friction are in the motor's body.
    Rigid(Play),
    /// The table is a body of its own.
    Sprung { spring: Spring, body: Body, glide: Glide },
}

/// All that makes a servo axis, in mm, s, kg, and forces divided by the mass that they push.
#[derive(Clone, Copy, Debug)]
pub struct ServoAxisModel {
    /// The drive's law.
    pub law: DriveLaw,
    /// The largest push of the drive on the motor's body, in mm/s^2.
    pub limit: f64,
    /// The drive's sample time in s; 0 refreshes at every integration step.
    pub sample_time: f64,
    /// Friction of the motor's body, or of the only one.
    pub friction: Friction,
    /// A spring and the table's friction; `None` for one body.
    pub spring: Option<(Spring, Friction)>,
    /// Play in mm without a spring.
    pub play: f64,
    /// A constant push on the table (weight, counterbalance), in mm/s^2 of the body it acts on.
    pub load: f64,
    /// The encoder.
    pub encoder: Encoder,
    /// The longest integration step in s.
    pub step: f64,
}

/// A servo axis in motion; see the module.
#[derive(Clone, Copy, Debug)]
pub struct ServoAxis {
    model: ServoAxisModel,
    steps: Steps,
    body: Body,
    glide: Glide,
    table: Table,
    drive: Drive,
}

/// What the drive remembers.
#[derive(Clone, Copy, Debug, Default)]
struct Drive {
    /// The push that it holds, in mm/s^2 of the motor's body.
    held: f64,
    /// The time until it looks again, in s.
    wait: f64,
    /// Whether what it holds was cut off.
    cut: bool,
}

impl ServoAxis {
    /// An axis at rest at 0.
    pub fn new(model: ServoAxisModel) -> Self {
        let table = match model.spring {
            None => Table::Rigid(Play::new(model.play)),
            Some((spring, friction)) => {
                let glide = Glide::new(friction, model.step);
                Table::Sprung { spring, body: Body::default(), glide }
            }
        };
        Self {
            model,
            steps: Steps::cut(model.step, model.step),
            body: Body::default(),
            glide: Glide::new(model.friction, model.step),
            table,
            drive: Drive::default(),
        }
    }

    /// The motor's position and velocity, as movement of the screw's nut in mm and mm/s.
    pub fn motor(&self) -> Body {
        self.body
    }

    /// The table's position in mm.
    pub fn table(&self) -> f64 {
        match self.table {
            Table::Rigid(play) => play.position(),
            Table::Sprung { body, .. } => body.position,
        }
    }

    /// Cuts a duration that differs from the last one.
    #[cold]
    fn prepare(&mut self, duration: f64) {
        self.steps = Steps::cut(duration, self.model.step);
        self.glide = Glide::new(self.model.friction, self.steps.time);
        if let (Table::Sprung { glide, .. }, Some((_, friction))) = (&mut self.table, self.model.spring) {
            *glide = Glide::new(friction, self.steps.time);
        }
    }

    fn reading(&self, saturated: bool) -> Reading {
        let position = self.table();
        let seen = if self.model.encoder.on_table { position } else { self.body.position };
        Reading { counts: self.model.encoder.counts(seen), position, saturated, lost_steps: 0 }
    }
}

impl ServoAxis {
    /// The prepared steps under one input; whether the drive was at its limit. On copies, so that they stay in registers.
    #[inline]
    fn run(&mut self, input: f64) -> bool {
        let Steps { count, time, .. } = self.steps;
        let (mut drive, mut motor, mut saturated) = (self.drive, self.body, false);
        match &mut self.table {
            Table::Rigid(table) => {
                let mut play = *table;
                for _ in 0..count {
                    let push = drive.push(&self.model, input, motor.velocity, time);
                    saturated |= drive.cut;
                    motor = self.glide.advance(motor, push + self.model.load);
                    play.carry(motor.position);
                }
                *table = play;
            }
            Table::Sprung { spring, body, glide } => {
                let (mut table, load) = (*body, self.model.load);
                for _ in 0..count {
                    let push = drive.push(&self.model, input, motor.velocity, time);
                    saturated |= drive.cut;
                    let go = |force: f64| {
                        (
                            self.glide.advance(motor, push - 1e3 * force / spring.masses[0]),
                            glide.advance(table, load + 1e3 * force / spring.masses[1]),
                        )
                    };
                    // The damper acts on the mean of the rates before and after, so the step is made twice.
                    let stretch = motor.position - table.position;
                    let rate = motor.velocity - table.velocity;
                    let first = go(spring.force(stretch + 0.5 * time * rate, rate));
                    let mean = 0.5 * (rate + first.0.velocity - first.1.velocity);
                    (motor, table) = go(spring.force(stretch + 0.5 * time * rate, mean));
                }
                *body = table;
            }
        }
        (self.drive, self.body) = (drive, motor);
        saturated
    }
}

impl Drive {
    /// Looks at its input and at the tachometer where it is time to, and lets `time` pass. Returns the push that it holds.
    #[inline]
    fn push(&mut self, model: &ServoAxisModel, input: f64, velocity: f64, time: f64) -> f64 {
        // Half a step of tolerance: a sample falls on the nearest step.
        if self.wait < 0.5 * time {
            let wanted = match model.law {
                DriveLaw::Velocity(gain) => gain * (input - velocity),
                DriveLaw::Torque(scale) => scale * input,
            };
            self.held = wanted.clamp(-model.limit, model.limit);
            self.cut = self.held != wanted;
            self.wait += model.sample_time;
        }
        self.wait -= time;
        if self.wait < -time {
            self.wait = -time;
        }
        self.held
    }
}

impl Spring {
    /// The force on the table in N at a stretch in mm that changes at a rate in mm/s; the motor's side feels its opposite.
    #[inline]
    fn force(&self, stretch: f64, rate: f64) -> f64 {
        let half = 0.5 * self.backlash;
        let taut = stretch - stretch.clamp(-half, half);
        if half > 0.0 && taut == 0.0 {
            return 0.0;
        }
        let force = self.stiffness * taut + self.damping * rate;
        // A flank can push but not pull: while it parts, the damper must not hold it.
        if half > 0.0 && force * taut < 0.0 { 0.0 } else { force }
    }
}

impl Axis for ServoAxis {
    fn rest_at(&mut self, position: f64) -> Reading {
        self.body = Body { position, velocity: 0.0 };
        match &mut self.table {
            Table::Rigid(play) => play.rest_at(position),
            Table::Sprung { body, .. } => *body = self.body,
        }
        self.drive = Drive::default();
        self.reading(false)
    }

    #[inline]
    fn advance(&mut self, command: Command, duration: f64) -> Reading {
        // A call without duration lets nothing happen; what the drive holds is still to be seen.
        let mut saturated = self.drive.cut;
        if duration > 0.0 {
            if !self.steps.fill(duration) {
                self.prepare(duration);
            }
            let input = match (self.model.law, command) {
                (DriveLaw::Velocity(_), Command::Velocity(input)) => input,
                (DriveLaw::Torque(_), Command::Acceleration(input)) => input,
                _ => 0.0,
            };
            saturated = self.run(input);
        }
        self.reading(saturated)
    }
}

#[cfg(test)]
mod tests;

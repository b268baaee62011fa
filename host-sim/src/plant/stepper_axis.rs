//! A stepping motor with its microstepping drive, screw and table.
//!
//! The drive turns a field by microsteps; the rotor is held to it by torque(v) sin(N theta), N theta being the electrical angle between
//! them: 360 degrees are four full steps. So a load makes the rotor lag by asin(load/holding)/N, and a rotor that is pulled beyond
//! a quarter of the electrical turn too long falls to another tooth: lost steps come out of the motion in multiples of four, no
//! rule in here counts them.
//!
//! The torque falls with speed as the winding's current does behind its inductance: holding / sqrt(1 + (v/vc)^2). Viscous and
//! Coulomb friction, a constant load and a play between nut and table are those of the other axes ([`super::friction`]).
//!
//! Left out: detent torque, the difference of a real field from a sine, the drive's current loop, missed pulses of a drive
//! whose input is too slow.
//!
//! Integration: leapfrog, with the holding torque at the middle of each step; second order and without loss of its own, so that
//! the rotor's ringing is damped by what the parameters say and by nothing else.

use shared::real::Real;

use super::axis::{Axis, Command, Encoder, Play, Reading, Steps, whole_below};
use super::friction::{Body, Friction, Glide};
use super::pulses::Pulse;

/// All that makes a stepping axis, in mm, s, and forces divided by the moving mass.
#[derive(Clone, Copy, Debug)]
pub struct StepperAxisModel {
    /// One microstep in mm.
    pub microstep: f64,
    /// Microsteps in one electrical turn: four times those of a full step.
    pub turn: i32,
    /// Holding torque as a push in mm/s^2.
    pub holding: f64,
    /// The speed in mm/s at which the torque has fallen to 1/sqrt 2.
    pub corner_speed: f64,
    /// Friction of rotor, screw and table.
    pub friction: Friction,
    /// A constant push on the table, in mm/s^2.
    pub load: f64,
    /// Play in mm.
    pub play: f64,
    /// An encoder, where there is one.
    pub encoder: Option<Encoder>,
    /// The longest integration step in s.
    pub step: f64,
}

/// A stepping axis in motion; see the module.
#[derive(Clone, Copy, Debug)]
pub struct StepperAxis {
    model: StepperAxisModel,
    steps: Steps,
    /// Microsteps in a mm, and electrical turns in a microstep.
    per_mm: f64,
    per_microstep: f64,
    body: Body,
    glide: Glide,
    play: Play,
    /// Where the field stands, in microsteps from coordinate zero.
    field: i64,
}

impl StepperAxis {
    /// An axis at rest at 0.
    pub fn new(model: StepperAxisModel) -> Self {
        Self {
            model,
            steps: Steps::cut(model.step, model.step),
            per_mm: 1.0 / model.microstep,
            per_microstep: 1.0 / f64::from(model.turn),
            body: Body::default(),
            glide: Glide::new(model.friction, model.step),
            play: Play::new(model.play),
            field: 0,
        }
    }

    /// The rotor's position and velocity, as movement of the screw's nut in mm and mm/s.
    pub fn rotor(&self) -> Body {
        self.body
    }

    /// The field's position in microsteps from coordinate zero: what the pulses amount to.
    pub fn field(&self) -> i64 {
        self.field
    }

    /// The microstep that is nearest to `position` mm.
    pub fn nearest_microstep(&self, position: f64) -> i64 {
        whole_below(position * self.per_mm + 0.5)
    }

    /// The rotor's lead over the field in electrical turns.
    #[inline]
    fn lead(&self, position: f64, field: i64) -> f64 {
        (position * self.per_mm - field as f64) * self.per_microstep
    }

    #[inline]
    fn step(&mut self, field: i64, time: f64) {
        let turns = self.lead(self.body.position + self.body.velocity * (time / 2.0), field);
        let (sine, _) = ((turns - whole_below(turns + 0.5) as f64) * std::f64::consts::TAU).sin_versin();
        let slip = self.body.velocity / self.model.corner_speed;
        let torque = self.model.holding / (1.0 + slip * slip).sqrt();
        self.body = self.glide.advance(self.body, self.model.load - torque * sine);
        self.play.carry(self.body.position);
    }

    /// Puts field, rotor and table at rest on a microstep, counted from coordinate zero.
    pub fn rest_at_microstep(&mut self, field: i64) -> Reading {
        self.field = field;
        self.body = Body { position: self.field as f64 * self.model.microstep, velocity: 0.0 };
        self.play.rest_at(self.body.position);
        self.reading()
    }

    /// Cuts a duration above 0 into integration steps.
    #[inline]
    fn cut(&mut self, duration: f64) -> Steps {
        if !self.steps.fill(duration) {
            self.steps = Steps::cut(duration, self.model.step);
            self.glide = Glide::new(self.model.friction, self.steps.time);
        }
        self.steps
    }

    /// Lets `duration` seconds pass with `pulses` at their instants, which are in order, and returns what is to be seen then. Each
    /// integration step sees the field as it stands in its middle.
    pub fn advance_through(&mut self, pulses: &[Pulse], duration: f64) -> Reading {
        let mut rest = pulses.iter();
        let turn = |field: i64, pulse: &Pulse| field + if pulse.forward { 1 } else { -1 };
        if duration > 0.0 {
            let Steps { count, time, .. } = self.cut(duration);
            for k in 0..count {
                let middle = (f64::from(k) + 0.5) * time;
                let come = rest.as_slice().iter().take_while(|pulse| pulse.instant < middle).count();
                self.field = rest.by_ref().take(come).fold(self.field, turn);
                self.step(self.field, time);
            }
        }
        self.field = rest.fold(self.field, turn);
        self.reading()
    }

    fn reading(&self) -> Reading {
        let position = self.play.position();
        let counts = match self.model.encoder {
            Some(encoder) => encoder.counts(if encoder.on_table { position } else { self.body.position }),
            None => self.nearest_microstep(self.body.position) as i32,
        };
        let lost_steps = 4 * whole_below(self.lead(self.body.position, self.field) + 0.5) as i32;
        Reading { counts, position, saturated: false, lost_steps }
    }
}

impl Axis for StepperAxis {
    /// The field stands on the microstep that is nearest to `position`, and the rotor and the table on it.
    fn rest_at(&mut self, position: f64) -> Reading {
        self.rest_at_microstep(self.nearest_microstep(position))
    }

    fn advance(&mut self, command: Command, duration: f64) -> Reading {
        let pulses = if let Command::Steps(pulses) = command { i64::from(pulses) } else { 0 };
        if duration > 0.0 {
            let Steps { count, time, .. } = self.cut(duration);
            // Pulses before the middle of step k: those with (j + 1/2)/asked below (k + 1/2)/count. The quotient is carried along.
            let (whole, mut part) = (2 * i64::from(count), pulses.abs() + i64::from(count));
            let mut field = self.field;
            for _ in 0..count {
                if part >= whole {
                    field += part / whole * pulses.signum();
                    part %= whole;
                }
                self.step(field, time);
                part += 2 * pulses.abs();
            }
        }
        self.field += pulses;
        self.reading()
    }
}

#[cfg(test)]
mod tests;

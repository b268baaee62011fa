//! The servo axis: a position loop around a velocity loop, with feedforward of velocity and acceleration.
//!
//! A setpoint says where the axis shall stand at the *next* tick, which is also what a step generator needs. So a tick knows the
//! setpoints before, at and after its own instant, and both feedforward terms are central differences: they neither lead nor lag.
//! With e the position error, r' and r'' those differences and x' the velocity by the encoder,
//!
//! ```text
//! v = kp e + kv r'                                                     the velocity that is asked for
//! command = v + lag ka r'' + ki integral(v - x')                       a drive that closes its own velocity loop
//! command = kd (v - x' + ki integral(v - x')) + ka r''                 a drive that takes an acceleration (torque, current)
//! ```
//!
//! limited on both sides. The integral rests while the command is at its limit and the velocity error points outwards.
//!
//! The position error is formed in integers: the setpoint times counts per unit as a 64-bit product, less the encoder's count.
//! It is cut to at most one unit and rounded only when it becomes a float, so that it is as good far from home as at home.
//!
//! | part | cost, f32 on a Cortex-M4F | error |
//! | --- | --- | --- |
//! | [`Servo::step`] | `cargo xtask budget`, stage `servo`; no division, no loop, no panic path | velocity and command: 8 roundoffs of the largest term (test `f32_twin`) |
//! | [`Servo::position_error`] | part of it | one unit, 3.8 nm; 2^-31 of the coordinate, 1 nm at 2 m; 2 roundoffs of the error itself |

use core::fmt;

use serde::{Deserialize, Serialize};

use crate::fixed::{Fixed, UNITS_PER_MM};
use crate::real::Real;

/// The finest encoder, in counts per mm; beyond it a coordinate is no longer finer than a count.
pub const MOST_COUNTS_PER_MM: f64 = 131_072.0;

/// The coarsest encoder, in counts per mm.
pub const LEAST_COUNTS_PER_MM: f64 = 0.01;

/// The highest limit of a command, in mm/s or mm/s^2: a hundred thousand times gravity.
pub const MOST_COMMAND: f64 = 1e9;

/// The shortest period of a tick, in s.
pub const SHORTEST_PERIOD: f64 = 1e-6;

/// What the servo's command means to the drive behind it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum DriveSettings {
    /// The drive closes its own velocity loop; the command is a velocity in mm/s.
    Velocity {
        /// The time by which the drive's velocity follows its command, in s: the inverse of its loop's gain. Acceleration
        /// feedforward makes up for it. Zero or more.
        #[serde(default)]
        lag: f64,
        /// The largest command, in mm/s; above 0 and at most [`MOST_COMMAND`].
        limit: f64,
    },
    /// The drive makes torque, or force; the command is an acceleration in mm/s^2.
    Acceleration {
        /// Gain of the velocity loop, in 1/s; above 0, below one per tick.
        velocity_gain: f64,
        /// The largest command, in mm/s^2; above 0 and at most [`MOST_COMMAND`].
        limit: f64,
    },
}

/// What a person writes about one servo axis; anything may be wrong in it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ServoSettings {
    /// Counts of the encoder per mm of the axis, in [`LEAST_COUNTS_PER_MM`]..=[`MOST_COUNTS_PER_MM`].
    pub counts_per_mm: f64,
    /// Gain of the position loop in 1/s; above 0, below one per tick.
    pub position_gain: f64,
    /// Rate of the integral of the velocity error in 1/s, the inverse of its reset time; 0 for none, below one per tick.
    #[serde(default)]
    pub integral_gain: f64,
    /// Part of the commanded velocity that is fed forward, in 0..=2; 1 leaves no lag at steady speed.
    #[serde(default)]
    pub velocity_feedforward: f64,
    /// Part of the commanded acceleration that is fed forward, in 0..=2.
    #[serde(default)]
    pub acceleration_feedforward: f64,
    /// What the command means.
    pub drive: DriveSettings,
}

/// Why settings cannot become a servo; each variant carries the value that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ServoError {
    /// The tick's period lies outside [`SHORTEST_PERIOD`]..=1 s.
    Period(f64),
    /// Counts per mm outside [`LEAST_COUNTS_PER_MM`]..=[`MOST_COUNTS_PER_MM`].
    CountsPerMm(f64),
    /// The position gain is not above 0 or not below one per tick.
    PositionGain(f64),
    /// The velocity gain is not above 0 or not below one per tick.
    VelocityGain(f64),
    /// The integral gain is negative or not below one per tick.
    IntegralGain(f64),
    /// The velocity feedforward lies outside 0..=2.
    VelocityFeedforward(f64),
    /// The acceleration feedforward lies outside 0..=2.
    AccelerationFeedforward(f64),
    /// The lag of the drive is negative or above 1 s.
    Lag(f64),
    /// The limit of the command is not above 0, or is above [`MOST_COMMAND`].
    Limit(f64),
}

impl ServoError {
    /// The field of [`ServoSettings`] that is to be changed.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Period(_) => "period",
            Self::CountsPerMm(_) => "counts_per_mm",
            Self::PositionGain(_) => "position_gain",
            Self::VelocityGain(_) => "velocity_gain",
            Self::IntegralGain(_) => "integral_gain",
            Self::VelocityFeedforward(_) => "velocity_feedforward",
            Self::AccelerationFeedforward(_) => "acceleration_feedforward",
            Self::Lag(_) => "lag",
            Self::Limit(_) => "limit",
        }
    }

    /// The value that was found.
    pub const fn found(self) -> f64 {
        match self {
            Self::Period(value)
            | Self::CountsPerMm(value)
            | Self::PositionGain(value)
            | Self::VelocityGain(value)
            | Self::IntegralGain(value)
            | Self::VelocityFeedforward(value)
            | Self::AccelerationFeedforward(value)
            | Self::Lag(value)
            | Self::Limit(value) => value,
        }
    }

    /// What would do instead.
    pub const fn remedy(self) -> &'static str {
        match self {
            Self::Period(_) => "1 us to 1 s",
            Self::CountsPerMm(_) => "0.01 to 131072 counts/mm",
            Self::PositionGain(_) | Self::VelocityGain(_) => "above 0 and below one per tick, in 1/s",
            Self::IntegralGain(_) => "0 or more and below one per tick, in 1/s",
            Self::VelocityFeedforward(_) | Self::AccelerationFeedforward(_) => "0 to 2, where 1 is all of it",
            Self::Lag(_) => "0 to 1 s",
            Self::Limit(_) => "above 0 and at most 1e9, in mm/s for a velocity and mm/s^2 for an acceleration",
        }
    }
}

impl fmt::Display for ServoError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} is {}; it must be {}", self.key(), self.found(), self.remedy())
    }
}

impl core::error::Error for ServoError {}

/// What the tick uses; made only by [`ServoSettings::activate`], so every value is in range.
#[derive(Clone, Copy, Debug)]
pub struct Servo<T> {
    /// Counts per unit of 2^-18 mm, times 2^(32 + `shift`); in 2^30..2^31.
    ratio: i32,
    /// Binary places by which a count is shifted above the lower word of the product.
    shift: u32,
    /// mm per unit of the position error in [`Servo::position_error`].
    weight: T,
    position_gain: T,
    /// Velocity feedforward / (2 periods), for the way of two ticks in units of 2^-18 mm.
    velocity_feedforward: T,
    /// Gain of the acceleration feedforward / period^2, for a way in units of 2^-18 mm.
    acceleration_feedforward: T,
    /// mm/s per count and tick.
    speed_per_count: T,
    velocity_gain: T,
    /// Command per measured mm/s: the velocity gain or, where the drive closes that loop, 0.
    damping: T,
    /// Command per mm/s of velocity error and tick.
    integral_gain: T,
    limit: T,
}

/// What one servo axis remembers between two ticks.
#[derive(Clone, Copy, Debug)]
pub struct ServoState<T> {
    /// The setpoint of the tick before: where the axis shall be now.
    target: Fixed,
    /// The way from the setpoint before to `target`, in units of 2^-18 mm.
    stride: T,
    /// The counter at coordinate zero.
    datum: i32,
    /// The counter when it was looked at last.
    encoder: i32,
    /// The velocity by the counter, in mm/s.
    measured: T,
    integral: T,
    error: T,
    /// What the limit cut off.
    excess: T,
}

impl<T: Real> ServoState<T> {
    /// The position error that the last step found, in mm; positive where the axis lags a movement in the positive direction.
    pub fn position_error(&self) -> T {
        self.error
    }

    /// Where the axis shall be now.
    pub fn target(&self) -> Fixed {
        self.target
    }

    /// Whether the last command was cut off at the limit.
    pub fn is_saturated(&self) -> bool {
        self.excess != T::ZERO
    }
}

impl ServoSettings {
    /// Checks every value for a tick of `period` seconds and turns the settings into what the tick uses. Load time.
    pub fn activate<T: Real>(&self, period: f64) -> Result<Servo<T>, ServoError> {
        // Written so that a NaN fails.
        let within = |value: f64, least: f64, most: f64| value >= least && value <= most;
        let gain = |value: f64| value > 0.0 && value * period < 1.0;
        if !within(period, SHORTEST_PERIOD, 1.0) {
            return Err(ServoError::Period(period));
        }
        if !within(self.counts_per_mm, LEAST_COUNTS_PER_MM, MOST_COUNTS_PER_MM) {
            return Err(ServoError::CountsPerMm(self.counts_per_mm));
        }
        if !gain(self.position_gain) {
            return Err(ServoError::PositionGain(self.position_gain));
        }
        if !(self.integral_gain >= 0.0 && self.integral_gain * period < 1.0) {
            return Err(ServoError::IntegralGain(self.integral_gain));
        }
        if !within(self.velocity_feedforward, 0.0, 2.0) {
            return Err(ServoError::VelocityFeedforward(self.velocity_feedforward));
        }
        if !within(self.acceleration_feedforward, 0.0, 2.0) {
            return Err(ServoError::AccelerationFeedforward(self.acceleration_feedforward));
        }
        // Both kinds of drive are one formula; a velocity is a command with gain 1 that subtracts nothing.
        let (velocity_gain, feedback, lag, limit) = match self.drive {
            DriveSettings::Velocity { lag, .. } if !within(lag, 0.0, 1.0) => return Err(ServoError::Lag(lag)),
            DriveSettings::Velocity { lag, limit } => (1.0, 0.0, lag, limit),
            DriveSettings::Acceleration { velocity_gain, .. } if !gain(velocity_gain) => {
                return Err(ServoError::VelocityGain(velocity_gain));
            }
            DriveSettings::Acceleration { velocity_gain, limit } => (velocity_gain, 1.0, 1.0, limit),
        };
        if !(limit > 0.0 && limit <= MOST_COMMAND) {
            return Err(ServoError::Limit(limit));
        }
        let (ratio, shift) = normalise(self.counts_per_mm / UNITS_PER_MM);
        Ok(Servo {
            ratio,
            shift,
            // The error is in counts * 2^(shift + 2).
            weight: T::lit(0.25 / (self.counts_per_mm * power_of_two(shift))),
            position_gain: T::lit(self.position_gain),
            velocity_feedforward: T::lit(self.velocity_feedforward / (2.0 * period * UNITS_PER_MM)),
            acceleration_feedforward: T::lit(self.acceleration_feedforward * lag / (period * period * UNITS_PER_MM)),
            speed_per_count: T::lit(1.0 / (self.counts_per_mm * period)),
            velocity_gain: T::lit(velocity_gain),
            damping: T::lit(velocity_gain * feedback),
            integral_gain: T::lit(velocity_gain * self.integral_gain * period),
            limit: T::lit(limit),
        })
    }
}

/// Counts per unit as a factor in 2^30..2^31 and the shift that belongs to it.
fn normalise(counts_per_unit: f64) -> (i32, u32) {
    let mut shift = 0;
    let mut ratio = counts_per_unit * 4_294_967_296.0;
    // At most 32 rounds: the range of counts per mm spans 24 powers of two.
    while ratio < 1_073_741_823.5 && shift < 31 {
        ratio *= 2.0;
        shift += 1;
    }
    // Saturates where rounding reaches 2^31: 2^-31 of the coordinate, as every other rounding here.
    (libm::round(ratio) as i32, shift)
}

/// 2^`exponent`, exactly.
fn power_of_two(exponent: u32) -> f64 {
    f64::from(1_u32.wrapping_shl(exponent))
}

impl<T: Real> Servo<T> {
    /// The state of an axis that rests at `position` while its counter reads `encoder`. Load time.
    ///
    /// `position` is taken to lie within the count that the counter shows, so that the encoder counts whole counts from
    /// coordinate zero.
    pub fn at_rest(&self, position: Fixed, encoder: i32) -> ServoState<T> {
        let counts = (self.scaled(position) >> 32) >> self.shift;
        ServoState {
            target: position,
            stride: T::ZERO,
            datum: encoder.wrapping_sub(counts as i32),
            encoder,
            measured: T::ZERO,
            integral: T::ZERO,
            error: T::ZERO,
            excess: T::ZERO,
        }
    }

    /// `position` in counts times 2^(32 + `shift`).
    #[inline(always)]
    fn scaled(&self, position: Fixed) -> i64 {
        // |position| <= 2^31 and ratio < 2^31: the product cannot overflow.
        i64::from(position.0).wrapping_mul(i64::from(self.ratio))
    }

    /// How far `position` is ahead of the encoder, in mm, where `counts` is the encoder's way from coordinate zero.
    ///
    /// The difference is exact modulo 2^64, so the counter may wrap and the axis may stand anywhere. It is cut to units between a
    /// half and one of 2^-18 mm, in which 32 bits hold every error up to 4 m.
    #[inline(always)]
    pub fn position_error(&self, position: Fixed, counts: i32) -> T {
        let counts = i64::from((counts as u32).wrapping_shl(self.shift)) << 32;
        let error = self.scaled(position).wrapping_sub(counts) >> 30;
        T::from_int(error as i32) * self.weight
    }

    /// One tick: the command for the time until the next tick, from the counter as it reads now and from where the axis shall be
    /// at the next tick. In mm/s or mm/s^2 as the settings say; always finite and within the limit.
    #[inline(always)]
    pub fn step(&self, state: &mut ServoState<T>, setpoint: Fixed, encoder: i32) -> T {
        self.sense(state, encoder);
        self.command(state, setpoint)
    }

    /// The first half of a tick: takes over what the counter reads, and returns the position error in mm, positive where the axis lags a
    /// movement in the positive direction.
    #[inline(always)]
    pub fn sense(&self, state: &mut ServoState<T>, encoder: i32) -> T {
        state.measured = T::from_int(encoder.wrapping_sub(state.encoder)) * self.speed_per_count;
        state.encoder = encoder;
        state.error = self.position_error(state.target, encoder.wrapping_sub(state.datum));
        state.error
    }

    /// The second half: the command, as [`Servo::step`] says.
    #[inline(always)]
    pub fn command(&self, state: &mut ServoState<T>, setpoint: Fixed) -> T {
        let ahead = T::from_int(setpoint.0.wrapping_sub(state.target.0));
        let asked = state.error * self.position_gain + (ahead + state.stride) * self.velocity_feedforward;

        let wanted = asked * self.velocity_gain - state.measured * self.damping
            + (ahead - state.stride) * self.acceleration_feedforward
            + state.integral;
        let command = wanted.most(-self.limit).least(self.limit);
        let excess = wanted - command;
        let velocity_error = asked - state.measured;
        // At the limit, only what leads back from it is summed up.
        let inward = velocity_error * excess <= T::ZERO;
        state.integral += if inward { velocity_error * self.integral_gain } else { T::ZERO };

        state.target = setpoint;
        state.stride = ahead;
        state.excess = excess;
        command
    }

    /// Takes the setpoint of an axis that was just sensed to be `position` from now on. How far the axis is from it stays as it is, so that
    /// nothing jumps. The setpoint rests, as it did before.
    pub fn stand_at(&self, state: &mut ServoState<T>, position: Fixed) {
        let error = state.error;
        *state = self.at_rest(position.offset_by(-error), state.encoder);
        (state.target, state.error) = (position, error);
    }

    /// Instead of the second half, for a drive without power: the axis is taken to rest where its encoder is, which is returned. The encoder
    /// goes on counting from the same zero.
    #[inline(always)]
    pub fn settle(&self, state: &mut ServoState<T>) -> Fixed {
        state.target = state.target.offset_by(-state.error);
        (state.stride, state.integral, state.error, state.excess) = (T::ZERO, T::ZERO, T::ZERO, T::ZERO);
        state.target
    }

    /// The largest command, in the drive's unit.
    pub fn limit(&self) -> T {
        self.limit
    }
}

#[cfg(test)]
mod tests;

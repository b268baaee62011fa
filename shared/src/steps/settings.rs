//! What a person writes about a step axis, and why it may be refused.

use core::fmt;

use serde::{Deserialize, Serialize};

use super::axis::StepAxis;
use super::{MOST_AXES, MOST_SLOTS, StepAxes};

/// The coarsest axis, in steps per mm.
pub const LEAST_STEPS_PER_MM: f64 = 0.01;

/// The finest axis, in steps per mm: half of a coordinate's unit resolves a step.
pub const MOST_STEPS_PER_MM: f64 = 131_072.0;

/// One output: a bit of one of the ports whose set/reset words are built.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pin {
    /// Which of the ports, counted from 0.
    pub port: u8,
    /// Which bit of it, 0..=15.
    pub bit: u8,
    /// Whether a pulse is low and a pause high; of a direction, whether low is the positive one.
    #[serde(default)]
    pub inverted: bool,
}

/// What a person writes about one step axis; anything may be wrong in it. Times are in slots; [`slots_in`] makes them of seconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepSettings {
    /// Steps per mm of the axis, in [`LEAST_STEPS_PER_MM`]..=[`MOST_STEPS_PER_MM`].
    pub steps_per_mm: f64,
    /// Where the pulses come out.
    pub step: Pin,
    /// Where the direction comes out.
    pub direction: Pin,
    /// The least width of a pulse; every pulse has it. 1 to a quarter of the slots.
    pub pulse: u16,
    /// The least pause between two pulses. 1 to a quarter of the slots.
    pub gap: u16,
    /// The least time from a change of direction to the leading edge of a pulse. 1 to a quarter of the slots.
    pub setup: u16,
    /// The least time from the trailing edge of a pulse to a change of direction. A drive that counts from the leading edge is
    /// served as well, since the trailing one is later. 0 to a quarter of the slots.
    pub hold: u16,
}

/// Why settings cannot become step axes; `axis` counts from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StepError {
    /// Steps per mm outside [`LEAST_STEPS_PER_MM`]..=[`MOST_STEPS_PER_MM`].
    StepsPerMm {
        /// Of which axis.
        axis: u8,
        /// What was found.
        found: f64,
    },
    /// A pin lies on a port or a bit that there is not.
    Pin {
        /// Of which axis.
        axis: u8,
        /// What was found.
        found: Pin,
        /// How many ports there are.
        ports: u8,
    },
    /// Two outputs share a pin.
    SharedPin {
        /// The second one that uses it.
        axis: u8,
        /// What was found.
        found: Pin,
    },
    /// A time is shorter or longer than can be played.
    Time {
        /// Of which axis.
        axis: u8,
        /// Which one.
        time: StepTime,
        /// What was found, in slots.
        found: u16,
        /// The longest, in slots.
        most: u16,
    },
}

/// The times of a step axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StepTime {
    /// [`StepSettings::pulse`].
    Pulse,
    /// [`StepSettings::gap`].
    Gap,
    /// [`StepSettings::setup`].
    Setup,
    /// [`StepSettings::hold`].
    Hold,
}

impl StepTime {
    /// The field of [`StepSettings`].
    pub const fn key(self) -> &'static str {
        match self {
            Self::Pulse => "pulse",
            Self::Gap => "gap",
            Self::Setup => "setup",
            Self::Hold => "hold",
        }
    }

    /// The shortest, in slots.
    const fn least(self) -> u16 {
        match self {
            Self::Hold => 0,
            _ => 1,
        }
    }
}

impl StepError {
    /// The axis at fault, from 0.
    pub const fn axis(self) -> u8 {
        match self {
            Self::StepsPerMm { axis, .. }
            | Self::Pin { axis, .. }
            | Self::SharedPin { axis, .. }
            | Self::Time { axis, .. } => axis,
        }
    }
}

impl fmt::Display for StepError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::StepsPerMm { axis, found } => {
                write!(
                    f,
                    "step axis {axis} takes {found} steps/mm; it must be {LEAST_STEPS_PER_MM} to {MOST_STEPS_PER_MM}"
                )
            }
            Self::Pin { axis, found: Pin { port, bit, .. }, ports } => {
                write!(
                    f,
                    "step axis {axis} uses bit {bit} of port {port}; there are bits 0 to 15 of {ports} ports from 0 on"
                )
            }
            Self::SharedPin { axis, found: Pin { port, bit, .. } } => {
                write!(
                    f,
                    "step axis {axis} uses bit {bit} of port {port}, which is in use; each output needs a pin of its own"
                )
            }
            Self::Time { axis, time, found, most } => {
                let (key, least) = (time.key(), time.least());
                write!(f, "{key} of step axis {axis} is {found} slots; it must be {least} to {most}")
            }
        }
    }
}

impl core::error::Error for StepError {}

impl StepSettings {
    /// Checks every value of all axes and turns the settings into what the tick uses. The slots of a tick should divide it: hardware
    /// paces them. Load time.
    pub fn activate<const AXES: usize, const PORTS: usize, const SLOTS: usize>(
        settings: &[Self; AXES],
    ) -> Result<StepAxes<AXES, PORTS, SLOTS>, StepError> {
        const {
            assert!(AXES >= 1 && AXES <= MOST_AXES, "one to six axes");
            assert!(PORTS >= 1 && PORTS <= 8, "one to eight ports");
            assert!(SLOTS >= 16 && SLOTS <= MOST_SLOTS, "16 to 4095 slots in a tick");
        }
        for (axis, one) in (0..).zip(settings) {
            // Written so that a NaN fails.
            if !(one.steps_per_mm >= LEAST_STEPS_PER_MM && one.steps_per_mm <= MOST_STEPS_PER_MM) {
                return Err(StepError::StepsPerMm { axis, found: one.steps_per_mm });
            }
            for found in [one.step, one.direction] {
                if usize::from(found.port) >= PORTS || found.bit > 15 {
                    return Err(StepError::Pin { axis, found, ports: PORTS as u8 });
                }
            }
            let most = SLOTS as u16 / 4;
            for (time, found) in [
                (StepTime::Pulse, one.pulse),
                (StepTime::Gap, one.gap),
                (StepTime::Setup, one.setup),
                (StepTime::Hold, one.hold),
            ] {
                if !(time.least()..=most).contains(&found) {
                    return Err(StepError::Time { axis, time, found, most });
                }
            }
        }
        let mut used = [0_u16; PORTS];
        let mut alone = [false; AXES];
        for ((axis, one), alone) in (0..).zip(settings).zip(&mut alone) {
            *alone = used.get(usize::from(one.step.port)) == Some(&0);
            for found in [one.step, one.direction] {
                let Some(port) = used.get_mut(usize::from(found.port)) else { continue };
                if *port >> found.bit & 1 != 0 {
                    return Err(StepError::SharedPin { axis, found });
                }
                *port |= 1 << found.bit;
            }
        }
        let mut axes = [StepAxis::default(); AXES];
        for ((axis, one), alone) in axes.iter_mut().zip(settings).zip(alone) {
            *axis = StepAxis::new::<SLOTS>(one, alone);
        }
        Ok(StepAxes::new(axes))
    }
}

#[cfg(feature = "defmt")]
impl defmt::Format for Pin {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(f, "{}.{}", self.port, self.bit);
    }
}

/// The slots that last at least `time` seconds, where a tick has `slots`. Load time; saturates.
pub fn slots_in(time: f64, slots: usize) -> u16 {
    let exact = time * slots as f64 / f64::from(crate::TICK);
    // A time that is meant to be a whole number of slots shall not become one more by its rounding.
    libm::ceil(exact * (1.0 - 1e-9)) as u16
}

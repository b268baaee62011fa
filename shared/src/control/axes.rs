//! The axes of a machine: each a step axis or a servo, by configuration.
//!
//! All of them follow targets in machine coordinates, where they shall stand at the next tick. A servo axis has a step axis too that
//! never moves, so that the pulses of any mixture are one call.

use core::fmt;

use super::ring::Ring;
use crate::extent::SLACK_MM;
use crate::fixed::{Fixed, Position, UNITS_PER_MM};
use crate::machine::{AxisDrive, AxisName, AxisSettings, Drive, Machine, StepDrive};
use crate::safety::Fault;
use crate::servo::{Servo, ServoState};
use crate::steps::{Half, StepAxes, StepError, StepFault, StepSettings, StepState};

/// The pins of a step axis on a board: port and bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StepPins {
    /// Where a pulse comes out.
    pub step: (u8, u8),
    /// Where the direction comes out.
    pub direction: (u8, u8),
}

/// Why a machine cannot be driven by this controller.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum AxesError {
    /// It has more axes than the board has connectors.
    TooMany {
        /// What the board has.
        most: u8,
    },
    /// It has an axis that no path moves: there are x, y and z.
    Name {
        /// Which axis.
        axis: u8,
    },
    /// A step axis that cannot be played.
    Steps(StepError),
}

impl fmt::Display for AxesError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooMany { most } => write!(f, "the machine has more axes than the board, which has {most}"),
            Self::Name { axis } => {
                write!(f, "axis {axis} is none of x, y and z, which are all that this controller moves")
            }
            Self::Steps(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for AxesError {}

/// A servo axis with what it remembers.
#[derive(Clone, Copy, Debug)]
struct ServoAxis {
    servo: Servo<f32>,
    state: ServoState<f32>,
    /// The distance from the setpoint that is a fault, in mm.
    following_error: f32,
    /// Whether the encoder counts down in the positive direction.
    encoder_inverted: bool,
    /// Where the encoder was seen.
    seen: Fixed,
    /// What a command in the drive's unit is of its full range; below zero where the sign is to be changed.
    level: f32,
}

/// See the module. `AXES` is how many connectors the board has; a machine may use fewer.
#[derive(Clone, Debug)]
pub struct Axes<const AXES: usize, const PORTS: usize, const SLOTS: usize> {
    servos: [Option<ServoAxis>; AXES],
    steps: StepAxes<AXES, PORTS, SLOTS>,
    step_state: StepState<AXES>,
    has_steps: bool,
    /// Which coordinate of a position each axis follows: 0 to 2, or [`NONE`].
    coordinates: [u8; AXES],
    /// Which axis follows each coordinate; [`NONE`] where none does.
    axes: [u8; 3],
    /// The lowest and the highest target of a path, with [`SLACK`].
    travel: [[Fixed; 2]; AXES],
    /// Where each axis shall be now.
    targets: [Fixed; AXES],
}

/// What the drives get in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Commands<const AXES: usize> {
    /// Of a servo: its command, in the drive's unit. Of a step axis: 0.
    pub commands: [f32; AXES],
    /// The same as a part of the drive's full range, -1..=1, with the sign that the drive wants.
    pub levels: [f32; AXES],
}

impl<const AXES: usize> Commands<AXES> {
    /// Nothing.
    pub const ZERO: Self = Self { commands: [0.0; AXES], levels: [0.0; AXES] };
}

/// The number of no axis and of no coordinate.
const NONE: u8 = 7;

/// One of eight, without a bound to check; the last is nobody's.
#[inline(always)]
fn one_of(values: &[Fixed; 8], number: u8) -> Fixed {
    // Three bits are below eight.
    values.get(usize::from(number & 7)).copied().unwrap_or(Fixed(0))
}

/// What a setpoint may seem to leave the travel by: twice what the check before motion allows, [`crate::extent::SLACK_MM`].
const SLACK: i32 = (2.0 * SLACK_MM * UNITS_PER_MM) as i32;

/// A drive for a connector without a step axis: the slowest pulses there are, and never one.
const STILL: StepDrive = StepDrive {
    steps_per_mm: 1.0,
    pulse: 1e-6,
    gap: 1e-6,
    setup: 1e-6,
    hold: 0.0,
    step_inverted: false,
    direction_inverted: false,
};

impl<const AXES: usize, const PORTS: usize, const SLOTS: usize> Axes<AXES, PORTS, SLOTS> {
    /// The axes of a machine on a board with these pins, at rest at 0 wherever they stand. Load time. Errors: a machine that this
    /// controller cannot drive.
    pub fn new(machine: &Machine, pins: &[StepPins; AXES]) -> Result<Self, AxesError> {
        if machine.axes.len() > AXES {
            return Err(AxesError::TooMany { most: AXES as u8 });
        }
        let mut settings = pins.map(|pins| STILL.on_pins(pins.step, pins.direction, SLOTS));
        let mut servos = [None; AXES];
        let mut coordinates = [NONE; AXES];
        let mut axes = [NONE; 3];
        let mut travel = [[Fixed(0); 2]; AXES];
        let mut has_steps = false;
        let places = settings.iter_mut().zip(pins).zip(servos.iter_mut().zip(coordinates.iter_mut().zip(&mut travel)));
        for ((number, axis), ((setting, pins), (servo, (coordinate, travel)))) in (0..).zip(&machine.axes).zip(places) {
            let [low, high] = axis.travel;
            // Both are within 4 m, and 32 bits hold 8 m.
            *travel = [Fixed(low.0.saturating_sub(SLACK)), Fixed(high.0.saturating_add(SLACK))];
            *coordinate = match axis.name {
                AxisName::X => 0,
                AxisName::Y => 1,
                AxisName::Z => 2,
                AxisName::A | AxisName::B | AxisName::C => return Err(AxesError::Name { axis: number }),
            };
            if let Some(place) = axes.get_mut(usize::from(*coordinate)) {
                *place = number;
            }
            match axis.drive {
                Drive::Step(drive) => {
                    has_steps = true;
                    *setting = drive.on_pins(pins.step, pins.direction, SLOTS);
                }
                Drive::Servo { servo: active, following_error, encoder_inverted, command_inverted } => {
                    let level = 1.0 / active.limit();
                    *servo = Some(ServoAxis {
                        servo: active,
                        state: active.at_rest(Fixed(0), 0),
                        following_error,
                        encoder_inverted,
                        seen: Fixed(0),
                        level: if command_inverted { -level } else { level },
                    });
                }
            }
        }
        let steps = StepSettings::activate(&settings).map_err(AxesError::Steps)?;
        let step_state = steps.at_rest([Fixed(0); AXES]);
        Ok(Self { servos, steps, step_state, has_steps, coordinates, axes, travel, targets: [Fixed(0); AXES] })
    }

    /// Whether there are step axes.
    #[inline(always)]
    pub fn has_steps(&self) -> bool {
        self.has_steps
    }

    /// Where each axis shall be now.
    #[inline(always)]
    pub fn targets(&self) -> [Fixed; AXES] {
        self.targets
    }

    /// Takes over what the encoders read. Errors: the first axis that is too far from where it shall be now.
    #[inline(always)]
    pub fn sense(&mut self, counts: [i32; AXES]) -> Result<(), Fault> {
        let mut found = Ok(());
        for (number, (servo, count)) in (0..).zip(self.servos.iter_mut().zip(counts)) {
            let Some(axis) = servo else { continue };
            let count = if axis.encoder_inverted { count.wrapping_neg() } else { count };
            let error = axis.servo.sense(&mut axis.state, count);
            // Written so that no NaN passes.
            axis.seen = axis.state.target().offset_by(-error);
            let follows = error <= axis.following_error && error >= -axis.following_error;
            if !follows {
                found = found.and(Err(Fault::FollowingError { axis: number }));
            }
        }
        found
    }

    /// Takes an axis to stand at `position`, without a motion. It is at rest, and the tick has sensed.
    pub fn stand_at(&mut self, number: usize, position: Fixed) {
        let Some(target) = self.targets.get_mut(number) else { return };
        *target = position;
        match self.servos.get_mut(number) {
            Some(Some(axis)) => {
                axis.servo.stand_at(&mut axis.state, position);
            }
            _ => self.steps.stand_at(&mut self.step_state, self.targets),
        }
    }

    /// Plays the steps that lead to `targets` and commands the drives. Errors: an axis that cannot keep up; the words are good all the same.
    #[inline(always)]
    pub fn follow(
        &mut self,
        targets: [Fixed; AXES],
        half: Option<Half>,
        ring: &mut impl Ring<PORTS, SLOTS>,
    ) -> (Commands<AXES>, Result<(), Fault>) {
        self.targets = targets;
        let mut commands = Commands::ZERO;
        let outputs = commands.commands.iter_mut().zip(&mut commands.levels);
        for ((servo, (command, level)), target) in self.servos.iter_mut().zip(outputs).zip(targets) {
            if let Some(axis) = servo {
                *command = axis.servo.command(&mut axis.state, target);
                *level = *command * axis.level;
            }
        }
        let Some(half) = half else { return (commands, Ok(())) };
        let filled = self.steps.fill(&mut self.step_state, targets, half, ring.words(half));
        ring.filled(half);
        let fault = filled.map_err(|fault| match fault {
            StepFault::TooFast { axis, .. } | StepFault::Late { axis, .. } => Fault::Steps { axis },
        });
        (commands, fault)
    }

    /// The drives have no power, and no step is played: servos are taken to rest where their encoders are, and steps that are owed
    /// are given up.
    pub fn go_limp(&mut self) {
        for (target, servo) in self.targets.iter_mut().zip(&mut self.servos) {
            if let Some(axis) = servo {
                *target = axis.servo.settle(&mut axis.state);
            }
        }
        self.step_state = self.steps.at_rest(self.targets);
    }

    /// The first of the axes whose position is known that would leave its travel.
    #[inline(always)]
    pub fn leaving(&self, targets: &[Fixed; AXES], known: u8) -> Option<u8> {
        let inside = |[low, high]: [Fixed; 2], target: Fixed| low <= target && target <= high;
        let axes = (0..).zip(self.travel.iter().zip(targets));
        axes.into_iter()
            .find_map(|(axis, (travel, target))| (known >> axis & 1 != 0 && !inside(*travel, *target)).then_some(axis))
    }

    /// Plays the ring, if there is anything to play and it is not played yet.
    pub fn play(&mut self, ring: &mut impl Ring<PORTS, SLOTS>) {
        if self.has_steps && !ring.is_played() {
            self.step_state = self.steps.at_rest(self.targets);
            ring.play(self.steps.idle());
        }
    }

    /// The coordinates of a position for each axis.
    #[inline(always)]
    pub fn of_position(&self, &[x, y, z]: &Position) -> [Fixed; AXES] {
        let values = [x, y, z, Fixed(0), Fixed(0), Fixed(0), Fixed(0), Fixed(0)];
        self.coordinates.map(|coordinate| one_of(&values, coordinate))
    }

    /// The position that values of the axes make; 0 where there is no axis.
    #[inline(always)]
    pub fn position(&self, of_axes: &[Fixed; AXES]) -> Position {
        let mut values = [Fixed(0); 8];
        values.iter_mut().zip(of_axes).for_each(|(value, of_axis)| *value = *of_axis);
        self.axes.map(|axis| one_of(&values, axis))
    }

    /// Where the axes are: a servo by its encoder, a step axis where it was told to be.
    #[inline(always)]
    pub fn actual(&self) -> [Fixed; AXES] {
        let mut actual = self.targets;
        for (place, servo) in actual.iter_mut().zip(&self.servos) {
            if let Some(axis) = servo {
                *place = axis.seen;
            }
        }
        actual
    }

    /// What each axis was told, for reports: a drive's command as the bits of an f32, or where a step axis stands, in steps.
    #[inline(always)]
    pub fn told(&self, commands: &Commands<AXES>) -> [u32; AXES] {
        let mut told = commands.commands.map(f32::to_bits);
        for (axis, (word, servo)) in told.iter_mut().zip(&self.servos).enumerate() {
            if servo.is_none() {
                *word = self.step_state.position(axis).unwrap_or(0) as u32;
            }
        }
        told
    }
}

/// The settings of the pulses of every axis on a board: what a decoder is made with.
pub fn step_settings<const AXES: usize>(
    axes: &[AxisSettings],
    pins: &[StepPins; AXES],
    slots: usize,
) -> [StepSettings; AXES] {
    let mut settings = pins.map(|pins| STILL.on_pins(pins.step, pins.direction, slots));
    for ((setting, pins), axis) in settings.iter_mut().zip(pins).zip(axes) {
        if let AxisDrive::Step(drive) = axis.drive {
            *setting = drive.on_pins(pins.step, pins.direction, slots);
        }
    }
    settings
}

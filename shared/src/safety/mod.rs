//! Safety: in which state the machine is, what that allows, and whether its position is known.
//!
//! [`Safety::step`] is called first in every tick with the levels at the inputs and with at most one event. What it returns holds for that
//! tick: a stop or a fault takes the drives' power and stops the setpoints in the tick that sees it.
//!
//! | input | acts | ends |
//! | --- | --- | --- |
//! | e-stop, drive fault | at once | after `release` ticks in a row, and an acknowledgement |
//! | limit switch | after `debounce` ticks in a row, while the machine moves | likewise |
//!
//! A limit switch by which an axis finds home does not trip during homing; the others do when they begin to act, so that an axis may leave
//! its far end. No job starts on a limit switch: the axis is homed, or moved by hand while a fault keeps the drives off.
//!
//! | the position is lost by | step axis | servo axis |
//! | --- | --- | --- |
//! | any reset of the controller | lost | lost |
//! | drives without power: every fault, e-stop, moving or not | lost: an unpowered rotor snaps to a full step, or is turned | known: the encoder counts on |
//! | a fault of its own drive | lost | lost: encoder and drive may share a supply |
//! | a following error of its own | - | lost: a failed encoder looks like this |
//! | the start of its homing, until it ends | lost | lost |
//! | hold, starvation, cancel | known | known |
//!
//! An encoder's position is known but not that of the setpoint: [`Outputs::resume_from_encoders`].
//!
//! Cost: no loop but the debouncing of six bits, no division, no float, no panic path.

mod debounce;
mod fault;
mod fault_word;
mod table;

#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

pub use debounce::Debounce;
pub use fault::{End, Fault, HomingFault, Refused, ResetCause};
pub use table::{Kind, Next, State};

/// The levels at the inputs, active where set; bit k is axis k. Polarity is applied by [`Wiring::levels`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Levels {
    /// The emergency stop is pressed.
    pub estop: bool,
    /// Limit switches at the low ends.
    pub low: u8,
    /// Limit switches at the high ends.
    pub high: u8,
    /// Home switches.
    pub home: u8,
    /// Drives that report a fault.
    pub drive_fault: u8,
}

/// Which inputs are connected, and which of them are active while low. Normally closed contacts that pull an input low are active
/// while it is high: a broken wire then looks like a pressed switch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wiring {
    /// The inputs that are connected.
    pub connected: Levels,
    /// The inputs that are active while low.
    pub active_low: Levels,
}

impl Wiring {
    /// The levels as they are meant, from those at the pins.
    #[inline]
    pub fn levels(&self, pins: Levels) -> Levels {
        let (used, low) = (&self.connected, &self.active_low);
        Levels {
            estop: (pins.estop ^ low.estop) & used.estop,
            low: (pins.low ^ low.low) & used.low,
            high: (pins.high ^ low.high) & used.high,
            home: (pins.home ^ low.home) & used.home,
            drive_fault: (pins.drive_fault ^ low.drive_fault) & used.drive_fault,
        }
    }
}

/// What holds for a machine as long as it is configured so. Any value is usable; bit k is axis k.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SafetyConfig {
    /// The axes that there are.
    pub axes: u8,
    /// The axes with an encoder; the others are step axes.
    pub encoders: u8,
    /// The axes that can find home.
    pub homing: u8,
    /// The axes that find home by the limit switch at their low end.
    pub home_low: u8,
    /// The axes that find home by the limit switch at their high end.
    pub home_high: u8,
    /// Ticks for which a limit switch must act.
    pub debounce: u8,
    /// Ticks for which an emergency stop or a drive's fault must have ended.
    pub release: u8,
}

/// The coordinates of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Coordinates {
    /// From the machine's zero; they need a known position.
    Machine,
    /// From where the machine stands.
    Relative,
}

/// What happens to a machine besides its inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The tick found something wrong.
    Trip(Fault),
    /// See [`Kind::Acknowledge`].
    Acknowledge,
    /// Look for home with these axes.
    Home {
        /// Bit k is axis k.
        axes: u8,
    },
    /// These axes have found home.
    AxisHomed {
        /// Bit k is axis k.
        axes: u8,
    },
    /// See [`Kind::Homed`].
    Homed,
    /// Run a job.
    Start(Coordinates),
    /// See [`Kind::Hold`].
    Hold,
    /// See [`Kind::Resume`].
    Resume,
    /// See [`Kind::Cancel`].
    Cancel,
    /// See [`Kind::AtRest`].
    AtRest,
    /// See [`Kind::End`].
    End,
}

impl Event {
    const fn kind(self) -> Kind {
        match self {
            Self::Trip(_) => Kind::Trip,
            Self::Acknowledge => Kind::Acknowledge,
            Self::Home { .. } => Kind::Home,
            Self::AxisHomed { .. } => Kind::AxisHomed,
            Self::Homed => Kind::Homed,
            Self::Start(_) => Kind::Start,
            Self::Hold => Kind::Hold,
            Self::Resume => Kind::Resume,
            Self::Cancel => Kind::Cancel,
            Self::AtRest => Kind::AtRest,
            Self::End => Kind::End,
        }
    }
}

/// What the machine remembers between two ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Safety {
    state: State,
    /// The axes whose position is known.
    known: u8,
    fault: Option<Fault>,
    estop: Debounce,
    drive_fault: Debounce,
    low: Debounce,
    high: Debounce,
}

/// What holds for this tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outputs {
    /// The state.
    pub state: State,
    /// Whether the drives shall have power. Without it no pulses are put out and all commands are zero.
    pub drives: bool,
    /// Whether setpoints may advance. Where they may not, a job or a homing is over.
    pub advance: bool,
    /// The axes whose position is known; bit k is axis k.
    pub known: u8,
    /// What is wrong, until it is acknowledged.
    pub fault: Option<Fault>,
    /// Why this tick's command was refused.
    pub refused: Option<Refused>,
    /// The drives get their power back in this tick: the setpoint of an axis with an encoder is to be set to where the encoder is, so
    /// that it does not jump.
    pub resume_from_encoders: bool,
}

impl Safety {
    /// The state after a reset: idle or at fault, with every position unknown.
    pub fn after_reset(cause: ResetCause) -> Self {
        let (state, fault) = match cause {
            ResetCause::Ordinary => (State::Idle, None),
            cause => (State::Fault, Some(Fault::Reset { cause })),
        };
        Self {
            state,
            known: 0,
            fault,
            estop: Debounce::default(),
            drive_fault: Debounce::default(),
            low: Debounce::default(),
            high: Debounce::default(),
        }
    }

    /// The state.
    pub fn state(&self) -> State {
        self.state
    }

    /// The state, what is wrong, and the axes whose position is known.
    #[inline(always)]
    pub fn summary(&self) -> (State, Option<Fault>, u8) {
        (self.state, self.fault, self.known)
    }

    /// Whether no input acts and none did lately, so that nothing is being debounced.
    #[inline(always)]
    fn is_quiet(&self, levels: &Levels) -> bool {
        let acting = u8::from(levels.estop) | levels.low | levels.high | levels.drive_fault;
        let debounced = self.estop.rests() & self.drive_fault.rests() & self.low.rests() & self.high.rests();
        acting == 0 && debounced
    }

    /// One tick. The emergency stop comes first, then a drive's fault, a limit switch, and the event.
    #[inline(always)]
    pub fn step(&mut self, config: &SafetyConfig, levels: Levels, event: Option<Event>) -> Outputs {
        let before = self.state;
        let mut refused = None;
        // Nearly every tick of a machine's life.
        if event.is_some() || !self.is_quiet(&levels) {
            refused = self.judge(config, levels, event);
        }
        let state = self.state;
        Outputs {
            state,
            drives: state.has_drives(),
            advance: state.advances(),
            known: self.known,
            fault: self.fault,
            refused,
            resume_from_encoders: state.has_drives() && !before.has_drives(),
        }
    }

    /// A tick in which something happens. Returns why the event was refused.
    #[inline(never)]
    fn judge(&mut self, config: &SafetyConfig, levels: Levels, event: Option<Event>) -> Option<Refused> {
        let pressed = self.estop.asymmetric(u8::from(levels.estop), 1, config.release) != 0;
        let drives = self.drive_fault.asymmetric(levels.drive_fault & config.axes, 1, config.release);
        let limits = self.limits(config, levels);

        // A drive at fault has lost its position in whatever state the machine is.
        self.known &= !drives;
        if pressed {
            self.enter(config, State::EStop);
        }
        if let Some(axis) = first(drives) {
            self.trip(config, Fault::Drive { axis });
        }
        if let Some(fault) = limits {
            self.trip(config, fault);
        }
        match event {
            Some(Event::Trip(fault)) => {
                self.trip(config, fault);
                None
            }
            Some(event) => self.take(config, event, pressed, drives),
            None => None,
        }
    }

    /// Whether a job in machine coordinates would be started now.
    pub fn is_ready(&self, config: &SafetyConfig) -> bool {
        self.start_refusal(config, Coordinates::Machine).is_none()
    }

    /// Debounces the limit switches, and finds the one that trips.
    fn limits(&mut self, config: &SafetyConfig, levels: Levels) -> Option<Fault> {
        let before = [self.low.level(), self.high.level()];
        let low = self.low.step(levels.low & config.axes, config.debounce);
        let high = self.high.step(levels.high & config.axes, config.debounce);
        let [low, high] = match self.state {
            State::Homing => [low & !before[0] & !config.home_low, high & !before[1] & !config.home_high],
            state if state.advances() => [low, high],
            _ => return None,
        };
        match (first(low), first(high)) {
            (Some(axis), _) => Some(Fault::Limit { axis, end: End::Low }),
            (None, Some(axis)) => Some(Fault::Limit { axis, end: End::High }),
            (None, None) => None,
        }
    }

    /// The command or the news of this tick.
    fn take(&mut self, config: &SafetyConfig, event: Event, pressed: bool, drives: u8) -> Option<Refused> {
        let next = match self.state.after(event.kind()) {
            Next::To(next) => next,
            Next::Refused => return Some(Refused::State { state: self.state }),
            Next::Nothing => return None,
        };
        match event {
            Event::Acknowledge if pressed => return Some(Refused::EStopPressed),
            Event::Acknowledge => {
                if let Some(axis) = first(drives) {
                    return Some(Refused::DriveFault { axis });
                }
                self.fault = None;
            }
            Event::Home { axes } if axes == 0 || axes & !(config.homing & config.axes) != 0 => {
                return Some(Refused::NoHome);
            }
            Event::Home { axes } => self.known &= !axes,
            Event::AxisHomed { axes } => self.known |= axes & config.axes,
            Event::Start(coordinates) => {
                if let Some(refused) = self.start_refusal(config, coordinates) {
                    return Some(refused);
                }
            }
            _ => {}
        }
        self.enter(config, next);
        None
    }

    /// Why a job could not be started now.
    pub(crate) fn start_refusal(&self, config: &SafetyConfig, coordinates: Coordinates) -> Option<Refused> {
        if !self.state.takes_jobs() {
            return Some(Refused::State { state: self.state });
        }
        if config.axes == 0 {
            return Some(Refused::NoMachine);
        }
        if let Some(axis) = first(self.low.level() | self.high.level()) {
            return Some(Refused::OnLimit { axis });
        }
        match coordinates {
            Coordinates::Machine => first(config.axes & !self.known).map(|axis| Refused::PositionUnknown { axis }),
            Coordinates::Relative => None,
        }
    }

    fn trip(&mut self, config: &SafetyConfig, fault: Fault) {
        if let Fault::FollowingError { axis } | Fault::Drive { axis } = fault {
            self.known &= !1_u8.wrapping_shl(u32::from(axis));
        }
        self.fault = self.fault.or(Some(fault));
        if let Next::To(next) = self.state.after(Kind::Trip) {
            self.enter(config, next);
        }
    }

    fn enter(&mut self, config: &SafetyConfig, state: State) {
        self.state = state;
        if !state.has_drives() {
            self.known &= config.encoders;
        }
    }
}

/// The lowest axis of a set.
#[inline(always)]
fn first(axes: u8) -> Option<u8> {
    (axes != 0).then_some(axes.trailing_zeros() as u8)
}

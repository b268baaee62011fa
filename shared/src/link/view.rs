//! The tick's status and answers in the words of the link: the same for every controller, a board or a simulated one.

use super::action::Action;
use super::endpoint::End;
use super::message::{Ending, MotionState, Refusal, Telemetry};
use crate::control::{Directive, DirectiveError, PathEnd, Status};
use crate::loader::Bounds;
use crate::machine::Machine;
use crate::safety::Coordinates;
use crate::{motion, safety};

impl<const AXES: usize> Status<AXES> {
    /// What the controller is doing. `loading` is what only the endpoint knows.
    pub fn motion_state(&self, loading: bool) -> MotionState {
        match (self.machine, self.motion) {
            (safety::State::EStop, _) => MotionState::Stopped,
            (safety::State::Fault, _) => MotionState::Fault,
            (safety::State::Homing, _) => MotionState::Homing,
            (safety::State::Braking, motion::State::Idle) => MotionState::Braking,
            (_, motion::State::Idle | motion::State::Finished | motion::State::Cancelled) if loading => {
                MotionState::Loading
            }
            (_, state) => state.into(),
        }
    }

    /// How the path that was started has ended, once it has.
    pub fn end(&self) -> Option<End> {
        match self.path {
            PathEnd::None | PathEnd::Running => None,
            PathEnd::Finished => Some(End::Finished { ticks: self.ticks, residual: self.residual, hash: self.hash }),
            PathEnd::Cancelled => Some(End::Early(Ending::Cancelled)),
            PathEnd::Stopped => Some(End::Early(Ending::Stopped)),
            PathEnd::Faulted(fault) => Some(End::Early(Ending::Fault(fault))),
        }
    }

    /// What a host is told of a machine with these axes, without what only the endpoint, a clock or a stack knows.
    pub fn telemetry(&self, axes: u8, loading: bool) -> Telemetry {
        Telemetry {
            state: self.motion_state(loading),
            machine: self.machine,
            fault: self.fault,
            axes,
            known: self.known,
            tick: self.ticks,
            pieces: self.pieces,
            setpoint: self.position,
            actual: self.actual,
            percent: self.percent,
            ..Telemetry::default()
        }
    }

    /// Whether a job may begin now. Errors: why not.
    pub fn ready(&self) -> Result<(), Refusal> {
        match (self.fault, self.machine, self.path) {
            (Some(fault), ..) => Err(Refusal::Fault(fault)),
            (None, safety::State::EStop, _) => Err(Refusal::Stopped),
            (None, _, PathEnd::Running) => Err(Refusal::Busy),
            _ => Ok(()),
        }
    }

    /// How far a path in these coordinates may go on this machine; none where nobody knows where it stands.
    pub fn bounds(&self, machine: &Machine, coordinates: Coordinates) -> Option<Bounds> {
        let limits = machine.soft_limits();
        let [x, y, z] = self.position;
        match coordinates {
            Coordinates::Machine => Some(Bounds::machine(limits)),
            Coordinates::Relative if self.known == machine.safety.axes => Some(Bounds::from_here(limits, [x, y], [z])),
            Coordinates::Relative => None,
        }
    }
}

impl Action {
    /// What the tick is asked for; none where it has no say.
    pub fn directive(&self) -> Option<Directive> {
        match *self {
            Self::Motion(command) => Some(Directive::Motion(command)),
            Self::Home => Some(Directive::Home { axes: 0 }),
            Self::Acknowledge => Some(Directive::Acknowledge),
            Self::WriteImage { .. } | Self::CommitImage { .. } | Self::ReadImage { .. } => None,
        }
    }
}

impl From<DirectiveError> for Refusal {
    fn from(error: DirectiveError) -> Self {
        match error {
            DirectiveError::Motion(error) => Self::Motion(error),
            DirectiveError::Machine(refused) => Self::Machine(refused),
        }
    }
}

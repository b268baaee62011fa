//! What the tick is asked for, and what it says of it.

use crate::fixed::Fixed;
use crate::loader::Motion;
use crate::motion::{CommandError, MotionCommand};
use crate::safety::{Coordinates, Event, Refused};

/// What somebody outside the tick asks of it; at most one is taken a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Directive {
    /// Begin the path whose first pieces stand in the queue.
    Start(Start),
    /// Change the motion that there is.
    Motion(MotionCommand),
    /// Look for home with these axes; bit k is axis k, and none are all that can.
    Home {
        /// The axes.
        axes: u8,
    },
    /// A person has seen what was wrong.
    Acknowledge,
    /// Forget the pieces in the queue and the path that was run, with nothing moving.
    Clear,
}

/// How a path begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// What the executor must know.
    pub motion: Motion<f32>,
    /// What the path's coordinates mean.
    pub coordinates: Coordinates,
    /// Its first point.
    pub at: [Fixed; 2],
    /// Where z begins; none where the path does not speak of it.
    pub further: Option<[Fixed; 1]>,
}

/// Why the tick did not do as it was asked; nothing has changed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DirectiveError {
    /// The machine's state does not allow it.
    Machine(Refused),
    /// The motion does not allow it.
    Motion(CommandError),
}

impl Directive {
    /// What it is to the table of states; none where that has no say.
    pub(super) fn event(&self, can_home: u8) -> Option<Event> {
        match *self {
            Self::Start(Start { coordinates, .. }) => Some(Event::Start(coordinates)),
            Self::Motion(MotionCommand::Hold) => Some(Event::Hold),
            Self::Motion(MotionCommand::Resume) => Some(Event::Resume),
            Self::Motion(MotionCommand::Cancel) => Some(Event::Cancel),
            Self::Motion(MotionCommand::Override { .. } | MotionCommand::SingleBlock(_)) | Self::Clear => None,
            Self::Home { axes: 0 } => Some(Event::Home { axes: can_home }),
            Self::Home { axes } => Some(Event::Home { axes }),
            Self::Acknowledge => Some(Event::Acknowledge),
        }
    }
}

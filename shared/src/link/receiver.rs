//! The controller's half of the sequence.

use super::frame::{FrameError, NO_SESSION, Received};
use super::message::{Command, LinkError};

/// Keeps the session and the next expected numbers. It decides whether a command is taken; what the command does is the caller's.
#[derive(Clone, Copy, Debug, Default)]
pub struct Receiver {
    session: u32,
    next: u16,
    next_action: u16,
}

/// What is to be done with what came.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Turn {
    /// Carry it out; its sequence number is here for a refusal.
    Take(u16, Command),
    /// It was carried out before: acknowledge it again.
    Repeated,
    /// The last action again: answer again what came of it.
    RepeatedAction(u16),
    /// Say what is expected instead.
    Refuse(LinkError),
    /// From another time or for nobody; say nothing.
    Ignore,
}

impl Receiver {
    /// In no session.
    pub const fn new() -> Self {
        Self { session: NO_SESSION, next: 0, next_action: 0 }
    }

    /// The session that is open.
    pub fn session(&self) -> u32 {
        self.session
    }

    /// The next expected sequence number.
    pub fn next(&self) -> u16 {
        self.next
    }

    /// Opens a session: the sequence begins at 1, behind the `Hello`.
    pub fn open(&mut self, session: u32) {
        *self = Self { session, next: 1, next_action: 0 };
    }

    /// Judges what the decoder found, and moves on to the next number if this one's turn has come.
    pub fn turn(&mut self, found: Result<Received<Command>, FrameError>) -> Turn {
        let Received { session, sequence, message: command } = match found {
            Ok(found) => found,
            Err(error) => return Turn::Refuse(LinkError::Frame(error)),
        };
        match command {
            Command::Hello { session, .. } if session == NO_SESSION => return Turn::Ignore,
            Command::Hello { .. } | Command::Status => return Turn::Take(sequence, command),
            _ if session == NO_SESSION => return Turn::Ignore,
            Command::Abort => return Turn::Take(sequence, command),
            Command::Act(_) => return self.action(sequence, command),
            Command::Begin(..) | Command::Piece(_) | Command::Run => {}
        }
        match sequence.wrapping_sub(self.next) {
            0 => {
                self.next = self.next.wrapping_add(1);
                Turn::Take(sequence, command)
            }
            // Half of all numbers lie behind, half ahead; a window is far smaller than either.
            ahead if ahead < 0x8000 => Turn::Refuse(LinkError::Gap { found: sequence }),
            _ => Turn::Repeated,
        }
    }

    fn action(&mut self, number: u16, command: Command) -> Turn {
        if number == self.next_action {
            self.next_action = self.next_action.wrapping_add(1);
            return Turn::Take(number, command);
        }
        // One is under way at a time: what is not the last one is a late copy.
        if number.wrapping_add(1) == self.next_action { Turn::RepeatedAction(number) } else { Turn::Ignore }
    }
}

#[cfg(test)]
mod tests {
    use super::super::action::Action;
    use super::*;

    const SESSION: u32 = 77;
    const RUN: Command = Command::Run;

    fn said(session: u32, sequence: u16, message: Command) -> Result<Received<Command>, FrameError> {
        Ok(Received { session, sequence, message })
    }

    #[test]
    fn only_the_next_one_is_taken() {
        let mut receiver = Receiver::new();
        receiver.open(SESSION);
        let mut turn = |sequence, command| receiver.turn(said(SESSION, sequence, command));
        assert_eq!(turn(1, RUN), Turn::Take(1, RUN));
        assert_eq!(turn(1, RUN), Turn::Repeated);
        assert_eq!(turn(3, RUN), Turn::Refuse(LinkError::Gap { found: 3 }));
        assert_eq!(turn(9, Command::Status), Turn::Take(9, Command::Status));
        assert_eq!(receiver.turn(Err(FrameError::Corrupted)), Turn::Refuse(LinkError::Frame(FrameError::Corrupted)));
        assert_eq!(receiver.next(), 2);
    }

    /// An action is carried out once, whatever else is under way and however often it comes.
    #[test]
    fn an_action_is_taken_once() {
        let mut receiver = Receiver::new();
        receiver.open(SESSION);
        let home = Command::Act(Action::Home);
        let mut turn = |sequence| receiver.turn(said(SESSION, sequence, home));
        assert_eq!(turn(0), Turn::Take(0, home));
        assert_eq!(turn(0), Turn::RepeatedAction(0));
        assert_eq!(turn(1), Turn::Take(1, home));
        assert_eq!((turn(0), turn(3)), (Turn::Ignore, Turn::Ignore));
    }

    /// Outside a session nothing moves.
    #[test]
    fn in_no_session_one_may_only_look() {
        let mut receiver = Receiver::new();
        for command in [RUN, Command::Abort, Command::Act(Action::Home)] {
            assert_eq!(receiver.turn(said(NO_SESSION, 0, command)), Turn::Ignore);
        }
        assert_eq!(receiver.turn(said(NO_SESSION, 0, Command::Status)), Turn::Take(0, Command::Status));
    }
}

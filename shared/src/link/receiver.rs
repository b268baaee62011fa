//! The controller's half of the sequence.

use super::frame::FrameError;
use super::message::{Command, LinkError};

/// Keeps the next expected sequence number. It decides whether a command is taken; what the command does is the caller's.
#[derive(Clone, Copy, Debug, Default)]
pub struct Receiver {
    next: u16,
}

/// What is to be done with what came.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Turn {
    /// Carry it out; its sequence number is here for a refusal.
    Take(u16, Command),
    /// It was carried out before: acknowledge it again.
    Repeated,
    /// Say what is expected instead.
    Refuse(LinkError),
}

impl Receiver {
    /// Expects sequence number 0, though a `Hello` may start elsewhere.
    pub const fn new() -> Self {
        Self { next: 0 }
    }

    /// The next expected sequence number.
    pub fn next(&self) -> u16 {
        self.next
    }

    /// Judges what the decoder found, and moves on to the next number if this one's turn has come.
    pub fn turn(&mut self, found: Result<(u16, Command), FrameError>) -> Turn {
        let (sequence, command) = match found {
            Ok(found) => found,
            Err(error) => return Turn::Refuse(LinkError::Frame(error)),
        };
        if let Command::Hello { .. } = command {
            self.next = sequence.wrapping_add(1);
            return Turn::Take(sequence, command);
        }
        if !command.is_sequenced() {
            return Turn::Take(sequence, command);
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_next_one_is_taken() {
        let mut receiver = Receiver::new();
        let hello = Command::Hello { version: 1 };
        assert_eq!(receiver.turn(Ok((0xfffe, hello))), Turn::Take(0xfffe, hello));
        assert_eq!(receiver.turn(Ok((0xffff, Command::Run))), Turn::Take(0xffff, Command::Run));
        assert_eq!(receiver.turn(Ok((0xffff, Command::Run))), Turn::Repeated);
        assert_eq!(receiver.turn(Ok((1, Command::Run))), Turn::Refuse(LinkError::Gap { found: 1 }));
        assert_eq!(receiver.turn(Ok((9, Command::Status))), Turn::Take(9, Command::Status));
        assert_eq!(receiver.turn(Err(FrameError::Corrupted)), Turn::Refuse(LinkError::Frame(FrameError::Corrupted)));
        assert_eq!(receiver.next(), 0);
        assert_eq!(receiver.turn(Ok((0, Command::Run))), Turn::Take(0, Command::Run));
    }
}

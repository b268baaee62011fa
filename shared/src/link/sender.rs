//! The host's half of the link: sends a job, whole and in order, over a line that loses things.
//!
//! It owns no port and no clock. The caller hands it what was received, sends what [`Sender::poll`] returns, and says what time it
//! is, in microseconds from any start. The virtual board and a real serial port drive the same code.
//!
//! Without a job it opens a session and carries actions only.
//!
//! A job becomes a script of commands, numbered from 0: `Hello`, `Begin`, as many pieces as the queue holds, `Run`, and the pieces
//! that are left. So a job that fits into the queue is refused as a whole before anything moves.

use heapless::Deque;

use super::action::Action;
use super::event::{Event, SenderError};
use super::frame::{Decoder, FRAME_SIZE, Frame, NO_SESSION, encode};
use super::message::{Command, Refusal, Report, VERSION};
use crate::piece::{Header, Piece};
use crate::safety::Coordinates;

/// Bytes that a controller can hold before its endpoint looks at them; it discards none.
pub const RECEIVE_SIZE: usize = 2_048;

/// Bytes of a job in flight at a time: what the controller can hold, less a longest frame for an action and one for a sign of life. At
/// 1 Mbaud that keeps the line busy for 18 ms, and a USB adapter that takes 16 ms each way still lets 600 pieces of 62 to 84 bytes through
/// in a second (`tests/tests/link_speed.rs`).
pub const WINDOW: usize = RECEIVE_SIZE - FRAME_SIZE - 16;

/// A slow line gets so much at a time, in microseconds: what was sent before a fault was heard of delays all that is sent again.
const WINDOW_US: u64 = 50_000;

/// Commands in flight at a time, however short: as many as the firmware's queue holds pieces, and `Begin`.
const MOST_IN_FLIGHT: usize = 64;

/// A command that was not acknowledged for so long is sent again, in microseconds. A window that was in vain and the one behind it take
/// 50 ms each on a slow line, and a USB adapter may keep each way for 16 ms.
pub const TIMEOUT_US: u64 = 150_000;

/// A host that has nothing to say asks for the status after so long, in microseconds, so that the controller knows it is there.
pub const SIGN_OF_LIFE_US: u64 = 250_000;

/// Actions that may wait for their turn.
pub const ACTIONS: usize = 8;

/// A command is sent so many times before the sender gives up. Where a third of all questions stay without an answer, that happens by chance
/// once in 6e4.
pub const TRIES: u32 = 10;

/// Sends one job. See the module.
#[derive(Clone, Debug)]
pub struct Sender<'a> {
    session: u32,
    header: Option<&'a Header<f32>>,
    pieces: &'a [Piece<f32>],
    coordinates: Coordinates,
    decoder: Decoder,
    /// Bytes of the job that may be in flight, and the frames that are: those from `acknowledged` to `next`.
    window: usize,
    in_flight: Deque<u8, MOST_IN_FLIGHT>,
    actions: Deque<Action, ACTIONS>,
    /// The number of the first of them, when it was sent, and how often.
    action_number: u16,
    action_sent_us: Option<u64>,
    action_tries: u32,
    said_us: u64,
    /// The controller's queue, once it has said hello.
    capacity: Option<u32>,
    /// The first command that is not acknowledged.
    acknowledged: u32,
    /// The next command to send; goes back to `acknowledged` when something was lost.
    next: u32,
    /// One past the last command that was ever sent.
    sent: u32,
    /// Pieces that may be sent in all, as far as the controller has said.
    allowed: u32,
    /// The command that the sender went back to last; it goes back once, and then on time only.
    back: Option<u32>,
    tries: u32,
    resent: u32,
    heard_us: u64,
    finished: bool,
    error: Option<SenderError>,
    last_refusal: Option<Refusal>,
}

impl<'a> Sender<'a> {
    /// A sender of the job of `header` and `pieces`, in a session of this number, which was not used lately.
    pub fn new(session: u32, header: &'a Header<f32>, pieces: &'a [Piece<f32>]) -> Self {
        Self { header: Some(header), pieces, ..Self::without_job(session) }
    }

    /// A session without a job, for actions.
    pub fn without_job(session: u32) -> Self {
        // A session of number 0 would be none.
        let session = session.max(1);
        let mut decoder = Decoder::new();
        decoder.enter(session);
        Self {
            session,
            header: None,
            pieces: &[],
            coordinates: Coordinates::Machine,
            decoder,
            window: WINDOW,
            in_flight: Deque::new(),
            actions: Deque::new(),
            action_number: 0,
            action_sent_us: None,
            action_tries: 0,
            said_us: 0,
            capacity: None,
            acknowledged: 0,
            next: 0,
            sent: 0,
            allowed: 0,
            back: None,
            tries: 0,
            resent: 0,
            heard_us: 0,
            finished: false,
            error: None,
            last_refusal: None,
        }
    }

    /// The same with the job in these coordinates, and not in those of the machine.
    pub fn in_coordinates(self, coordinates: Coordinates) -> Self {
        Self { coordinates, ..self }
    }

    /// The same over a line of so many bits a second, ten for a byte.
    pub fn at_baud(self, baud: u32) -> Self {
        let bytes = u64::from(baud) / 10 * WINDOW_US / 1_000_000;
        Self { window: usize::try_from(bytes).unwrap_or(WINDOW).clamp(FRAME_SIZE, WINDOW), ..self }
    }

    /// Asks for an action; false where too many wait already.
    pub fn act(&mut self, action: Action) -> bool {
        self.actions.push_back(action).is_ok()
    }

    /// The next frame to put on the wire, if there is one now. Call until there is none.
    pub fn poll(&mut self, now_us: u64) -> Option<Frame> {
        let frame = self.choose(now_us)?;
        self.said_us = now_us;
        Some(frame)
    }

    fn choose(&mut self, now_us: u64) -> Option<Frame> {
        if self.finished || self.error.is_some() {
            return None;
        }
        if self.sent > 0 && now_us.saturating_sub(self.heard_us) > TIMEOUT_US {
            self.heard_us = now_us;
            self.tries += 1;
            if self.tries >= TRIES {
                self.error = Some(SenderError::Lost { reason: self.last_refusal });
                return None;
            }
            if self.acknowledged == self.sent {
                // Everything has arrived, or there is no room: a lost report is all that can be missing.
                return encode(self.session, self.next as u16, &Command::Status);
            }
            self.go_back();
        }
        self.action(now_us).or_else(|| self.script(now_us)).or_else(|| self.sign_of_life(now_us))
    }

    /// The action whose turn it is, where it was not sent or not answered.
    fn action(&mut self, now_us: u64) -> Option<Frame> {
        self.capacity?;
        let action = *self.actions.front()?;
        if self.action_sent_us.is_some_and(|sent| now_us.saturating_sub(sent) <= TIMEOUT_US) {
            return None;
        }
        self.resent += u32::from(self.action_tries > 0);
        self.action_tries += 1;
        if self.action_tries > TRIES {
            self.error = Some(SenderError::Lost { reason: self.last_refusal });
            return None;
        }
        self.action_sent_us = Some(now_us);
        encode(self.session, self.action_number, &Command::Act(action))
    }

    fn sign_of_life(&self, now_us: u64) -> Option<Frame> {
        let due = self.capacity.is_some() && now_us.saturating_sub(self.said_us) >= SIGN_OF_LIFE_US;
        if due { encode(self.session, self.next as u16, &Command::Status) } else { None }
    }

    /// The next command of the job, where window and room allow it.
    fn script(&mut self, now_us: u64) -> Option<Frame> {
        let command = self.command(self.next)?;
        if matches!(command, Command::Run) && self.acknowledged < self.next {
            // Nothing starts before all that is to be there has been taken: a refused piece is heard of first.
            return None;
        }
        let in_flight: usize = self.in_flight.iter().map(|&length| usize::from(length)).sum();
        if in_flight >= self.window || self.pieces_before(self.next + 1) > self.allowed {
            return None;
        }
        let session = if self.next == 0 { NO_SESSION } else { self.session };
        let frame = encode(session, self.next as u16, &command)?;
        if in_flight + frame.len() > self.window || self.in_flight.push_back(frame.len() as u8).is_err() {
            return None;
        }
        if self.sent == self.acknowledged {
            // Nothing was on its way: the wait begins now.
            self.heard_us = now_us;
        }
        self.next += 1;
        self.sent = self.sent.max(self.next);
        Some(frame)
    }

    /// Takes one received byte.
    pub fn receive(&mut self, now_us: u64, byte: u8) -> Option<Event> {
        // A broken report is made good by the next one, or by asking for the status.
        let said = self.decoder.push::<Report>(byte)?.ok()?;
        // A conversation begins outside its session. Until it has begun, and there alone, what is said in none is for us.
        let beginning = self.capacity.is_none();
        if (said.session == NO_SESSION) != beginning {
            return None;
        }
        match said.message {
            Report::Hello { session, .. } if session != self.session => None,
            Report::Hello { version, .. } if version != VERSION => Some(self.fail(None, Refusal::Version { version })),
            Report::Hello { identity, .. } => {
                self.capacity = Some(u32::from(identity.capacity).max(1));
                self.advance(now_us, 1, identity.capacity);
                Some(Event::Hello(identity))
            }
            // Somebody else's.
            Report::Telemetry(_) if beginning => None,
            Report::Ack { next, room } => {
                self.advance(now_us, next, room);
                None
            }
            Report::Refused { sequence, reason: Refusal::Link(link) } => {
                self.last_refusal = Some(Refusal::Link(link));
                self.advance(now_us, sequence, 0);
                if self.back != Some(self.acknowledged) {
                    self.go_back();
                }
                None
            }
            Report::Refused { sequence, reason } => Some(self.fail(self.piece_of(sequence), reason)),
            Report::Telemetry(telemetry) => {
                // The controller lives; and it says again what it has taken.
                self.advance(now_us, telemetry.next, telemetry.room);
                Some(Event::Telemetry(telemetry))
            }
            Report::Finished { ticks, residual, hash } => {
                self.finished = true;
                Some(Event::Finished { ticks, residual, hash })
            }
            Report::Ended(ending) => {
                self.finished = true;
                Some(Event::Ended(ending))
            }
            Report::Done { number, outcome } => {
                if number != self.action_number || self.action_tries == 0 {
                    return None;
                }
                let action = self.actions.pop_front()?;
                self.action_number = self.action_number.wrapping_add(1);
                (self.action_sent_us, self.action_tries) = (None, 0);
                Some(Event::Done(action, outcome))
            }
        }
    }

    /// The frame that stops the motion at once.
    pub fn abort(&self) -> Option<Frame> {
        encode(self.session, self.next as u16, &Command::Abort)
    }

    /// Why the job failed, if it did.
    pub fn error(&self) -> Option<SenderError> {
        self.error
    }

    /// Commands of the job that were sent at least once.
    pub fn sent(&self) -> u32 {
        self.sent
    }

    /// Commands of the job that the controller has taken.
    pub fn acknowledged(&self) -> u32 {
        self.acknowledged
    }

    /// Whether the controller has reported the end of the job.
    pub fn is_finished(&self) -> bool {
        self.finished
    }

    /// Pieces that the controller has taken.
    pub fn acknowledged_pieces(&self) -> u32 {
        self.pieces_before(self.acknowledged)
    }

    /// Commands that were sent more than once.
    pub fn resent(&self) -> u32 {
        self.resent
    }

    fn heard(&mut self, now_us: u64) {
        self.heard_us = now_us;
        self.tries = 0;
    }

    /// Everything before `sequence` has arrived, and `room` more pieces may follow.
    fn advance(&mut self, now_us: u64, sequence: u16, room: u16) {
        if self.capacity.is_none() {
            // Until the controller has said hello, it may be counting from an earlier conversation.
            return;
        }
        let progress = u32::from(sequence.wrapping_sub(self.acknowledged as u16));
        if progress > self.sent - self.acknowledged {
            return;
        }
        self.acknowledged += progress;
        for _ in 0..progress {
            if self.in_flight.pop_front().is_none() {
                break;
            }
        }
        self.next = self.next.max(self.acknowledged);
        self.allowed = self.allowed.max(self.pieces_before(self.acknowledged) + u32::from(room));
        if progress > 0 || self.acknowledged == self.sent {
            self.heard(now_us);
        }
    }

    fn go_back(&mut self) {
        self.back = Some(self.acknowledged);
        self.resent += self.next - self.acknowledged;
        self.next = self.acknowledged;
        self.in_flight.clear();
    }

    fn fail(&mut self, piece: Option<u32>, reason: Refusal) -> Event {
        let error = *self.error.get_or_insert(SenderError::Refused { piece, reason });
        Event::Failed(error)
    }

    /// Where `Run` stands in the script: behind as many pieces as the queue holds.
    fn run_index(&self) -> u32 {
        self.capacity.unwrap_or(0).min(self.pieces.len() as u32) + 2
    }

    /// The command at `index` of the script; none at its end, and none behind `Hello` before that was answered.
    fn command(&self, index: u32) -> Option<Command> {
        if index == 0 {
            return Some(Command::Hello { version: VERSION, session: self.session });
        }
        self.capacity?;
        let header = self.header?;
        let run = self.run_index();
        match index {
            1 => Some(Command::Begin(*header, self.coordinates)),
            _ if index == run => Some(Command::Run),
            _ => self.pieces.get(self.pieces_before(index) as usize).copied().map(Command::Piece),
        }
    }

    /// How many of the commands before `index` are pieces.
    fn pieces_before(&self, index: u32) -> u32 {
        let others = if index > self.run_index() { 3 } else { 2 };
        index.saturating_sub(others).min(self.pieces.len() as u32)
    }

    /// The piece that travels under `sequence`.
    fn piece_of(&self, sequence: u16) -> Option<u32> {
        let index =
            self.acknowledged.wrapping_add_signed(i32::from(sequence.wrapping_sub(self.acknowledged as u16) as i16));
        matches!(self.command(index), Some(Command::Piece(_))).then(|| self.pieces_before(index))
    }
}

#[cfg(test)]
#[path = "sender_tests.rs"]
mod tests;

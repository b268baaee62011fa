//! Conversations with a controller's end of the link that are made of any bytes: what the fuzz targets and the properties of plain
//! `cargo test` have in common.
//!
//! Whoever has only bytes would hardly ever find a whole frame; so most of what a script says is whole, has its turn, and is faulty
//! inside.

use serde::ser::{Serialize, SerializeTuple, Serializer};
use shared::complex::Complex;
use shared::feed::Ramp;
use shared::fixed::Fixed;
use shared::further::Travel;
use shared::link::{
    Action, Answer, Chunk, Command, Decoder, Ending, Endpoint, FRAME_SIZE, Frame, Identity, NO_SESSION, Refusal,
    Report, Telemetry, VERSION, encode,
};
use shared::motion::MotionCommand;
use shared::pace::PaceLimits;
use shared::piece::{Header, Order, Piece, Shape};
use shared::profile::Profile;
use shared::safety::{Coordinates, End, Fault, Refused};

use crate::strict_machine::StrictMachine;

/// The session of all that is not said otherwise.
pub const SESSION: u32 = 0x5eed_1234;

/// A job whose pieces may lie anywhere: a gap of a metre is none.
pub const HEADER: Header<f32> =
    Header { weight: 0.5, order: Order::First, closed: false, tolerance: 1e3, rest: true, pace: PaceLimits::USUAL };

fn piece(shape: Shape<f32>) -> Piece<f32> {
    Piece {
        origin: [Fixed(0); 2],
        shape,
        interval: [0.0, 1.0],
        feed: 40.0,
        start: None,
        end: None,
        profile: None,
        further: None,
        last: None,
    }
}

/// One command of every kind and every shape, all of them good.
pub fn commands() -> Vec<Command> {
    let line = piece(Shape::Line { chord: Complex::new(2.0, 1.0) });
    let arc = Shape::Arc { radius: Complex::new(1.0, 0.0), sweep: 1.5, ratio: 1.0 };
    let w = [Complex::new(1.0, 0.0), Complex::new(0.5, 0.25), Complex::new(-0.125, 0.25)];
    let ramp = Some(Ramp { length: 0.25, factor: 0.25 });
    // The first piece says where z is, or no later one could move it.
    let rests = Some(Travel { from: [Fixed(0)], to: [Fixed(0)] });
    let ph = Piece { start: ramp, end: ramp, further: rests, ..piece(Shape::Ph { preimage: w, offset: 0.25 }) };
    let profile = Some(Profile { factors: [0.0, 0.25, 1.0, 1.0] });
    let timed = Piece { profile, ..piece(Shape::Ph { preimage: w, offset: -0.5 }) };
    let further = Some(Travel { from: [Fixed(0)], to: [Fixed(262_144)] });
    let motion = [
        MotionCommand::Hold,
        MotionCommand::Resume,
        MotionCommand::Cancel,
        MotionCommand::Override { percent: 150 },
        MotionCommand::SingleBlock(true),
    ];
    let chunk = Chunk::new(&[7; 64]).unwrap_or_default();
    let actions = [
        Action::Home,
        Action::Acknowledge,
        Action::WriteImage { offset: 4_000, chunk },
        Action::CommitImage { length: 4_096, crc: 1 },
        Action::ReadImage { offset: 64 },
    ];
    let mut commands = vec![
        Command::Begin(HEADER, Coordinates::Machine),
        Command::Piece(ph),
        Command::Piece(piece(arc)),
        Command::Piece(Piece { further, ..line }),
        Command::Piece(Piece { last: Some([Fixed(262_144), Fixed(131_072), Fixed(0)]), ..line }),
        Command::Run,
        Command::Begin(HEADER, Coordinates::Relative),
        Command::Abort,
        Command::Status,
        Command::Hello { version: VERSION, session: SESSION },
    ];
    commands.extend(motion.map(Action::Motion).into_iter().chain(actions).map(Command::Act));
    // Behind the others, so that a script of before says what it said.
    commands.extend([timed, Piece { profile, ..piece(arc) }].map(Command::Piece));
    commands
}

/// One report of every kind.
pub fn reports() -> Vec<Report> {
    let answer = Answer::Image { length: 700, crc: 9, offset: 64, chunk: Chunk::new(&[7; 64]).unwrap_or_default() };
    vec![
        Report::Hello { version: VERSION, session: SESSION, identity: Identity::default() },
        Report::Ack { next: 300, room: 60 },
        Report::Refused { sequence: 4, reason: Refusal::Machine(Refused::PositionUnknown { axis: 2 }) },
        Report::Telemetry(Telemetry { tick: 70_000, speed: 31.5, ..Telemetry::default() }),
        Report::Finished { ticks: 70_000, residual: 0.5e-3, hash: 0x0123_4567_89ab_cdef },
        Report::Ended(Ending::Fault(Fault::Limit { axis: 1, end: End::High })),
        Report::Done { number: 3, outcome: Ok(answer) },
    ]
}

/// A whole frame around these bytes; none where they are too many.
pub fn wrap(session: u32, sequence: u16, body: &[u8]) -> Option<Frame> {
    struct Raw<'a>(&'a [u8]);
    impl Serialize for Raw<'_> {
        // A tuple of bytes has no length in front, as a message has none.
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            let mut tuple = serializer.serialize_tuple(self.0.len())?;
            self.0.iter().try_for_each(|byte| tuple.serialize_element(byte))?;
            tuple.end()
        }
    }
    encode(session, sequence, &Raw(body))
}

/// A message as bytes.
fn body<M: Serialize>(message: &M) -> Vec<u8> {
    postcard::to_allocvec(message).unwrap_or_default()
}

/// Reads a script from bytes; behind its end there are zeros.
struct Script<'a>(&'a [u8]);

impl<'a> Script<'a> {
    fn byte(&mut self) -> u8 {
        let Some((&byte, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        byte
    }

    fn bytes(&mut self, count: usize) -> &'a [u8] {
        let (bytes, rest) = self.0.split_at(count.min(self.0.len()));
        self.0 = rest;
        bytes
    }
}

/// A host that says what a script wants, with the numbers that the controller expects.
struct Talk {
    endpoint: Endpoint,
    machine: StrictMachine,
    decoder: Decoder,
    session: u32,
    next: u16,
    action: u16,
    now: u32,
}

impl Talk {
    fn say(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.endpoint.receive(&mut self.machine, self.now, byte);
        }
        self.listen();
    }

    /// What the controller says is always whole, and of the session.
    fn listen(&mut self) {
        for byte in std::mem::take(&mut self.machine.said) {
            let Some(found) = self.decoder.push::<Report>(byte) else { continue };
            match found.map(|found| found.message) {
                Ok(Report::Hello { session, .. }) => {
                    if session != self.session {
                        (self.session, self.next, self.action) = (session, 1, 0);
                        self.decoder.enter(session);
                    }
                }
                Ok(Report::Ack { next, .. } | Report::Telemetry(Telemetry { next, .. })) => self.next = next,
                Ok(Report::Refused { reason: Refusal::Link(_), sequence }) => self.next = sequence,
                Ok(Report::Refused { sequence, .. }) if self.next == sequence => self.next = sequence.wrapping_add(1),
                Ok(Report::Done { number, .. }) => self.action = number.wrapping_add(1),
                Ok(_) => {}
                Err(error) => panic!("the controller said what is no frame: {error}"),
            }
        }
    }

    /// Says this message in its turn.
    fn say_whole(&mut self, body: &[u8], off: u16) {
        // The first byte of a message says which command it is: `Hello` is said in no session, an action has numbers of its own.
        let (session, number) = match body.first() {
            Some(0) => (NO_SESSION, 0),
            Some(6) => (self.session, self.action),
            _ => (self.session, self.next),
        };
        if let Some(frame) = wrap(session, number.wrapping_add(off), body) {
            self.say(&frame);
        }
    }
}

/// Plays a script of any bytes against an endpoint with a machine that panics where it is handed anything out of range; returns that
/// machine.
pub fn play(script: &[u8]) -> StrictMachine {
    let commands = commands();
    let mut script = Script(script);
    let mut talk = Talk {
        endpoint: Endpoint::new(),
        machine: StrictMachine::default(),
        decoder: Decoder::new(),
        session: NO_SESSION,
        next: 0,
        action: 0,
        now: 0,
    };
    if let Some(frame) = encode(NO_SESSION, 0, &Command::Hello { version: VERSION, session: SESSION }) {
        talk.say(&frame);
    }
    while !script.0.is_empty() {
        match script.byte() % 8 {
            // A good command of which some bytes are others, in its turn.
            0..=3 => {
                let chosen = usize::from(script.byte()) % commands.len();
                let mut body = body(&commands[chosen]);
                for _ in 0..script.byte() % 4 {
                    let at = usize::from(script.byte()) % body.len();
                    body[at] = script.byte();
                }
                talk.say_whole(&body, 0);
            }
            // Any message in its turn.
            4 => {
                let count = usize::from(script.byte()) % FRAME_SIZE;
                let body = script.bytes(count);
                talk.say_whole(body, 0);
            }
            // A good command out of its turn.
            5 => {
                let chosen = usize::from(script.byte()) % commands.len();
                let off = u16::from_le_bytes([script.byte(), script.byte()]);
                talk.say_whole(&body(&commands[chosen]), off);
            }
            // Noise.
            6 => {
                let count = usize::from(script.byte());
                talk.say(script.bytes(count));
                // It must not eat the start of the next frame.
                talk.say(&[0]);
            }
            _ => {
                for _ in 0..16 * u32::from(script.byte()) {
                    talk.now = talk.now.wrapping_add(1);
                    talk.machine.tick();
                    talk.endpoint.poll(&mut talk.machine, talk.now);
                }
                talk.listen();
            }
        }
    }
    talk.machine
}

/// What an error of up to four bits makes of a frame of `session`, where it makes or unmakes no zero: never a message of that session.
/// What it may become is a message of none, where a controller only looks, and a host in its session does not. Returns whether the
/// error was one of these; `bits` are places in the frame.
pub fn up_to_four_bits_are_found<M: serde::de::DeserializeOwned>(frame: &Frame, session: u32, bits: &[u16]) -> bool {
    let mut spoiled = frame.clone();
    let data = data_places(frame);
    for bit in bits.iter().take(4) {
        let Some(&place) = data.get(usize::from(bit / 8) % data.len().max(1)) else { continue };
        if let Some(byte) = spoiled.get_mut(place) {
            *byte ^= 1 << (bit % 8);
        }
    }
    let whole = spoiled.iter().take(spoiled.len() - 1).all(|&byte| byte != 0);
    if spoiled == *frame || !whole {
        return false;
    }
    let mut decoder = Decoder::new();
    decoder.enter(session);
    for &byte in &spoiled {
        if let Some(Ok(found)) = decoder.push::<M>(byte) {
            assert_eq!(found.session, NO_SESSION, "{bits:?} of {frame:?} pass");
        }
    }
    true
}

/// The places of a frame that are neither codes of COBS nor its zero.
fn data_places(frame: &Frame) -> Vec<usize> {
    let mut places = Vec::new();
    let mut at = 0;
    while let Some(&code) = frame.get(at).filter(|&&code| code != 0) {
        places.extend(at + 1..at + usize::from(code));
        at += usize::from(code);
    }
    places
}

//! Frames: a sequence number and a message, protected by a CRC-32 (ISO-HDLC) and ended by a zero byte.
//!
//! The CRC is sent with the number of the session added to it (exclusive or). A whole frame of another session therefore never
//! passes for one of this, however late it comes: two session numbers differ, and so do the two CRCs. It costs no byte.
//!
//! Strength. The polynomial 0x04C11DB7 finds every error of up to four bits in bodies of up to 2974 bits (its Hamming distance is 5
//! there [Koopman, CRC polynomial zoo]), and every burst of up to 32 bits; the longest body here is 1280 bits, which is why a
//! frame holds one piece and not several. An error that makes or unmakes a zero moves the ends of frames, and COBS spreads it over
//! the body: such a frame passes once in 2^32. At one broken frame a second that is once in 136 years.
//!
//! What is found is that a frame is none of the session. An error that looks like the session's number makes it one of no session, where a
//! controller takes `Hello` and `Status` alone, and a host that is in a session takes nothing.

use core::fmt;

use crc::{CRC_32_ISO_HDLC, Crc};
use heapless::Vec;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// The longest body of a frame: sequence number, message and CRC.
pub const BODY_SIZE: usize = 160;

/// The longest frame on the wire, its zero byte included.
pub const FRAME_SIZE: usize = cobs::max_encoding_length(BODY_SIZE) + 1;

/// One frame, ready for the wire.
pub type Frame = Vec<u8, FRAME_SIZE>;

const CRC_SIZE: usize = 4;
// The sender counts the length of a frame in a byte.
const _: () = assert!(FRAME_SIZE <= u8::MAX as usize);
const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// Why bytes are no frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FrameError {
    /// Longer than any frame.
    Oversized,
    /// Ends before it should.
    Truncated,
    /// Its CRC does not fit its content.
    Corrupted,
    /// Whole, but holds no known message.
    Unknown,
}

impl fmt::Display for FrameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Oversized => write!(f, "a frame is longer than {FRAME_SIZE} bytes; no message is"),
            Self::Truncated => write!(f, "a frame ends before it should; send it again"),
            Self::Corrupted => write!(f, "a frame was damaged on its way; send it again"),
            Self::Unknown => write!(f, "a frame holds no message of this version"),
        }
    }
}

/// The CRC-32 of frames and of configuration images.
pub fn checksum(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// The number of no session: what is said before one, or outside it.
pub const NO_SESSION: u32 = 0;

/// A message as it came.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Received<M> {
    /// The decoder's session, or [`NO_SESSION`].
    pub session: u32,
    /// Its number.
    pub sequence: u16,
    /// The message.
    pub message: M,
}

/// The frame of `message` in `session`; none if the message is longer than a frame can be, which none of this protocol is (test
/// `every_message_fits`).
pub fn encode<M: Serialize>(session: u32, sequence: u16, message: &M) -> Option<Frame> {
    let mut body = [0; BODY_SIZE];
    let room = body.get_mut(..BODY_SIZE - CRC_SIZE)?;
    let length = postcard::to_slice(&(sequence, message), room).ok()?.len();
    let crc = CRC.checksum(body.get(..length)?) ^ session;
    body.get_mut(length..length + CRC_SIZE)?.copy_from_slice(&crc.to_le_bytes());

    let mut frame = Frame::new();
    frame.resize_default(FRAME_SIZE - 1).ok()?;
    let length = cobs::try_encode(body.get(..length + CRC_SIZE)?, &mut frame).ok()?;
    frame.truncate(length);
    frame.push(0).ok()?;
    Some(frame)
}

/// Finds frames in a stream of bytes. After anything faulty it is in step again at the next zero.
#[derive(Clone, Debug, Default)]
pub struct Decoder {
    bytes: Frame,
    oversized: bool,
    session: u32,
}

impl Decoder {
    /// A decoder that takes the first byte for the first of a frame.
    pub const fn new() -> Self {
        Self { bytes: Vec::new(), oversized: false, session: NO_SESSION }
    }

    /// Takes frames of this session from now on, beside those of none.
    pub fn enter(&mut self, session: u32) {
        self.session = session;
    }

    /// Takes one byte. At the end of a frame it returns its message, or what is wrong with it.
    ///
    /// Zeros between frames are no frames: a sender may put one in front of its first, to end whatever noise came before.
    pub fn push<M: DeserializeOwned>(&mut self, byte: u8) -> Option<Result<Received<M>, FrameError>> {
        if byte != 0 {
            self.oversized |= self.bytes.push(byte).is_err();
            return None;
        }
        let result = match (self.oversized, self.bytes.is_empty()) {
            (true, _) => Some(Err(FrameError::Oversized)),
            (false, true) => None,
            (false, false) => Some(open(&mut self.bytes, self.session)),
        };
        self.bytes.clear();
        self.oversized = false;
        result
    }
}

/// The content of a frame without its zero byte.
fn open<M: DeserializeOwned>(bytes: &mut [u8], current: u32) -> Result<Received<M>, FrameError> {
    let length = cobs::decode_in_place(bytes).map_err(|_| FrameError::Truncated)?;
    let split = length.checked_sub(CRC_SIZE).ok_or(FrameError::Truncated)?;
    let (Some(body), Some(crc)) = (bytes.get(..split), bytes.get(split..length)) else {
        return Err(FrameError::Truncated);
    };
    let crc = crc.try_into().map(u32::from_le_bytes).map_err(|_| FrameError::Truncated)?;
    let session = crc ^ CRC.checksum(body);
    if session != current && session != NO_SESSION {
        return Err(FrameError::Corrupted);
    }
    match postcard::take_from_bytes(body) {
        Ok(((sequence, message), [])) => Ok(Received { session, sequence, message }),
        _ => Err(FrameError::Unknown),
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use proptest::prelude::*;

    use super::super::action::{Action, Answer, CHUNK_SIZE, Chunk};
    use super::super::message::{Command, Refusal, Report, Telemetry};
    use super::*;
    use crate::complex::Complex;
    use crate::error::PathError;
    use crate::feed::Ramp;
    use crate::fixed::Fixed;
    use crate::further::Travel;
    use crate::piece::{Piece, Shape, SplineShape};
    use crate::profile::Profile;
    use crate::safety::{Fault, HomingFault, State};
    use crate::spline::CorrectionOrder;

    fn piece(x: f32, origin: i32) -> Piece<f32> {
        let w = Complex::new(x, -x);
        Piece {
            origin: [Fixed(origin), Fixed(i32::MIN)],
            shape: Shape::Ph { preimage: [w, w, w], offset: x },
            interval: [0.0, 1.0],
            feed: x,
            start: Some(Ramp { length: 0.25, factor: 0.25 }),
            end: Some(Ramp { length: x, factor: 0.25 }),
            profile: None,
            further: Some(Travel { from: [Fixed(i32::MIN)], to: [Fixed(origin)] }),
            last: Some([Fixed(i32::MIN), Fixed(i32::MAX), Fixed(origin)]),
        }
    }

    const SESSION: u32 = 0x5eed_1234;
    const RUN: Command = Command::Run;

    fn decoder() -> Decoder {
        let mut decoder = Decoder::new();
        decoder.enter(SESSION);
        decoder
    }

    fn decode(decoder: &mut Decoder, bytes: &[u8]) -> std::vec::Vec<Result<(u16, Command), FrameError>> {
        let content = |found: Result<Received<Command>, _>| found.map(|found| (found.sequence, found.message));
        bytes.iter().filter_map(|&byte| decoder.push(byte)).map(content).collect()
    }

    /// The longest values of the longest messages; integers at the ends of their ranges take the most bytes.
    #[test]
    fn every_message_fits() {
        let frame = encode(SESSION, u16::MAX, &Command::Piece(piece(f32::MAX, i32::MAX))).unwrap();
        let spline = SplineShape {
            plane: [Complex::new(f32::MAX, f32::MIN); 5],
            bow: [f32::MAX; 4],
            correction: CorrectionOrder::Ninth,
        };
        let spline = Piece { shape: Shape::Spline(spline), ..piece(f32::MAX, i32::MAX) };
        let longest = encode(SESSION, u16::MAX, &Command::Piece(spline)).unwrap();
        assert!(longest.len() <= FRAME_SIZE, "a spline: {}", longest.len());
        assert!(frame.len() < FRAME_SIZE);
        // A profile takes the place of two ramps, byte for byte.
        let profile = Some(Profile { factors: [f32::MAX; 4] });
        let timed = encode(SESSION, u16::MAX, &Command::Piece(Piece { start: None, end: None, profile, ..spline }));
        assert_eq!(timed.unwrap().len(), longest.len());
        let telemetry = Telemetry {
            machine: State::EStop,
            fault: Some(Fault::Homing { axis: u8::MAX, fault: HomingFault::Stuck }),
            axes: u8::MAX,
            known: u8::MAX,
            tick: u32::MAX,
            pieces: u32::MAX,
            setpoint: [Fixed(i32::MIN); 3],
            actual: [Fixed(i32::MIN); 3],
            speed: f32::MAX,
            percent: u8::MAX,
            queued: u16::MAX,
            next: u16::MAX,
            room: u16::MAX,
            cycles: u32::MAX,
            worst_cycles: u32::MAX,
            stack: u32::MAX,
            broken_frames: u32::MAX,
            ..Telemetry::default()
        };
        assert!(encode(SESSION, u16::MAX, &Report::Telemetry(telemetry)).is_some());
        let chunk = Chunk::new(&[255; CHUNK_SIZE]).unwrap();
        let write = Command::Act(Action::WriteImage { offset: u16::MAX, chunk });
        assert!(encode(SESSION, u16::MAX, &write).is_some());
        let answer = Answer::Image { length: u16::MAX, crc: u32::MAX, offset: u16::MAX, chunk };
        assert!(encode(SESSION, u16::MAX, &Report::Done { number: u16::MAX, outcome: Ok(answer) }).is_some());
        let reason = Refusal::Path(PathError::Profile { factors: [f32::MAX; 4] });
        assert!(encode(SESSION, u16::MAX, &Report::Refused { sequence: u16::MAX, reason }).is_some());
    }

    #[test]
    fn an_oversized_frame_is_refused_and_the_next_one_read() {
        let mut bytes = std::vec![7; 3 * FRAME_SIZE];
        bytes.push(0);
        bytes.extend(encode(SESSION, 5, &RUN).unwrap());
        let found = decode(&mut decoder(), &bytes);
        assert_eq!(found, [Err(FrameError::Oversized), Ok((5, RUN))]);
    }

    /// What was said in another session is not taken for this one's, whatever it is; what was said in none is told apart.
    #[test]
    fn a_frame_of_another_session_is_no_frame() {
        for other in [1, SESSION ^ 1, !SESSION, u32::MAX] {
            let frame = super::encode(other, 5, &RUN).unwrap();
            assert_eq!(decode(&mut decoder(), &frame), [Err(FrameError::Corrupted)]);
        }
        let frame = super::encode(NO_SESSION, 5, &Command::Status).unwrap();
        let mut decoder = decoder();
        let found: Option<Result<Received<Command>, _>> = frame.iter().find_map(|&byte| decoder.push(byte));
        assert_eq!(found, Some(Ok(Received { session: NO_SESSION, sequence: 5, message: Command::Status })));
    }

    /// `Hello`, its answer and the refusal of a version have the form that they had in version 3, byte by byte: otherwise two versions
    /// could not tell each other that they are two.
    #[test]
    fn what_versions_say_to_each_other_keeps_its_form() {
        use super::super::message::Identity;
        let form = |frame: Frame| {
            let mut bytes = frame.to_vec();
            let length = cobs::decode_in_place(&mut bytes[..frame.len() - 1]).unwrap() - CRC_SIZE;
            bytes[..length].to_vec()
        };
        let hello = Command::Hello { version: 4, session: 300 };
        assert_eq!(form(encode(NO_SESSION, 0, &hello).unwrap()), [0, 0, 4, 0xac, 2]);
        let identity = Identity { firmware: [1, 2, 3], axes: 5, capacity: 63 };
        let answer = Report::Hello { version: 4, session: 300, identity };
        assert_eq!(form(encode(NO_SESSION, 9, &answer).unwrap()), [9, 0, 4, 0xac, 2, 1, 2, 3, 5, 63]);
        let refused = Report::Refused { sequence: 0, reason: Refusal::Version { version: 4 } };
        assert_eq!(form(encode(NO_SESSION, 9, &refused).unwrap()), [9, 2, 0, 2, 4]);
    }

    #[test]
    fn zeros_between_frames_are_nothing() {
        assert_eq!(decode(&mut decoder(), &[0; 9]), []);
    }

    #[test]
    fn a_whole_frame_of_something_else_is_unknown() {
        let frame = encode(SESSION, 1, &(200_u8, [1_u8; 30])).unwrap();
        assert_eq!(decode(&mut decoder(), &frame), [Err(FrameError::Unknown)]);
    }

    proptest! {
        #[test]
        fn what_goes_in_comes_out(sequence: u16, x in -1e9_f32..1e9, origin: i32) {
            let command = Command::Piece(piece(x, origin));
            let frame = encode(SESSION, sequence, &command).unwrap();
            prop_assert_eq!(frame.iter().position(|&byte| byte == 0), Some(frame.len() - 1));
            prop_assert_eq!(decode(&mut decoder(), &frame), [Ok((sequence, command))]);
        }

        /// Any single changed byte, a cut or an insertion gives an error or nothing, never a wrong command, and the frame behind it
        /// is read: a CRC-32 finds every burst of up to 32 bits.
        #[test]
        fn damage_is_found_and_forgotten(x in -1e3_f32..1e3, at in 0_usize..90, change in 1_u8.., kind in 0..3) {
            let good = encode(SESSION, 8, &RUN).unwrap();
            let mut bytes = encode(SESSION, 7, &Command::Piece(piece(x, 1))).unwrap().to_vec();
            let at = at.min(bytes.len() - 2);
            match kind {
                0 => bytes[at] ^= change,
                1 => { bytes.drain(at..at + 1); }
                _ => bytes.insert(at, change),
            }
            // A zero in the middle cuts the frame in two: both halves are faulty.
            bytes.extend(&good);
            let found = decode(&mut decoder(), &bytes);
            prop_assert_eq!(found.last(), Some(&Ok((8, RUN))));
            prop_assert!(found[..found.len() - 1].iter().all(Result::is_err));
        }

        #[test]
        fn noise_never_panics(bytes in proptest::collection::vec(0_u8.., 0..2_000)) {
            let _ = decode(&mut decoder(), &bytes);
        }
    }
}

//! Frames: a sequence number and a message, protected by a CRC-32 (ISO-HDLC) and ended by a zero byte.

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

/// The frame of `message`; none if the message is longer than a frame can be, which none of this protocol is (test
/// `every_message_fits`).
pub fn encode<M: Serialize>(sequence: u16, message: &M) -> Option<Frame> {
    let mut body = [0; BODY_SIZE];
    let room = body.get_mut(..BODY_SIZE - CRC_SIZE)?;
    let length = postcard::to_slice(&(sequence, message), room).ok()?.len();
    let crc = CRC.checksum(body.get(..length)?);
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
}

impl Decoder {
    /// A decoder that takes the first byte for the first of a frame.
    pub const fn new() -> Self {
        Self { bytes: Vec::new(), oversized: false }
    }

    /// Takes one byte. At the end of a frame it returns its sequence number and message, or what is wrong with it.
    ///
    /// Zeros between frames are no frames: a sender may put one in front of its first, to end whatever noise came before.
    pub fn push<M: DeserializeOwned>(&mut self, byte: u8) -> Option<Result<(u16, M), FrameError>> {
        if byte != 0 {
            self.oversized |= self.bytes.push(byte).is_err();
            return None;
        }
        let result = match (self.oversized, self.bytes.is_empty()) {
            (true, _) => Some(Err(FrameError::Oversized)),
            (false, true) => None,
            (false, false) => Some(open(&mut self.bytes)),
        };
        self.bytes.clear();
        self.oversized = false;
        result
    }
}

/// The content of a frame without its zero byte.
fn open<M: DeserializeOwned>(bytes: &mut [u8]) -> Result<(u16, M), FrameError> {
    let length = cobs::decode_in_place(bytes).map_err(|_| FrameError::Truncated)?;
    let split = length.checked_sub(CRC_SIZE).ok_or(FrameError::Truncated)?;
    let (Some(body), Some(crc)) = (bytes.get(..split), bytes.get(split..length)) else {
        return Err(FrameError::Truncated);
    };
    if CRC.checksum(body).to_le_bytes() != crc {
        return Err(FrameError::Corrupted);
    }
    match postcard::take_from_bytes(body) {
        Ok((content, [])) => Ok(content),
        _ => Err(FrameError::Unknown),
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use proptest::prelude::*;

    use super::super::message::{Command, Refusal, Report, Telemetry};
    use super::*;
    use crate::complex::Complex;
    use crate::error::PathError;
    use crate::feed::Ramp;
    use crate::fixed::Fixed;
    use crate::further::Travel;
    use crate::piece::{Piece, Shape};

    fn piece(x: f32, origin: i32) -> Piece<f32> {
        let w = Complex::new(x, -x);
        Piece {
            origin: [Fixed(origin), Fixed(i32::MIN)],
            shape: Shape::Ph { preimage: [w, w, w], offset: x },
            interval: [0.0, 1.0],
            feed: x,
            start: Some(Ramp { length: 0.25, factor: 0.25 }),
            end: Some(Ramp { length: x, factor: 0.25 }),
            further: Some(Travel { from: [Fixed(i32::MIN)], to: [Fixed(origin)] }),
            last: Some([Fixed(i32::MIN), Fixed(i32::MAX), Fixed(origin)]),
        }
    }

    fn decode(decoder: &mut Decoder, bytes: &[u8]) -> std::vec::Vec<Result<(u16, Command), FrameError>> {
        bytes.iter().filter_map(|&byte| decoder.push(byte)).collect()
    }

    /// The longest values of the longest messages; integers at the ends of their ranges take the most bytes.
    #[test]
    fn every_message_fits() {
        let frame = encode(u16::MAX, &Command::Piece(piece(f32::MAX, i32::MAX))).unwrap();
        assert!(frame.len() < FRAME_SIZE);
        let telemetry = Telemetry {
            tick: u32::MAX,
            pieces: u32::MAX,
            setpoint: [Fixed(i32::MIN); 3],
            speed: f32::MAX,
            queued: u16::MAX,
            worst_cycles: u32::MAX,
            stack: u32::MAX,
            broken_frames: u32::MAX,
            ..Telemetry::default()
        };
        assert!(encode(u16::MAX, &Report::Telemetry(telemetry)).is_some());
        let reason = Refusal::Path(PathError::Interval { from: f32::MIN, to: f32::MAX });
        assert!(encode(u16::MAX, &Report::Refused { sequence: u16::MAX, reason }).is_some());
    }

    #[test]
    fn an_oversized_frame_is_refused_and_the_next_one_read() {
        let mut bytes = std::vec![7; 3 * FRAME_SIZE];
        bytes.push(0);
        bytes.extend(encode(5, &Command::Run).unwrap());
        let found = decode(&mut Decoder::new(), &bytes);
        assert_eq!(found, [Err(FrameError::Oversized), Ok((5, Command::Run))]);
    }

    #[test]
    fn zeros_between_frames_are_nothing() {
        assert_eq!(decode(&mut Decoder::new(), &[0; 9]), []);
    }

    #[test]
    fn a_whole_frame_of_something_else_is_unknown() {
        let frame = encode(1, &(200_u8, [1_u8; 30])).unwrap();
        assert_eq!(decode(&mut Decoder::new(), &frame), [Err(FrameError::Unknown)]);
    }

    proptest! {
        #[test]
        fn what_goes_in_comes_out(sequence: u16, x in -1e9_f32..1e9, origin: i32) {
            let command = Command::Piece(piece(x, origin));
            let frame = encode(sequence, &command).unwrap();
            prop_assert_eq!(frame.iter().position(|&byte| byte == 0), Some(frame.len() - 1));
            prop_assert_eq!(decode(&mut Decoder::new(), &frame), [Ok((sequence, command))]);
        }

        /// Any single changed byte, a cut or an insertion gives an error or nothing, never a wrong command, and the frame behind it
        /// is read: a CRC-32 finds every burst of up to 32 bits.
        #[test]
        fn damage_is_found_and_forgotten(x in -1e3_f32..1e3, at in 0_usize..90, change in 1_u8.., kind in 0..3) {
            let good = encode(8, &Command::Run).unwrap();
            let mut bytes = encode(7, &Command::Piece(piece(x, 1))).unwrap().to_vec();
            let at = at.min(bytes.len() - 2);
            match kind {
                0 => bytes[at] ^= change,
                1 => { bytes.drain(at..at + 1); }
                _ => bytes.insert(at, change),
            }
            // A zero in the middle cuts the frame in two: both halves are faulty.
            bytes.extend(&good);
            let found = decode(&mut Decoder::new(), &bytes);
            prop_assert_eq!(found.last(), Some(&Ok((8, Command::Run))));
            prop_assert!(found[..found.len() - 1].iter().all(Result::is_err));
        }

        #[test]
        fn noise_never_panics(bytes in proptest::collection::vec(0_u8.., 0..2_000)) {
            let _ = decode(&mut Decoder::new(), &bytes);
        }
    }
}

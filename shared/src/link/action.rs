//! What may be asked of a controller beside a job: to hold and resume, to home, to keep a configuration.
//!
//! Actions have numbers of their own, one is under way at a time, and each is carried out once: a hold never waits behind pieces.

use serde::{Deserialize, Serialize};

use super::frame::checksum;
use crate::motion::MotionCommand;

/// Bytes of a configuration image in one frame.
pub const CHUNK_SIZE: usize = 64;

/// The longest configuration image, in bytes.
pub const IMAGE_SIZE: u16 = 4096;

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Action {
    /// Hold, resume, cancel, override, single block.
    Motion(MotionCommand),
    /// Find the reference switches.
    Home,
    /// Take notice of a fault, so that motion is possible again.
    Acknowledge,
    /// Put these bytes of a new configuration image aside.
    WriteImage {
        /// Where they belong.
        offset: u16,
        /// The bytes.
        chunk: Chunk,
    },
    /// Check the image that was put aside and keep it.
    CommitImage {
        /// Its length in bytes.
        length: u16,
        /// Its CRC-32 (ISO-HDLC).
        crc: u32,
    },
    /// Read the image that is kept.
    ReadImage {
        /// From here on.
        offset: u16,
    },
}

impl Action {
    /// Whether every number in it is one that a controller may be given.
    pub fn is_in_range(&self) -> bool {
        match self {
            Self::Motion(MotionCommand::Override { percent }) => (1..=200).contains(percent),
            Self::WriteImage { offset, chunk } => {
                let length = usize::from(chunk.length);
                length <= CHUNK_SIZE && usize::from(*offset) + length <= usize::from(IMAGE_SIZE)
            }
            Self::CommitImage { length, .. } => *length <= IMAGE_SIZE,
            Self::ReadImage { offset } => *offset <= IMAGE_SIZE,
            Self::Motion(_) | Self::Home | Self::Acknowledge => true,
        }
    }
}

/// What comes back from an action that was carried out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Answer {
    /// It was done, or is under way: telemetry tells.
    Done,
    /// A part of the configuration image.
    Image {
        /// The length of the whole image in bytes; 0 where there is none.
        length: u16,
        /// Its CRC-32 (ISO-HDLC).
        crc: u32,
        /// Where the part begins.
        offset: u16,
        /// The part; empty behind the end.
        chunk: Chunk,
    },
}

impl Answer {
    /// The part of an image, shorter than 64 KiB, that begins at `offset`; an empty one behind its end.
    pub fn part_of(image: &[u8], offset: u16) -> Self {
        let rest = image.get(usize::from(offset)..).unwrap_or_default();
        let part = rest.get(..CHUNK_SIZE).unwrap_or(rest);
        let chunk = Chunk::new(part).unwrap_or_default();
        Self::Image { length: image.len() as u16, crc: checksum(image), offset, chunk }
    }
}

/// Up to [`CHUNK_SIZE`] bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Chunk {
    length: u8,
    /// In two halves, because serde knows arrays of up to 32.
    halves: [[u8; CHUNK_SIZE / 2]; 2],
}

impl Chunk {
    /// A chunk of these bytes; none if they are too many.
    pub fn new(bytes: &[u8]) -> Option<Self> {
        let mut chunk = Self { length: u8::try_from(bytes.len()).ok()?, halves: Default::default() };
        chunk.halves.as_flattened_mut().get_mut(..bytes.len())?.copy_from_slice(bytes);
        Some(chunk)
    }

    /// Puts the bytes into an image that is being sent, at `offset`; false where they do not belong there.
    pub fn put_into(&self, draft: &mut [u8], offset: u16) -> bool {
        let from = usize::from(offset);
        let place = self.bytes().and_then(|bytes| Some((draft.get_mut(from..from.checked_add(bytes.len())?)?, bytes)));
        place.map(|(place, bytes)| place.copy_from_slice(bytes)).is_some()
    }

    /// The bytes; none where the length that came is no length of a chunk.
    pub fn bytes(&self) -> Option<&[u8]> {
        self.halves.as_flattened().get(..usize::from(self.length))
    }
}

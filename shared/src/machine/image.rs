//! Settings as they are kept in flash and sent over the link: a mark, a version, a length, a checksum, and the settings in postcard's form.
//!
//! | bytes | what |
//! | --- | --- |
//! | 0..4 | `HODO` |
//! | 4..6 | [`VERSION`], little-endian like all that follow |
//! | 6..8 | the length of the settings |
//! | 8..12 | CRC-32 (ISO-HDLC) of bytes 4..8 and of the settings |
//! | 12.. | the settings |
//!
//! Whatever is read, nothing is accepted that [`MachineSettings::check`] would not accept.

use core::fmt;

use crc::{CRC_32_ISO_HDLC, Crc};
use heapless::Vec;

use super::check::MachineError;
use super::settings::MachineSettings;

/// The version of the settings' form. It changes with every change of [`MachineSettings`].
pub const VERSION: u16 = 1;

/// The longest image, in bytes.
pub const IMAGE_SIZE: usize = 2_048;

/// Settings as bytes.
pub type Image = Vec<u8, IMAGE_SIZE>;

const MARK: [u8; 4] = *b"HODO";
const HEAD_SIZE: usize = 12;
const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// Why bytes are no settings.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ImageError {
    /// There is no mark: nothing was stored here.
    Empty,
    /// Written by another version.
    Version {
        /// Which one.
        found: u16,
    },
    /// The bytes end before the settings do.
    Truncated,
    /// The checksum does not fit.
    Corrupted,
    /// The checksum fits, but these are no settings.
    Form,
    /// A value that will not do.
    Settings(MachineError),
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Empty => write!(f, "no machine is stored; send one"),
            Self::Version { found } => {
                write!(f, "the stored machine has version {found}, and {VERSION} is needed; send it again")
            }
            Self::Truncated => write!(f, "the stored machine is cut off; send it again"),
            Self::Corrupted => write!(f, "the stored machine is damaged; send it again"),
            Self::Form => write!(f, "the stored machine cannot be read; send it again"),
            Self::Settings(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for ImageError {}

/// The image of settings. Errors: settings that will not do.
pub fn encode(settings: &MachineSettings) -> Result<Image, ImageError> {
    settings.check().map_err(ImageError::Settings)?;
    let mut image = Image::new();
    image.resize_default(IMAGE_SIZE).map_err(|_| ImageError::Truncated)?;
    let (head, body) = image.split_at_mut(HEAD_SIZE);
    // The longest settings fit (test `the_longest_settings_fit`).
    let length = postcard::to_slice(settings, body).map_err(|_| ImageError::Truncated)?.len();
    let body = body.get(..length).unwrap_or_default();
    let ([v0, v1], [l0, l1]) = (VERSION.to_le_bytes(), (length as u16).to_le_bytes());
    let said = [v0, v1, l0, l1];
    let bytes = MARK.into_iter().chain(said).chain(checksum(said, body).to_le_bytes());
    head.iter_mut().zip(bytes).for_each(|(slot, byte)| *slot = byte);
    image.truncate(HEAD_SIZE + length);
    Ok(image)
}

/// The settings of an image; what follows it is not looked at. Any bytes may be given.
pub fn decode(bytes: &[u8]) -> Result<MachineSettings, ImageError> {
    let Some((&MARK, bytes)) = bytes.split_first_chunk() else { return Err(ImageError::Empty) };
    let (&said, bytes) = bytes.split_first_chunk().ok_or(ImageError::Truncated)?;
    let (&crc, bytes) = bytes.split_first_chunk().ok_or(ImageError::Truncated)?;
    let [v0, v1, l0, l1] = said;
    let found = u16::from_le_bytes([v0, v1]);
    if found != VERSION {
        return Err(ImageError::Version { found });
    }
    let body = bytes.get(..usize::from(u16::from_le_bytes([l0, l1]))).ok_or(ImageError::Truncated)?;
    if checksum(said, body) != u32::from_le_bytes(crc) {
        return Err(ImageError::Corrupted);
    }
    match postcard::take_from_bytes::<MachineSettings>(body) {
        Ok((settings, [])) => settings.check().map(|()| settings).map_err(ImageError::Settings),
        _ => Err(ImageError::Form),
    }
}

/// The bytes of `bytes` that are the image at their start, by its own word; none where there is no mark, or less than it says.
pub fn whole(bytes: &[u8]) -> Option<&[u8]> {
    let (head, _) = bytes.split_first_chunk::<HEAD_SIZE>()?;
    let [m0, m1, m2, m3, _, _, l0, l1, ..] = *head;
    let length = HEAD_SIZE + usize::from(u16::from_le_bytes([l0, l1]));
    bytes.get(..length).filter(|_| [m0, m1, m2, m3] == MARK)
}

fn checksum(said: [u8; 4], body: &[u8]) -> u32 {
    let mut digest = CRC.digest();
    digest.update(&said);
    digest.update(body);
    digest.finalize()
}

//! A machine's image to a controller and back, part by part.
//!
//! A controller keeps what was written when it is committed, and only if it is whole; until then what it kept before stays.

use std::fmt;

use shared::link::action::{CHUNK_SIZE, IMAGE_SIZE};
use shared::link::frame::checksum;
use shared::link::{Action, Answer, Chunk, Refusal};
use shared::machine::MachineSettings;
use shared::machine::image::{ImageError, decode};

use crate::session::Session;
use crate::stream::StreamError;

/// Why an image did not get there or back.
#[derive(Debug)]
pub enum TransferError {
    /// The line or the session is gone.
    Stream(StreamError),
    /// The controller refused it.
    Refused(Refusal),
    /// The controller keeps none.
    Empty,
    /// What came back is not what the controller keeps, or what it keeps is not what was written.
    Changed,
    /// What the controller keeps is no machine of this version.
    Image(ImageError),
    /// The image is longer than a controller takes.
    Long,
}

impl fmt::Display for TransferError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stream(error) => error.fmt(f),
            Self::Refused(reason) => write!(f, "the machine was refused: {reason}"),
            Self::Empty => write!(f, "the controller keeps no machine; send one with --write"),
            Self::Changed => {
                write!(f, "what the controller keeps changed on the way; try again, with nobody else on the line")
            }
            Self::Image(error) => error.fmt(f),
            Self::Long => write!(f, "the machine is longer than the {IMAGE_SIZE} bytes that a controller keeps"),
        }
    }
}

impl std::error::Error for TransferError {}

/// Writes an image, and makes sure that this is the one that the controller keeps.
pub fn write(session: &mut Session<'_>, image: &[u8]) -> Result<(), TransferError> {
    write_by(image, |action| session.ask(action))
}

/// Reads the image that the controller keeps. It is whole, and a machine.
pub fn read(session: &mut Session<'_>) -> Result<MachineSettings, TransferError> {
    let image = read_by(|action| session.ask(action))?;
    decode(&image).map_err(TransferError::Image)
}

/// Whoever asks a controller.
type Asked = Result<Result<Answer, Refusal>, StreamError>;

fn answer(asked: Asked) -> Result<Answer, TransferError> {
    asked.map_err(TransferError::Stream)?.map_err(TransferError::Refused)
}

fn write_by(image: &[u8], mut ask: impl FnMut(Action) -> Asked) -> Result<(), TransferError> {
    let length = u16::try_from(image.len()).ok().filter(|length| *length <= IMAGE_SIZE).ok_or(TransferError::Long)?;
    for (offset, part) in (0..).step_by(CHUNK_SIZE).zip(image.chunks(CHUNK_SIZE)) {
        let chunk = Chunk::new(part).ok_or(TransferError::Long)?;
        answer(ask(Action::WriteImage { offset, chunk }))?;
    }
    let crc = checksum(image);
    answer(ask(Action::CommitImage { length, crc }))?;
    match answer(ask(Action::ReadImage { offset: 0 }))? {
        Answer::Image { length: kept, crc: of, .. } if (kept, of) == (length, crc) => Ok(()),
        _ => Err(TransferError::Changed),
    }
}

fn read_by(mut ask: impl FnMut(Action) -> Asked) -> Result<Vec<u8>, TransferError> {
    let mut image = Vec::new();
    let mut whole = None;
    loop {
        // It is no longer than `IMAGE_SIZE`, as is checked below.
        let from = image.len() as u16;
        let Answer::Image { length, crc, offset, chunk } = answer(ask(Action::ReadImage { offset: from }))? else {
            return Err(TransferError::Changed);
        };
        if length == 0 {
            return Err(TransferError::Empty);
        }
        let part = chunk.bytes().unwrap_or_default();
        let fits =
            offset == from && !part.is_empty() && image.len() + part.len() <= usize::from(length.min(IMAGE_SIZE));
        if *whole.get_or_insert((length, crc)) != (length, crc) || !fits {
            return Err(TransferError::Changed);
        }
        image.extend_from_slice(part);
        if image.len() == usize::from(length) {
            return if checksum(&image) == crc { Ok(image) } else { Err(TransferError::Changed) };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A controller that keeps what is committed, and spoils what `spoil` says.
    fn keeper(kept: Vec<u8>, spoil: impl Fn(&mut Answer)) -> impl FnMut(Action) -> Asked {
        let (mut kept, mut draft) = (kept, vec![0; usize::from(IMAGE_SIZE)]);
        move |action| {
            Ok(match action {
                Action::WriteImage { offset, chunk } => {
                    let bytes = chunk.bytes().unwrap();
                    draft[usize::from(offset)..][..bytes.len()].copy_from_slice(bytes);
                    Ok(Answer::Done)
                }
                Action::CommitImage { length, crc } => {
                    let image = &draft[..usize::from(length)];
                    if checksum(image) == crc {
                        kept = image.to_vec()
                    }
                    if checksum(image) == crc { Ok(Answer::Done) } else { Err(Refusal::Image) }
                }
                Action::ReadImage { offset } => {
                    let rest = kept.get(usize::from(offset)..).unwrap_or_default();
                    let chunk = Chunk::new(&rest[..rest.len().min(CHUNK_SIZE)]).unwrap();
                    let mut answer = Answer::Image { length: kept.len() as u16, crc: checksum(&kept), offset, chunk };
                    spoil(&mut answer);
                    Ok(answer)
                }
                _ => Err(Refusal::Unsupported),
            })
        }
    }

    #[test]
    fn what_is_written_is_what_is_read() {
        for length in [1, 63, 64, 65, 500, 4_096] {
            let image: Vec<u8> = (0..length).map(|k| (k * k % 251) as u8).collect();
            let mut controller = keeper(Vec::new(), |_| {});
            write_by(&image, &mut controller).unwrap();
            assert_eq!(read_by(controller).unwrap(), image);
        }
        assert!(matches!(write_by(&[0; 4_097], |_| panic!("it is too long")), Err(TransferError::Long)));
    }

    /// A controller that answers something else than it keeps is never believed, and never asked for ever.
    #[test]
    fn what_changes_on_the_way_is_no_image() {
        let image = vec![7; 200];
        let spoils: [fn(&mut Answer); 6] = [
            |answer| {
                if let Answer::Image { crc, .. } = answer {
                    *crc ^= 1
                }
            },
            |answer| {
                if let Answer::Image { length, .. } = answer {
                    *length -= 1
                }
            },
            |answer| {
                if let Answer::Image { length, .. } = answer {
                    *length = u16::MAX
                }
            },
            |answer| {
                if let Answer::Image { offset, .. } = answer {
                    *offset += 1
                }
            },
            |answer| {
                if let Answer::Image { chunk, .. } = answer {
                    *chunk = Chunk::default()
                }
            },
            |answer| *answer = Answer::Done,
        ];
        for spoil in spoils {
            assert!(matches!(read_by(keeper(image.clone(), spoil)), Err(TransferError::Changed)));
        }
        assert!(matches!(read_by(keeper(Vec::new(), |_| {})), Err(TransferError::Empty)));
        let wrong = keeper(Vec::new(), |answer| {
            if let Answer::Image { crc, .. } = answer {
                *crc ^= 1
            }
        });
        assert!(matches!(write_by(&image, wrong), Err(TransferError::Changed)));
    }

    #[test]
    fn a_refusal_ends_the_transfer() {
        let mut asked = 0;
        let refuses = |_| {
            asked += 1;
            Ok(Err(Refusal::Unsupported))
        };
        let error = write_by(&[1; 300], refuses).unwrap_err();
        assert_eq!(error.to_string(), "the machine was refused: this controller cannot do that");
        assert_eq!(asked, 1);
    }
}

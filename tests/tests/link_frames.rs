//! Frames of every message against bytes of any kind, and against errors that their CRC must find. The same as `cargo fuzz run frames`.
#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use proptest::prelude::*;
use serde::de::DeserializeOwned;
use shared::link::{Command, Decoder, FRAME_SIZE, Frame, NO_SESSION, Report, encode};
use tests::link_script::{SESSION, commands, reports, up_to_four_bits_are_found};

/// What a decoder in the session finds in these bytes: messages, as far as they are of the session.
fn found<M: DeserializeOwned>(bytes: &[u8]) -> Vec<M> {
    let mut decoder = Decoder::new();
    decoder.enter(SESSION);
    let own = bytes.iter().filter_map(|&byte| decoder.push::<M>(byte)?.ok()).filter(|said| said.session != NO_SESSION);
    own.map(|said| said.message).collect()
}

fn frames() -> (Vec<Frame>, Vec<Frame>) {
    let frames = commands().iter().map(|command| encode(SESSION, 300, command).unwrap()).collect();
    (frames, reports().iter().map(|report| encode(SESSION, 300, report).unwrap()).collect())
}

fn no_single_error_passes<M: DeserializeOwned>(frames: &[Frame]) {
    for frame in frames {
        assert_eq!(found::<M>(frame).len(), 1);
        for bit in 0..frame.len() * 8 {
            let mut spoiled = frame.to_vec();
            spoiled[bit / 8] ^= 1 << (bit % 8);
            // An end that is none any more waits for the next one.
            spoiled.push(0);
            assert!(found::<M>(&spoiled).is_empty(), "bit {bit} of {frame:?}");
        }
        for length in 0..frame.len() - 1 {
            let mut cut = frame[..length].to_vec();
            cut.push(0);
            assert!(found::<M>(&cut).is_empty(), "{length} bytes of {frame:?}");
            let mut tail = frame[frame.len() - 1 - length..].to_vec();
            tail.push(0);
            assert!(found::<M>(&tail).is_empty(), "the last {length} bytes of {frame:?}");
        }
    }
}

/// Every wrong bit and every cut of a frame of every message, all of them tried: none is a message.
#[test]
fn no_wrong_bit_and_no_cut_passes() {
    let (commands, reports) = frames();
    no_single_error_passes::<Command>(&commands);
    no_single_error_passes::<Report>(&reports);
}

proptest! {
    /// Any bytes: no panic, and the frame behind them is read.
    #[test]
    fn the_frame_behind_any_bytes_is_read(mut bytes in proptest::collection::vec(0_u8.., 0..3 * FRAME_SIZE)) {
        let (_, reports) = frames();
        let end = bytes.len();
        bytes.push(0);
        bytes.extend(encode(SESSION, 300, &Command::Run).unwrap());
        prop_assert_eq!(found::<Command>(&bytes).pop(), Some(Command::Run));
        bytes.truncate(end + 1);
        bytes.extend(&reports[1]);
        prop_assert_eq!(found::<Report>(&bytes).pop(), Some(Report::Ack { next: 300, room: 60 }));
    }

    /// The polynomial's distance is 5: up to four wrong bits never make another message of the session.
    #[test]
    fn four_wrong_bits_never_pass(which: prop::sample::Index, bits in proptest::collection::vec(0_u16.., 1..=4)) {
        let (commands, reports) = frames();
        let which = which.index(commands.len() + reports.len());
        match commands.get(which) {
            Some(frame) => up_to_four_bits_are_found::<Command>(frame, SESSION, &bits),
            None => up_to_four_bits_are_found::<Report>(&reports[which - commands.len()], SESSION, &bits),
        };
    }
}

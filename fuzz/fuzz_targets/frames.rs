//! Both decoders of the link: whatever bytes there are, no panic; what is accepted has a frame of its own, which says the same; and the
//! frame behind it all is read.
#![no_main]

use libfuzzer_sys::fuzz_target;
use serde::Serialize;
use serde::de::DeserializeOwned;
use shared::link::{Command, Decoder, NO_SESSION, Received, Report, encode};
use tests::link_script::{SESSION, wrap};

fn read<M: Serialize + DeserializeOwned>(bytes: &[u8]) {
    let mut decoder = Decoder::new();
    decoder.enter(SESSION);
    // As they are, and as the content of a frame whose CRC fits.
    let whole = wrap(SESSION, 9, bytes).unwrap_or_default();
    for &byte in bytes.iter().chain(&[0]).chain(&whole) {
        let Some(Ok(Received { session, sequence, message })) = decoder.push::<M>(byte) else { continue };
        let frame = encode(session, sequence, &message).expect("what came in a frame fits into one");
        let mut again = Decoder::new();
        again.enter(session);
        let same = frame.iter().find_map(|&byte| again.push::<M>(byte)).expect("a frame has an end");
        let same = same.expect("it is one");
        assert!(same.session == session && same.sequence == sequence);
        // A NaN is not equal to itself, but its bytes are.
        assert_eq!(postcard::to_allocvec(&same.message), postcard::to_allocvec(&message));
    }
    let status = encode(NO_SESSION, 1, &Command::Status).expect("it fits");
    let mut behind = None;
    for &byte in &status {
        behind = decoder.push::<Command>(byte).or(behind);
    }
    assert!(behind.is_some_and(|found| found.is_ok_and(|found| found.message == Command::Status)));
}

fuzz_target!(|bytes: &[u8]| {
    read::<Command>(bytes);
    read::<Report>(bytes);
});

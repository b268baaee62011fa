//! Frames of every message with up to four wrong bits: none of them is another message of the session.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shared::link::{Command, Report, encode};
use tests::link_script::{commands, reports, up_to_four_bits_are_found};

fuzz_target!(|input: (u32, u16, u8, [u16; 4], u8)| {
    let (session, sequence, which, bits, count) = input;
    // A session of number 0 is none.
    let session = session.max(1);
    let bits = &bits[..1 + usize::from(count) % 4];
    let (commands, reports) = (commands(), reports());
    let which = usize::from(which) % (commands.len() + reports.len());
    match commands.get(which) {
        Some(command) => {
            let frame = encode(session, sequence, command).expect("it fits");
            up_to_four_bits_are_found::<Command>(&frame, session, bits);
        }
        None => {
            let frame = encode(session, sequence, &reports[which - commands.len()]).expect("it fits");
            up_to_four_bits_are_found::<Report>(&frame, session, bits);
        }
    }
});

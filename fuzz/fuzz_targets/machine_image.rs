//! The stored form of a machine: whatever bytes there are, no panic, and nothing is accepted that is out of range or does not come back.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shared::machine::image::{decode, encode};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(settings) = decode(bytes) {
        assert!(settings.check().is_ok() && settings.activate().is_ok());
        assert!(encode(&settings).is_ok_and(|image| decode(&image) == Ok(settings)));
    }
});

//! The stored form of a machine: whatever bytes there are, no panic, and nothing is accepted that is out of range or does not come back.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shared::link::frame::checksum;
use shared::machine::image::{VERSION, decode, encode};

fn read(bytes: &[u8]) {
    if let Ok(settings) = decode(bytes) {
        assert!(settings.check().is_ok() && settings.activate().is_ok());
        assert!(encode(&settings).is_ok_and(|image| decode(&image) == Ok(settings)));
    }
}

fuzz_target!(|bytes: &[u8]| {
    read(bytes);
    // The same as the content of an image whose checksum fits.
    let Ok(length) = u16::try_from(bytes.len()) else { return };
    let said: Vec<u8> =
        VERSION.to_le_bytes().into_iter().chain(length.to_le_bytes()).chain(bytes.iter().copied()).collect();
    let mut image = b"HODO".to_vec();
    image.extend_from_slice(&said[..4]);
    image.extend_from_slice(&checksum(&said).to_le_bytes());
    image.extend_from_slice(bytes);
    read(&image);
});

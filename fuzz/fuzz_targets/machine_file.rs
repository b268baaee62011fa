//! A machine's file: any text is refused in one line that names a place in it, or is a machine that its image brings back.
#![no_main]

use host_sim::machine::{from_toml, to_image};
use libfuzzer_sys::fuzz_target;
use shared::machine::image::decode;

fuzz_target!(|text: &str| {
    match from_toml("machine.toml", text) {
        Ok(settings) => {
            let image = to_image(&settings).expect("what was checked has an image");
            assert_eq!(decode(&image), Ok(settings));
        }
        Err(error) => {
            assert_eq!(error.to_string().lines().count(), 1, "{error}");
            let (line, column) = error.position.expect("an error has a place");
            assert!(line >= 1 && column >= 1 && line <= text.matches('\n').count() + 1);
        }
    }
});

//! The controller's end of the link, with a machine behind it that panics where it is handed anything out of range.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|script: &[u8]| {
    tests::link_script::play(script);
});

//! A program: any bytes are read to an end with finite items, or refused with a place in them.
#![no_main]

use host_sim::program::rs274::{Settings, read};
use libfuzzer_sys::fuzz_target;
use tests::program_items::ProgramItems;

fuzz_target!(|bytes: &[u8]| {
    let mut items = ProgramItems::default();
    let result = read("program.ngc", bytes, &Settings::default(), &mut |item| {
        assert!(item.line >= 1 || bytes.is_empty());
        items.take(item);
        Ok(())
    });
    items.program(bytes, result);
});

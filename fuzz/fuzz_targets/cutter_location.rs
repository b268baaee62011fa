//! A cutter-location file: any bytes are read to an end with finite items, or refused with a place in them.
#![no_main]

use host_sim::program::apt;
use host_sim::units::Units;
use libfuzzer_sys::fuzz_target;
use tests::program_items::ProgramItems;

fuzz_target!(|bytes: &[u8]| {
    let mut items = ProgramItems::default();
    let result = apt::read("part.apt", bytes, Units::Inch, &mut |item| {
        items.take(item);
        Ok(())
    });
    items.program(bytes, result);
});

//! A DXF drawing: any bytes come to chains of finite curves that end once, or are refused.
#![no_main]

use host_sim::program::drawing::dxf;
use host_sim::program::{Action, Item};
use libfuzzer_sys::fuzz_target;
use tests::program_items::ProgramItems;

fuzz_target!(|bytes: &[u8]| {
    let mut items = ProgramItems::default();
    let mut place = [0.0; 3];
    let mut sink = |item: &Item<'_>| {
        assert!(item.from == place, "a motion begins where the last one ended");
        items.take(item);
        if let Action::Motion(motion) = item.action {
            place = motion.to().unwrap_or(place);
        }
        Ok(())
    };
    match dxf::read("drawing.dxf", bytes, &dxf::Settings::default(), &mut sink) {
        Ok(_) => items.ended(),
        Err(error) => assert!(!error.message.is_empty()),
    }
});

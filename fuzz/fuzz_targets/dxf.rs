//! A DXF drawing: any bytes come to chains of finite curves that end once, or are refused.
#![no_main]

use host_sim::program::drawing::dxf;
use host_sim::program::{Action, Item};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let mut ended = false;
    let mut place = [0.0; 3];
    let mut sink = |item: &Item<'_>| {
        assert!(!ended, "nothing follows the end");
        assert!(item.from == place, "a motion begins where the last one ended");
        if let Action::Motion(motion) = item.action {
            place = motion.to().expect("every motion ends");
            assert!(place.iter().all(|x| x.is_finite()));
        }
        ended = item.action == Action::End;
        Ok(())
    };
    match dxf::read("drawing.dxf", bytes, &dxf::Settings::default(), &mut sink) {
        Ok(_) => assert!(ended, "a drawing that is right ends"),
        Err(error) => assert!(!error.message.is_empty()),
    }
});

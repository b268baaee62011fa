//! A cutter-location file: any bytes are read to an end with finite items, or refused with a place in them.
#![no_main]

use host_sim::program::{Action, apt};
use host_sim::units::Units;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let mut ended = false;
    let result = apt::read("part.apt", bytes, Units::Inch, &mut |item| {
        assert!(!ended, "nothing follows the end");
        assert!(item.from.iter().all(|x| x.is_finite()));
        if let Action::Motion(motion) = item.action {
            assert!(motion.to().expect("every motion ends").iter().all(|x| x.is_finite()));
        }
        ended = item.action == Action::End;
        Ok(())
    });
    match result {
        Ok(_) => assert!(ended, "a file that is right ends"),
        Err(error) => assert!(error.position.is_some() && !error.message.contains('\n')),
    }
});

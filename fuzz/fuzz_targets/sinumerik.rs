//! A Sinumerik program: any bytes are read to an end with finite items, or refused with a place in them; and what a writer takes
//! of it can be read back.
#![no_main]

use host_sim::program::sinumerik::{Settings, read};
use host_sim::program::write::{self, Dialect, Writer};
use host_sim::program::{Action, Motion, rs274};
use libfuzzer_sys::fuzz_target;
use tests::program_items::ProgramItems;

fuzz_target!(|bytes: &[u8]| {
    let mut items = ProgramItems::default();
    let mut writers = [Dialect::Rs274, Dialect::Sinumerik]
        .map(|dialect| Writer::new(Vec::new(), dialect, write::Settings::default()).expect("memory can be written"));
    let result = read("program.mpf", bytes, &Settings::default(), &mut |item| {
        assert!(item.line >= 1 || bytes.is_empty());
        items.take(item);
        if let Action::Motion(motion) = item.action {
            if let Motion::Nurbs(curve) = motion {
                assert!(curve.points[0] == item.from);
            }
            for writer in &mut writers {
                // A language may lack a motion; its program goes on elsewhere then, and refuses the next one.
                let _ = writer.motion(item.from, item.feed, &motion);
            }
        }
        Ok(())
    });
    items.program(bytes, result);
    let [rs274, sinumerik] = writers.map(|writer| writer.finish().expect("memory can be written"));
    let back = rs274::read("back.ngc", &rs274[..], &rs274::Settings::default(), &mut |_| Ok(()));
    assert!(back.is_ok(), "{}\n{}", back.unwrap_err(), String::from_utf8_lossy(&rs274));
    let back = read("back.mpf", &sinumerik[..], &Settings::default(), &mut |_| Ok(()));
    assert!(back.is_ok(), "{}\n{}", back.unwrap_err(), String::from_utf8_lossy(&sinumerik));
});

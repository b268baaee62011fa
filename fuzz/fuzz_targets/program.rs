//! A program: any bytes are read to an end with finite items, or refused with a place in them and their block.
#![no_main]

use host_sim::program::rs274::{Settings, read};
use host_sim::program::{Action, Motion};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let mut ended = false;
    let result = read("program.ngc", bytes, &Settings::default(), &mut |item| {
        assert!(!ended, "nothing follows the end");
        assert!(item.line >= 1 || bytes.is_empty());
        assert!(item.from.iter().all(|x| x.is_finite()));
        match item.action {
            Action::Motion(motion) => {
                assert!(motion.to().expect("every motion ends").iter().all(|x| x.is_finite()));
                if let Motion::Arc(arc) = motion {
                    assert!(arc.sweep.is_finite() && arc.sweep != 0.0 && arc.centre.iter().all(|x| x.is_finite()));
                }
                if let Motion::Nurbs(curve) = motion {
                    assert_eq!(curve.points.len(), curve.weights.len());
                    assert_eq!(curve.points.len() + curve.order, curve.knots.len());
                    assert!(curve.weights.iter().all(|&weight| weight > 0.0));
                }
            }
            Action::End => ended = true,
            _ => {}
        }
        Ok(())
    });
    match result {
        Ok(_) => assert!(ended, "a program that is right ends"),
        Err(error) => {
            let (line, column) = error.position.expect("an error has a place");
            let lines = bytes.iter().filter(|&&byte| byte == b'\n').count() + 1;
            assert!(column >= 1 && line <= lines);
            assert!(!error.message.contains('\n'));
        }
    }
});

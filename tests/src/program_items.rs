//! What every reader of programs and drawings promises of any bytes: what the fuzz targets have in common.

use host_sim::input::InputError;
use host_sim::program::{Action, Item, Motion};

/// Takes items and holds them to the promises.
#[derive(Debug, Default)]
pub struct ProgramItems {
    ended: bool,
}

impl ProgramItems {
    /// Panics where an item follows the end, is not finite, or is no curve.
    pub fn take(&mut self, item: &Item<'_>) {
        assert!(!self.ended, "nothing follows the end");
        assert!(item.from.iter().all(|x| x.is_finite()));
        match item.action {
            Action::Motion(motion) => {
                assert!(motion.to().is_some_and(|to| to.iter().all(|x| x.is_finite())), "every motion ends");
                match motion {
                    Motion::Arc(arc) => {
                        assert!(arc.sweep.is_finite() && arc.sweep != 0.0);
                        assert!(arc.centre.iter().all(|x| x.is_finite()));
                    }
                    Motion::Nurbs(curve) => {
                        assert_eq!(curve.points.len(), curve.weights.len());
                        assert_eq!(curve.points.len() + curve.order, curve.knots.len());
                        assert!(curve.weights.iter().all(|&weight| weight > 0.0));
                        assert!(curve.knots.is_sorted());
                    }
                    _ => {}
                }
            }
            Action::End => self.ended = true,
            _ => {}
        }
    }

    /// Panics where a reading that went well has not ended.
    pub fn ended(&self) {
        assert!(self.ended, "what is right ends");
    }

    /// The promises of a program's whole reading: it ends, or is refused with a place within it and one sentence.
    pub fn program(&self, bytes: &[u8], result: Result<usize, InputError>) {
        match result {
            Ok(_) => self.ended(),
            Err(error) => {
                let lines = bytes.iter().filter(|&&byte| byte == b'\n').count() + 1;
                assert!(error.position.is_some_and(|(line, column)| column >= 1 && line <= lines), "{error:?}");
                assert!(!error.message.contains('\n'));
            }
        }
    }
}

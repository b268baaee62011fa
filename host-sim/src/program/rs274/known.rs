//! The parameters that the machine keeps, as expressions read them.

use super::frames::{Frames, turns};
use super::interpreter::Modal;
use super::parameters::Kept;
use crate::units::Units;

/// The parameters that the machine keeps, in the program's unit.
pub struct Known<'a> {
    /// What holds.
    pub modal: &'a Modal,
    /// Where everything is.
    pub frames: &'a Frames,
    /// The line that is read.
    pub line: usize,
}

impl Known<'_> {
    /// A length or an angle as the program counts it.
    fn counted(&self, axis: usize, value: f64) -> f64 {
        if turns(axis) { value } else { value / self.modal.units.mm() }
    }
}

impl Kept for Known<'_> {
    fn numbered(&self, number: u16) -> Option<f64> {
        let of = |first: u16, values: &[f64; 9]| {
            let axis = usize::from(number - first);
            values.get(axis).map(|&value| self.counted(axis, value))
        };
        match number {
            5161..=5169 => of(5161, &self.frames.homes[0]),
            5181..=5189 => of(5181, &self.frames.homes[1]),
            5211..=5219 => of(5211, &self.frames.shift),
            5220 => Some((self.frames.active + 1) as f64),
            5221..=5399 => {
                let [system, axis] = [(number - 5221) / 20, (number - 5221) % 20].map(usize::from);
                let value = *self.frames.systems.get(system)?.get(axis)?;
                Some(self.counted(axis, value))
            }
            5400 => Some(f64::from(self.modal.loaded)),
            5401..=5409 => of(5401, &self.frames.length),
            5420..=5428 => {
                let axis = usize::from(number - 5420);
                Some(self.counted(axis, self.frames.counted(axis)))
            }
            _ => None,
        }
    }

    fn named(&self, name: &str) -> Option<f64> {
        let truth = |holds: bool| Some(f64::from(u8::from(holds)));
        let coordinate = |axis: usize| Some(self.counted(axis, self.frames.counted(axis)));
        match name {
            "_line" => Some(self.line as f64),
            "_metric" => truth(self.modal.units == Units::Mm),
            "_imperial" => truth(self.modal.units == Units::Inch),
            "_absolute" => truth(!self.modal.incremental),
            "_incremental" => truth(self.modal.incremental),
            "_inverse_time" => truth(self.modal.inverse_time),
            "_current_tool" => Some(f64::from(self.modal.loaded)),
            "_x" => coordinate(0),
            "_y" => coordinate(1),
            "_z" => coordinate(2),
            _ => None,
        }
    }
}

//! Coordinate systems, shifts, tool lengths, and the fixed places of a machine: G10 G28 G30 G43 G49 G54 to G59.3 G92.

use super::codes::{AXES, Code, Group};
use super::fault::{Checked, Fault, fail};
use super::frames::{AXIS_LETTERS, Axes, turns};
use super::interpreter::Interpreter;
use super::words::Block;
use crate::program::Action;
use crate::program::output::Output;

impl Interpreter {
    /// The values of a block's axis words in mm or degrees, each with its axis.
    pub(super) fn axis_words(&self, block: &Block) -> impl Iterator<Item = (usize, f64)> + use<> {
        let mm = self.mm();
        let values = AXIS_LETTERS.map(|letter| block.value(letter));
        let scaled = move |(axis, value): (usize, f64)| (axis, if turns(axis) { value } else { value * mm });
        values.into_iter().enumerate().filter_map(|(axis, value)| Some((axis, value?))).map(scaled)
    }

    /// G43, G43.1 and G49.
    pub(super) fn length(&mut self, block: &Block, out: &mut Output<'_, '_>) -> Checked<()> {
        let Some((code, at)) = block.in_group(Group::Length) else { return Ok(()) };
        let mut length = [0.0; 3];
        match code.tenths {
            430 => {
                let tool = block.whole(b'H', 0, 99_999)?.unwrap_or(self.modal.loaded);
                length[2] = self.lengths.get(&tool).copied().unwrap_or(0.0);
            }
            431 => {
                for (axis, value) in self.axis_words(block) {
                    match length.get_mut(axis) {
                        Some(length) => *length = value,
                        None => {
                            let letter = AXIS_LETTERS[axis];
                            return fail(block.place(letter), Fault::Unused(char::from(letter)));
                        }
                    }
                }
            }
            _ => {}
        }
        self.frames.set_length(length);
        self.event(at, Action::ToolLength(length), out)
    }

    /// G54 to G59.3.
    pub(super) fn system(&mut self, block: &Block) -> Checked<()> {
        let Some((code, at)) = block.in_group(Group::System) else { return Ok(()) };
        let number = match code.tenths {
            tenths @ 540..=590 => (tenths - 540) / 10,
            tenths => 5 + tenths % 10,
        };
        self.only_uncompensated(usize::from(number) != self.frames.active, code, at)?;
        self.frames.active = usize::from(number);
        Ok(())
    }

    /// G10, G28, G30 and G92.
    pub(super) fn setup(&mut self, block: &Block, out: &mut Output<'_, '_>) -> Checked<()> {
        let Some((code, at)) = block.in_group(Group::Once) else { return Ok(()) };
        match code.tenths {
            100 => self.set_system(code, at, block),
            280 => self.go_home(0, at, block, out),
            300 => self.go_home(1, at, block, out),
            281 | 301 => {
                self.frames.set_home(usize::from(code.tenths == 301));
                Ok(())
            }
            920 => {
                if block.letters.and(AXES).is_empty() {
                    return fail(at, Fault::Needs(code, "an axis"));
                }
                for (axis, value) in self.axis_words(block) {
                    self.frames.shift_to(axis, value);
                }
                self.frames.kept_shift = self.frames.shift;
                Ok(())
            }
            921 => {
                self.frames.shift = [0.0; 9];
                self.frames.kept_shift = [0.0; 9];
                Ok(())
            }
            922 => {
                self.frames.shift = [0.0; 9];
                Ok(())
            }
            923 => {
                self.frames.shift = self.frames.kept_shift;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// G10 L2 and L20.
    fn set_system(&mut self, code: Code, at: usize, block: &Block) -> Checked<()> {
        let kind = match block.whole(b'L', 0, u32::MAX)? {
            Some(kind @ (2 | 20)) => kind,
            _ => return fail(at, Fault::SetupKind),
        };
        if block.value(b'R').is_some() {
            return fail(block.place(b'R'), Fault::SetupTurned);
        }
        let number = match block.whole(b'P', 0, 9)? {
            Some(0) => self.frames.active,
            Some(number) => number as usize - 1,
            None => return fail(at, Fault::Needs(code, "the number of a coordinate system (P)")),
        };
        self.only_uncompensated(number == self.frames.active, code, at)?;
        for (axis, value) in self.axis_words(block) {
            if kind == 20 {
                self.frames.move_system_to(number, axis, value);
            } else if let Some(system) = self.frames.systems.get_mut(number) {
                system[axis] = value;
            }
        }
        Ok(())
    }

    /// G28 and G30: by way of the place that the axis words name, to the machine's place. Without axis words straight there
    /// with all axes, with some of them with those alone.
    fn go_home(&mut self, which: usize, at: usize, block: &Block, out: &mut Output<'_, '_>) -> Checked<()> {
        let home = self.frames.homes.get(which).copied().unwrap_or(self.frames.tip);
        let home: Axes = std::array::from_fn(|axis| home[axis] + self.frames.machine_zero(axis));
        if block.letters.and(AXES).is_empty() {
            return self.rapid(home, at, out);
        }
        let mut end = self.target(block);
        self.rapid(end, at, out)?;
        for (axis, _) in self.axis_words(block) {
            end[axis] = home[axis];
        }
        self.rapid(end, at, out)
    }
}

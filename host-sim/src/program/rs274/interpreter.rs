//! What holds from block to block, and the order in which the codes of a block act.
//!
//! The order is that of the RS274/NGC standard (table 8): feed mode, feed, speed, tool, spindle, coolant, dwell, plane, units,
//! compensation, length, system, path mode, distances, G10 G28 G92, motion, stop; but units come first (see the module
//! above).

use std::collections::BTreeMap;

use super::Settings;
use super::codes::{self, ALWAYS, AXES, CENTRE, Code, Group, Letters};
use super::fault::{Checked, Fault, fail, give};
use super::frames::{AXIS_LETTERS, Frames};
use super::known::Known;
use super::nurbs::Curve;
use super::parameters::Parameters;
use super::words::Block;
use crate::program::item::{Coolant, Speed, Spindle, Turning};
use crate::program::output::Output;
use crate::program::{Action, Feed, Plane};
use crate::units::Units;

/// G53 in tenths.
pub const MACHINE: u16 = 530;
/// G5.2 in tenths.
const NURBS: u16 = 52;
/// G5.3 in tenths.
const NURBS_END: u16 = 53;

/// What holds until a code changes it.
#[derive(Clone, Debug)]
pub struct Modal {
    /// The motion of blocks that have only axis words.
    pub motion: Option<Code>,
    /// Of arcs.
    pub plane: Plane,
    /// G91.
    pub incremental: bool,
    /// G90.1.
    pub absolute_centres: bool,
    /// G93.
    pub inverse_time: bool,
    /// G20 or G21.
    pub units: Units,
    /// Whether cutter compensation is on.
    pub compensated: bool,
    /// Of G94; unset while G93 holds.
    pub feed: Feed,
    /// The tool that T named last.
    pub selected: u32,
    /// The tool that M6 put in.
    pub loaded: u32,
    /// What the spindle does.
    pub spindle: Spindle,
    /// Which coolant runs.
    pub coolant: Coolant,
    /// What a G5 without I and J begins with: the tangent in which the one just before it has ended.
    pub tangent: Option<[f64; 2]>,
}

/// A program while it is read.
#[derive(Clone, Debug)]
pub struct Interpreter {
    /// What holds.
    pub modal: Modal,
    /// Where everything is.
    pub frames: Frames,
    /// What the program has set.
    pub parameters: Parameters,
    /// The curve between G5.2 and G5.3.
    pub curve: Curve,
    /// Tool lengths by number.
    pub lengths: BTreeMap<u32, f64>,
}

impl Interpreter {
    /// Before the first block.
    pub fn new(settings: &Settings) -> Self {
        let modal = Modal {
            motion: None,
            plane: Plane::Xy,
            incremental: false,
            absolute_centres: false,
            inverse_time: false,
            units: settings.units,
            compensated: false,
            feed: Feed::Unset,
            selected: 0,
            loaded: 0,
            spindle: Spindle { turning: Turning::Off, speed: Speed::Turns(0.0) },
            coolant: Coolant::default(),
            tangent: None,
        };
        Self {
            modal,
            frames: Frames::new(settings),
            parameters: Parameters::default(),
            curve: Curve::default(),
            lengths: settings.lengths.clone(),
        }
    }

    /// What expressions of a line can know of the machine.
    pub fn known(&self, line: usize) -> Known<'_> {
        Known { modal: &self.modal, frames: &self.frames, line }
    }

    /// Does what a block says. Returns whether the program has ended.
    pub fn block(&mut self, block: &mut Block, out: &mut Output<'_, '_>) -> Checked<bool> {
        for (at, key, value) in block.settings.drain(..) {
            self.parameters.set(key, value).or_else(|fault| fail(at, fault))?;
        }
        if block.is_empty() {
            return Ok(false);
        }
        let motion = self.motion_of(block)?;
        if block.has_beside(Group::Motion) || !block.letters.and(ALWAYS).is_empty() {
            self.switch(block, out)?;
        }
        match (motion, block.in_group(Group::Once)) {
            (Some((code, at)), _) => self.motion(code, at, block, out)?,
            (None, Some((Code { tenths: MACHINE, .. }, at))) => return fail(at, Fault::MachineMotion),
            (None, _) => {}
        }
        match block.in_group(Group::Stop) {
            Some((Code { tenths: 20 | 300, .. }, at)) => self.end(at, out).map(|()| true),
            Some((code, at)) => {
                self.event(at, Action::Stop { optional: code.tenths == 10 }, out)?;
                Ok(false)
            }
            None => Ok(false),
        }
    }

    /// Everything of a block but its motion and its stop.
    fn switch(&mut self, block: &Block, out: &mut Output<'_, '_>) -> Checked<()> {
        self.units(block)?;
        self.feed(block)?;
        self.tool_and_spindle(block, out)?;
        self.coolant(block, out)?;
        self.dwell(block, out)?;
        self.plane(block)?;
        self.compensation(block, out)?;
        self.length(block, out)?;
        self.system(block)?;
        self.path_mode(block, out)?;
        if let Some((code, _)) = block.in_group(Group::Distance) {
            self.modal.incremental = code.tenths == 910;
        }
        if let Some((code, _)) = block.in_group(Group::Centres) {
            self.modal.absolute_centres = code.tenths == 901;
        }
        self.setup(block, out)
    }

    /// The end of the program.
    pub fn end(&mut self, at: usize, out: &mut Output<'_, '_>) -> Checked<()> {
        if self.curve.is_open() {
            return fail(at, Fault::NurbsEnd);
        }
        self.event(at, Action::End, out)
    }

    /// Gives an event.
    pub fn event(&self, at: usize, action: Action<'_>, out: &mut Output<'_, '_>) -> Checked<()> {
        give(out, at, self.frames.place(), self.modal.feed, action)
    }

    /// The millimetres of the program's unit.
    pub fn mm(&self) -> f64 {
        self.modal.units.mm()
    }

    /// The motion that a block asks for, and the place of the word that does. Errors: words that nothing uses, or that two
    /// codes would use; axes without motion; anything but control points in a curve.
    fn motion_of(&self, block: &Block) -> Checked<Option<(Code, usize)>> {
        let mut used = Letters(0);
        for (code, at) in block.codes() {
            claim(block, &mut used, code, at)?;
        }
        let left = block.letters.without(used);
        let axes = left.and(AXES);
        let motion = match (block.in_group(Group::Motion), self.modal.motion) {
            (Some(motion), _) => Some(motion),
            (None, Some(code)) if !axes.is_empty() => Some((code, first_place(block, axes))),
            (None, Some(code @ Code { tenths: 20 | 30, .. })) if !left.and(CENTRE).is_empty() => {
                Some((code, first_place(block, left.and(CENTRE))))
            }
            _ => None,
        };
        if let (Some((code, at)), None) = (motion, block.in_group(Group::Motion)) {
            claim(block, &mut used, code, at)?;
        }
        if self.curve.is_open() {
            let goes_on = matches!(motion, None | Some((Code { tenths: NURBS | NURBS_END, .. }, _)));
            if !goes_on || block.has_beside(Group::Motion) || !block.letters.and(Letters::of(b"FST")).is_empty() {
                let code = block.codes().map(|(_, at)| at).min();
                let word = (!block.letters.is_empty()).then(|| first_place(block, block.letters));
                return fail(code.into_iter().chain(word).min().unwrap_or(0), Fault::NurbsOpen);
            }
        }
        match block.letters.without(used).without(ALWAYS).first() {
            None => Ok(motion),
            Some(index) => {
                let letter = b'A' + index as u8;
                let is_axis = AXIS_LETTERS.contains(&letter) && motion.is_none();
                let letter_name = char::from(letter);
                fail(
                    block.place(letter),
                    if is_axis { Fault::NoMotion(letter_name) } else { Fault::Unused(letter_name) },
                )
            }
        }
    }
}

/// Marks the words that a code uses. Errors: another code uses one of them already.
fn claim(block: &Block, used: &mut Letters, code: Code, at: usize) -> Checked<()> {
    let words = codes::words(code).and(block.letters);
    if let Some(index) = words.and(*used).first() {
        let letter = b'A' + index as u8;
        let other = block
            .codes()
            .map(|(other, _)| other)
            .find(|&other| other != code && !codes::words(other).and(Letters::of(&[letter])).is_empty());
        return fail(at, Fault::Shared(char::from(letter), other.unwrap_or(code), code));
    }
    *used = used.or(words);
    Ok(())
}

/// Where the first word of some letters stands.
fn first_place(block: &Block, letters: Letters) -> usize {
    let letters = (b'A'..=b'Z').filter(|&letter| !letters.and(Letters::of(&[letter])).is_empty());
    letters.map(|letter| block.place(letter)).min().unwrap_or(0)
}

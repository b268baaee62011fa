//! Units, feeds, tools, spindle, coolant, dwells: what a block says beside its motion.

use super::codes::{Code, Group};
use super::fault::{Checked, Fault, fail};
use super::interpreter::Interpreter;
use super::words::Block;
use crate::program::item::{Compensation, Coolant, Cutter, PathMode, Side, Speed, Turning};
use crate::program::output::Output;
use crate::program::{Action, Feed, Plane};
use crate::units::Units;

/// Seconds in a minute: programs count feeds and turns by it.
const MINUTE: f64 = 60.0;
/// Millimetres in a foot.
const FOOT: f64 = 304.8;
/// The largest number of a tool.
const LAST_TOOL: u32 = 99_999;

impl Interpreter {
    /// G20 and G21.
    pub(super) fn units(&mut self, block: &Block) -> Checked<()> {
        let Some((code, at)) = block.in_group(Group::Units) else { return Ok(()) };
        let units = if code.tenths == 200 { Units::Inch } else { Units::Mm };
        self.only_uncompensated(units != self.modal.units, code, at)?;
        self.modal.units = units;
        Ok(())
    }

    /// G93, G94 and F.
    pub(super) fn feed(&mut self, block: &Block) -> Checked<()> {
        if let Some((code, _)) = block.in_group(Group::FeedMode) {
            let inverse_time = code.tenths == 930;
            if inverse_time != self.modal.inverse_time {
                self.modal.feed = Feed::Unset;
            }
            self.modal.inverse_time = inverse_time;
        }
        let Some(value) = block.positive_or_zero(b'F')? else { return Ok(()) };
        if !self.modal.inverse_time {
            self.modal.feed = Feed::Rate(value * self.mm() / MINUTE);
        }
        Ok(())
    }

    /// The feed of a cut. Errors: there is none.
    pub(super) fn cutting_feed(&self, code: Code, at: usize, block: &Block) -> Checked<Feed> {
        if self.modal.inverse_time {
            return match block.value(b'F') {
                Some(value) if value > 0.0 => Ok(Feed::Duration(MINUTE / value)),
                _ => fail(at, Fault::NoInverseFeed(code)),
            };
        }
        match self.modal.feed {
            Feed::Rate(rate) if rate > 0.0 => Ok(self.modal.feed),
            _ => fail(at, Fault::NoFeed(code)),
        }
    }

    /// T, M6, S, M3 to M5, G96, G97.
    pub(super) fn tool_and_spindle(&mut self, block: &Block, out: &mut Output<'_, '_>) -> Checked<()> {
        if let Some(tool) = block.whole(b'T', 0, LAST_TOOL)? {
            self.modal.selected = tool;
            self.event(block.place(b'T'), Action::ToolSelect(tool), out)?;
        }
        if let Some((_, at)) = block.in_group(Group::Tool) {
            self.modal.loaded = self.modal.selected;
            self.modal.spindle.turning = Turning::Off;
            self.event(at, Action::ToolChange(self.modal.loaded), out)?;
        }
        let mode = block.in_group(Group::SpindleMode);
        let turning = block.in_group(Group::Spindle);
        let value = block.positive_or_zero(b'S')?;
        self.modal.spindle.speed = match (mode, self.modal.spindle.speed) {
            (Some((code @ Code { tenths: 960, .. }, at)), _) => {
                let Some(value) = value else { return fail(at, Fault::Needs(code, "the speed of the cut (S)")) };
                let most = block.positive_or_zero(b'D')?.map(|most| most / MINUTE);
                Speed::Surface { speed: self.surface_speed(value), most }
            }
            (None, Speed::Surface { speed, most }) => {
                Speed::Surface { speed: value.map_or(speed, |value| self.surface_speed(value)), most }
            }
            (Some(_), Speed::Surface { .. }) => Speed::Turns(value.unwrap_or(0.0) / MINUTE),
            (_, Speed::Turns(turns)) => Speed::Turns(value.map_or(turns, |value| value / MINUTE)),
        };
        if let Some((code, _)) = turning {
            self.modal.spindle.turning = match code.tenths {
                30 => Turning::Clockwise,
                40 => Turning::Anticlockwise,
                _ => Turning::Off,
            };
        }
        let said = turning.or(mode).map(|(_, at)| at).or(value.map(|_| block.place(b'S')));
        said.map_or(Ok(()), |at| self.event(at, Action::Spindle(self.modal.spindle), out))
    }

    /// In mm/s, from m/min or feet/min.
    fn surface_speed(&self, value: f64) -> f64 {
        let length = match self.modal.units {
            Units::Mm => 1000.0,
            Units::Inch => FOOT,
        };
        value * length / MINUTE
    }

    /// M7 to M9.
    pub(super) fn coolant(&mut self, block: &Block, out: &mut Output<'_, '_>) -> Checked<()> {
        let Some((code, at)) = block.in_group(Group::Coolant) else { return Ok(()) };
        match code.tenths {
            70 => self.modal.coolant.mist = true,
            80 => self.modal.coolant.flood = true,
            _ => self.modal.coolant = Coolant::default(),
        }
        self.event(at, Action::Coolant(self.modal.coolant), out)
    }

    /// G4.
    pub(super) fn dwell(&mut self, block: &Block, out: &mut Output<'_, '_>) -> Checked<()> {
        let Some((code @ Code { tenths: 40, .. }, at)) = block.in_group(Group::Once) else { return Ok(()) };
        match block.positive_or_zero(b'P')? {
            Some(seconds) => self.event(at, Action::Dwell(seconds), out),
            None => fail(at, Fault::Needs(code, "its seconds (P)")),
        }
    }

    /// G17 to G19.
    pub(super) fn plane(&mut self, block: &Block) -> Checked<()> {
        let Some((code, at)) = block.in_group(Group::Plane) else { return Ok(()) };
        let plane = match code.tenths {
            170 => Plane::Xy,
            180 => Plane::Zx,
            _ => Plane::Yz,
        };
        self.only_uncompensated(plane != self.modal.plane, code, at)?;
        self.modal.plane = plane;
        Ok(())
    }

    /// G40 to G42, and .1.
    pub(super) fn compensation(&mut self, block: &Block, out: &mut Output<'_, '_>) -> Checked<()> {
        let Some((code, at)) = block.in_group(Group::Cutter) else { return Ok(()) };
        let compensation = match code.tenths {
            400 => Compensation::Off,
            tenths => {
                self.only_uncompensated(true, code, at)?;
                if self.modal.plane == Plane::Yz {
                    return fail(at, Fault::CompensationPlane);
                }
                let cutter = if tenths % 10 == 0 {
                    block.whole(b'D', 0, LAST_TOOL)?.map_or(Cutter::Loaded, Cutter::Number)
                } else {
                    match block.positive_or_zero(b'D')? {
                        Some(diameter) => Cutter::Diameter(diameter * self.mm()),
                        None => return fail(at, Fault::Needs(code, "the diameter of the tool (D)")),
                    }
                };
                Compensation::On { side: if tenths < 420 { Side::Left } else { Side::Right }, cutter }
            }
        };
        self.modal.compensated = compensation != Compensation::Off;
        self.event(at, Action::Compensation(compensation), out)
    }

    /// G61, G61.1 and G64.
    pub(super) fn path_mode(&mut self, block: &Block, out: &mut Output<'_, '_>) -> Checked<()> {
        let Some((code, at)) = block.in_group(Group::Path) else { return Ok(()) };
        let mode = match code.tenths {
            610 => PathMode::Exact,
            611 => PathMode::Stop,
            _ => {
                let [tolerance, thinning] = [block.positive_or_zero(b'P')?, block.positive_or_zero(b'Q')?]
                    .map(|length| length.map(|length| length * self.mm()));
                PathMode::Blend { tolerance, thinning: thinning.or(tolerance) }
            }
        };
        self.event(at, Action::PathMode(mode), out)
    }

    /// Refuses a code that would change what compensation stands on.
    pub(super) fn only_uncompensated(&self, changes: bool, code: Code, at: usize) -> Checked<()> {
        if changes && self.modal.compensated { fail(at, Fault::Compensated(code)) } else { Ok(()) }
    }
}

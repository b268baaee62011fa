//! What blocks do.

use super::Settings;
use super::block::{Block, Exactness, Move, Number, UnitCode};
use super::fault::{Checked, Fault, Misplaced, Place, fail, given};
use super::spline::Spline;
use super::words::Name;
use crate::program::arc::Ends;
use crate::program::item::{Compensation, Coolant, Cutter, PathMode, Speed, Spindle, Turning};
use crate::program::output::{Output, Refused};
use crate::program::{Action, Arc, Feed, Motion, Plane};
use crate::units::Units;

/// Seconds in a minute.
const MINUTE: f64 = 60.0;
/// The most turns that TURN= adds.
const MOST_TURNS: f64 = 999.0;
/// The highest number of a tool.
const MOST_TOOLS: f64 = 99_999_999.0;

/// The motion in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    None,
    Move(Move),
    /// BSPLINE, and an event has ended the spline.
    Ended,
}

/// A program while it is read.
#[derive(Clone, Debug)]
pub struct Reader {
    units: UnitCode,
    plane: Plane,
    incremental: bool,
    inverse: bool,
    mode: Mode,
    system: Option<u16>,
    place: [f64; 3],
    feed: Feed,
    spline: Spline,
    tool: u32,
    spindle: Spindle,
    coolant: Coolant,
}

impl Reader {
    /// At the beginning of a program.
    pub fn new(settings: &Settings) -> Self {
        Self {
            units: UnitCode { units: settings.units, feeds: true },
            plane: Plane::Xy,
            incremental: false,
            inverse: false,
            mode: Mode::None,
            system: None,
            place: settings.start,
            feed: Feed::Unset,
            spline: Spline::new(),
            tool: 0,
            spindle: Spindle { turning: Turning::Off, speed: Speed::Turns(0.0) },
            coolant: Coolant::default(),
        }
    }

    /// Does what a block says. Returns whether the program has ended.
    pub fn block(&mut self, block: &Block, out: &mut Output<'_, '_>) -> Checked<bool> {
        self.ends_spline(block, out)?;
        if let Some((units, _)) = block.units {
            self.units = units;
        }
        if let Some((inverse, _)) = block.inverse.filter(|&(inverse, _)| inverse != self.inverse) {
            self.inverse = inverse;
            // A number of the other kind means nothing.
            self.feed = Feed::Unset;
        }
        if let Some((plane, _)) = block.plane {
            self.plane = plane;
        }
        if let Some((incremental, _)) = block.incremental {
            self.incremental = incremental;
        }
        if let Some((system, at)) = block.system
            && *self.system.get_or_insert(system) != system
        {
            return fail(at, Fault::System);
        }
        if let Some(((), at)) = block.dwell {
            return self.dwell(at, block, out).map(|()| false);
        }
        self.set_feed(block)?;
        self.events(block, out)?;
        if let Some((motion, _)) = block.motion {
            self.mode = Mode::Move(motion);
        }
        self.motion(block, out)?;
        for &(m, at) in &block.m {
            match m {
                0 | 1 => self.give(at, Action::Stop { optional: m == 1 }, out)?,
                2 | 17 | 30 => return self.end(at, out).map(|()| true),
                _ => {}
            }
        }
        Ok(false)
    }

    /// The end of the program, which the byte at `at` asks for.
    pub fn end(&mut self, at: usize, out: &mut Output<'_, '_>) -> Checked<()> {
        self.close_spline(out)?;
        self.give(at, Action::End, out)
    }

    fn give(&self, at: usize, action: Action<'_>, out: &mut Output<'_, '_>) -> Checked<()> {
        given(at, out.give(at, self.place, self.feed, action))
    }

    /// Gives the spline that is open, if this block does not go on with it.
    fn ends_spline(&mut self, block: &Block, out: &mut Output<'_, '_>) -> Checked<()> {
        if !self.spline.is_open() {
            return Ok(());
        }
        let event = block.m.first().map(|&(_, at)| (b"M", at));
        let event = event.or(block.speed.map(|word| (b"S", word.at))).or(block.tool.map(|word| (b"T", word.at)));
        let goes_on = block.has_axes() && block.motion.is_none();
        match event {
            Some((name, at)) if goes_on => fail(at, Fault::Within(Name::new(name))),
            None if block.motion.is_none() && block.dwell.is_none() => {
                let codes = [
                    block.exactness.map(|(_, at)| at),
                    block.compensation.map(|(_, at)| at),
                    block.inverse.map(|(_, at)| at),
                ];
                codes.into_iter().flatten().next().map_or(Ok(()), |at| fail(at, Fault::Within(Name::new(b"G"))))
            }
            _ => {
                self.close_spline(out)?;
                self.mode = Mode::Ended;
                Ok(())
            }
        }
    }

    fn close_spline(&mut self, out: &mut Output<'_, '_>) -> Checked<()> {
        let Some(start) = self.spline.start() else { return Ok(()) };
        let (place, feed) = (self.spline.begins, self.spline.feed);
        let curve = self.spline.close()?;
        let result = out.give_before(place, start, feed, Action::Motion(Motion::Nurbs(curve)));
        self.spline.clear();
        let (line, column) = place;
        result.map_err(|Refused| Misplaced { place: Place::Before { line, column }, fault: Fault::Refused })
    }

    fn set_feed(&mut self, block: &Block) -> Checked<()> {
        let Some(Number { value, at }) = block.feed else { return Ok(()) };
        if value <= 0.0 {
            return fail(at, Fault::Feed);
        }
        let mm = if self.units.feeds { self.units.units.mm() } else { Units::Mm.mm() };
        let feed = if self.inverse { Feed::Duration(MINUTE / value) } else { Feed::Rate(value * mm / MINUTE) };
        if self.spline.is_open() && feed != self.spline.feed {
            return fail(at, Fault::Within(Name::new(b"F")));
        }
        self.feed = feed;
        Ok(())
    }

    /// G4.
    fn dwell(&mut self, at: usize, block: &Block, out: &mut Output<'_, '_>) -> Checked<()> {
        match block.feed {
            _ if block.has_axes() || block.motion.is_some() || !block.m.is_empty() || block.speed.is_some() => {
                fail(at, Fault::Dwell)
            }
            Some(Number { value, .. }) if value >= 0.0 => self.give(at, Action::Dwell(value), out),
            _ => fail(at, Fault::Dwell),
        }
    }

    /// What happens before the motion.
    fn events(&mut self, block: &Block, out: &mut Output<'_, '_>) -> Checked<()> {
        if let Some(Number { value, at }) = block.tool {
            if value.fract() != 0.0 || !(0.0..=MOST_TOOLS).contains(&value) {
                return fail(at, Fault::Range(Name::new(b"T")));
            }
            self.tool = value as u32;
            self.give(at, Action::ToolSelect(self.tool), out)?;
        }
        if let Some(&(_, at)) = block.m.iter().find(|(m, _)| *m == 6) {
            self.give(at, Action::ToolChange(self.tool), out)?;
        }
        let mut turned = None;
        if let Some(Number { value, at }) = block.speed {
            if value < 0.0 {
                return fail(at, Fault::Range(Name::new(b"S")));
            }
            self.spindle.speed = Speed::Turns(value / MINUTE);
            turned = Some(at);
        }
        for &(m, at) in &block.m {
            self.spindle.turning = match m {
                3 => Turning::Clockwise,
                4 => Turning::Anticlockwise,
                5 => Turning::Off,
                _ => continue,
            };
            turned = Some(at);
        }
        if let Some(at) = turned {
            self.give(at, Action::Spindle(self.spindle), out)?;
        }
        for &(m, at) in &block.m {
            match m {
                7 => self.coolant.mist = true,
                8 => self.coolant.flood = true,
                9 => self.coolant = Coolant::default(),
                _ => continue,
            }
            self.give(at, Action::Coolant(self.coolant), out)?;
        }
        if let Some((exactness, at)) = block.exactness {
            let mode = match exactness {
                Exactness::Stop => PathMode::Stop,
                Exactness::Blend => PathMode::Blend { tolerance: None, thinning: None },
            };
            self.give(at, Action::PathMode(mode), out)?;
        }
        if let Some((side, at)) = block.compensation {
            let on = |side| Compensation::On { side, cutter: Cutter::Loaded };
            self.give(at, Action::Compensation(side.map_or(Compensation::Off, on)), out)?;
        }
        Ok(())
    }

    /// The motion of a block.
    fn motion(&mut self, block: &Block, out: &mut Output<'_, '_>) -> Checked<()> {
        let is_arc = matches!(self.mode, Mode::Move(Move::Arc { .. }));
        let arc_words = block.centre.iter().chain([&block.radius, &block.turns]).flatten().next();
        if let (false, Some(word)) = (is_arc, arc_words) {
            return fail(word.at, Fault::NoUse("I, J, K, CR or TURN"));
        }
        let is_spline = self.mode == Mode::Move(Move::Spline);
        if let Some(Number { value, at }) = block.degree {
            if !is_spline {
                return fail(at, Fault::NoUse("SD"));
            }
            if self.spline.is_open() {
                return fail(at, Fault::LateDegree);
            }
            self.spline.degree = if value == 2.0 { 2 } else { 3 };
            if self.spline.degree as f64 != value {
                return fail(at, Fault::Range(Name::new(b"SD")));
            }
        } else if block.motion.is_some() && is_spline {
            self.spline.degree = Spline::DEGREE;
        }
        let moves = block.has_axes() || (is_arc && arc_words.is_some());
        let spline_word = block.interval.or(block.weight);
        if let Some(word) = spline_word.filter(|_| !(moves && is_spline)) {
            return fail(word.at, Fault::NoUse("PL or PW"));
        }
        if !moves {
            return Ok(());
        }
        let words = block.axes.iter().chain(&block.centre).chain([&block.radius, &block.turns]).flatten();
        let at = words.map(|word| word.at).min().unwrap_or(0);
        let to = self.target(block);
        match self.mode {
            Mode::None => fail(at, Fault::NoMotion),
            Mode::Ended => fail(at, Fault::Ended),
            Mode::Move(Move::Rapid) => self.go(at, Motion::Rapid { to }, to, out),
            Mode::Move(Move::Line) => {
                self.check_feed(at, block)?;
                self.go(at, Motion::Line { to }, to, out)
            }
            Mode::Move(Move::Arc { anticlockwise }) => {
                self.check_feed(at, block)?;
                self.arc(at, anticlockwise, to, block, out)
            }
            Mode::Move(Move::Spline) => {
                let place = out.place(at);
                if !self.spline.is_open() {
                    if self.inverse {
                        // Each of its blocks would have a time, and a spline is one motion.
                        return fail(at, Fault::NoUse("G93"));
                    }
                    self.check_feed(at, block)?;
                    self.spline.begin(self.place, self.feed, place);
                }
                self.spline.add(to, block.weight, block.interval, at, place)?;
                self.place = to;
                Ok(())
            }
        }
    }

    fn go(&mut self, at: usize, motion: Motion<'_>, to: [f64; 3], out: &mut Output<'_, '_>) -> Checked<()> {
        self.give(at, Action::Motion(motion), out)?;
        self.place = to;
        Ok(())
    }

    fn check_feed(&self, at: usize, block: &Block) -> Checked<()> {
        match self.feed {
            _ if self.inverse && block.feed.is_none() => fail(at, Fault::NoDuration),
            Feed::Unset => fail(at, Fault::NoFeed),
            _ => Ok(()),
        }
    }

    /// Where the axis words of a block lead.
    fn target(&self, block: &Block) -> [f64; 3] {
        let mm = self.units.units.mm();
        std::array::from_fn(|axis| match block.axes[axis] {
            Some(word) => word.value * mm + if self.incremental { self.place[axis] } else { 0.0 },
            None => self.place[axis],
        })
    }

    /// G2 and G3.
    fn arc(
        &mut self,
        at: usize,
        anticlockwise: bool,
        to: [f64; 3],
        block: &Block,
        out: &mut Output<'_, '_>,
    ) -> Checked<()> {
        let (mm, plane) = (self.units.units.mm(), self.plane);
        let [first, second, across] = plane.axes();
        let turns = match block.turns {
            None => 0,
            Some(Number { value, .. }) if value.fract() == 0.0 && (0.0..=MOST_TURNS).contains(&value) => value as u32,
            Some(Number { at, .. }) => return fail(at, Fault::Range(Name::new(b"TURN"))),
        };
        let from = [self.place[first], self.place[second]];
        let ends = Ends { from, to: [to[first], to[second]], anticlockwise, turns };
        let has_centre = block.centre.iter().any(Option::is_some);
        let (centre, sweep) = match block.radius {
            Some(radius) if has_centre => return fail(radius.at, Fault::ArcBoth),
            Some(radius) => ends.by_radius(radius.value * mm, mm).or_else(|reason| fail(at, Fault::Arc(reason)))?,
            None if !has_centre => return fail(at, Fault::ArcCentre),
            None => {
                if let Some(word) = block.centre[across] {
                    return fail(word.at, Fault::ArcAcross);
                }
                // I, J and K are from the start, with G90 too.
                let along = |axis: usize| self.place[axis] + block.centre[axis].map_or(0.0, |word| word.value * mm);
                let centre = [along(first), along(second)];
                (centre, ends.about(centre, mm).or_else(|reason| fail(at, Fault::Arc(reason)))?)
            }
        };
        self.go(at, Motion::Arc(Arc { plane, centre, to, sweep, turns }), to, out)
    }
}

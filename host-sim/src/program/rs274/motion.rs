//! Motions: G0 G1 G2 G3 G5 G5.1 G5.2 G5.3 G53 G80.

use super::codes::{AXES, CENTRE, Code, Group, Letters};
use super::fault::{Checked, Fault, fail, give};
use super::frames::{AXIS_LETTERS, Axes};
use super::interpreter::{Interpreter, MACHINE};
use super::words::Block;
use crate::program::arc::Ends;
use crate::program::item::Nurbs;
use crate::program::output::Output;
use crate::program::{Action, Arc, Feed, Motion, Plane};

/// The most turns of one arc; no thread has so many.
const MOST_TURNS: u32 = 1_000;
/// The highest order of a curve.
const HIGHEST_ORDER: u32 = 16;

impl Interpreter {
    /// Does the motion of a block.
    pub(super) fn motion(&mut self, code: Code, at: usize, block: &Block, out: &mut Output<'_, '_>) -> Checked<()> {
        let machine = matches!(block.in_group(Group::Once), Some((Code { tenths: MACHINE, .. }, _)));
        if machine && code.tenths > 10 {
            return fail(at, Fault::MachineMotion);
        }
        if machine && self.modal.incremental {
            return fail(at, Fault::MachineIncremental);
        }
        let tangent = self.modal.tangent.take();
        self.modal.motion = (!matches!(code.tenths, 53 | 800)).then_some(code);
        let moves = !block.letters.and(AXES).is_empty();
        match code.tenths {
            0 | 10 if !moves => Ok(()),
            0 => self.rapid(if machine { self.machine_target(block) } else { self.target(block) }, at, out),
            10 => {
                let feed = self.cutting_feed(code, at, block)?;
                let end = if machine { self.machine_target(block) } else { self.target(block) };
                self.go(end, at, feed, |[x, y, z, ..]| Motion::Line { to: [x, y, z] }, out)
            }
            20 | 30 if block.letters.and(ARC_WORDS).is_empty() => Ok(()),
            20 | 30 => self.arc(code, at, block, out),
            50 => self.cubic(code, at, tangent, block, out),
            51 => self.quadratic(code, at, block, out),
            52 => self.control_point(code, block),
            53 => self.nurbs(code, at, block, out),
            _ => Ok(()),
        }
    }

    /// Where the axis words of a block lead.
    pub(super) fn target(&self, block: &Block) -> Axes {
        let mut target = self.frames.tip;
        for (axis, value) in self.axis_words(block) {
            target[axis] = value + if self.modal.incremental { target[axis] } else { self.frames.zero(axis) };
        }
        target
    }

    /// Where they lead if they are the machine's coordinates.
    fn machine_target(&self, block: &Block) -> Axes {
        let mut target = self.frames.tip;
        for (axis, value) in self.axis_words(block) {
            target[axis] = value + self.frames.machine_zero(axis);
        }
        target
    }

    /// A rapid.
    pub(super) fn rapid(&mut self, end: Axes, at: usize, out: &mut Output<'_, '_>) -> Checked<()> {
        let feed = self.modal.feed;
        self.go(end, at, feed, |[x, y, z, ..]| Motion::Rapid { to: [x, y, z] }, out)
    }

    /// Gives a motion to `end`, after the other axes that it takes along.
    fn go<'m>(
        &mut self,
        end: Axes,
        at: usize,
        feed: Feed,
        motion: impl FnOnce(Axes) -> Motion<'m>,
        out: &mut Output<'_, '_>,
    ) -> Checked<()> {
        let from = self.frames.place();
        for (axis, &letter) in AXIS_LETTERS.iter().enumerate().skip(3) {
            if end[axis] != self.frames.tip[axis] {
                give(out, at, from, feed, Action::Further { axis: char::from(letter), to: end[axis] })?;
            }
        }
        self.frames.tip = end;
        give(out, at, from, feed, Action::Motion(motion(end)))
    }

    /// G2 and G3.
    fn arc(&mut self, code: Code, at: usize, block: &Block, out: &mut Output<'_, '_>) -> Checked<()> {
        let feed = self.cutting_feed(code, at, block)?;
        let (mm, plane) = (self.mm(), self.modal.plane);
        let [first, second, across] = plane.axes();
        let end = self.target(block);
        let turns = block.whole(b'P', 1, MOST_TURNS)?.map_or(0, |turns| turns - 1);
        let ends = Ends {
            from: [self.frames.tip[first], self.frames.tip[second]],
            to: [end[first], end[second]],
            anticlockwise: code.tenths == 30,
            turns,
        };
        let has_centre = !block.letters.and(CENTRE).is_empty();
        let (centre, sweep) = match block.value(b'R') {
            Some(_) if has_centre => return fail(at, Fault::ArcBoth(code)),
            Some(radius) => ends.by_radius(radius * mm, mm).or_else(|reason| fail(at, Fault::Arc(reason)))?,
            None if !has_centre => return fail(at, Fault::ArcCentre(code)),
            None => {
                let letter = b'I' + across as u8;
                if block.value(letter).is_some() {
                    return fail(block.place(letter), Fault::ArcAcross(char::from(letter), plane));
                }
                let centre = [self.centre(first, at, block)?, self.centre(second, at, block)?];
                (centre, ends.about(centre, mm).or_else(|reason| fail(at, Fault::Arc(reason)))?)
            }
        };
        self.go(end, at, feed, |[x, y, z, ..]| Motion::Arc(Arc { plane, centre, to: [x, y, z], sweep, turns }), out)
    }

    /// One coordinate of a centre that I, J and K give.
    fn centre(&self, axis: usize, at: usize, block: &Block) -> Checked<f64> {
        let letter = b'I' + axis as u8;
        match block.value(letter) {
            Some(value) if self.modal.absolute_centres => Ok(value * self.mm() + self.frames.zero(axis)),
            None if self.modal.absolute_centres => fail(at, Fault::ArcHalf(char::from(letter))),
            value => Ok(self.frames.tip[axis] + value.unwrap_or(0.0) * self.mm()),
        }
    }

    /// What two words add to a place in the plane, in mm; none if both are missing. Errors: one is missing.
    fn pair(&self, code: Code, letters: [u8; 2], needs: &'static str, block: &Block) -> Checked<Option<[f64; 2]>> {
        match letters.map(|letter| block.value(letter)) {
            [Some(one), Some(other)] => Ok(Some([one * self.mm(), other * self.mm()])),
            [None, None] => Ok(None),
            [Some(_), None] => fail(block.place(letters[0]), Fault::Needs(code, needs)),
            [None, Some(_)] => fail(block.place(letters[1]), Fault::Needs(code, needs)),
        }
    }

    /// G5.
    fn cubic(
        &mut self,
        code: Code,
        at: usize,
        tangent: Option<[f64; 2]>,
        block: &Block,
        out: &mut Output<'_, '_>,
    ) -> Checked<()> {
        let feed = self.cutting_feed(code, at, block)?;
        self.only_xy(code, at)?;
        let Some([i, j]) = self.pair(code, *b"IJ", "both I and J, or neither", block)?.or(tangent) else {
            return fail(at, Fault::SplineStart);
        };
        let Some([p, q]) = self.pair(code, *b"PQ", "both P and Q", block)? else {
            return fail(at, Fault::Needs(code, "both P and Q"));
        };
        let ([x, y, z], end) = (self.frames.place(), self.target(block));
        let points = [[x + i, y + j, z], [end[0] + p, end[1] + q, z], [end[0], end[1], z]];
        self.modal.tangent = Some([-p, -q]);
        self.go(end, at, feed, |_| Motion::Bezier { points: &points }, out)
    }

    /// G5.1.
    fn quadratic(&mut self, code: Code, at: usize, block: &Block, out: &mut Output<'_, '_>) -> Checked<()> {
        let feed = self.cutting_feed(code, at, block)?;
        self.only_xy(code, at)?;
        let Some([i, j]) = self.pair(code, *b"IJ", "both I and J", block)? else {
            return fail(at, Fault::Needs(code, "both I and J"));
        };
        let ([x, y, z], end) = (self.frames.place(), self.target(block));
        let points = [[x + i, y + j, z], [end[0], end[1], z]];
        self.go(end, at, feed, |_| Motion::Bezier { points: &points }, out)
    }

    /// G5.2.
    fn control_point(&mut self, code: Code, block: &Block) -> Checked<()> {
        let at = block.in_group(Group::Motion).map_or(block.place(b'X'), |(_, at)| at);
        self.cutting_feed(code, at, block)?;
        self.only_xy(code, at)?;
        if self.modal.incremental {
            return fail(at, Fault::NurbsIncremental);
        }
        let weight = block.value(b'P').unwrap_or(1.0);
        if weight <= 0.0 {
            return fail(block.place(b'P'), Fault::NotPositive('P'));
        }
        let point = [block.value(b'X'), block.value(b'Y')];
        let begins = !self.curve.is_open();
        if begins {
            // A weight without a point is the start's.
            self.curve.begin(self.frames.place(), if point == [None, None] { weight } else { 1.0 });
        }
        if let Some(order) = block.whole(b'L', 3, HIGHEST_ORDER)? {
            self.curve.order = order as usize;
        }
        match point {
            [Some(_), Some(_)] => {
                let [x, y, ..] = self.target(block);
                let [.., z] = self.frames.place();
                self.curve.add([x, y, z], weight).or_else(|fault| fail(at, fault))
            }
            [None, None] if begins => Ok(()),
            _ => fail(at, Fault::NurbsHalf),
        }
    }

    /// G5.3.
    fn nurbs(&mut self, code: Code, at: usize, block: &Block, out: &mut Output<'_, '_>) -> Checked<()> {
        if !self.curve.is_open() {
            return fail(at, Fault::NurbsNone);
        }
        self.curve.close().or_else(|fault| fail(at, fault))?;
        let feed = self.cutting_feed(code, at, block)?;
        let curve = std::mem::take(&mut self.curve);
        let mut end = self.frames.tip;
        if let Some([x, y, _]) = curve.points.last() {
            [end[0], end[1]] = [*x, *y];
        }
        let nurbs = Nurbs { order: curve.order, points: &curve.points, weights: &curve.weights, knots: &curve.knots };
        self.go(end, at, feed, |_| Motion::Nurbs(nurbs), out)?;
        self.curve = curve;
        self.curve.clear();
        Ok(())
    }

    fn only_xy(&self, code: Code, at: usize) -> Checked<()> {
        if self.modal.plane == Plane::Xy { Ok(()) } else { fail(at, Fault::SplinePlane(code)) }
    }
}

/// Words of which an arc needs one.
const ARC_WORDS: Letters = Letters::of(b"XYZABCUVWIJKR");

//! Programs for other machines, written from exact curves: what is written can be read back.
//!
//! ```
//! use host_sim::program::write::{Dialect, Settings, Writer};
//! use host_sim::program::{Feed, Motion};
//!
//! let mut writer = Writer::new(Vec::new(), Dialect::Rs274, Settings::default())?;
//! writer.motion([0.0; 3], Feed::Unset, &Motion::Rapid { to: [1.0, 2.0, 0.0] })?;
//! writer.motion([1.0, 2.0, 0.0], Feed::Rate(10.0), &Motion::Line { to: [3.0, 2.0, 0.0] })?;
//! let program = writer.finish()?;
//! assert_eq!(program, b"G17 G21 G90 G91.1 G94\nG0 X1 Y2 Z0\nG1 X3 F600\nM30\n");
//! # Ok::<(), host_sim::program::write::WriteError>(())
//! ```
//!
//! A writer takes motions as readers give them, one after another, and keeps none of them. Coordinates have ten decimals, in
//! mm: what is read back is equal to 1e-9 mm. Weights and intervals of knots have all their digits.
//!
//! | | RS-274 | Sinumerik 840D |
//! | --- | --- | --- |
//! | lines, arcs, helices | G1, G2 and G3 with I J K (P) | G1, G2 and G3 with I J K (TURN=) |
//! | Bézier | G5, G5.1; in XY alone | a BSPLINE of one interval; 3D |
//! | NURBS | G5.2 to G5.3; in XY alone. Its knots are equally far apart: a curve with others is written as its Bézier pieces | BSPLINE of degree 2 or 3 with PL, PW; 3D |
//!
//! A NURBS of degree 1 is lines. BSPLINE and G5.2 weigh the first point 1: weights are divided by the first one, which leaves the
//! curve as it is. Sinumerik takes weights up to 3. Between two splines stands a G1 without axes, so that the second one is
//! new for every control.
//!
//! | module | what |
//! | --- | --- |
//! | `blocks` | blocks, words and digits |
//! | `events` | spindle, coolant, tools, dwells, path modes |
//! | `rs274`, `sinumerik` | curves in the words of each |

mod blocks;
mod events;
mod rs274;
mod sinumerik;
#[cfg(test)]
mod tests;

use std::fmt;
use std::io::{self, Write};

use super::arc::Ends;
use super::bspline::{Clamped, NoCurve, projected};
use super::{Arc, Feed, Motion, Plane};
use crate::units::plain;
use blocks::Blocks;

/// The language of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dialect {
    /// G-code of LinuxCNC; of Grbl as well, where there are lines and arcs alone.
    Rs274,
    /// Sinumerik 840D.
    Sinumerik,
}

/// How a program looks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Settings {
    /// Number the blocks in steps of this; after 99 999 they begin anew.
    pub numbers: Option<u32>,
}

/// Why a motion cannot be written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WriteError {
    /// The file cannot be written.
    Io(io::ErrorKind),
    /// A number is not finite, or too large for a machine.
    Number,
    /// The motion begins elsewhere than the last one ended; how far away.
    Gap(f64),
    /// A cut without feed, or with one that is not more than 0.
    NoFeed,
    /// A duration for a curve of which the language runs the parts one by one.
    Duration,
    /// The angle of an arc is not that between its ends.
    Arc,
    /// A curve leaves the plane XY, and the language has only curves in it.
    Flat,
    /// A Bézier curve of another degree than 2 or 3, or a NURBS of one that the language does not have.
    Degree(usize),
    /// The weight of a point is this many times the first one's.
    Weight(f64),
    /// A spline that is none.
    Curve(NoCurve),
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Io(kind) => write!(f, "cannot be written: {kind}"),
            Self::Number => f.write_str("a number is too large for a machine"),
            Self::Gap(width) => write!(f, "a motion begins {} mm from where the last one ended", plain(width)),
            Self::NoFeed => f.write_str("a motion has no feed; every cut needs one"),
            Self::Duration => {
                f.write_str("a curve has a duration, and the language only has one for each part of it; give a feed")
            }
            Self::Arc => f.write_str("the angle of an arc is not that between its ends"),
            Self::Flat => f.write_str("a curve leaves the plane XY; Sinumerik has curves in space"),
            Self::Degree(degree) => {
                write!(f, "the language has no curve of degree {degree}; one of degree 2 or 3 would do")
            }
            Self::Weight(weight) => {
                write!(f, "a point weighs {} times the first one; Sinumerik has weights up to 3", plain(weight))
            }
            Self::Curve(reason) => reason.fmt(f),
        }
    }
}

impl std::error::Error for WriteError {}

/// Places that are nearer than this, in mm, are one.
const SAME: f64 = 1e-9;
/// An arc within this angle is a line, as is one within [`SAME`]: readers would take it for a full circle or for none, and it
/// bulges by less than 1e-12 of its radius.
const FLAT: f64 = 2e-6;
/// Angles may differ by this much: the ends of a program's arcs are rounded.
const ANGLE: f64 = 1e-5;

/// Writes a program.
#[derive(Debug)]
pub struct Writer<W> {
    blocks: Blocks<W>,
    dialect: Dialect,
    place: Option<[f64; 3]>,
    plane: Plane,
    /// Whether G93 is in force.
    inverse: bool,
    /// The text of the F in force.
    feed: Option<String>,
    /// Whether the last motion was a BSPLINE.
    spline: bool,
}

impl<W: Write> Writer<W> {
    /// Begins a program: mm, absolute places, the plane XY.
    pub fn new(out: W, dialect: Dialect, settings: Settings) -> Result<Self, WriteError> {
        let mut blocks = Blocks::new(out, settings.numbers);
        blocks.word(match dialect {
            Dialect::Rs274 => "G17 G21 G90 G91.1 G94",
            Dialect::Sinumerik => "G17 G710 G90 G94",
        });
        blocks.end()?;
        Ok(Self { blocks, dialect, place: None, plane: Plane::Xy, inverse: false, feed: None, spline: false })
    }

    /// Ends the program and gives back what it was written to.
    pub fn finish(mut self) -> Result<W, WriteError> {
        self.blocks.word("M30");
        self.blocks.end()?;
        self.blocks.finish()
    }

    /// Writes a motion from `from`. A program that begins with a cut has a rapid to its start in front.
    ///
    /// Errors: the language does not have this motion, or it does not follow the last one. Nothing of it is written then, unless
    /// the file is the reason.
    pub fn motion(&mut self, from: [f64; 3], feed: Feed, motion: &Motion<'_>) -> Result<(), WriteError> {
        let cuts = !matches!(motion, Motion::Rapid { .. });
        if cuts {
            f_word(feed)?;
        }
        check(&from)?;
        if let Some(place) = self.place {
            let width = distance(place, from);
            if width > SAME {
                return Err(WriteError::Gap(width));
            }
        } else if cuts {
            self.straight("G0", from, Feed::Unset)?;
        }
        match *motion {
            Motion::Rapid { to } => self.straight("G0", to, Feed::Unset),
            Motion::Line { to } => self.straight("G1", to, feed),
            Motion::Arc(arc) => self.arc(from, feed, &arc),
            Motion::Bezier { points } if !(2..=3).contains(&points.len()) => Err(WriteError::Degree(points.len())),
            Motion::Bezier { points } => {
                match self.dialect {
                    Dialect::Rs274 => self.rs274_bezier(from, feed, points)?,
                    Dialect::Sinumerik => self.sinumerik_bezier(feed, points)?,
                }
                self.place = motion.to();
                Ok(())
            }
            Motion::Nurbs(nurbs) => self.nurbs(from, feed, &Clamped::new(&nurbs).map_err(WriteError::Curve)?),
        }
    }

    fn nurbs(&mut self, from: [f64; 3], feed: Feed, curve: &Clamped) -> Result<(), WriteError> {
        let place = |point: Option<&[f64; 4]>| point.map_or(from, |&point| projected(point).0);
        let width = distance(from, place(curve.points.first()));
        if width > SAME {
            return Err(WriteError::Gap(width));
        }
        match self.dialect {
            _ if curve.degree == 1 => {
                if matches!(feed, Feed::Duration(_)) {
                    return Err(WriteError::Duration);
                }
                for &point in &curve.points {
                    check(&projected(point).0)?;
                }
                for &point in &curve.points[1..] {
                    self.straight("G1", projected(point).0, feed)?;
                }
            }
            Dialect::Rs274 => self.rs274_nurbs(feed, curve)?,
            Dialect::Sinumerik => self.sinumerik_nurbs(feed, curve)?,
        }
        self.place = Some(place(curve.points.last()));
        Ok(())
    }

    /// G0 and G1.
    fn straight(&mut self, code: &str, to: [f64; 3], feed: Feed) -> Result<(), WriteError> {
        check(&to)?;
        self.spline = false;
        self.blocks.word(code);
        let stays = self.place.map(|place| place.map(blocks::decimals));
        let mut moves = false;
        for (axis, letter) in ["X", "Y", "Z"].into_iter().enumerate() {
            let text = blocks::decimals(to[axis]);
            // Machines begin somewhere: the first place is written whole.
            if stays.as_ref().is_none_or(|stays| stays[axis] != text) {
                self.blocks.valued(letter, &text);
                moves = true;
            }
        }
        if !moves {
            self.blocks.valued("X", &blocks::decimals(to[0]));
        }
        self.feed(feed)?;
        self.place = Some(to);
        self.blocks.end()
    }

    /// G2 and G3.
    fn arc(&mut self, from: [f64; 3], feed: Feed, arc: &Arc) -> Result<(), WriteError> {
        check(&arc.to)?;
        check(&arc.centre)?;
        let [first, second, _] = arc.plane.axes();
        let radius = (from[first] - arc.centre[0]).hypot(from[second] - arc.centre[1]);
        let short = arc.sweep.abs() < FLAT || arc.sweep.abs() * radius <= SAME;
        if (short && arc.turns == 0) || 2.0 * radius <= SAME {
            return self.straight("G1", arc.to, feed);
        }
        // The angle is what a reader finds, of the digits that are written.
        let ends = Ends {
            from: [from[first], from[second]].map(blocks::rounded),
            to: [arc.to[first], arc.to[second]].map(blocks::rounded),
            anticlockwise: arc.sweep > 0.0,
            turns: arc.turns,
        };
        let offset = [arc.centre[0] - from[first], arc.centre[1] - from[second]];
        let centre = std::array::from_fn(|k| ends.from[k] + blocks::rounded(offset[k]));
        let angle = ends.about(centre, 1.0).map_err(|_| WriteError::Arc)?;
        if (angle - arc.sweep).abs() * radius > ANGLE * radius + SAME {
            return Err(WriteError::Arc);
        }
        self.spline = false;
        self.in_plane(arc.plane);
        self.blocks.word(if arc.sweep > 0.0 { "G3" } else { "G2" });
        for (letter, value) in ["X", "Y", "Z"].into_iter().zip(arc.to) {
            self.blocks.valued(letter, &blocks::decimals(value));
        }
        for (axis, offset) in [first, second].into_iter().zip(offset) {
            self.blocks.valued(["I", "J", "K"][axis], &blocks::decimals(offset));
        }
        if arc.turns > 0 {
            match self.dialect {
                Dialect::Rs274 => self.blocks.valued("P", &(arc.turns + 1).to_string()),
                Dialect::Sinumerik => self.blocks.valued("TURN=", &arc.turns.to_string()),
            }
        }
        self.feed(feed)?;
        self.place = Some(arc.to);
        self.blocks.end()
    }

    /// Puts the code of a plane into the block, if another one is in force.
    fn in_plane(&mut self, plane: Plane) {
        if self.plane != plane {
            self.plane = plane;
            self.blocks.word(match plane {
                Plane::Xy => "G17",
                Plane::Zx => "G18",
                Plane::Yz => "G19",
            });
        }
    }

    /// Puts F into the block, if another one is in force; a duration is said in each.
    fn feed(&mut self, feed: Feed) -> Result<(), WriteError> {
        if feed == Feed::Unset {
            return Ok(());
        }
        let (value, inverse) = f_word(feed)?;
        if self.inverse != inverse {
            self.inverse = inverse;
            self.feed = None;
            self.blocks.word(if inverse { "G93" } else { "G94" });
        }
        let text = blocks::significant(value);
        if inverse || self.feed.as_ref() != Some(&text) {
            self.blocks.valued("F", &text);
            self.feed = Some(text);
        }
        Ok(())
    }
}

/// The number of F, and whether it is one of G93.
fn f_word(feed: Feed) -> Result<(f64, bool), WriteError> {
    let (value, inverse) = match feed {
        Feed::Unset => return Err(WriteError::NoFeed),
        Feed::Rate(rate) => (rate * 60.0, false),
        Feed::Duration(seconds) => (60.0 / seconds, true),
    };
    check(&[value])?;
    if value > 0.0 { Ok((value, inverse)) } else { Err(WriteError::NoFeed) }
}

fn distance(p: [f64; 3], q: [f64; 3]) -> f64 {
    (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt()
}

/// Errors: a number is not finite, or beyond what readers take.
fn check(values: &[f64]) -> Result<(), WriteError> {
    const LARGEST: f64 = 1e9;
    if values.iter().all(|value| value.abs() <= LARGEST) { Ok(()) } else { Err(WriteError::Number) }
}

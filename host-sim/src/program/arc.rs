//! Arcs: from the words of a program to a centre and a signed angle, in the coordinates of a plane.

use std::f64::consts::TAU;
use std::fmt;

use crate::units::plain;

/// Why words make no arc. Lengths in the program's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoArc {
    /// The distances of the ends from the centre.
    Radii([f64; 2]),
    /// The centre is where an end is.
    Zero,
    /// A radius, and half of the distance that it should span.
    Short([f64; 2]),
    /// A radius and no way to go.
    Same,
}

impl fmt::Display for NoArc {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Radii(radii) => {
                let [start, end] = radii.map(plain);
                write!(f, "the start is {start} from the centre and the end {end}; both are on one circle")
            }
            Self::Zero => f.write_str("the centre is where the arc starts or ends; there is no circle"),
            Self::Short(lengths) => {
                let [radius, half] = lengths.map(plain);
                write!(f, "a radius of {radius} cannot span the distance; {half} or more would do")
            }
            Self::Same => f.write_str("an arc by radius needs another end; give a full circle by its centre"),
        }
    }
}

/// Ends that are seen from the centre within this angle make a full circle: programs are rounded to six decimals.
const FULL: f64 = 1e-6;
/// By how much, in mm, half of the distance may exceed a radius; the arc is then half a circle.
const SHORT: f64 = 0.05;
/// The distances of the ends from the centre may differ by this part of them ...
const PART: f64 = 1e-3;
/// ... or by this many mm, and never by [`WIDEST`] (LinuxCNC's manual, and Grbl).
const CLOSE: f64 = 0.005;
/// See [`CLOSE`].
const WIDEST: f64 = 0.5;

/// What every arc has.
#[derive(Clone, Copy, Debug)]
pub struct Ends {
    /// Where it starts, in the plane.
    pub from: [f64; 2],
    /// Where it ends.
    pub to: [f64; 2],
    /// G3.
    pub anticlockwise: bool,
    /// Whole turns before the last one.
    pub turns: u32,
}

impl Ends {
    /// The signed angle about a centre. Errors: the centre is not equally far from both ends; `mm` is the program's unit.
    pub fn about(&self, centre: [f64; 2], mm: f64) -> Result<f64, NoArc> {
        let [start, end] = [self.from, self.to].map(|end| [end[0] - centre[0], end[1] - centre[1]]);
        let [first, last] = [start, end].map(|[x, y]| x.hypot(y));
        if first == 0.0 || last == 0.0 {
            return Err(NoArc::Zero);
        }
        let apart = (first - last).abs();
        // In an inch program numbers have a digit less: the manual's bounds are then 0.0005 and 0.05 inch.
        let wide = if mm > 1.0 { 0.1 * mm } else { 1.0 };
        if apart > WIDEST * wide || (apart > CLOSE * wide && apart > PART * first.max(last)) {
            return Err(NoArc::Radii([first / mm, last / mm]));
        }
        let cross = start[0] * end[1] - start[1] * end[0];
        let dot = start[0] * end[0] + start[1] * end[1];
        let angle = if self.anticlockwise { cross.atan2(dot) } else { (-cross).atan2(dot) };
        Ok(self.signed(if angle < FULL { angle + TAU } else { angle }))
    }

    /// The centre and the signed angle for a radius; a negative one means the longer way round. Errors: the radius is too
    /// short, or the ends are one point; `mm` is the program's unit.
    pub fn by_radius(&self, radius: f64, mm: f64) -> Result<([f64; 2], f64), NoArc> {
        let chord = [self.to[0] - self.from[0], self.to[1] - self.from[1]];
        let length = chord[0].hypot(chord[1]);
        if length == 0.0 {
            return Err(NoArc::Same);
        }
        let half = 0.5 * length;
        if half - radius.abs() > SHORT {
            return Err(NoArc::Short([radius.abs() / mm, half / mm]));
        }
        let height = ((radius.abs() - half) * (radius.abs() + half)).max(0.0).sqrt();
        // The centre of an arc below half a circle lies left of the chord, if the arc is anticlockwise.
        let left = if self.anticlockwise == (radius > 0.0) { height } else { -height } / length;
        let centre =
            [0.5 * (self.from[0] + self.to[0]) - left * chord[1], 0.5 * (self.from[1] + self.to[1]) + left * chord[0]];
        let short = 2.0 * half.atan2(height);
        Ok((centre, self.signed(if radius > 0.0 { short } else { TAU - short })))
    }

    fn signed(&self, angle: f64) -> f64 {
        let whole = angle + TAU * f64::from(self.turns);
        if self.anticlockwise { whole } else { -whole }
    }
}

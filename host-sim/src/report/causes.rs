//! How causes are named and shown: a hue for each kind of limit, dark for x, light and hatched for y, hatched on white for z.

use plotters::style::RGBColor;

use super::canvas::{Mark, Stroke};
use super::limited::{Axis, Cause};
use super::style::{INK, MAIN, PAPER};

/// The colour of a cause, and of the lines over it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// The colour.
    pub colour: RGBColor,
    /// The lines.
    pub hatch: Option<Stroke>,
}

/// Of each kind that axes have: dark and light.
const VELOCITY: [RGBColor; 2] = [RGBColor(0x12, 0x78, 0x5a), RGBColor(0x93, 0xd6, 0xb8)];
const ACCELERATION: [RGBColor; 2] = [MAIN, RGBColor(0x96, 0xc6, 0xee)];
const JERK: [RGBColor; 2] = [RGBColor(0xc4, 0x66, 0x08), RGBColor(0xfa, 0xc8, 0x82)];
const CORNER: [RGBColor; 2] = [RGBColor(0xa8, 0x16, 0x42), RGBColor(0xf4, 0x9f, 0xb6)];
const JOB: RGBColor = RGBColor(0xd8, 0xdb, 0xdf);
const MACHINE: RGBColor = RGBColor(0x9a, 0xa0, 0xa8);
const CENTRIPETAL: RGBColor = RGBColor(0x8a, 0x5c, 0xb8);

/// The width of the lines over an area.
const HATCH: f64 = 1.1;

impl Cause {
    /// As a legend names it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Job => "job\u{2019}s feed",
            Self::Machine => "machine\u{2019}s feed",
            Self::Velocity(Axis::X) => "x velocity",
            Self::Velocity(Axis::Y) => "y velocity",
            Self::Velocity(Axis::Z) => "z velocity",
            Self::Acceleration(Axis::X) => "x acceleration",
            Self::Acceleration(Axis::Y) => "y acceleration",
            Self::Acceleration(Axis::Z) => "z acceleration",
            Self::Centripetal => "acceleration across the path",
            Self::Jerk(Axis::X) => "x jerk",
            Self::Jerk(Axis::Y) => "y jerk",
            Self::Jerk(Axis::Z) => "z jerk",
            Self::Corner(Axis::X) => "corner step of x",
            Self::Corner(Axis::Y) => "corner step of y",
            Self::Corner(Axis::Z) => "corner step of z",
            Self::Rest => "rest",
        }
    }

    /// Its colour and lines.
    pub fn look(self) -> Look {
        let plain = |colour| Look { colour, hatch: None };
        let of = |[dark, light]: [RGBColor; 2], axis| match axis {
            Axis::X => plain(dark),
            Axis::Y => Look { colour: light, hatch: Some(Stroke::new(dark, HATCH)) },
            Axis::Z => Look { colour: PAPER, hatch: Some(Stroke::new(dark, HATCH)) },
        };
        match self {
            Self::Job => plain(JOB),
            Self::Machine => plain(MACHINE),
            Self::Velocity(axis) => of(VELOCITY, axis),
            Self::Acceleration(axis) => of(ACCELERATION, axis),
            Self::Centripetal => plain(CENTRIPETAL),
            Self::Jerk(axis) => of(JERK, axis),
            Self::Corner(axis) => of(CORNER, axis),
            Self::Rest => plain(INK),
        }
    }

    /// Its mark in a key.
    pub fn mark(self) -> Mark {
        let Look { colour, hatch } = self.look();
        hatch.map_or(Mark::Area(colour), |lines| Mark::Hatched(colour, lines))
    }

    /// Its mark in a text of HTML.
    pub fn swatch(self) -> String {
        let hex = |RGBColor(r, g, b): RGBColor| format!("#{r:02x}{g:02x}{b:02x}");
        let Look { colour, hatch } = self.look();
        let colour = hex(colour);
        let ground = match hatch {
            None => colour,
            Some(lines) => {
                let dark = hex(lines.colour);
                format!("repeating-linear-gradient(135deg, {colour} 0 3.2px, {dark} 3.2px 4.2px)")
            }
        };
        format!("<span class=\"swatch\" style=\"background: {ground}\"></span>")
    }
}

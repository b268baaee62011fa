//! A program as the curves of the tool's centre: what a path is made of.
//!
//! Each motion of a program, or each curve that stands for its lines, is a *stroke*: a segment in the plane, how z goes along it, and how
//! fast. Lines, arcs and PH curves are kept as they are; z rises evenly along them. Whatever else bends (G5, NURBS, arcs that stand upright, curves
//! of relief) becomes polynomial quintics ([`crate::program::quintic`]) in space.
//!
//! Strokes follow each other without a gap: where the length of the tool changes (G43, G49) its tip is elsewhere at once, but no axis
//! moves. So what follows is shifted by as much, and z of the path is that of the tool as it was measured when the program began.

mod builder;
mod event;
mod read;
pub mod rounding;

use shared::curve::Segment;

use crate::height::Height;

pub use builder::Strokes;
pub use event::{Event, What};
pub use read::{Lines, Tooling, read};

/// How fast a stroke is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// As fast as the machine can.
    Rapid,
    /// So many mm/s along the way in space.
    Feed(f64),
    /// The program says nothing.
    Unset,
}

/// How a stroke is entered, as RS-274 has it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Entry {
    /// As fast as its start bears: G64.
    #[default]
    Through,
    /// From rest where that is a corner: G61.
    RestInCorner,
    /// From rest: G61.1, or something is done before it.
    Rest,
}

/// One curve of the tool's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// The curve in the plane, in mm.
    pub segment: Segment<f64>,
    /// The part of it that is run.
    pub interval: [f64; 2],
    /// How far the tool's centre is from it, positive right of travel, in mm.
    pub offset: f64,
    /// How z goes along it.
    pub height: Height,
    /// How fast it is.
    pub pace: Pace,
    /// How it is entered.
    pub entry: Entry,
    /// The line of the program, from 1; the first of those that a curve stands for.
    pub line: usize,
}

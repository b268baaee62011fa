//! Programs as people have them, read into one motion after another.
//!
//! A reader gives [`Item`]s to a sink while it reads: memory does not grow with the program, and what stands before a
//! faulty block has been given when the error comes. All readers give the same items, so nothing behind them knows what
//! language a program was in.
//!
//! | module | what |
//! | --- | --- |
//! | [`item`] | motions and events, in mm and seconds |
//! | [`rs274`] | G-code as LinuxCNC and Grbl speak it |
//! | [`apt`] | cutter-location files of CAM systems |
//! | [`sinumerik`] | programs for the Sinumerik 840D, with B-splines |
//! | [`drawing`] | the curves of SVG and DXF drawings |
//! | [`mod@write`] | programs of one's own, from the same motions |
//!
//! Coordinates are those of the *program*: of the tool's tip in the coordinate system that is active when the program
//! begins. Other systems, G92 and machine coordinates are brought into that one frame, so the items are one coherent path.

pub mod apt;
mod arc;
mod bspline;
pub mod drawing;
pub mod item;
mod lines;
mod number;
mod output;
pub mod rs274;
pub mod sinumerik;
pub mod write;

pub use item::{Action, Arc, Feed, Item, Motion, Plane};

/// What takes the items of a program, in order. An error that it returns ends the reading and is put at the item's place.
pub type Sink<'a> = &'a mut dyn FnMut(&Item<'_>) -> Result<(), String>;

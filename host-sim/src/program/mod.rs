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
//! | [`quintic`] | quintics in the place of curves that the tick does not know |
//! | [`mod@write`] | programs of one's own, from the same motions |
//!
//! Coordinates are those of the *program*: of the tool's tip in the coordinate system that is active when the program
//! begins. Other systems, G92 and machine coordinates are brought into that one frame, so the items are one coherent path.

pub mod apt;
mod arc;
pub(crate) mod bspline;
pub mod drawing;
pub mod item;
mod lines;
mod number;
mod output;
pub mod quintic;
pub mod rs274;
pub mod sinumerik;
pub mod write;

use std::io::BufRead;

use crate::input::InputError;
use crate::units::Units;

pub use item::{Action, Arc, Feed, Item, Motion, Plane};

/// The languages by the endings of files.
fn language(name: &str) -> Option<Language> {
    let (_, ending) = name.rsplit_once('.')?;
    match ending.to_ascii_lowercase().as_str() {
        "nc" | "ngc" | "gcode" | "tap" => Some(Language::Rs274),
        "mpf" | "spf" => Some(Language::Sinumerik),
        "apt" | "cls" => Some(Language::Apt),
        "svg" => Some(Language::Svg),
        "dxf" => Some(Language::Dxf),
        _ => None,
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Language {
    Rs274,
    Sinumerik,
    Apt,
    Svg,
    Dxf,
}

/// Whether a file's ending is that of a program or a drawing: .nc .ngc .gcode .tap, .mpf .spf, .apt .cls, .svg .dxf.
pub fn is_one(name: &str) -> bool {
    language(name).is_some()
}

/// Whether a file's ending is that of a drawing: .svg .dxf.
pub fn is_drawing(name: &str) -> bool {
    matches!(language(name), Some(Language::Svg | Language::Dxf))
}

/// Reads a program or a drawing by its file's ending, with the settings that its language begins with; gives what of a drawing was left out. Errors
/// are those of its reader, or that the ending is none of these.
pub fn read(name: &str, input: impl BufRead, sink: Sink<'_>) -> Result<Vec<drawing::Warning>, InputError> {
    let lines = match language(name) {
        Some(Language::Svg) => return drawing::svg::read(name, input, sink).map(|seen| seen.warnings),
        Some(Language::Dxf) => {
            return drawing::dxf::read(name, input, &drawing::dxf::Settings::default(), sink).map(|seen| seen.warnings);
        }
        Some(Language::Rs274) => rs274::read(name, input, &rs274::Settings::default(), sink),
        Some(Language::Sinumerik) => sinumerik::read(name, input, &sinumerik::Settings::default(), sink),
        Some(Language::Apt) => apt::read(name, input, Units::Mm, sink),
        None => {
            let message =
                "has no ending of a program or a drawing; .nc .ngc .gcode .tap .mpf .spf .apt .cls .svg .dxf are";
            Err(InputError::new(name, message))
        }
    };
    lines.map(|_| Vec::new())
}

/// What takes the items of a program, in order. An error that it returns ends the reading and is put at the item's place.
pub type Sink<'a> = &'a mut dyn FnMut(&Item<'_>) -> Result<(), String>;

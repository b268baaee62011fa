//! DXF, as drawing programs exchange it, by the crate `dxf`.
//!
//! Read are LINE, ARC, CIRCLE, LWPOLYLINE and POLYLINE with their bulges, SPLINE with weights and knots, and ELLIPSE, which is a
//! NURBS exactly. Curves whose ends meet within [`Settings::tolerance`] become one chain, whatever their order and direction
//! ([`drawing`](super)). Lengths are in the unit of `$INSUNITS`; without any they are mm.
//!
//! Left out with a warning are all other entities, those of the paper space or invisible, splines that are given by points on
//! them alone, meshes, curves of no length, and circles and polylines in a plane that is not XY or its mirror image. Blocks
//! are not put in (INSERT).
//!
//! The crate ends its list of entities without a word at the first one that it cannot read, and does not give those that
//! it does not know: the names of all entities are therefore read beside it and compared. It reads binary files as well, of
//! which they cannot be; such a file is an error.
//!
//! | module | what |
//! | --- | --- |
//! | `entity` | an entity as a chain of curves |
//! | `names` | the names of the entities in a file |

mod entity;
mod names;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::io::Read;

use ::dxf::Drawing;
use ::dxf::enums::Units as Unit;

use super::join::join;
use super::{LeftOut, Seen, Sink, give};
use crate::input::InputError;
use entity::{KNOWN, chain, kind};

/// How a drawing is understood.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Ends that are no farther apart than this, in mm, meet.
    pub tolerance: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { tolerance: 1e-6 }
    }
}

/// Reads a drawing and gives its items to `sink`; the last one is [`crate::program::Action::End`].
///
/// Errors: the file cannot be read or is none, an entity is wrong, or the sink refuses an item.
pub fn read(name: &str, mut input: impl Read, settings: &Settings, sink: Sink<'_>) -> Result<Seen, InputError> {
    let mut bytes = Vec::new();
    input.read_to_end(&mut bytes).map_err(|error| InputError::new(name, format_args!("cannot be read: {error}")))?;
    let Some(mut names) = names::names(&bytes) else {
        return Err(InputError::new(name, "is no DXF text with a section ENTITIES; binary DXF can be saved as text"));
    };
    let drawing = Drawing::load(&mut &bytes[..])
        .map_err(|error| InputError::new(name, format_args!("is no DXF that can be read: {error}")))?;
    let mm = millimetres(drawing.header.default_drawing_units).ok_or_else(|| {
        InputError::new(name, "has a unit in $INSUNITS that no part is drawn in; mm or inches would do")
    })?;

    let (mut chains, mut left_out) = (Vec::new(), LeftOut::default());
    let mut read: BTreeMap<&str, usize> = BTreeMap::new();
    for found in drawing.entities() {
        let Some(kind) = kind(&found.specific) else { continue };
        *read.entry(kind).or_default() += 1;
        match chain(found, mm) {
            Ok(chain) => chains.push(chain),
            Err(reason) => left_out.add(format!("{kind} ({reason})")),
        }
    }
    for known in KNOWN {
        let (there, came) = (names.remove(known).unwrap_or(0), read.get(known).copied().unwrap_or(0));
        if there != came {
            return Err(InputError::new(
                name,
                format_args!("only {came} of {there} {known} can be read; one is faulty"),
            ));
        }
    }
    for (what, count) in names {
        *left_out.0.entry(what).or_default() += count;
    }
    let tolerance = if settings.tolerance.is_finite() { settings.tolerance.max(0.0) } else { 0.0 };
    // The grid of ends needs numbers.
    if !chains.iter().all(super::curve::finite) {
        return Err(InputError::new(name, "a number of a curve is none, or too large for a machine"));
    }
    let chains = join(chains, tolerance);
    give(name, &chains, sink)?;
    Ok(Seen { chains: chains.len(), warnings: left_out.warnings() })
}

/// How many mm a unit has; none for those of maps and of stars.
fn millimetres(unit: Unit) -> Option<f64> {
    Some(match unit {
        Unit::Unitless | Unit::Millimeters => 1.0,
        Unit::Inches => 25.4,
        Unit::Feet => 304.8,
        Unit::Yards => 914.4,
        Unit::Mils => 0.0254,
        Unit::Microinches => 25.4e-6,
        Unit::Microns => 1e-3,
        Unit::Nanometers => 1e-6,
        Unit::Centimeters => 10.0,
        Unit::Decimeters => 100.0,
        Unit::Meters => 1000.0,
        _ => return None,
    })
}

//! The ways onto the compensated path and off it.

use shared::complex::Complex;
use shared::curve::{Arc, Line, Segment};

use super::curves::{SAME, arc_over};
use super::error::Fault;

/// Angles below this, in radians, are none.
const STRAIGHT: f64 = 1e-9;

/// The first motion of a run, in x and y.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    /// Where the tool's centre is before it.
    pub from: Complex<f64>,
    /// Its programmed end, where the contour begins.
    pub to: Complex<f64>,
    /// Centre and sense of an arc.
    pub arc: Option<(Complex<f64>, f64)>,
}

/// Where the compensated path begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct First {
    /// The point of the centre.
    pub point: Complex<f64>,
    /// The direction there.
    pub tangent: Complex<f64>,
    /// Whether the tool touches the contour's very start there.
    pub at_start: bool,
    /// Whether the contour begins with a round, so that its start is on the part.
    pub is_round: bool,
}

/// The curves onto the path: along the first motion, and about its end where that is a convex corner.
///
/// As in LinuxCNC the first motion ends beside its programmed end, across its own direction there. Differently: where that would be a
/// concave corner, an error there, it leads straight to where the path begins; and where a round begins it comes tangentially to the
/// circle about the contour's start, since the straight way to beside it would cut into the part by 1 - cos of its angle.
///
/// Errors: it is shorter than the tool's radius, or there is no such arc.
pub(super) fn onto(entry: &Entry, distance: f64, first: Option<&First>) -> Result<Vec<Segment<f64>>, Fault> {
    let Some((centre, sense)) = entry.arc else { return straight_onto(entry, distance, first) };
    let radius = entry.to - centre;
    let tangent = radius.left() * (sense.signum() / radius.norm());
    if 1.0 + distance * sense.signum() / radius.norm() <= 0.0 {
        return Err(Fault::EntryArc);
    }
    let Some(first) = first else {
        return Ok(vec![arc_onto(entry, entry.to + tangent.right() * distance, tangent, sense)?]);
    };
    let turn = (tangent.conj() * first.tangent).arg();
    if !first.at_start || distance * turn <= 0.0 {
        return Ok(vec![arc_onto(entry, first.point, first.tangent, sense)?]);
    }
    let beside = tangent.right() * distance;
    let arc = arc_onto(entry, entry.to + beside, tangent, sense)?;
    Ok(std::iter::once(arc).chain(fill(entry.to, beside, turn)).collect())
}

fn straight_onto(entry: &Entry, distance: f64, first: Option<&First>) -> Result<Vec<Segment<f64>>, Fault> {
    let way = entry.to - entry.from;
    let (length, radius) = (way.norm(), distance.abs());
    if length <= radius {
        return Err(Fault::EntryShort { length, radius });
    }
    let direction = way * (1.0 / length);
    let (direction, sweep) = match first {
        None => (direction, 0.0),
        Some(first) if first.at_start => {
            // Tangentially to the circle about the start, if that is on the part.
            let leaning = if first.is_round { (distance / length).asin() } else { 0.0 };
            let sweep = (direction.conj() * first.tangent).arg() + leaning;
            if distance * sweep <= 0.0 {
                return Ok(line(entry.from, first.point));
            }
            (direction * Complex::new(leaning.cos(), -leaning.sin()), sweep)
        }
        Some(first) => return Ok(line(entry.from, first.point)),
    };
    let beside = direction.right() * distance;
    Ok(line(entry.from, entry.to + beside).into_iter().chain(fill(entry.to, beside, sweep)).collect())
}

/// The curves off the path to a programmed point, up to the straight way there.
///
/// Nothing but that way, as in LinuxCNC; but where the path ends with a round, about its end until the way misses the part's edge.
pub(super) fn off(node: Complex<f64>, tangent: Complex<f64>, distance: f64, to: Complex<f64>) -> Option<Segment<f64>> {
    let way = to - node;
    let length = way.norm();
    if length <= distance.abs() {
        return None;
    }
    let leaning = (distance / length).asin();
    let direction = way * Complex::new(leaning.cos(), leaning.sin()) * (1.0 / length);
    let sweep = (tangent.conj() * direction).arg();
    let is_convex = distance * sweep > 0.0;
    if is_convex { fill(node, tangent.right() * distance, sweep) } else { None }
}

fn line(start: Complex<f64>, end: Complex<f64>) -> Vec<Segment<f64>> {
    if (end - start).norm() > SAME { vec![Segment::Line(Line { start, end })] } else { Vec::new() }
}

fn fill(node: Complex<f64>, radius: Complex<f64>, sweep: f64) -> Option<Segment<f64>> {
    (sweep.abs() > STRAIGHT).then_some(Segment::Arc(Arc { start: node + radius, radius, sweep }))
}

/// The arc that ends in a direction. The chord and the tangents at its ends make equal angles.
fn arc_onto(entry: &Entry, end: Complex<f64>, tangent: Complex<f64>, sense: f64) -> Result<Segment<f64>, Fault> {
    let chord = end - entry.from;
    let sweep = 2.0 * (chord.conj() * tangent).arg();
    if chord.norm() <= SAME || sweep * sense <= STRAIGHT {
        return Err(Fault::EntryArc);
    }
    Ok(Segment::Arc(arc_over(entry.from, end, sweep)))
}

//! Reads the contour form (design section 6) and checks it, sentence by sentence.

use std::ops::Range;

use shared::complex::Complex;
use shared::curve::{Arc, Curve as _, Line, PhQuintic, Segment, hermite};

use super::schema::{Point, RawFeed, RawJob, RawPiece, RawReduction, RawSegment};
use super::{Corner, FeedWish, GivenPiece, Job, Part, Place, Places, Reduction, Units};
use super::{check_ramp, check_rate, check_reduction, check_weight};
use crate::contour::{Along, Contour};
use crate::input::{InputError, Source};
use crate::offset::OffsetError;

/// A gap of this many mm is none unless the file says otherwise: what four decimals of a millimetre may leave.
const TOLERANCE_MM: f64 = 1e-3;

/// Reads all of a job.
pub(super) fn job(source: Source) -> Result<Job, InputError> {
    let raw = parse(&source)?;
    let Some(feed) = &raw.feed else {
        let message = "there is no [feed]; a motion needs at least its rate, as `rate = 600.0` under [feed]";
        return Err(InputError::new(source.name, message));
    };
    let feed = read_feed(&source, feed, raw.units)?;
    let (part, tolerance) = read_part(source, &raw)?;
    let Part { units, offset, contour, places } = part;
    let pieces = read_pieces(&places.source, &raw, &contour, offset)?;
    let is_spline = |segment: &Segment<f64>| matches!(segment, Segment::Spline(_));
    if let Some(segment) = contour.segments.iter().position(is_spline)
        && offset != 0.0
    {
        return Err(places.segment_error(segment, OffsetError::Spline { segment }.sentence(offset, units)));
    }
    let chosen = raw.offset.and_then(|offset| offset.chosen).map(toml::Spanned::into_inner);
    Ok(Job {
        units,
        tolerance,
        rest: raw.rest,
        offset,
        chosen,
        feed,
        contour,
        strokes: Vec::new(),
        events: Vec::new(),
        warnings: Vec::new(),
        pieces,
        places,
    })
}

/// Reads what an offset takes; what else the file says must be well-formed, no more.
pub(super) fn part(source: Source) -> Result<Part, InputError> {
    let raw = parse(&source)?;
    read_part(source, &raw).map(|(part, _)| part)
}

fn parse(source: &Source) -> Result<RawJob, InputError> {
    toml::from_str(&source.text)
        .map_err(|error| source.error(&error.span().unwrap_or(0..0), first_line(error.message())))
}

/// Contour and offset, and the widest gap that is taken for none, in mm.
fn read_part(source: Source, raw: &RawJob) -> Result<(Part, f64), InputError> {
    let mm = raw.units.mm();
    let tolerance = match &raw.tolerance {
        None => TOLERANCE_MM,
        Some(value) if *value.get_ref() > 0.0 && value.get_ref().is_finite() => value.get_ref() * mm,
        Some(value) => return Err(source.error(&value.span(), "the tolerance must be a number above zero")),
    };
    let (offset, distance) = match &raw.offset {
        None => (0.0, Place::Nowhere),
        Some(offset) if offset.distance.get_ref().is_finite() => {
            (offset.distance.get_ref() * mm, Place::File(offset.distance.span()))
        }
        Some(offset) => return Err(source.error(&offset.distance.span(), "the offset distance is not a number")),
    };
    let (segments, places) = read_segments(&source, raw, tolerance)?.into_iter().unzip();
    let contour = Contour { segments, closed: *raw.closed.get_ref() };
    let chosen = raw.offset.as_ref().and_then(|offset| offset.chosen.as_ref());
    let places = Places {
        segments: places,
        pieces: raw.piece.iter().map(|p| p.span()).collect(),
        distance,
        chosen: chosen.map_or(Place::Nowhere, |chosen| Place::File(chosen.span())),
        source,
    };
    Ok((Part { units: raw.units, offset, contour, places }, tolerance))
}

fn first_line(message: &str) -> &str {
    message.lines().next().unwrap_or(message)
}

fn read_feed(source: &Source, raw: &RawFeed, units: Units) -> Result<FeedWish, InputError> {
    let checked = |value: &toml::Spanned<f64>, check: fn(f64) -> Result<f64, String>| {
        check(*value.get_ref()).map_err(|message| source.error(&value.span(), message))
    };
    let optional = |value: &Option<toml::Spanned<f64>>, default: f64, check| match value {
        Some(value) => checked(value, check),
        None => Ok(default),
    };
    let reduction = match &raw.reduction {
        None => Reduction::Fixed(1.0),
        Some(value) => match value.get_ref() {
            RawReduction::Number(factor) => check_reduction(*factor).map(Reduction::Fixed),
            RawReduction::Word(word) => word.parse().map_err(|m: String| format!("the reduction is \"{word}\"; {m}")),
        }
        .map_err(|message| source.error(&value.span(), message))?,
    };
    Ok(FeedWish {
        rate: checked(&raw.rate, check_rate)? * units.mm() / 60.0,
        weight: optional(&raw.weight, 0.0, check_weight)?,
        reduction,
        ramp: optional(&raw.ramp, 0.25, check_ramp)?,
    })
}

/// A segment, and the place of its [[segment]].
type Placed = (Segment<f64>, Range<usize>);

/// The segments; a [[segment]] that is a spline is several.
fn read_segments(source: &Source, raw: &RawJob, tolerance: f64) -> Result<Vec<Placed>, InputError> {
    let unit = raw.units.short();
    let in_units = |mm: f64| mm / raw.units.mm();
    let mut segments: Vec<Placed> = Vec::with_capacity(raw.segment.len());
    // A spline that is the whole of a closed contour joins itself smoothly.
    let alone = *raw.closed.get_ref() && raw.segment.len() == 1;
    let mut end: Option<Complex<f64>> = None;
    for (number, item) in raw.segment.iter().enumerate() {
        let fail = |message: String| source.error(&item.span(), format_args!("segment {number}: {message}"));
        let curves = curves(item.get_ref(), end, alone, raw.units, tolerance).map_err(fail)?;
        let (Some(start), Some(new_end)) =
            (curves.first().map(|curve| curve.point(0.0)), curves.last().map(|curve| curve.point(1.0)))
        else {
            continue;
        };
        if let Some(before) = end {
            let gap = (start - before).norm();
            if gap > tolerance {
                return Err(fail(format!(
                    "it starts {} {unit} away from where the segment before it ends, at ({}, {}); they must meet within {} {unit}",
                    in_units(gap),
                    in_units(before.re),
                    in_units(before.im),
                    in_units(tolerance),
                )));
            }
        }
        end = Some(new_end);
        segments.extend(curves.into_iter().map(|curve| (curve, item.span())));
    }
    let (Some(first), Some(end)) = (segments.first(), end) else {
        return Err(InputError::new(source.name.clone(), "the contour has no segments; add a [[segment]]"));
    };
    let gap = (first.0.point(0.0) - end).norm();
    if *raw.closed.get_ref() && gap > tolerance {
        return Err(source.error(
            &raw.closed.span(),
            format_args!(
                "the contour is called closed, but ends {} {unit} away from its start; close it or say `closed = false`",
                in_units(gap)
            ),
        ));
    }
    Ok(segments)
}

/// The curves of one [[segment]]: one, or those of a spline.
fn curves(
    raw: &RawSegment,
    end: Option<Complex<f64>>,
    alone: bool,
    units: Units,
    tolerance: f64,
) -> Result<Vec<Segment<f64>>, String> {
    let mm = units.mm();
    let point = |[x, y]: Point| Complex::new(x * mm, y * mm);
    let start_or_end =
        |start: Option<Point>| start.map(point).or(end).ok_or_else(|| "the first segment needs a `start`".to_string());
    let curves = match (&raw.ph, &raw.line, &raw.arc, &raw.hermite, &raw.bezier, &raw.spline) {
        (Some(ph), None, None, None, None, None) => {
            let root = mm.sqrt();
            let w = ph.w.map(|[u, v]| Complex::new(u * root, v * root));
            vec![Segment::Ph(PhQuintic { start: start_or_end(ph.start)?, w })]
        }
        (None, Some(line), None, None, None, None) => {
            vec![Segment::Line(Line { start: start_or_end(line.start)?, end: point(line.to) })]
        }
        (None, None, Some(raw), None, None, None) => {
            let start = start_or_end(raw.start)?;
            vec![Segment::Arc(arc(start, point(raw.to), point(raw.centre), raw.ccw, units, tolerance)?)]
        }
        (None, None, None, Some(raw), None, None) => {
            let start = start_or_end(raw.start)?;
            let curve = hermite(start, point(raw.to), point(raw.d0), point(raw.d1)).map_err(|e| e.to_string())?;
            vec![Segment::Ph(curve)]
        }
        (None, None, None, None, Some(raw), None) => vec![raw.read(start_or_end(raw.start)?, units)?],
        (None, None, None, None, None, Some(raw)) => raw.read(start_or_end(raw.start)?, alone, units, tolerance)?,
        _ => return Err("it must be one of `ph`, `line`, `arc`, `hermite`, `bezier` and `spline`".to_string()),
    };
    curves.iter().try_for_each(|curve| check(curve, units))?;
    Ok(curves)
}

fn check(segment: &Segment<f64>, units: Units) -> Result<(), String> {
    let length = segment.length();
    if !length.is_finite() {
        return Err("a number of it is infinite or not a number".to_string());
    }
    // The shortest motion that a setpoint can show is 4 nm.
    if length < 4e-6 {
        return Err(format!("it has no length ({}); leave it out", units.length(length)));
    }
    Ok(())
}

fn arc(
    start: Complex<f64>,
    to: Complex<f64>,
    centre: Complex<f64>,
    ccw: bool,
    units: Units,
    tolerance: f64,
) -> Result<Arc<f64>, String> {
    let (radius, end) = (start - centre, to - centre);
    let mismatch = (radius.norm() - end.norm()).abs();
    if mismatch > tolerance || mismatch.is_nan() {
        return Err(format!(
            "start and end of the arc are not at one distance from its centre: {} and {} {}",
            radius.norm() / units.mm(),
            end.norm() / units.mm(),
            units.short(),
        ));
    }
    if radius.norm() <= tolerance {
        return Err("the arc has no radius".to_string());
    }
    let turn = std::f64::consts::TAU;
    let angle = (radius.conj() * end).arg();
    // A start that is the end again means a whole turn.
    let angle = if (end - radius).norm() <= tolerance { 0.0 } else { angle };
    let sweep = match (ccw, angle > 0.0) {
        (true, true) | (false, false) if angle != 0.0 => angle,
        (true, _) => angle + turn,
        (false, _) => angle - turn,
    };
    Ok(Arc { start, radius, sweep })
}

fn read_pieces(source: &Source, raw: &RawJob, contour: &Contour, offset: f64) -> Result<Vec<GivenPiece>, InputError> {
    let read = |(number, item): (usize, &toml::Spanned<RawPiece>)| {
        piece(item.get_ref(), contour, offset)
            .map_err(|message| source.error(&item.span(), format_args!("piece {number}: {message}")))
    };
    raw.piece.iter().enumerate().map(read).collect()
}

fn piece(raw: &RawPiece, contour: &Contour, offset: f64) -> Result<GivenPiece, String> {
    let interval = |from: Option<f64>, to: Option<f64>| {
        let (from, to) = (from.unwrap_or(0.0), to.unwrap_or(1.0));
        let usable = from >= 0.0 && from < to && to <= 1.0;
        usable.then_some((from, to)).ok_or_else(|| format!("it runs from {from} to {to}; it needs 0 <= from < to <= 1"))
    };
    let along = match (raw.segment, raw.from, raw.to, &raw.fill) {
        (Some(segment), from, to, None) => {
            let last = contour.segments.len() - 1;
            if segment > last {
                return Err(format!("there is no segment {segment}; the last one is {last}"));
            }
            let (from, to) = interval(from, to)?;
            Along::Segment { segment, from, to }
        }
        (None, None, None, Some(fill)) => {
            let node = fill.node;
            let (from, to) = interval(fill.from, fill.to)?;
            let turn = contour.turning_angle(node).ok_or_else(|| {
                format!("there is no node {node}; node i is where segment i ends and the next one begins")
            })?;
            if turn * offset <= 0.0 {
                return Err(format!(
                    "node {node} is not convex for this offset, so there is no gap to fill; trim there"
                ));
            }
            Along::Fill { node, from, to }
        }
        _ => return Err("it needs either `segment` (with `from` and `to`) or `fill = { node = .. }`".to_string()),
    };
    let corner = |stands: bool, name: &str, ramp: Option<f64>, reduction: Option<f64>| {
        if !stands {
            if ramp.is_some() || reduction.is_some() {
                return Err(format!("it has a ramp at its {name} but no corner there; say `{name}_corner = true`"));
            }
            return Ok(None);
        }
        let ramp = ramp.map(check_ramp).transpose()?;
        let reduction = reduction.map(check_reduction).transpose()?;
        Ok(Some(Corner { reduction, ramp }))
    };
    Ok(GivenPiece {
        along,
        start: corner(raw.start_corner, "start", raw.start_ramp, raw.start_reduction)?,
        end: corner(raw.end_corner, "end", raw.end_ramp, raw.end_reduction)?,
    })
}

//! An entity as a chain of curves, in mm.

use std::f64::consts::{FRAC_PI_2, TAU};

use ::dxf::entities::{self, Entity, EntityType};
use ::dxf::{Point, Vector};

use crate::program::bspline::{Clamped, projected};
use crate::program::drawing::curve::{Chain, Curve, Shape};
use crate::program::item::{Arc, Nurbs, Plane};

/// The entities that are read.
pub const KNOWN: [&str; 7] = ["LINE", "ARC", "CIRCLE", "LWPOLYLINE", "POLYLINE", "SPLINE", "ELLIPSE"];
/// How far a unit vector may be from an axis.
const UPRIGHT: f64 = 1e-9;

/// Its name, if it is one that is read.
pub fn kind(entity: &EntityType) -> Option<&'static str> {
    Some(match entity {
        EntityType::Line(_) => "LINE",
        EntityType::Arc(_) => "ARC",
        EntityType::Circle(_) => "CIRCLE",
        EntityType::LwPolyline(_) => "LWPOLYLINE",
        EntityType::Polyline(_) => "POLYLINE",
        EntityType::Spline(_) => "SPLINE",
        EntityType::Ellipse(_) => "ELLIPSE",
        _ => return None,
    })
}

/// Its curves. Errors: why it is left out.
pub fn chain(entity: &Entity, mm: f64) -> Result<Chain, String> {
    if entity.common.is_in_paper_space {
        return Err("in the paper space".to_string());
    }
    if !entity.common.is_visible {
        return Err("invisible".to_string());
    }
    let chain = match &entity.specific {
        EntityType::Line(line) => Chain(vec![Curve::line(place(&line.p1, mm), place(&line.p2, mm))]),
        EntityType::Arc(arc) => {
            let turned = (arc.end_angle - arc.start_angle).rem_euclid(360.0);
            let sweep = if turned == 0.0 { 360.0 } else { turned };
            circle(&arc.center, arc.radius, &arc.normal, [arc.start_angle, sweep].map(f64::to_radians), mm)?
        }
        EntityType::Circle(circle_) => circle(&circle_.center, circle_.radius, &circle_.normal, [0.0, TAU], mm)?,
        EntityType::LwPolyline(line) => {
            let z = entity.common.elevation;
            let points = line.vertices.iter().map(|vertex| ([vertex.x, vertex.y, z], vertex.bulge)).collect();
            polyline(points, line.flags & 1 != 0, Some(&line.extrusion_direction), mm)?
        }
        EntityType::Polyline(line) => old_polyline(line, mm)?,
        EntityType::Spline(spline) => Chain(vec![nurbs(spline, mm)?]),
        EntityType::Ellipse(curve) => Chain(vec![ellipse(curve, mm)?]),
        _ => return Err("not supported".to_string()),
    };
    let moves = |curve: &Curve| !matches!(curve.shape, Shape::Line(to) if to == curve.from);
    let chain = Chain(chain.0.into_iter().filter(moves).collect());
    if chain.0.is_empty() { Err("of no length".to_string()) } else { Ok(chain) }
}

fn place(point: &Point, mm: f64) -> [f64; 3] {
    [point.x * mm, point.y * mm, point.z * mm]
}

/// 1 if the plane of an entity is XY, and -1 if it is seen from below: x then counts to the left.
fn side(normal: &Vector) -> Result<f64, String> {
    let upright = normal.x.abs() <= UPRIGHT && normal.y.abs() <= UPRIGHT && (normal.z.abs() - 1.0).abs() <= UPRIGHT;
    if upright { Ok(normal.z.signum()) } else { Err("in a plane that is not XY".to_string()) }
}

fn circle(centre: &Point, radius: f64, normal: &Vector, [start, sweep]: [f64; 2], mm: f64) -> Result<Chain, String> {
    if radius <= 0.0 {
        return Err("of no radius".to_string());
    }
    let side = side(normal)?;
    let at = |angle: f64| {
        let (sin, cos) = angle.sin_cos();
        [side * (centre.x + radius * cos) * mm, (centre.y + radius * sin) * mm, side * centre.z * mm]
    };
    let from = at(start);
    let to = if sweep == TAU { from } else { at(start + sweep) };
    let centre = [side * centre.x * mm, centre.y * mm];
    Ok(Chain(vec![Curve {
        from,
        shape: Shape::Arc(Arc { plane: Plane::Xy, centre, to, sweep: side * sweep, turns: 0 }),
    }]))
}

/// Lines and arcs through points, each with its bulge: the tangent of a quarter of the angle to the next one.
fn polyline(points: Vec<([f64; 3], f64)>, closed: bool, normal: Option<&Vector>, mm: f64) -> Result<Chain, String> {
    let side = normal.map_or(Ok(1.0), side)?;
    let placed: Vec<_> =
        points.into_iter().map(|([x, y, z], bulge)| ([side * x * mm, y * mm, side * z * mm], side * bulge)).collect();
    let next = placed.iter().skip(1).chain(placed.first().filter(|_| closed));
    let curves = placed.iter().zip(next).map(|(&(from, bulge), &(to, _))| {
        if bulge == 0.0 || from == to {
            return Curve::line(from, to);
        }
        let sweep = 4.0 * bulge.atan();
        // The centre is beside the middle of the chord, to the left of it for an arc of less than half a turn to the left.
        let left = 0.25 * (1.0 / bulge - bulge);
        let centre =
            [0.5 * (from[0] + to[0]) - left * (to[1] - from[1]), 0.5 * (from[1] + to[1]) + left * (to[0] - from[0])];
        Curve { from, shape: Shape::Arc(Arc { plane: Plane::Xy, centre, to, sweep, turns: 0 }) }
    });
    Ok(Chain(curves.collect()))
}

/// POLYLINE: its flags say what its vertices are.
fn old_polyline(line: &entities::Polyline, mm: f64) -> Result<Chain, String> {
    const CLOSED: i32 = 1;
    const SPATIAL: i32 = 8;
    const MESHES: i32 = 16 | 64;
    /// Of a vertex: it draws the frame of a spline and not the curve.
    const FRAME: i32 = 16;
    if line.flags & MESHES != 0 {
        return Err("a mesh".to_string());
    }
    let spatial = line.flags & SPATIAL != 0;
    let vertices = line.vertices().filter(|vertex| vertex.flags & FRAME == 0);
    let points = vertices.map(|vertex| {
        let Point { x, y, z } = vertex.location;
        if spatial { ([x, y, z], 0.0) } else { ([x, y, line.location.z], vertex.bulge) }
    });
    polyline(points.collect(), line.flags & CLOSED != 0, (!spatial).then_some(&line.normal), mm)
}

fn nurbs(spline: &entities::Spline, mm: f64) -> Result<Curve, String> {
    if spline.control_points.is_empty() {
        return Err("by points on it alone".to_string());
    }
    let points: Vec<[f64; 3]> = spline.control_points.iter().map(|point| place(point, mm)).collect();
    let weights = if spline.weight_values.is_empty() { vec![1.0; points.len()] } else { spline.weight_values.clone() };
    let order = usize::try_from(spline.degree_of_curve).map_or(0, |degree| degree.saturating_add(1));
    let curve = Nurbs { order, points: &points, weights: &weights, knots: &spline.knot_values };
    let Clamped { degree, points, knots } = Clamped::new(&curve).map_err(|reason| reason.to_string())?;
    let (points, weights): (Vec<_>, Vec<_>) = points.into_iter().map(projected).unzip();
    let from = points.first().copied().unwrap_or_default();
    Ok(Curve { from, shape: Shape::Nurbs { order: degree + 1, points, weights, knots } })
}

/// An ellipse is the image of a circle, and a circle a rational parabola on each part below half a turn: the middle control
/// point stands where the tangents meet and weighs as much as the cosine of half of the angle.
fn ellipse(curve: &entities::Ellipse, mm: f64) -> Result<Curve, String> {
    let (centre, major) =
        (place(&curve.center, mm), place(&Point::new(curve.major_axis.x, curve.major_axis.y, curve.major_axis.z), mm));
    let normal = [curve.normal.x, curve.normal.y, curve.normal.z];
    let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
    if !(length > 0.0 && curve.minor_axis_ratio > 0.0 && major.iter().any(|&x| x != 0.0)) {
        return Err("of no width".to_string());
    }
    let across = |k: usize| normal[(k + 1) % 3] * major[(k + 2) % 3] - normal[(k + 2) % 3] * major[(k + 1) % 3];
    let minor: [f64; 3] = std::array::from_fn(|k| across(k) / length * curve.minor_axis_ratio);
    let at = |angle: f64, far: f64| -> [f64; 3] {
        let (sin, cos) = angle.sin_cos();
        std::array::from_fn(|k| centre[k] + far * (major[k] * cos + minor[k] * sin))
    };
    let (start, end) = (curve.start_parameter, curve.end_parameter);
    let turned = (end - start).rem_euclid(TAU);
    // Files have a full turn as 6.283185307.
    let sweep = if turned < 1e-8 || TAU - turned < 1e-8 { TAU } else { turned };
    // A full one is four quarters, whatever rounding makes of it.
    let parts = ((sweep / FRAC_PI_2 - 1e-9).ceil() as usize).clamp(1, 4);
    let step = sweep / parts as f64;
    let half = 0.5 * step;
    let (mut points, mut weights, mut knots) = (vec![at(start, 1.0)], vec![1.0], vec![0.0; 3]);
    for part in 0..parts {
        let from = start + step * part as f64;
        points.extend([at(from + half, 1.0 / half.cos()), at(from + step, 1.0)]);
        weights.extend([half.cos(), 1.0]);
        knots.extend([(part + 1) as f64; 2]);
    }
    knots.push(parts as f64);
    let from = points[0];
    if sweep == TAU
        && let Some(last) = points.last_mut()
    {
        *last = from;
    }
    Ok(Curve { from, shape: Shape::Nurbs { order: 3, points, weights, knots } })
}

//! SVG, by the crate `usvg`, which resolves styles, units, transforms and references.
//!
//! Each subpath of a visible path or shape is a chain, in the order of the drawing. Lengths are mm: those of `width` and
//! `height` where they have a unit, mapped by the `viewBox`, and 96 px to the inch otherwise. y is turned up, so that the
//! drawing's lower left corner is the origin. Quadratic curves become cubic ones, which is exact.
//!
//! Texts, images, foreign objects, clip paths and masks are left out with a warning: a clipped path is given whole. Strokes are
//! the lines in their middle. A path with a fault is drawn up to it, as the standard has it. No other file is opened.
//!
//! # How exact it is
//!
//! The crate holds coordinates as `f32`: a drawing of 300 mm is on a grid of about 20 nm. It turns circles, ellipses, round
//! corners and arcs of paths into cubic curves, which leave a circle by up to 0.00028 of its radius. A cubic curve whose
//! control points are those of a circle's part is therefore taken for that arc (`round`); parts of ellipses stay cubic curves.

mod round;
#[cfg(test)]
mod tests;

use std::io::Read;

use usvg::roxmltree::{Document, ParsingOptions};
use usvg::tiny_skia_path::{PathSegment, Point};
use usvg::{Group, ImageHrefResolver, Node, Options, Path, Transform, Tree};

use super::curve::{Chain, Curve, Shape, distance};
use super::{LeftOut, Seen, Sink, give};
use crate::input::InputError;

/// Millimetres in a px.
const PX: f64 = 25.4 / 96.0;
/// Rounding of `f32` in px, as a part of the drawing's size: a few steps, for curves have passed a few sums.
const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;
/// Elements that are left out.
const LEFT_OUT: [&str; 5] = ["text", "image", "foreignObject", "clipPath", "mask"];

/// Reads a drawing and gives its items to `sink`; the last one is [`crate::program::Action::End`].
///
/// Errors: the file cannot be read or is none, or the sink refuses an item.
pub fn read(name: &str, mut input: impl Read, sink: Sink<'_>) -> Result<Seen, InputError> {
    let mut text = String::new();
    input
        .read_to_string(&mut text)
        .map_err(|error| InputError::new(name, format_args!("cannot be read: {error}; SVG is UTF-8 text")))?;
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    let document = Document::parse_with_options(&text, options).map_err(|error| {
        let at = error.pos();
        InputError {
            position: Some((at.row as usize, at.col as usize)),
            ..InputError::new(name, format_args!("is no XML: {error}"))
        }
    })?;
    // Images are left out, and a drawing opens no other file.
    let closed = ImageHrefResolver { resolve_data: Box::new(|_, _, _| None), resolve_string: Box::new(|_, _| None) };
    let options = Options { image_href_resolver: closed, ..Options::default() };
    let tree = Tree::from_xmltree(&document, &options)
        .map_err(|error| InputError::new(name, format_args!("is no SVG that can be read: {error}")))?;

    let mut left_out = LeftOut::default();
    let elements = document.descendants().filter(|node| node.is_element()).map(|node| node.tag_name().name());
    for element in elements.filter(|element| LEFT_OUT.contains(element)) {
        left_out.add(element);
    }
    let size = f64::from(tree.size().width().max(tree.size().height()));
    let mut paths =
        Paths { height: f64::from(tree.size().height()), rounding: ROUNDING * size * PX, chains: Vec::new() };
    paths.group(tree.root());
    give(name, &paths.chains, sink)?;
    Ok(Seen { chains: paths.chains.len(), warnings: left_out.warnings() })
}

/// Gathers the chains of all paths.
struct Paths {
    /// Of the drawing, in px.
    height: f64,
    /// How far apart places may be that are one, in mm.
    rounding: f64,
    chains: Vec<Chain>,
}

impl Paths {
    fn group(&mut self, group: &Group) {
        for node in group.children() {
            match node {
                Node::Group(group) => self.group(group),
                Node::Path(path) if path.is_visible() => self.path(path),
                _ => {}
            }
        }
    }

    fn path(&mut self, path: &Path) {
        let to_mm = path.abs_transform();
        let mut chain = Chain::default();
        let mut place = [0.0; 3];
        let mut start = place;
        for segment in path.data().segments() {
            let at = |point: Point| self.place(to_mm, point);
            match segment {
                PathSegment::MoveTo(to) => {
                    start = at(to);
                    place = start;
                    self.end(&mut chain);
                }
                PathSegment::LineTo(to) => {
                    let to = at(to);
                    self.line(&mut chain, place, to);
                    place = to;
                }
                PathSegment::QuadTo(control, to) => {
                    let (control, to) = (at(control), at(to));
                    let between = |end: [f64; 3]| std::array::from_fn(|k| (end[k] + 2.0 * control[k]) / 3.0);
                    self.cubic(&mut chain, place, [between(place), between(to), to]);
                    place = to;
                }
                PathSegment::CubicTo(first, second, to) => {
                    let points = [at(first), at(second), at(to)];
                    self.cubic(&mut chain, place, points);
                    place = points[2];
                }
                PathSegment::Close => {
                    // What rounding has left between the ends is no line of the drawing.
                    match chain.0.last_mut() {
                        Some(last) if distance(place, start) <= self.rounding => last.end_at(start),
                        _ => self.line(&mut chain, place, start),
                    }
                    place = start;
                    self.end(&mut chain);
                }
            }
        }
        self.end(&mut chain);
    }

    /// A point of a path in mm; in `f64`, so that only the file's own rounding is left.
    fn place(&self, by: Transform, point: Point) -> [f64; 3] {
        let [sx, kx, ky, sy, tx, ty] = [by.sx, by.kx, by.ky, by.sy, by.tx, by.ty].map(f64::from);
        let (x, y) = (f64::from(point.x), f64::from(point.y));
        [(sx * x + kx * y + tx) * PX, (self.height - (ky * x + sy * y + ty)) * PX, 0.0]
    }

    fn line(&self, chain: &mut Chain, from: [f64; 3], to: [f64; 3]) {
        if from != to {
            chain.0.push(Curve::line(from, to));
        }
    }

    fn cubic(&self, chain: &mut Chain, from: [f64; 3], points: [[f64; 3]; 3]) {
        if points.iter().all(|&point| point == from) {
            return;
        }
        let shape = round::arc(from, points, self.rounding).map_or(Shape::Bezier(points), Shape::Arc);
        chain.0.push(Curve { from, shape });
    }

    /// Takes a chain that has ended.
    fn end(&mut self, chain: &mut Chain) {
        if !chain.0.is_empty() {
            self.chains.push(std::mem::take(chain));
        }
    }
}

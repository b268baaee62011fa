//! The material that a tool leaves, as areas to shade: between the part of C that it cannot touch and the round of the tool
//! where it comes nearest.
//!
//! From every point of that part a ray goes out along the normal, as far as no other part of C is nearer, and no farther than
//! |d|. What of it the tool does not cover where it stands at a trim point, or at the end of an open path, is left: the part
//! before the tool, and behind it the one that only a second wall bounds.

use shared::complex::Complex;
use shared::curve::Curve as _;

use super::geometry::Place;
use crate::contour::{Contour, SMOOTH};
use crate::offset::{Offset, Undercut};

/// Rays of all areas together, and the least and the most of one segment's part.
const RAYS: usize = 4_000;
const FEWEST: usize = 8;
const MOST: usize = 120;
/// How far a ray goes beyond the middle between two walls, so that no seam shows between the areas of both.
const OVERLAP: f64 = 1.01;

/// The areas that `undercuts` leave; `line` is C as points.
pub fn areas(contour: &Contour, offset: &Offset, undercuts: &[Undercut], line: &[Place]) -> Vec<Vec<Place>> {
    let field = Field { contour, radius: offset.distance, tools: tools(offset), line };
    let rays = (RAYS / undercuts.len().max(1)).clamp(FEWEST, MOST);
    undercuts.iter().flat_map(|undercut| field.areas(undercut, rays)).collect()
}

/// Where the tool's centre stands at a corner or an end of its path: from there it reaches farthest into what is left.
fn tools(offset: &Offset) -> Vec<Place> {
    let ends = offset.loops.iter().filter(|found| !found.closed);
    let ends = ends
        .flat_map(|found| found.pieces.first().map(|p| p.start).into_iter().chain(found.pieces.last().map(|p| p.end)));
    let pieces = offset.loops.iter().flat_map(|found| &found.pieces);
    pieces.filter(|piece| piece.start_turn.abs() > SMOOTH).map(|piece| piece.start).chain(ends).collect()
}

struct Field<'a> {
    contour: &'a Contour,
    /// d, with its sign.
    radius: f64,
    tools: Vec<Place>,
    line: &'a [Place],
}

impl Field<'_> {
    /// The area that begins at C, and those behind the tool.
    fn areas(&self, undercut: &Undercut, rays: usize) -> Vec<Vec<Place>> {
        let near = self.tools_near(undercut);
        let (mut first, mut behind) = (Strip::default(), vec![Strip::default()]);
        for (from, normal) in self.rays(undercut, rays) {
            let (before, after) = self.uncovered(from, normal, &near);
            first.add(before.map(|t| from + normal * t));
            match (after, behind.last_mut()) {
                (Some(after), Some(strip)) => strip.add(after.map(|t| from + normal * t)),
                _ => behind.push(Strip::default()),
            }
        }
        behind.push(first);
        behind.into_iter().filter_map(Strip::outline).collect()
    }

    /// Points of the undercut's part of C, each with the unit normal towards the tool.
    fn rays(&self, undercut: &Undercut, rays: usize) -> Vec<(Place, Complex<f64>)> {
        let mut found = Vec::new();
        let parts = parts(self.contour, undercut);
        let last = parts.len().saturating_sub(1);
        for (k, &(number, from, to)) in parts.iter().enumerate() {
            let Some(segment) = self.contour.segments.get(number) else { continue };
            found.extend((0..=rays).map(|step| {
                let xi = from + (to - from) * step as f64 / rays as f64;
                (segment.point(xi), segment.tangent(xi).right() * self.radius.signum())
            }));
            // About a convex node within the undercut the normals turn.
            let arc =
                self.contour.fill_arc(number, self.radius).filter(|arc| k < last && arc.sweep * self.radius > 0.0);
            found.extend(arc.into_iter().flat_map(|arc| {
                (0..=FEWEST).map(move |step| {
                    let radius = arc.point(step as f64 / FEWEST as f64) - arc.centre();
                    (arc.centre(), radius * (1.0 / radius.norm()))
                })
            }));
        }
        found
    }

    /// The tools that may reach a point of the undercut's part of C.
    fn tools_near(&self, undercut: &Undercut) -> Vec<Place> {
        let mut points = parts(self.contour, undercut)
            .into_iter()
            .filter_map(|(number, from, to)| self.contour.segments.get(number).map(|segment| (segment, from, to)))
            .flat_map(|(segment, from, to)| {
                (0..=4).map(move |k| segment.point(from + (to - from) * 0.25 * f64::from(k)))
            })
            .collect::<Vec<_>>();
        points.push(undercut.deepest);
        let extent = points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).fold(0.0, f64::max);
        let reach = 2.0 * self.radius.abs() + extent;
        let near = |tool: &&Place| points.iter().any(|&point| (point - **tool).norm() < reach);
        self.tools.iter().filter(near).copied().collect()
    }

    /// The parts of the ray from a point of C along its unit normal that no tool covers: before the tool, and behind it.
    fn uncovered(&self, from: Place, normal: Complex<f64>, tools: &[Place]) -> ([f64; 2], Option<[f64; 2]>) {
        let radius = self.radius.abs();
        let own = (1e-5 * radius).powi(2);
        // The circle that touches C at `from` and passes through another point of C: beyond its centre that one is nearer.
        let other = self.line.iter().map(|&point| point - from).filter_map(|apart| {
            let ahead = apart.dot(normal);
            (ahead > 0.0 && apart.norm_sqr() > own).then(|| apart.norm_sqr() / (2.0 * ahead))
        });
        let end = other.fold(radius, |least, reach| least.min(OVERLAP * reach));
        let covered = tools.iter().filter_map(|&tool| {
            let apart = from - tool;
            let along = apart.dot(normal);
            let square = along * along - apart.norm_sqr() + radius * radius;
            (along < 0.0 && square >= 0.0).then(|| [-along - square.sqrt(), -along + square.sqrt()])
        });
        let [first, last] = covered.fold([end, 0.0], |[first, last], [from, to]| [from.min(first), to.max(last)]);
        ([0.0, first.max(0.0)], (last > first && last < end).then_some([last, end]))
    }
}

/// An area between two lines that are drawn side by side.
#[derive(Default)]
struct Strip {
    way: Vec<Place>,
    back: Vec<Place>,
}

impl Strip {
    fn add(&mut self, [near, far]: [Place; 2]) {
        self.way.push(near);
        self.back.push(far);
    }

    /// Along one line and back along the other; none where there is no area.
    fn outline(mut self) -> Option<Vec<Place>> {
        self.back.reverse();
        self.way.append(&mut self.back);
        (self.way.len() > 3).then_some(self.way)
    }
}

/// The segments of an undercut with their parameters; behind the end of a closed contour it goes on at its start, and the end of
/// an open one may be told as that start.
fn parts(contour: &Contour, undercut: &Undercut) -> Vec<(usize, f64, f64)> {
    let ((first, from), (last, to)) = (undercut.from, undercut.to);
    let count = contour.segments.len();
    let onward = (first, from) < (last, to);
    let (last, to) = if onward || contour.closed { (last, to) } else { (count.saturating_sub(1), 1.0) };
    let span = if onward || !contour.closed { last } else { last + count }.saturating_sub(first);
    (0..=span)
        .map(|k| {
            let start = if k == 0 { from } else { 0.0 };
            let end = if k == span { to } else { 1.0 };
            ((first + k) % count.max(1), start, end)
        })
        .filter(|(_, start, end)| start <= end)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Part;
    use crate::offset::undercuts;
    use std::f64::consts::PI;

    /// The sizes of the areas of a part, and of all of them together.
    fn sizes(text: &str) -> Vec<f64> {
        let part = Part::from_toml("part.toml", text).unwrap();
        let offset = part.trim().unwrap();
        let undercuts = undercuts(&part.contour, &offset);
        let line: Vec<Place> = (0..part.contour.segments.len())
            .flat_map(|k| (0..=600).map(move |step| (k, f64::from(step) / 600.0)))
            .map(|(k, xi)| part.contour.segments[k].point(xi))
            .collect();
        let areas = areas(&part.contour, &offset, &undercuts, &line);
        let size = |area: &Vec<Place>| {
            let next = area.iter().cycle().skip(1);
            area.iter().zip(next).map(|(&a, &b)| 0.5 * a.cross(b)).sum::<f64>().abs()
        };
        areas.iter().map(size).collect()
    }

    fn polygon(corners: &[[f64; 2]], distance: f64) -> String {
        let mut text = format!("units = \"mm\"\nclosed = true\n[offset]\ndistance = {distance:?}\n");
        for (k, to) in corners.iter().cycle().skip(1).take(corners.len()).enumerate() {
            let start = if k == 0 { format!("start = {:?}, ", corners[0]) } else { String::new() };
            text += &format!("[[segment]]\nline = {{ {start}to = {to:?} }}\n");
        }
        text
    }

    /// In a right-angled corner a tool of radius r leaves r^2 (1 - pi/4).
    #[test]
    fn corner_keeps_what_is_beside_the_round_of_the_tool() {
        let sizes = sizes(&polygon(&[[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0]], -3.0));
        assert_eq!(sizes.len(), 4);
        let expected = 9.0 * (1.0 - PI / 4.0);
        // The overlap beyond the middle of the corner is a hundredth, so is the error of the polygon.
        assert!(sizes.iter().all(|size| (size / expected - 1.0).abs() < 0.03), "{sizes:?}, not {expected}");
    }

    /// A slot 6 wide and 14 deep, passed by a tool of radius 4: it keeps everything but the segment of the tool's circle on
    /// the chord of the mouth.
    #[test]
    fn slot_keeps_all_but_what_the_tool_dips_in() {
        let slot = [[20.0, 20.0], [13.0, 20.0], [13.0, 34.0], [7.0, 34.0], [7.0, 20.0], [0.0, 20.0]];
        let all = sizes(&polygon(&[&[[0.0, 0.0], [20.0, 0.0]], &slot[..]].concat(), -4.0));
        let half = (3.0_f64 / 4.0).asin();
        let expected = 6.0 * 14.0 - 16.0 * (half - half.sin() * half.cos());
        let found = all.iter().copied().fold(0.0, f64::max);
        assert!((found / expected - 1.0).abs() < 0.02, "{found}, not {expected}");
    }

    /// What the tool reaches has no area.
    #[test]
    fn nothing_is_left_outside_of_a_square() {
        assert!(sizes(&polygon(&[[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0]], 3.0)).is_empty());
    }
}

//! What `hodograph offset` finds, as people and programs read it: in the units of the contour's file.
//!
//! A table, JSON and a picture are readers of this one result; angles are radians, parameters those of the segments.

use serde::Serialize;
use shared::complex::Complex;
use shared::curve::Curve as _;

use crate::contour::{Along, Contour, SMOOTH};
use crate::measure::Clearance;
use crate::offset::{self, Offset, Undercut};
use crate::units::Units;

/// The trimmed offset of a contour, and what its tool cannot reach.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Trimming {
    /// The unit of all lengths here.
    pub units: Units,
    /// The signed offset distance, positive right of travel.
    pub distance: f64,
    /// The loops, in the order in which they stand along the contour.
    pub loops: Vec<LoopResult>,
    /// Where the part keeps material, in order along the contour.
    pub undercuts: Vec<UndercutResult>,
    /// The thickness of what is left at its thickest; 0 where the tool reaches everything.
    pub largest_undercut: f64,
    /// The radius of the largest tool on this side that reaches everything; none where no tool is too large.
    pub largest_reaching_tool: Option<f64>,
    /// The sharp concave corners, which no tool reaches.
    pub sharp_corners: Vec<SharpCorner>,
    /// What an independent measurement says of it, where one was made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub check: Option<Check>,
}

/// One loop.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LoopResult {
    /// Whether it ends where it starts.
    pub closed: bool,
    /// Its length.
    pub length: f64,
    /// The signed area that it encloses, positive anticlockwise; 0 of an open one.
    pub area: f64,
    /// Which way round it goes; none of an open one, anticlockwise of one that encloses nothing.
    pub orientation: Option<Orientation>,
    /// How many loops lie around it.
    pub depth: usize,
    /// The loop just around it.
    pub parent: Option<usize>,
    /// Its pieces in order of travel.
    pub pieces: Vec<PieceResult>,
}

/// Which way round a closed loop goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Orientation {
    /// Anticlockwise.
    Ccw,
    /// Clockwise.
    Cw,
}

/// What a piece runs along.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A segment of the contour.
    Segment,
    /// The arc about a convex node.
    Fill,
}

/// One piece of a loop.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PieceResult {
    /// What it runs along.
    pub kind: Kind,
    /// The number of the segment; for a fill the number of its node, which ends the segment of that number.
    pub segment: usize,
    /// The first parameter on it.
    pub from: f64,
    /// The last parameter on it.
    pub to: f64,
    /// The first point.
    pub start: [f64; 2],
    /// The last point.
    pub end: [f64; 2],
    /// Whether the tangent breaks where it starts.
    pub start_corner: bool,
    /// Whether the tangent breaks where it ends.
    pub end_corner: bool,
    /// The turn of the tangent at its end, positive anticlockwise; 0 where it ends smoothly or freely.
    pub angle: f64,
}

/// A place on the contour.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OnContour {
    /// The number of the segment.
    pub segment: usize,
    /// The parameter on it.
    pub parameter: f64,
}

/// A part of the contour that the tool cannot touch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct UndercutResult {
    /// Where it begins.
    pub from: OnContour,
    /// Where it ends.
    pub to: OnContour,
    /// The thickness of what is left at its thickest.
    pub depth: f64,
    /// The point of the contour where that is.
    pub deepest: [f64; 2],
}

/// A node at which the contour turns towards the tool at once.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SharpCorner {
    /// The node, which ends the segment of this number.
    pub node: usize,
    /// Where it is.
    pub at: [f64; 2],
}

/// What [`crate::measure::clearance`] found, which does not know how the offset was made.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Check {
    /// Whether no point of the path is nearer to the contour than |d| (1 - 1e-9).
    pub holds: bool,
    /// The smallest distance of a point of the path from the contour.
    pub smallest_clearance: f64,
    /// The point of the path where that is.
    pub at: [f64; 2],
    /// The largest distance of a removed point of the untrimmed offset from the contour.
    pub largest_removed: f64,
    /// The thickness of what is left at its thickest.
    pub largest_undercut: f64,
    /// How many points were measured.
    pub samples: usize,
}

/// The part of |d| by which rounding may bring the path nearer.
const SLACK: f64 = 1e-9;

impl Trimming {
    /// Puts `offset`, which is that of `contour`, into `units`; finds what the tool leaves. No check is made.
    pub fn new(contour: &Contour, offset: &Offset, undercuts: &[Undercut], units: Units) -> Self {
        let reaching = offset::largest_reaching(contour, offset.distance);
        Self {
            units,
            distance: offset.distance / units.mm(),
            loops: offset.loops.iter().map(|found| LoopResult::new(found, units)).collect(),
            undercuts: undercuts.iter().map(|undercut| UndercutResult::new(undercut, units)).collect(),
            largest_undercut: undercuts.iter().map(|undercut| undercut.depth).fold(0.0, f64::max) / units.mm(),
            largest_reaching_tool: reaching.is_finite().then_some(reaching / units.mm()),
            sharp_corners: sharp_corners(contour, offset.distance, units),
            check: None,
        }
    }

    /// This result with what an independent measurement says of it.
    pub fn checked(self, clearance: &Clearance) -> Self {
        let length = |mm: f64| mm / self.units.mm();
        let check = Check {
            holds: length(clearance.smallest) >= self.distance.abs() * (1.0 - SLACK),
            smallest_clearance: length(clearance.smallest),
            at: point(clearance.smallest_at, self.units),
            largest_removed: length(clearance.largest_removed),
            largest_undercut: length(clearance.largest_undercut),
            samples: clearance.samples,
        };
        Self { check: Some(check), ..self }
    }
}

impl LoopResult {
    fn new(found: &offset::Loop, units: Units) -> Self {
        // The loop of a tool that just fits goes to and fro and encloses nothing but rounding.
        let nothing = 1e-9 * found.length * found.length;
        let clockwise = found.area < -nothing;
        let orientation = found.closed.then_some(if clockwise { Orientation::Cw } else { Orientation::Ccw });
        Self {
            closed: found.closed,
            length: found.length / units.mm(),
            area: found.area / (units.mm() * units.mm()),
            orientation,
            depth: found.depth,
            parent: found.parent,
            pieces: found.pieces.iter().map(|piece| PieceResult::new(piece, units)).collect(),
        }
    }

    /// How many of its nodes are corners.
    pub fn corners(&self) -> usize {
        self.pieces.iter().filter(|piece| piece.end_corner).count()
    }
}

impl PieceResult {
    fn new(piece: &offset::Piece, units: Units) -> Self {
        let (kind, segment, from, to) = match piece.along {
            Along::Segment { segment, from, to } => (Kind::Segment, segment, from, to),
            Along::Fill { node, from, to } => (Kind::Fill, node, from, to),
        };
        let [start_corner, end_corner] = [piece.start_turn, piece.end_turn].map(|turn| turn.abs() > SMOOTH);
        Self {
            kind,
            segment,
            from,
            to,
            start: point(piece.start, units),
            end: point(piece.end, units),
            start_corner,
            end_corner,
            angle: if end_corner { piece.end_turn } else { 0.0 },
        }
    }
}

impl UndercutResult {
    fn new(undercut: &Undercut, units: Units) -> Self {
        let on = |(segment, parameter)| OnContour { segment, parameter };
        Self {
            from: on(undercut.from),
            to: on(undercut.to),
            depth: undercut.depth / units.mm(),
            deepest: point(undercut.deepest, units),
        }
    }
}

fn point(place: Complex<f64>, units: Units) -> [f64; 2] {
    [place.re, place.im].map(|mm| mm / units.mm())
}

/// The nodes at which the contour turns towards the side of `distance`'s sign.
fn sharp_corners(contour: &Contour, distance: f64, units: Units) -> Vec<SharpCorner> {
    let towards = |node: &usize| contour.turning_angle(*node).is_some_and(|turn| turn * distance.signum() < -SMOOTH);
    let nodes = (0..contour.nodes()).filter(towards);
    nodes
        .filter_map(|node| Some((node, contour.segments.get(node)?.point(1.0))))
        .map(|(node, place)| SharpCorner { node, at: point(place, units) })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::offset::{Loop, Piece};
    use shared::curve::{Line, Segment};
    use std::f64::consts::{FRAC_PI_2, SQRT_2};

    /// A square of 4 in, anticlockwise, and the offset 1 in inside it, made by hand.
    fn square() -> (Contour, Offset, Vec<Undercut>) {
        let at = |x: f64, y: f64| Complex::new(25.4 * x, 25.4 * y);
        let corners = [at(0.0, 0.0), at(4.0, 0.0), at(4.0, 4.0), at(0.0, 4.0)];
        let inner = [at(1.0, 1.0), at(3.0, 1.0), at(3.0, 3.0), at(1.0, 3.0)];
        let line = |k: usize| Segment::Line(Line { start: corners[k], end: corners[(k + 1) % 4] });
        let piece = |k: usize| Piece {
            along: Along::Segment { segment: k, from: 0.25, to: 0.75 },
            start: inner[k],
            end: inner[(k + 1) % 4],
            start_turn: FRAC_PI_2,
            end_turn: FRAC_PI_2,
        };
        let found = Loop {
            closed: true,
            pieces: (0..4).map(piece).collect(),
            length: 8.0 * 25.4,
            area: 4.0 * 25.4 * 25.4,
            parent: None,
            depth: 0,
        };
        let undercut = |k: usize| Undercut {
            from: (k, 0.75),
            to: ((k + 1) % 4, 0.25),
            depth: 25.4 * (SQRT_2 - 1.0),
            deepest: corners[(k + 1) % 4],
        };
        let contour = Contour { segments: (0..4).map(line).collect(), closed: true };
        (contour, Offset { distance: -25.4, loops: vec![found] }, (0..4).map(undercut).collect())
    }

    #[test]
    fn lengths_are_in_the_files_units() {
        let (contour, offset, undercuts) = square();
        let result = Trimming::new(&contour, &offset, &undercuts, Units::Inch);
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(near(result.distance, -1.0) && near(result.loops[0].length, 8.0) && near(result.loops[0].area, 4.0));
        assert_eq!(result.loops[0].orientation, Some(Orientation::Ccw));
        assert_eq!(result.loops[0].corners(), 4);
        let piece = result.loops[0].pieces[1];
        assert!(near(piece.start[0], 3.0) && near(piece.end[1], 3.0) && near(piece.angle, FRAC_PI_2));
        assert!(near(result.largest_undercut, SQRT_2 - 1.0) && near(result.undercuts[0].deepest[0], 4.0));
        let corners: Vec<usize> = result.sharp_corners.iter().map(|corner| corner.node).collect();
        assert_eq!(corners, [0, 1, 2, 3], "each corner keeps every tool out from inside");
        assert!(sharp_corners(&contour, 25.4, Units::Inch).is_empty(), "and none from outside");
    }

    /// The names that other programs read.
    #[test]
    fn json_has_the_promised_keys() {
        let (contour, offset, undercuts) = square();
        let clearance = Clearance {
            smallest: 25.4 * (1.0 - 1e-8),
            smallest_at: Complex::new(25.4, 50.8),
            largest_removed: 25.3,
            largest_removed_at: Complex::ZERO,
            largest_undercut: 10.0,
            largest_undercut_at: Complex::ZERO,
            samples: 400,
        };
        let result = Trimming::new(&contour, &offset, &undercuts, Units::Inch);
        assert!(serde_json::to_value(&result).unwrap().get("check").is_none());
        let value = serde_json::to_value(result.checked(&clearance)).unwrap();
        let has = |value: &serde_json::Value, keys: &[&str]| {
            for key in keys {
                assert!(value.get(key).is_some(), "{key}");
            }
        };
        has(&value, &["units", "distance", "loops", "undercuts", "largest_undercut", "largest_reaching_tool"]);
        has(&value["loops"][0], &["closed", "length", "area", "orientation", "depth", "parent", "pieces"]);
        let piece = &value["loops"][0]["pieces"][0];
        has(piece, &["kind", "segment", "from", "to", "start", "end", "start_corner", "end_corner", "angle"]);
        assert_eq!((&piece["kind"], &value["loops"][0]["orientation"]), (&"segment".into(), &"ccw".into()));
        has(&value["undercuts"][0], &["from", "to", "depth", "deepest"]);
        has(&value["undercuts"][0]["from"], &["segment", "parameter"]);
        has(&value["check"], &["smallest_clearance", "at", "largest_removed", "largest_undercut", "samples"]);
        assert_eq!(value["check"]["holds"], false, "1e-8 of the distance is more than rounding");
    }
}

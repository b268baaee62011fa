//! Contour, untrimmed and trimmed offset as points to draw: equation (2), over the whole of each segment or over the pieces.

use shared::complex::Complex;
use shared::curve::Curve as _;

use super::leftover;
use crate::contour::{Contour, SMOOTH};
use crate::job::Job;
use crate::offset::{Loop, Offset, Undercut};
use crate::path::{Path, PathPiece};

/// A point of the plane, in mm.
pub type Place = Complex<f64>;

/// Points on a curve, for a picture of it; many curves share a budget of this size.
const BUDGET: usize = 16_000;

/// Where the part is, of which C is the outline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Material {
    /// Inside C.
    Inside,
    /// Outside C: it is a pocket.
    Outside,
    /// C is open, and has no side that is all of the part's.
    Unbounded,
}

/// What the trimming is about, each as lines of points.
#[derive(Clone, Debug)]
pub struct Outlines {
    /// The contour C, in one line.
    pub contour: Vec<Place>,
    /// Where the part is.
    pub material: Material,
    /// The untrimmed offset with the arcs that join it over the nodes, in one line.
    pub untrimmed: Vec<Place>,
    /// The path, one line for each run of pieces that meet.
    pub trimmed: Vec<Vec<Place>>,
    /// The loops of the trimmed offset that are not run.
    pub others: Vec<Vec<Place>>,
    /// Where the path has a tangent break.
    pub corners: Vec<Place>,
    /// The material that the tool leaves, as areas.
    pub left: Vec<Vec<Place>>,
}

impl Outlines {
    /// Samples the path of a job, and the offset that it was taken from.
    pub fn new(job: &Job, path: &Path) -> Self {
        let mut all = Self::of_contour(&job.contour, job.offset);
        let steps = steps(path.pieces.len());
        let meets = |a: Option<&Place>, b: Option<&Place>| match (a, b) {
            (Some(&a), Some(&b)) => (a - b).norm() <= job.tolerance,
            _ => false,
        };
        for piece in &path.pieces {
            let points = centre(piece, steps);
            match all.trimmed.last_mut().filter(|line| meets(line.last(), points.first())) {
                Some(line) => line.extend(points),
                None => all.trimmed.push(points),
            }
            let [from, to] = piece.interval;
            let ends = [(piece.start_corner.is_some(), from), (piece.end_corner.is_some(), to)];
            for at in ends.into_iter().filter(|(corner, _)| *corner).map(|(_, xi)| piece.point(xi)) {
                // One piece ends where the next one starts, and the last where the first starts.
                if !meets(all.corners.last(), Some(&at)) && !meets(all.corners.first(), Some(&at)) {
                    all.corners.push(at);
                }
            }
        }
        if let Some(trimmed) = &path.trimmed {
            let others = trimmed.offset.loops.iter().enumerate().filter(|(number, _)| *number != trimmed.number);
            all.others = others.map(|(_, found)| run(&job.contour, found, trimmed.offset.distance, steps)).collect();
        }
        all
    }

    /// Samples a trimmed offset, all of whose loops are the path.
    pub fn of_offset(contour: &Contour, offset: &Offset) -> Self {
        let mut all = Self::of_contour(contour, offset.distance);
        let steps = steps(offset.loops.iter().map(|found| found.pieces.len()).sum());
        for found in &offset.loops {
            all.trimmed.push(run(contour, found, offset.distance, steps));
            all.corners.extend(found.pieces.iter().filter(|p| p.start_turn.abs() > SMOOTH).map(|p| p.start));
        }
        all
    }

    /// This with the material that the tool of `offset` leaves.
    pub fn leaving(mut self, contour: &Contour, offset: &Offset, undercuts: &[Undercut]) -> Self {
        self.left = leftover::areas(contour, offset, undercuts, &self.contour);
        self
    }

    /// Where the tool's centre is when it comes nearest to the thickest of what it leaves: the nearest trim point.
    pub fn tool(&self, undercuts: &[Undercut]) -> Option<Place> {
        let thickest = undercuts.iter().max_by(|a, b| a.depth.total_cmp(&b.depth))?;
        let distance = |place: &Place| (*place - thickest.deepest).norm();
        self.corners.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    fn of_contour(contour: &Contour, distance: f64) -> Self {
        let steps = steps(contour.segments.len());
        let line: Vec<Place> =
            contour.segments.iter().flat_map(|segment| along(steps, 0.0, 1.0, |xi| segment.point(xi))).collect();
        let material = match contour.closed {
            false => Material::Unbounded,
            // Right of travel is outside of an anticlockwise contour; the tool is there where d is positive.
            true if distance != 0.0 && (area(&line) > 0.0) != (distance > 0.0) => Material::Outside,
            true => Material::Inside,
        };
        Self {
            untrimmed: untrimmed(contour, distance),
            contour: line,
            material,
            trimmed: Vec::new(),
            others: Vec::new(),
            corners: Vec::new(),
            left: Vec::new(),
        }
    }

    /// All points, for the extent of a picture.
    pub fn all(&self) -> impl Iterator<Item = Place> {
        self.contour.iter().chain(&self.untrimmed).chain(self.trimmed.iter().chain(&self.others).flatten()).copied()
    }
}

/// The signed area within a closed line, positive anticlockwise.
fn area(line: &[Place]) -> f64 {
    let next = line.iter().cycle().skip(1);
    line.iter().zip(next).map(|(&a, &b)| 0.5 * a.cross(b)).sum()
}

/// The way of the tool's centre on a piece.
fn centre(piece: &PathPiece, steps: u32) -> Vec<Place> {
    let [from, to] = piece.interval;
    along(steps, from, to, |xi| piece.point(xi)).collect()
}

/// The way of the tool's centre on a loop.
fn run(contour: &Contour, found: &Loop, distance: f64, steps: u32) -> Vec<Place> {
    let curves = found.pieces.iter().filter_map(|piece| contour.carrier(piece.along, distance));
    curves
        .flat_map(|(segment, [from, to], distance)| {
            along(steps, from, to, move |xi| segment.offset_point(xi, distance))
        })
        .collect()
}

/// The offset to the whole of each segment, and about each node the arc from d n of one segment to d n of the next.
fn untrimmed(contour: &Contour, distance: f64) -> Vec<Place> {
    let steps = steps(contour.segments.len());
    let mut all: Vec<Place> = Vec::new();
    for (number, segment) in contour.segments.iter().enumerate() {
        all.extend(along(steps, 0.0, 1.0, |xi| segment.offset_point(xi, distance)));
        all.extend(node_arc(contour, number, distance));
    }
    all
}

/// The arc about a node; empty where the node is smooth, and where there is none.
fn node_arc(contour: &Contour, node: usize, distance: f64) -> Vec<Place> {
    match contour.fill_arc(node, distance).filter(|arc| arc.sweep.abs() > SMOOTH) {
        Some(arc) => along(48, 0.0, 1.0, |xi| arc.point(xi)).collect(),
        None => Vec::new(),
    }
}

fn steps(curves: usize) -> u32 {
    (BUDGET / curves.max(1)).clamp(8, 600) as u32
}

fn along(steps: u32, from: f64, to: f64, place: impl Fn(f64) -> Place) -> impl Iterator<Item = Place> {
    (0..=steps).map(move |k| place(from + (to - from) * f64::from(k) / f64::from(steps)))
}

/// How far the tangent may turn within half a detail, in radians.
const TURN: f64 = 1.35;

/// A part of a piece around the place where contact point and centre differ most in speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detail {
    /// The number of the piece.
    pub piece: usize,
    /// The parameters of its segment.
    pub interval: [f64; 2],
    /// The largest |1 + kappa d| of equation (15).
    pub stretch: f64,
}

impl Detail {
    /// The part around the largest |1 + kappa d| of the path, as far to both sides as the tangent turns by less than [`TURN`];
    /// none where the centre is nowhere notably faster than the contact point.
    pub fn find(path: &Path) -> Option<Self> {
        /// Below this the two speeds look the same.
        const NOTABLE: f64 = 1.2;
        let steps = steps(path.pieces.len());
        let peaks = path.pieces.iter().enumerate().filter(|(_, piece)| !piece.is_fill()).flat_map(|(number, piece)| {
            let [from, to] = piece.interval;
            (0..=steps).map(move |k| {
                let xi = from + (to - from) * f64::from(k) / f64::from(steps);
                (number, xi, piece.stretch(xi))
            })
        });
        let (number, xi, stretch) = peaks.filter(|peak| peak.2.is_finite()).max_by(|a, b| a.2.total_cmp(&b.2))?;
        let piece = path.pieces.get(number).filter(|_| stretch > NOTABLE)?;
        let [from, to] = piece.interval;
        let middle = piece.segment.tangent(xi);
        let reach = |end: f64| {
            let step = (end - xi) / f64::from(steps);
            let inside = (1..=steps)
                .map(|k| xi + step * f64::from(k))
                .take_while(|&there| (middle.conj() * piece.segment.tangent(there)).arg().abs() < TURN);
            inside.last().unwrap_or(xi)
        };
        let interval = [reach(from), reach(to)];
        Some(Self { piece: number, interval, stretch })
    }

    /// The contact curve and the centre's way over the part.
    pub fn curves(&self, path: &Path) -> [Vec<Place>; 2] {
        let Some(piece) = path.pieces.get(self.piece) else { return [Vec::new(), Vec::new()] };
        let [from, to] = self.interval;
        let contact = along(400, from, to, |xi| piece.segment.point(xi)).collect();
        let centre = along(400, from, to, |xi| piece.point(xi)).collect();
        [contact, centre]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduce::farouki2018::CONTOUR;
    use shared::piece::Order;

    fn published() -> (Job, Path) {
        let job = Job::from_toml("contour", CONTOUR).unwrap();
        let path = Path::new(&job, Order::First).unwrap();
        (job, path)
    }

    /// Equation (2): every point of the untrimmed offset is |d| from its contour point; on an arc that is the node. So no
    /// point is farther than |d| from the contour, and none of the trimmed ones is nearer.
    #[test]
    fn untrimmed_points_are_at_the_offset_distance() {
        let (job, path) = published();
        let steps = steps(job.contour.segments.len());
        for segment in &job.contour.segments {
            let contour = along(steps, 0.0, 1.0, |xi| segment.point(xi));
            let offset = along(steps, 0.0, 1.0, |xi| segment.offset_point(xi, job.offset));
            assert!(contour.zip(offset).all(|(c, o)| ((c - o).norm() - 25.4).abs() < 1e-9));
        }
        for (number, segment) in job.contour.segments.iter().enumerate() {
            let node = segment.point(1.0);
            assert!(
                node_arc(&job.contour, number, job.offset).iter().all(|&p| ((p - node).norm() - 25.4).abs() < 1e-9)
            );
        }
        let outlines = Outlines::new(&job, &path);
        // Contour points are less than 0.1 mm apart: their chords are nearer to the true curve than the bar below.
        let distance = |p: Place| outlines.contour.iter().map(|&c| (p - c).norm()).fold(f64::INFINITY, f64::min);
        assert!(outlines.untrimmed.iter().step_by(37).all(|&p| distance(p) < 25.4 + 1e-3));
        assert!(outlines.trimmed.iter().flatten().step_by(37).all(|&p| distance(p) > 25.4 - 1e-3));
    }

    /// The untrimmed offset has no gap: its arcs join it over every node, the last one too.
    #[test]
    fn untrimmed_offset_is_closed() {
        let (job, path) = published();
        let points = Outlines::new(&job, &path).untrimmed;
        let apart = points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).fold(0.0, f64::max);
        assert!(apart < 3.0, "a gap of {apart} mm");
        assert!((points[0] - points[points.len() - 1]).norm() < 1e-3);
    }

    /// Six concave nodes and two trims inside segments; each corner once, though two pieces meet there.
    #[test]
    fn published_path_has_eight_corners() {
        let (job, path) = published();
        assert_eq!(Outlines::new(&job, &path).corners.len(), 8);
    }

    /// The paper says that the centre feed exceeds V "by a factor greater than six".
    #[test]
    fn detail_is_where_the_centre_is_fastest() {
        let (_, path) = published();
        let detail = Detail::find(&path).unwrap();
        assert!(detail.stretch > 6.0);
        let [contact, centre] = detail.curves(&path);
        assert!(contact.iter().zip(&centre).all(|(&c, &o)| ((c - o).norm() - 25.4).abs() < 1e-9));
    }
}

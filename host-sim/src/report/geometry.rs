//! Contour, untrimmed and trimmed offset as points to draw: equation (2), over the whole of each segment or over the pieces.

use shared::complex::Complex;
use shared::curve::{Curve as _, Segment};

use crate::job::Job;
use crate::path::{Path, PathPiece};

/// A point of the plane, in mm.
pub type Place = Complex<f64>;

/// Points on a curve, for a picture of it; many curves share a budget of this size.
const BUDGET: usize = 16_000;
/// A turn of the tangent below this, in radians, leaves no gap that an arc would have to fill.
const SMOOTH: f64 = 1e-6;

/// What the trimming is about, each as lines of points.
#[derive(Clone, Debug)]
pub struct Outlines {
    /// The contour C, in one line.
    pub contour: Vec<Place>,
    /// The untrimmed offset with the arcs that join it over the nodes, in one line.
    pub untrimmed: Vec<Place>,
    /// The path, one line for each run of pieces that meet.
    pub trimmed: Vec<Vec<Place>>,
    /// Where the path has a tangent break.
    pub corners: Vec<Place>,
}

impl Outlines {
    /// Samples all of it.
    pub fn new(job: &Job, path: &Path) -> Self {
        let steps = steps(job.segments.len());
        let contour = job.segments.iter().flat_map(|segment| along(steps, 0.0, 1.0, |xi| segment.point(xi))).collect();
        let steps = self::steps(path.pieces.len());
        let meets = |a: Option<&Place>, b: Option<&Place>| match (a, b) {
            (Some(&a), Some(&b)) => (a - b).norm() <= job.tolerance,
            _ => false,
        };
        let mut trimmed: Vec<Vec<Place>> = Vec::new();
        let mut corners: Vec<Place> = Vec::new();
        for piece in &path.pieces {
            let points = centre(piece, steps);
            match trimmed.last_mut().filter(|line| meets(line.last(), points.first())) {
                Some(line) => line.extend(points),
                None => trimmed.push(points),
            }
            let [from, to] = piece.interval;
            let ends = [(piece.start.is_some(), from), (piece.end.is_some(), to)];
            for at in ends.into_iter().filter(|(corner, _)| *corner).map(|(_, xi)| piece.point(xi)) {
                // One piece ends where the next one starts, and the last where the first starts.
                if !meets(corners.last(), Some(&at)) && !meets(corners.first(), Some(&at)) {
                    corners.push(at);
                }
            }
        }
        Self { contour, untrimmed: untrimmed(job), trimmed, corners }
    }

    /// All points, for the extent of a picture.
    pub fn all(&self) -> impl Iterator<Item = Place> {
        self.contour.iter().chain(&self.untrimmed).chain(self.trimmed.iter().flatten()).copied()
    }
}

/// The way of the tool's centre on a piece.
fn centre(piece: &PathPiece, steps: u32) -> Vec<Place> {
    let [from, to] = piece.interval;
    along(steps, from, to, |xi| piece.point(xi)).collect()
}

/// The offset to the whole of each segment, and about each node the arc from d n of one segment to d n of the next.
fn untrimmed(job: &Job) -> Vec<Place> {
    let steps = steps(job.segments.len());
    let mut all: Vec<Place> = Vec::new();
    for (number, segment) in job.segments.iter().enumerate() {
        all.extend(along(steps, 0.0, 1.0, |xi| segment.offset_point(xi, job.offset)));
        let last = number + 1 == job.segments.len();
        if let Some(next) = job.segments.get(if last { 0 } else { number + 1 }).filter(|_| !last || job.closed) {
            all.extend(node_arc(segment, next, job.offset));
        }
    }
    all
}

/// The arc about the node between two segments; empty where the node is smooth.
fn node_arc(before: &Segment<f64>, after: &Segment<f64>, offset: f64) -> Vec<Place> {
    let (first, second) = (before.tangent(1.0), after.tangent(0.0));
    let turn = (first.conj() * second).arg();
    if turn.abs() < SMOOTH {
        return Vec::new();
    }
    let (centre, radius) = (before.point(1.0), first.right() * offset);
    along(48, 0.0, turn, |angle| centre + radius * Complex::new(angle.cos(), angle.sin())).collect()
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
        let peaks = path.pieces.iter().enumerate().filter(|(_, piece)| !piece.fill).flat_map(|(number, piece)| {
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
        let steps = steps(job.segments.len());
        for segment in &job.segments {
            let contour = along(steps, 0.0, 1.0, |xi| segment.point(xi));
            let offset = along(steps, 0.0, 1.0, |xi| segment.offset_point(xi, job.offset));
            assert!(contour.zip(offset).all(|(c, o)| ((c - o).norm() - 25.4).abs() < 1e-9));
        }
        for pair in job.segments.windows(2) {
            let node = pair[0].point(1.0);
            assert!(node_arc(&pair[0], &pair[1], job.offset).iter().all(|&p| ((p - node).norm() - 25.4).abs() < 1e-9));
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

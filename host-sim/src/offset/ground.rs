//! The contour in a frame of its own: its middle at the origin, its size 1, so that rounding and tolerances are relative to it.

use shared::complex::Complex;
use shared::curve::{Arc, Curve as _, Line, PhQuintic, Segment, Spline};

use super::crossing::{Crossing, crossings};
use super::field::Field;
use super::strand::Source;
use super::stretch::{Stretch, cuts};
use super::{Contour, OffsetError};

/// A node that turns by more than this, in radians, goes back the way it came.
const REVERSAL: f64 = std::f64::consts::PI - 1e-9;

/// Two stretches that both end within this distance of a point touch there, but do not cross.
const TOUCH: f64 = 1e-9;

/// A contour that offsets can be taken of, and what is near to what on it.
#[derive(Debug)]
pub struct Ground {
    /// The contour in the frame.
    pub contour: Contour,
    /// For each segment, where it is cut into stretches.
    pub cuts: Vec<Vec<f64>>,
    /// All stretches in order along C.
    pub field: Field,
    /// For each stretch, the segment that it is a part of.
    pub segment_of: Vec<usize>,
    /// For each node, by how much the contour does not meet there.
    gaps: Vec<f64>,
    middle: Complex<f64>,
    scale: f64,
    /// The frame's turn against the contour's own axes.
    turn: Complex<f64>,
}

impl Ground {
    /// Checks a contour for offsets up to |`distance`|, in mm, and turns its frame by `angle`, in radians. Errors: a cusp, a node that turns back.
    pub fn new(contour: &Contour, distance: f64, angle: f64) -> Result<Self, OffsetError> {
        let is_spline = |segment: &Segment<f64>| matches!(segment, Segment::Spline(_));
        if let Some(segment) = contour.segments.iter().position(is_spline) {
            return Err(OffsetError::Spline { segment });
        }
        let [low, high] = contour.extent();
        let middle = (low + high) * 0.5;
        let scale = 1.0 / (high - low).norm().max(distance.abs());
        let turn = Complex::new(angle.cos(), angle.sin());
        let segments: Vec<Segment<f64>> = contour.segments.iter().map(|s| framed(s, middle, scale, turn)).collect();
        for (segment, curve) in contour.segments.iter().enumerate() {
            if let Segment::Ph(curve) = curve
                && has_cusp(curve)
            {
                return Err(OffsetError::Cusp { segment });
            }
        }
        let contour = Contour { segments, closed: contour.closed };
        for node in 0..contour.nodes() {
            if contour.turning_angle(node).is_some_and(|angle| angle.abs() > REVERSAL) {
                return Err(OffsetError::Reversal { node });
            }
        }
        let cuts: Vec<Vec<f64>> = contour.segments.iter().map(cuts).collect();
        let mut stretches = Vec::new();
        let mut segment_of = Vec::new();
        for (number, (segment, cuts)) in contour.segments.iter().zip(&cuts).enumerate() {
            for pair in cuts.windows(2) {
                if let [from, to] = *pair {
                    stretches.push(Stretch::new(segment, from, to, 0.0));
                    segment_of.push(number);
                }
            }
        }
        let gap = |[before, after]: [&Segment<f64>; 2]| (before.point(1.0) - after.point(0.0)).norm();
        let gaps = (0..contour.segments.len()).map(|node| contour.at_node(node).map_or(0.0, gap)).collect();
        Ok(Self { gaps, contour, cuts, field: Field::new(stretches), segment_of, middle, scale, turn })
    }

    /// A length in mm in this frame's unit.
    pub fn to_frame(&self, length: f64) -> f64 {
        length * self.scale
    }

    /// A length of this frame in mm.
    pub fn to_mm(&self, length: f64) -> f64 {
        length / self.scale
    }

    /// A point of this frame in mm.
    pub fn place(&self, point: Complex<f64>) -> Complex<f64> {
        point * self.turn.conj() * (1.0 / self.scale) + self.middle
    }

    /// How far the contour is from meeting at a node.
    pub fn gap(&self, node: usize) -> f64 {
        self.gaps.get(node).copied().unwrap_or(0.0)
    }

    /// By how much a stretch may seem too near to the offset along `source` for no other reason than that the contour does not meet
    /// at the node between them.
    pub fn slack(&self, source: Source, stretch: usize) -> f64 {
        let last = self.contour.segments.len().saturating_sub(1);
        let Some(&segment) = self.segment_of.get(stretch) else { return 0.0 };
        let before = if segment > 0 { segment - 1 } else { last };
        let here = match source {
            Source::Segment(own) if own == segment => 0.0,
            Source::Segment(own) if own == before => self.gap(own),
            Source::Segment(own) if segment == if own > 0 { own - 1 } else { last } => self.gap(segment),
            Source::Fill(node) if node == before => self.gap(node),
            _ => 0.0,
        };
        2.0 * here
    }

    /// Errors: two stretches cross.
    pub fn check_simple(&self) -> Result<(), OffsetError> {
        let stretches = self.field.stretches();
        let mut found: Vec<Crossing> = Vec::new();
        let mut first: Option<((usize, f64), OffsetError)> = None;
        self.field.pairs(|a, b| {
            let (Some(one), Some(other)) = (stretches.get(a), stretches.get(b)) else { return };
            let [Some(&i), Some(&j)] = [a, b].map(|k| self.segment_of.get(k)) else { return };
            // Neighbours on one segment turn by less than a half turn together and cannot meet again.
            if i == j && a + 1 == b {
                return;
            }
            found.clear();
            crossings(one, other, &mut found);
            // Segments meet at their nodes, as well as the file says so.
            let touch = TOUCH + 4.0 * self.gap(i).max(self.gap(j));
            for crossing in &found {
                let at = one.at(crossing.tau[0]).point;
                let ends = |s: &Stretch| (s.start() - at).norm().min((s.end() - at).norm()) < touch;
                let place = (a, crossing.tau[0]);
                if !(ends(one) && ends(other)) && first.as_ref().is_none_or(|&(before, _)| place < before) {
                    first = Some((place, OffsetError::Crossing { segments: [i, j], at: self.place(at) }));
                }
            }
        });
        first.map_or(Ok(()), |(_, error)| Err(error))
    }
}

/// The segment with `middle` at the origin, turned, and `scale` times its size; parameters stay.
fn framed(segment: &Segment<f64>, middle: Complex<f64>, scale: f64, turn: Complex<f64>) -> Segment<f64> {
    let place = |point: Complex<f64>| (point - middle) * turn * scale;
    match *segment {
        Segment::Ph(PhQuintic { start, w }) => {
            let root = turn.sqrt() * scale.sqrt();
            Segment::Ph(PhQuintic { start: place(start), w: w.map(|w| w * root) })
        }
        Segment::Line(Line { start, end }) => Segment::Line(Line { start: place(start), end: place(end) }),
        Segment::Spline(Spline { points, correction }) => {
            Segment::Spline(Spline { points: points.map(place), correction })
        }
        Segment::Arc(Arc { start, radius, sweep }) => {
            Segment::Arc(Arc { start: place(start), radius: radius * turn * scale, sweep })
        }
    }
}

/// Whether the parametric speed comes to rest, to rounding: w is a quadratic, so |w| is least at one of a few places.
fn has_cusp(curve: &PhQuintic<f64>) -> bool {
    const SLOWEST: f64 = 1e-7;
    let fastest = curve.w.iter().map(|w| w.norm_sqr()).fold(0.0, f64::max);
    let sigma = curve.speed_coefficients();
    let slope = [0, 1, 2, 3].map(|k| sigma[k + 1] - sigma[k]);
    let places = super::roots::zeros(slope).into_iter().chain([0.0, 1.0]);
    places.map(|xi| curve.speed(xi)).any(|speed| speed.is_nan() || speed <= SLOWEST * SLOWEST * fastest)
}

//! The untrimmed offset in strands: the stretches of it that run forwards, and the arcs that fill the gaps at convex nodes.

use std::f64::consts::{FRAC_PI_2, PI};

use shared::complex::Complex;
use shared::curve::{Arc, Curve as _, Segment};

use super::ground::Ground;
use super::stretch::{Stretch, TURN, cusps};

/// Ends of strands that follow each other along C and are nearer than this to each other, in the unit of the frame, are joined:
/// smooth nodes, and loops too small to be seen.
const JOINED: f64 = 1e-10;

/// What a strand runs along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The segment of this number.
    Segment(usize),
    /// The fill arc at the node of this number.
    Fill(usize),
    /// The other side or the end of an open contour: it bounds what the tool may reach, but is no part of the offset.
    Border,
}

/// A stretch of the untrimmed offset.
#[derive(Clone, Copy, Debug)]
pub struct Strand {
    /// What it runs along.
    pub source: Source,
    /// The curve; parameters are those of its segment, or of the whole fill arc.
    pub stretch: Stretch,
    /// Whether it begins where the strand before it ends.
    pub follows: bool,
    /// Whether C lies to the left of its travel.
    pub left: bool,
}

/// The untrimmed offset.
#[derive(Debug)]
pub struct Untrimmed {
    /// Its strands in order along C; behind them the borders of an open contour.
    pub strands: Vec<Strand>,
    /// How many of them are no borders.
    pub own: usize,
}

impl Untrimmed {
    /// The untrimmed offset at `distance`, in the frame of `ground`.
    pub fn new(ground: &Ground, distance: f64) -> Self {
        let mut strands = side(ground, distance);
        let own = strands.len();
        if !ground.contour.closed {
            let border = |strand: Strand| Strand { source: Source::Border, ..strand };
            strands.extend(side(ground, -distance).into_iter().map(border));
            strands.extend(caps(ground, distance.abs()));
        }
        Self { strands, own }
    }

    /// Whether the strand of a number bounds the offset without being a part of it.
    pub fn is_border(&self, number: usize) -> bool {
        number >= self.own
    }

    /// Whether one strand goes on where the other ends: then they turn by less than a half turn together and cannot cross.
    /// `a` is less than `b`.
    pub fn neighbours(&self, a: usize, b: usize) -> bool {
        let follows = |k: usize| self.strands.get(k).is_some_and(|strand| strand.follows);
        if !self.is_border(b) {
            return a + 1 == b && follows(b) || a == 0 && b + 1 == self.own && follows(0);
        }
        // The caps begin and end where an open offset does.
        const TOUCH: f64 = 1e-9;
        let (Some(one), Some(cap)) = (self.strands.get(a), self.strands.get(b)) else { return false };
        let touch = |p: &Strand, q: &Strand| (p.stretch.end() - q.stretch.start()).norm() < TOUCH;
        (a == 0 || a + 1 == self.own) && (touch(one, cap) || touch(cap, one))
    }
}

/// The offset of one side, in order along C.
fn side(ground: &Ground, distance: f64) -> Vec<Strand> {
    let contour = &ground.contour;
    let mut strands: Vec<Strand> = Vec::new();
    let mut push = |source: Source, stretch: Stretch, gap: f64| {
        let before = strands.last().map(|strand: &Strand| strand.stretch.end());
        let follows = before.is_some_and(|end| joined(&stretch, end, gap));
        strands.push(Strand { source, stretch, follows, left: distance > 0.0 });
    };
    let mut gap = 0.0;
    for (number, (segment, cuts)) in contour.segments.iter().zip(&ground.cuts).enumerate() {
        let mut cuts = cuts.clone();
        cuts.extend(cusps(segment, distance));
        cuts.sort_by(f64::total_cmp);
        for pair in cuts.windows(2) {
            let [from, to] = *pair else { continue };
            // Cusps a rounding away from another cut leave nothing between.
            if to - from < 1e-13 {
                continue;
            }
            let stretch = Stretch::new(segment, from, to, distance);
            if stretch.at(0.0).speed > 0.0 {
                push(Source::Segment(number), stretch, gap);
            }
            gap = 0.0;
        }
        gap = ground.gap(number);
        if let Some(arc) = contour.fill_arc(number, distance)
            && arc.sweep * distance > JOINED
        {
            fill(arc).for_each(|stretch| push(Source::Fill(number), stretch, 0.0));
        }
    }
    // The first one follows the last one around a closed contour, if they meet.
    if let (true, Some(end)) = (contour.closed, strands.last().map(|last| last.stretch.end()))
        && let Some(first) = strands.first_mut()
    {
        first.follows = joined(&first.stretch, end, gap);
    }
    strands
}

/// Whether a stretch begins at `end`, as well as the contour meets there.
fn joined(stretch: &Stretch, end: Complex<f64>, gap: f64) -> bool {
    (stretch.start() - end).norm() < JOINED + 2.0 * gap
}

/// A fill arc in stretches.
pub fn fill(arc: Arc<f64>) -> impl Iterator<Item = Stretch> {
    let parts = (arc.sweep.abs() / TURN).ceil().max(1.0);
    let segment = Segment::Arc(arc);
    (0..parts as usize).map(move |k| Stretch::new(&segment, k as f64 / parts, (k + 1) as f64 / parts, 0.0))
}

/// Half circles about both ends of an open contour.
fn caps(ground: &Ground, radius: f64) -> Vec<Strand> {
    let contour = &ground.contour;
    let ends = contour.segments.first().map(|s| (s.point(0.0), s.tangent(0.0).left())).into_iter();
    let ends = ends.chain(contour.segments.last().map(|s| (s.point(1.0), s.tangent(1.0).right())));
    let halves = ends.flat_map(|(centre, side)| {
        let radius = side * radius;
        fill(Arc { start: centre + radius, radius, sweep: PI })
    });
    debug_assert!(TURN <= FRAC_PI_2);
    halves.map(|stretch| Strand { source: Source::Border, stretch, follows: false, left: true }).collect()
}

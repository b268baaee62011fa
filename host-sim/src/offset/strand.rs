//! The untrimmed offset in strands: the stretches of it that run forwards, and the arcs that fill the gaps at convex nodes.

use std::f64::consts::PI;

use shared::complex::Complex;
use shared::curve::{Arc, Curve as _, Segment};

use super::ground::Ground;
use super::stretch::{Stretch, TURN, cusps};

/// Ends of strands that follow each other along C and are nearer to each other than this part of |d| are joined: smooth nodes, and
/// loops too small to be seen. Half of it may be lacking from the clearance there.
const JOINED: f64 = 1e-10;

/// Strands of the half circle about an end of an open contour.
const CAP: usize = (PI / TURN) as usize;

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
        // The cap about the start of C begins or ends where the first strand starts, that about its end where the last one ends.
        const TOUCH: f64 = 1e-12;
        let behind = self.strands.len() - b;
        let (Some(one), Some(cap)) = (self.strands.get(a), self.strands.get(b)) else { return false };
        let touches =
            |p| [cap.stretch.start(), cap.stretch.end()].into_iter().any(|q: Complex<f64>| (q - p).norm() < TOUCH);
        a == 0 && (CAP + 1..=2 * CAP).contains(&behind) && touches(one.stretch.start())
            || a + 1 == self.own && behind <= CAP && touches(one.stretch.end())
    }
}

/// The offset of one side, in order along C.
fn side(ground: &Ground, distance: f64) -> Vec<Strand> {
    let contour = &ground.contour;
    let mut strands: Vec<Strand> = Vec::new();
    let near = (JOINED * distance.abs()).max(1e-15);
    let mut push = |source: Source, stretch: Stretch, gap: f64| {
        let follows =
            strands.last().is_some_and(|before: &Strand| follows(&before.stretch, &stretch, near + 2.0 * gap));
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
            && arc.sweep * distance > near
        {
            fill(arc).for_each(|stretch| push(Source::Fill(number), stretch, 0.0));
        }
    }
    // The first one follows the last one around a closed contour.
    if let (true, Some(last)) = (contour.closed, strands.last().copied())
        && let Some(first) = strands.first_mut()
    {
        first.follows = follows(&last.stretch, &first.stretch, near + 2.0 * gap);
    }
    strands
}

/// Whether one stretch begins where the one before it ends.
fn follows(before: &Stretch, stretch: &Stretch, near: f64) -> bool {
    (stretch.start() - before.end()).norm() < near
}

/// A fill arc in stretches.
pub fn fill(arc: Arc<f64>) -> impl Iterator<Item = Stretch> {
    let parts = (arc.sweep.abs() / TURN).ceil().max(1.0);
    let segment = Segment::Arc(arc);
    (0..parts as usize).map(move |k| Stretch::new(&segment, k as f64 / parts, (k + 1) as f64 / parts, 0.0))
}

/// Half circles about both ends of an open contour, [`CAP`] strands each.
fn caps(ground: &Ground, radius: f64) -> Vec<Strand> {
    let contour = &ground.contour;
    let ends = contour.segments.first().map(|s| (s.point(0.0), s.tangent(0.0).left())).into_iter();
    let ends = ends.chain(contour.segments.last().map(|s| (s.point(1.0), s.tangent(1.0).right())));
    let halves = ends.flat_map(|(centre, side)| {
        let radius = side * radius;
        fill(Arc { start: centre + radius, radius, sweep: PI })
    });
    halves.map(|stretch| Strand { source: Source::Border, stretch, follows: false, left: true }).collect()
}

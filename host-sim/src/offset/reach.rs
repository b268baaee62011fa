//! Which tools reach how far: the largest disc that touches C at a place and lies on the tool's side.
//!
//! A tool touches a point of C exactly if it is no larger than the disc that is tangent there and as large as C lets it be. So the
//! least of these radii belongs to the largest tool that reaches everything, and the greatest to the largest that fits at all.

use super::golden::golden;
use super::ground::Ground;
use super::strand::{Source, Strand, Untrimmed};
use super::stretch::Stretch;
use super::trace::{End, Traced, interval, trace};

/// Discs larger than this, in the unit of the frame, are bounded by the curvature of C alone: a point of C as far away as the
/// contour is large would lie in one by less than rounding can tell.
const UNBOUNDED: f64 = 200.0;

/// A distance so small that the offset at it is the contour itself, with all of its convex nodes opened to arcs.
const GRAZING: f64 = 1e-7;

/// Places on each strand at which discs are tried before the best ones are narrowed down, and how far apart they are.
const TRIES: [f64; 9] = [-0.5, -0.375, -0.25, -0.125, 0.0, 0.125, 0.25, 0.375, 0.5];
const APART: f64 = 0.125;

/// How often the trimming is asked whether a disc is the extreme one.
const ROUNDS: u32 = 16;

/// How many strands the largest disc is narrowed down on.
const NARROWED: usize = 64;

/// A node that turns away from the tool by more than this, in radians, keeps every tool out.
const SHARP: f64 = 1e-9;

/// Discs along one side of a contour.
pub struct Reach<'a> {
    ground: &'a Ground,
    side: f64,
    strands: Vec<Strand>,
}

impl<'a> Reach<'a> {
    /// Discs on the side of `side`'s sign, positive right of travel.
    pub fn new(ground: &'a Ground, side: f64) -> Self {
        let side = side.signum();
        let Untrimmed { mut strands, own } = Untrimmed::new(ground, side * GRAZING);
        strands.truncate(own);
        Self { ground, side, strands }
    }

    /// The radius of the largest tool that reaches every point, in the frame's unit: 0 where a sharp concave node keeps every tool
    /// out, infinite where none is too large. Good to 1e-7 of itself.
    pub fn everywhere(&self) -> f64 {
        let contour = &self.ground.contour;
        let sharp = |node: usize| contour.turning_angle(node).is_some_and(|angle| angle * self.side < -SHARP);
        if (0..contour.nodes()).any(sharp) {
            return 0.0;
        }
        // The curvature is extreme at the ends of stretches.
        let bends = self.ground.field.stretches().iter().flat_map(|s| [-0.5, 0.5].map(|tau| self.bend(s, tau)));
        let mut least = bends.fold(f64::INFINITY, f64::min);
        for strand in &self.strands {
            for tau in TRIES {
                least = self.narrow(strand, tau, least);
            }
        }
        // What the trials have missed, the trimming finds: a tool a little smaller must lose nothing.
        for _ in 0..ROUNDS {
            let Some((strand, tau)) = self.lost(least * (1.0 - 1e-8)) else { break };
            let better = self.narrow(&strand, tau, least);
            if better >= least {
                break;
            }
            least = better;
        }
        least
    }

    /// The radius of the largest tool that touches any point, in the frame's unit; infinite where none is too large.
    pub fn anywhere(&self) -> f64 {
        let best = |strand: &'_ Strand| {
            let tried = TRIES.map(|tau| (self.disc(strand, tau, f64::INFINITY), tau));
            tried.into_iter().fold((0.0, 0.0), |best, tried| if tried.0 > best.0 { tried } else { best })
        };
        let mut tried: Vec<((f64, f64), &Strand)> = self.strands.iter().map(|s| (best(s), s)).collect();
        tried.sort_by(|a, b| b.0.0.total_cmp(&a.0.0));
        // All along an arc that a disc fills it is the same one.
        tried.dedup_by(|b, a| (a.0.0 - b.0.0).abs() < 1e-9);
        let narrowed = tried.iter().take(NARROWED).map(|&((_, tau), strand)| self.widen(strand, tau));
        let mut greatest = narrowed.fold(0.0, f64::max);
        // What the trials have missed, the trimming finds: of a tool a little larger nothing must be left.
        for _ in 0..ROUNDS {
            let Some((strand, tau)) = self.left(greatest * (1.0 + 1e-8)) else { break };
            let better = self.widen(&strand, tau);
            if better <= greatest {
                break;
            }
            greatest = better;
        }
        greatest
    }

    /// The greatest disc near a place.
    fn widen(&self, strand: &Strand, tau: f64) -> f64 {
        let disc = |tau: f64| self.disc(strand, tau, f64::INFINITY);
        let place = golden(|tau| -disc(tau), (tau - APART).max(-0.5), (tau + APART).min(0.5));
        disc(place).max(disc(tau))
    }

    /// The least disc near a place, if it is less than `least`; else that.
    fn narrow(&self, strand: &Strand, tau: f64, least: f64) -> f64 {
        let here = self.disc(strand, tau, least);
        if here >= least {
            return least;
        }
        let place = golden(|tau| self.disc(strand, tau, least), (tau - APART).max(-0.5), (tau + APART).min(0.5));
        self.disc(strand, place, least).min(here)
    }

    /// The radius of the largest tangent disc at a place that C bounds, or `most` if it is no less.
    ///
    /// A disc that holds a point of C shrinks until it touches that point, [Ma, Bae & Choi 2012]; each round is one look-up.
    fn disc(&self, strand: &Strand, tau: f64, most: f64) -> f64 {
        let at = strand.stretch.at(tau);
        let normal = at.tangent.right() * self.side;
        let point = at.point - normal * GRAZING;
        let free = match strand.source {
            Source::Segment(_) => most.min(self.bend(&strand.stretch.with_offset(0.0), tau)),
            _ => most,
        };
        let mut radius = free.min(UNBOUNDED);
        for _ in 0..64 {
            let centre = point + normal * radius;
            let Some((number, foot)) = self.ground.field.nearest(centre, radius * (1.0 - 1e-13)) else { break };
            let Some(other) = self.ground.field.stretches().get(number) else { break };
            let chord = other.at(foot.tau).point - point;
            let less = chord.norm_sqr() / (2.0 * normal.dot(chord));
            if !(less > 0.0 && less < radius) {
                break;
            }
            radius = less;
        }
        if radius < UNBOUNDED { radius } else { free }
    }

    /// The radius of curvature where C bends around the tool, else infinite.
    fn bend(&self, stretch: &Stretch, tau: f64) -> f64 {
        let curvature = -self.side * Stretch::curvature(&stretch.at(tau));
        if curvature > 0.0 { 1.0 / curvature } else { f64::INFINITY }
    }

    /// The trimmed offset of a tool, if it is not so large that only the curvature bounds it.
    fn traced(&self, radius: f64) -> Option<Traced> {
        (radius > 0.0 && radius < 0.5 * UNBOUNDED).then(|| trace(self.ground, self.side * radius, false).ok()).flatten()
    }

    /// A place that a tool of this radius does not touch.
    fn lost(&self, radius: f64) -> Option<(Strand, f64)> {
        let traced = self.traced(radius)?;
        let trimmed = traced.loops.iter().flat_map(|l| &l.fragments).find_map(|fragment| match fragment.end {
            End::Joint(joint) => traced.joints.get(joint).copied(),
            End::Free => None,
        })?;
        // Just behind the place where the tool turns off C begins what it does not touch.
        let (number, tau) = trimmed.ends;
        self.place(traced.untrimmed.strands.get(number)?, (tau + 1e-3).min(0.5))
    }

    /// A place that a tool of this radius touches.
    fn left(&self, radius: f64) -> Option<(Strand, f64)> {
        let traced = self.traced(radius)?;
        let fragment = traced.loops.iter().flat_map(|l| &l.fragments).next()?;
        let [from, to] = interval(fragment, &traced.joints, 0);
        self.place(traced.untrimmed.strands.get(*fragment.strands.first()?)?, 0.5 * (from + to))
    }

    /// The same place on the strands of this side.
    fn place(&self, strand: &Strand, tau: f64) -> Option<(Strand, f64)> {
        let at = strand.stretch.parameter(tau);
        let same = |s: &&Strand| s.source == strand.source && s.stretch.from <= at && at <= s.stretch.to;
        let found = self.strands.iter().find(same)?;
        Some((*found, (at - found.stretch.from) / (found.stretch.to - found.stretch.from) - 0.5))
    }
}

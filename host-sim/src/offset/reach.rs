//! Which tools reach how far: the largest disc that touches C at a place and lies on the tool's side.
//!
//! A tool touches a point of C exactly if it is no larger than the disc that is tangent there and as large as C lets it be. So the
//! least of these radii belongs to the largest tool that reaches everything, and the greatest to the largest that fits at all.

use super::ground::Ground;
use super::strand::{Source, Strand, Untrimmed};
use super::stretch::Stretch;
use super::trace::{End, trace};
use super::undercut::golden;

/// A disc larger than this, in the unit of the frame, is not bounded by C.
const UNBOUNDED: f64 = 1e4;

/// A distance so small that the offset at it is the contour itself, with all of its convex nodes opened to arcs.
const GRAZING: f64 = 1e-7;

/// Places on each strand at which discs are tried before the best ones are narrowed down.
const TRIES: [f64; 5] = [-0.5, -0.25, 0.0, 0.25, 0.5];

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
        let mut least = bends.fold(UNBOUNDED, f64::min);
        for strand in &self.strands {
            for tau in TRIES {
                least = self.narrow(strand, tau, least);
            }
        }
        // What the trials have missed, the trimming finds: a tool a little smaller must lose nothing.
        for _ in 0..8 {
            let Some((strand, tau)) = self.lost(least * (1.0 - 1e-8)) else { break };
            let better = self.narrow(&strand, tau, least);
            if better >= least {
                break;
            }
            least = better;
        }
        if least >= UNBOUNDED { f64::INFINITY } else { least }
    }

    /// The radius of the largest tool that touches any point, in the frame's unit; infinite where none is too large.
    pub fn anywhere(&self) -> f64 {
        let mut tried: Vec<(f64, &Strand, f64)> = Vec::new();
        for strand in &self.strands {
            for tau in TRIES {
                tried.push((self.disc(strand, tau, UNBOUNDED), strand, tau));
            }
        }
        tried.sort_by(|a, b| b.0.total_cmp(&a.0));
        let narrowed = tried.iter().take(12).map(|&(radius, strand, tau)| {
            let tau = golden(|tau| -self.disc(strand, tau, UNBOUNDED), (tau - 0.25).max(-0.5), (tau + 0.25).min(0.5));
            self.disc(strand, tau, UNBOUNDED).max(radius)
        });
        let greatest = narrowed.fold(0.0, f64::max);
        if greatest >= 0.99 * UNBOUNDED { f64::INFINITY } else { greatest }
    }

    /// The least disc near a place, if it is less than `least`; else that.
    fn narrow(&self, strand: &Strand, tau: f64, least: f64) -> f64 {
        let here = self.disc(strand, tau, least);
        if here >= least {
            return least;
        }
        let place = golden(|tau| self.disc(strand, tau, least), (tau - 0.25).max(-0.5), (tau + 0.25).min(0.5));
        self.disc(strand, place, least).min(here)
    }

    /// The radius of the largest tangent disc at a place that C bounds, or `most` if it is no less.
    ///
    /// A disc that holds a point of C shrinks until it touches that point, [Ma, Bae & Choi 2012]; each round is one look-up.
    fn disc(&self, strand: &Strand, tau: f64, most: f64) -> f64 {
        let at = strand.stretch.at(tau);
        let normal = at.tangent.right() * self.side;
        let point = at.point - normal * GRAZING;
        let mut radius = match strand.source {
            Source::Segment(_) => most.min(self.bend(&strand.stretch.with_offset(0.0), tau)),
            _ => most,
        };
        for _ in 0..64 {
            let centre = point + normal * radius;
            let Some((number, foot)) = self.ground.field.nearest(centre, radius * (1.0 - 1e-11)) else { break };
            let Some(other) = self.ground.field.stretches().get(number) else { break };
            let chord = other.at(foot.tau).point - point;
            let less = chord.norm_sqr() / (2.0 * normal.dot(chord));
            if !(less > 0.0 && less < radius) {
                break;
            }
            radius = less;
        }
        radius
    }

    /// The radius of curvature where C bends around the tool, else infinite.
    fn bend(&self, stretch: &Stretch, tau: f64) -> f64 {
        let curvature = -self.side * Stretch::curvature(&stretch.at(tau));
        if curvature > 0.0 { 1.0 / curvature } else { f64::INFINITY }
    }

    /// A place that a tool of this radius does not touch.
    fn lost(&self, radius: f64) -> Option<(Strand, f64)> {
        if !(radius > 0.0 && radius < 0.5 * UNBOUNDED) {
            return None;
        }
        let traced = trace(self.ground, self.side * radius).ok()?;
        let trimmed = traced.loops.iter().flat_map(|l| &l.fragments).find_map(|fragment| match fragment.end {
            End::Joint(joint) => traced.joints.get(joint).copied(),
            End::Free => None,
        })?;
        // Just behind the place where the tool turns off C begins what it does not touch.
        let (number, tau) = trimmed.ends;
        let strand = traced.untrimmed.strands.get(number)?;
        let beyond = strand.stretch.parameter((tau + 1e-3).min(0.5));
        let same = |s: &&Strand| s.source == strand.source && s.stretch.from <= beyond && beyond <= s.stretch.to;
        let found = self.strands.iter().find(same)?;
        Some((*found, (beyond - found.stretch.from) / (found.stretch.to - found.stretch.from) - 0.5))
    }
}

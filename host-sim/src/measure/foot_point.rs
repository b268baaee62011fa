//! The contour error: the normal distance of a position from the exact path.
//!
//! A point and its offset have one normal, so the foot point on the offset is over the foot point on C:
//! Re((p - r) conj(r')) = 0, which Newton's method solves from the foot of the tick before. Two feet are followed, because a
//! lagging axis is still on one piece when the setpoint is on the next one: one that stays with the position, and one on the
//! piece of the setpoint. The nearer one counts.

use shared::complex::Complex;
use shared::curve::Segment;

use super::quintic::Quintic;
use crate::path::{Path, PathPiece};

/// How many ticks the position's own foot may stay behind on an earlier piece once the setpoint's piece is nearer.
const PATIENCE: u32 = 64;

/// Follows the foot points of a moving position. One object a run.
#[derive(Debug)]
pub struct ContourError<'a> {
    path: &'a Path,
    own: Foot,
    commanded: Foot,
    behind: u32,
}

#[derive(Clone, Copy, Debug)]
struct Foot {
    piece: usize,
    xi: f64,
    distance: f64,
}

impl<'a> ContourError<'a> {
    /// Begins at the start of `path`.
    pub fn new(path: &'a Path) -> Self {
        let xi = path.pieces.first().map_or(0.0, |piece| piece.interval[0]);
        let foot = Foot { piece: 0, xi, distance: 0.0 };
        Self { path, own: foot, commanded: foot, behind: 0 }
    }

    /// The distance of `position` from the path, in mm, while the setpoint is at parameter `xi` of piece `piece`.
    pub fn at(&mut self, position: Complex<f64>, piece: usize, xi: f64) -> f64 {
        if piece != self.commanded.piece {
            self.commanded = Foot { piece, xi, distance: 0.0 };
        }
        self.commanded = self.foot(position, self.commanded);
        if self.own.piece == piece {
            self.own = self.commanded;
            self.behind = 0;
            return self.own.distance;
        }
        self.own = self.foot(position, self.own);
        // Over the end of its piece the own foot walks on, as long as that brings it nearer.
        while self.own.piece < piece && self.own.xi >= self.path.pieces[self.own.piece].interval[1] {
            let next = self.own.piece + 1;
            let from = self.path.pieces[next].interval[0];
            let onward = self.foot(position, Foot { piece: next, xi: from, distance: 0.0 });
            if onward.distance > self.own.distance {
                break;
            }
            self.own = onward;
        }
        self.behind = if self.commanded.distance <= self.own.distance { self.behind + 1 } else { 0 };
        let distance = self.own.distance.min(self.commanded.distance);
        if self.behind > PATIENCE {
            self.own = self.commanded;
        }
        distance
    }

    /// The foot of `position` on the piece of `from`, by Newton's method from there.
    fn foot(&self, position: Complex<f64>, from: Foot) -> Foot {
        let Some(piece) = self.path.pieces.get(from.piece) else { return from };
        let xi = foot_parameter(piece, position, from.xi);
        Foot { piece: from.piece, xi, distance: (position - piece.point(xi)).norm() }
    }
}

/// The parameter of the foot of `position`, within the piece.
fn foot_parameter(piece: &PathPiece, position: Complex<f64>, guess: f64) -> f64 {
    let [first, last] = piece.interval;
    match &piece.segment {
        Segment::Line(line) => {
            let along = line.end - line.start;
            let square = along.norm_sqr();
            // A line along which only z moves is one point, and what follows is at its end.
            if square > 0.0 { (along.dot(position - line.start) / square).clamp(first, last) } else { last }
        }
        Segment::Arc(arc) => {
            let angle = (arc.radius.conj() * (position - arc.centre())).arg();
            // The turn of the angle that is nearest to the guess.
            let turn = std::f64::consts::TAU;
            let near = angle + turn * ((arc.sweep * guess - angle) / turn).round();
            (near / arc.sweep).clamp(first, last)
        }
        Segment::Ph(curve) => on_quintic(curve, position, guess, [first, last]),
        Segment::Spline(curve) => on_quintic(curve, position, guess, [first, last]),
    }
}

/// Newton's method from `guess`, within an interval.
fn on_quintic(curve: &impl Quintic, position: Complex<f64>, guess: f64, [first, last]: [f64; 2]) -> f64 {
    let mut xi = guess.clamp(first, last);
    for _ in 0..8 {
        let [tangent, bend] = curve.two_derivatives(xi);
        let apart = position - curve.point(xi);
        let speed_sqr = tangent.norm_sqr();
        // Beyond the centre of curvature Newton's slope changes its sign; there the tangent's own slope leads back.
        let slope = speed_sqr - apart.dot(bend);
        let step = apart.dot(tangent) / if slope > 0.1 * speed_sqr { slope } else { speed_sqr };
        let before = xi;
        xi = (xi + step).clamp(first, last);
        if (xi - before).abs() < 1e-9 {
            break;
        }
    }
    xi
}

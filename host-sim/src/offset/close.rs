//! Trim points that are too flat to be found as crossings.
//!
//! Where two strands pass each other under a small angle a, over a length l, they differ in height by a l / 2. At a concave node
//! that turns by a, l is |d| a; at the mouth of a neck, l is the neck's width. If that height drowns in rounding, no sign tells
//! that they cross. But then the ends that reach beyond the crossing reach so little beyond it that C is no nearer to them than
//! |d|, to rounding. So such ends are looked for, and joined half-way.

use shared::complex::Complex;

use super::bury::Cover;
use super::ground::Ground;
use super::strand::{Strand, Untrimmed};
use super::stretch::At;
use super::trace::{Joint, ROUNDING};

/// An end that is nearer to C than |d| by no more than this, in the unit of the frame and as a part of |d|, is not covered for
/// certain.
const UNCERTAIN: [f64; 2] = [1e-13, 1e-10];

/// Ends farther from each other than this do not belong together.
const NEAR: f64 = 1e-6;

/// Joins ends of strands that nothing covers for certain with the nearest such beginnings.
pub fn close(ground: &Ground, untrimmed: &Untrimmed, covers: &[Cover], limit: f64) -> Vec<Joint> {
    let own = untrimmed.own;
    let lives = |k: usize| covers.get(k).is_some_and(|cover| *cover != Cover::Buried);
    let next = |k: usize| if k + 1 < own { k + 1 } else { 0 };
    // Strand `next(k)` goes on where strand `k` ends.
    let goes_on = |k: usize| lives(next(k)) && lives(k) && untrimmed.strands.get(next(k)).is_some_and(|s| s.follows);
    let [absolute, relative] = UNCERTAIN;
    let certain = limit - absolute.min(relative * limit).max(ROUNDING);
    let open = |strand: &Strand, point: Complex<f64>| {
        !ground.field.any_nearer(point, certain, |stretch| ground.slack(strand.source, stretch))
    };
    let mut ends: Vec<(usize, At)> = Vec::new();
    let mut starts: Vec<(usize, At)> = Vec::new();
    for k in 0..own {
        let Some(strand) = untrimmed.strands.get(k).filter(|_| lives(k)) else { continue };
        let stretch = &strand.stretch;
        let free = |number: usize| !ground.contour.closed && number == 0;
        if !goes_on(k) && !free(next(k)) && open(strand, stretch.end()) {
            ends.push((k, stretch.at(0.5)));
        }
        let before = if k > 0 { k - 1 } else { own - 1 };
        if !goes_on(before) && !free(k) && open(strand, stretch.start()) {
            starts.push((k, stretch.at(-0.5)));
        }
    }
    let mut joints = Vec::new();
    for (strand, end) in ends {
        let apart = |start: &At| (start.point - end.point).norm();
        let nearest = (0..starts.len()).min_by(|&a, &b| apart(&starts[a].1).total_cmp(&apart(&starts[b].1)));
        let Some(position) = nearest.filter(|&k| apart(&starts[k].1) < NEAR) else { continue };
        let (other, start) = starts.swap_remove(position);
        joints.push(half_way(untrimmed, (strand, &end), (other, &start)));
    }
    joints
}

/// At the mouth of a neck that is narrower than rounding can tell: strands that lead to a place which nothing covers for certain,
/// with the strands that lead away from one so near that they overlap. The way comes along the latter and goes on along the former.
///
/// That these are kept at all is not certain; whoever asks must see whether loops come of it.
pub fn mouths(ground: &Ground, untrimmed: &Untrimmed, covers: &[Cover], limit: f64) -> Vec<Joint> {
    let own = untrimmed.own;
    let partly = |k: usize| covers.get(k) == Some(&Cover::Partly);
    let clear = |k: usize| covers.get(k) == Some(&Cover::Clear);
    let [absolute, relative] = UNCERTAIN;
    let certain = limit - absolute.min(relative * limit).max(ROUNDING);
    let open = |strand: &Strand, point: Complex<f64>| {
        !ground.field.any_nearer(point, certain, |stretch| ground.slack(strand.source, stretch))
    };
    // From the covered end of a run into a clear strand, and from a clear strand into the covered beginning of one.
    let leading = |clear_one: usize, covered: usize, at: f64| {
        let strand = untrimmed.strands.get(covered)?;
        let place = strand.stretch.at(at);
        (clear(clear_one) && partly(covered) && open(strand, place.point)).then_some((covered, place))
    };
    let around = |k: usize| (k, if k + 1 < own { k + 1 } else { 0 });
    let pairs = (0..own).map(around).filter(|&(_, next)| untrimmed.strands.get(next).is_some_and(|s| s.follows));
    let into: Vec<(usize, At)> = pairs.clone().filter_map(|(k, next)| leading(next, k, 0.5)).collect();
    let away: Vec<(usize, At)> = pairs.filter_map(|(k, next)| leading(k, next, -0.5)).collect();
    let mut joints = Vec::new();
    for (strand, end) in &into {
        for (other, start) in &away {
            let over = end.point - start.point;
            if over.norm() < NEAR
                && over.dot(end.tangent) > 0.0
                && end.tangent.dot(start.tangent) > 0.5
                && strand != other
            {
                let Joint { ends, begins, exact } = half_way(untrimmed, (*strand, end), (*other, start));
                joints.push(Joint { ends: begins, begins: ends, exact });
            }
        }
    }
    joints
}

/// The joint of an end with a beginning: where they stand over each other, half of that is cut from each.
fn half_way(untrimmed: &Untrimmed, (strand, end): (usize, &At), (other, start): (usize, &At)) -> Joint {
    let over = (end.point - start.point).dot(end.tangent).max(0.0) * 0.5;
    let cut = |number: usize, from: f64, to: f64, at: &At| {
        let Some(strand) = untrimmed.strands.get(number) else { return from };
        let ahead = |tau: f64| (strand.stretch.at(tau).point - at.point).dot(at.tangent).abs() - over;
        if over > 0.0 { zero_between(ahead, from, to) } else { from }
    };
    Joint { ends: (strand, cut(strand, 0.5, -0.5, end)), begins: (other, cut(other, -0.5, 0.5, start)), exact: true }
}

/// Where a function that rises from below zero at `from` passes zero before `to`, by halving; `to` where it does not.
fn zero_between(function: impl Fn(f64) -> f64, mut from: f64, mut to: f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (from + to);
        if function(middle) < 0.0 { from = middle } else { to = middle }
    }
    to
}

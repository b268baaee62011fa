//! Where the places of a plan stand: as dense as the speed there asks for.
//!
//! A step takes a few milliseconds at the largest speed that a place can be passed at by itself, and neighbouring steps differ by a part
//! of them: a slow corner on a fast way, or a tight bend in a long curve, has places near to each other around it and nowhere else.

use shared::curve::Segment;

use super::caps::{Bends, Cap, alone, caps};
use super::course::{Course, Place};
use super::limits::{AXES, Limits};
use super::manner::Manner;
use crate::path::PathPiece;

/// The time that a step takes at most, in s.
const TIME: f64 = 4e-3;

/// The same where no jerk is limited: an acceleration may change from one step to the next.
const TIME_FREE: f64 = 2e-3;

/// The time that a step takes at least, in s: a quarter of a tick, in which nobody could see more of it.
const SHORTEST: f64 = 0.25 * shared::TICK as f64;

/// The part of a speed that a peak may sag by between two places.
const SAG: f64 = 1e-3;

/// By what part of the way between them two steps may differ.
const GROWTH: f64 = 0.3;

/// The shortest way of the centre and of the contact point that is a motion to the controller, in mm, and more than twice that.
const LEAST: f64 = 1e-5;

/// By what part of itself the stretch may change over a step: towards a cusp of the offset the contact point runs away from the centre.
const STRETCHING: f64 = 0.1;

/// The largest turn over a step, in radians: between two places a direction is off their chord by an eighth of its square.
const TURN: f64 = 0.08;

/// Steps of a curve between the places where its speed is looked at first.
const LOOKS: u32 = 16;

/// The places for a plan within limits.
pub(super) fn places(pieces: &[PathPiece], weight: f64, limits: &Limits, manner: &Manner) -> Course {
    let coarse = Course::through(pieces, weight, manner, |_, piece| match piece.segment {
        Segment::Line(_) => vec![0.0, 1.0],
        _ => (0..=LOOKS).map(|k| f64::from(k) / f64::from(LOOKS)).collect(),
    });
    let caps = caps(&coarse, limits, Bends::Steady, &vec![1.0; coarse.places.len()]);
    let least = first_step(limits);
    let jerk = least_of(limits.jerk);
    let wanted: Vec<f64> = coarse.places.iter().zip(&caps).map(|(place, cap)| step(place, cap, jerk, least)).collect();
    let mut start = 0;
    let mut course = Course::through(pieces, weight, manner, |number, piece| {
        let end = start + coarse.places[start..].iter().take_while(|place| place.piece == number).count();
        // Away from its ends: a line is the same all along.
        let within = coarse.places[start..end]
            .iter()
            .map(|place| step(place, &alone(place, limits, Bends::Steady, 1.0), jerk, least));
        let longest = within.fold(0.0, f64::max);
        let parts = parts(piece, &coarse.places[start..end], &wanted[start..end], longest);
        start = end;
        parts
    });
    // A rapid asks for what the machine has: a number that can be shown.
    let fastest = limits.velocity.into_iter().filter(|v| v.is_finite()).fold(0.0, f64::hypot);
    for place in &mut course.places {
        place.feed = if place.feed.is_finite() { place.feed } else { fastest };
    }
    course
}

/// The way from rest in two steps' time, in mm.
fn first_step(limits: &Limits) -> f64 {
    let (a, j) = (least_of(limits.acceleration), least_of(limits.jerk));
    if j.is_finite() { j * (2.0 * TIME).powi(3) / 6.0 } else { 0.5 * a * TIME * TIME }
}

fn least_of(of_axes: [f64; AXES]) -> f64 {
    of_axes.into_iter().fold(f64::INFINITY, f64::min)
}

fn step(place: &Place, cap: &Cap, jerk: f64, least: f64) -> f64 {
    // Between two places at constant jerk a speed is off its chord by J t^2/8.
    let time =
        if jerk.is_finite() { (8.0 * SAG * cap.speed / jerk).sqrt().clamp(0.25 * TIME, TIME) } else { TIME_FREE };
    let even = STRETCHING * place.stretch * place.stretch / place.stretching.abs();
    (cap.speed * time + least).min(even).min(TURN / place.curvature()).max(cap.speed * SHORTEST)
}

/// The parts of a piece whose steps are what is wanted at the places looked at, and between these at most as much as growth allows.
fn parts(piece: &PathPiece, places: &[Place], wanted: &[f64], longest: f64) -> Vec<f64> {
    /// More places than that on one piece say nothing new.
    const MOST: usize = 100_000;
    let length: f64 = places.iter().map(|place| place.step).sum();
    let straight = matches!(piece.segment, Segment::Line(_));
    let stretch = places.iter().map(|place| place.stretch).fold(1.0, f64::max);
    if length <= LEAST * stretch || (straight && length <= wanted.iter().copied().fold(longest, f64::min)) {
        return vec![0.0, 1.0];
    }
    // Way and step where the speed was looked at; the parameter is even in between.
    let mut ways = Vec::with_capacity(places.len());
    let mut way = 0.0;
    for place in places {
        way += place.step;
        ways.push(way);
    }
    let mut steps = wanted.to_vec();
    for k in 1..steps.len() {
        steps[k] = steps[k].min(steps[k - 1] + GROWTH * (ways[k] - ways[k - 1]));
    }
    for k in (1..steps.len()).rev() {
        steps[k - 1] = steps[k - 1].min(steps[k] + GROWTH * (ways[k] - ways[k - 1]));
    }
    let curved = if straight { longest } else { longest.min(length / 6.0) };
    let last = places.len() - 1;
    let mut marks = vec![0.0];
    let (mut at, mut look) = (0.0, 0);
    while marks.len() < MOST {
        while look + 1 < last && ways[look + 1] <= at {
            look += 1;
        }
        let here = (steps[look] + GROWTH * (at - ways[look])).min(steps[look + 1] + GROWTH * (ways[look + 1] - at));
        // Over the step itself the wanted one may fall: so much of it is sure.
        let step = here.min(curved) / (1.0 + GROWTH);
        at += step.max(2e-5 * length).max(LEAST * stretch);
        if at >= length - LEAST * stretch {
            at = at.max(length);
            break;
        }
        marks.push(at);
    }
    // The last steps end at the end.
    let scale = length / at;
    let mut parts: Vec<f64> = marks.iter().map(|mark| mark * scale).map(|mark| part_of(mark, &ways)).collect();
    parts.push(1.0);
    parts
}

/// The part of the parameter interval at a way, evenly between the places that were looked at.
fn part_of(way: f64, ways: &[f64]) -> f64 {
    let last = ways.len() - 1;
    let behind = ways.partition_point(|&at| at <= way).clamp(1, last);
    let (from, to) = (ways[behind - 1], ways[behind]);
    ((behind - 1) as f64 + ((way - from) / (to - from)).clamp(0.0, 1.0)) / last as f64
}

//! One attempt at a plan: speeds at places within what each may use, what they ask for too much of, and the pieces that make them.

use super::bound::{self, Allowed};
use super::caps::{Bends, Cap, Reason, caps};
use super::course::{Course, Place};
use super::law::{self, Law, Parts, Tolerance};
use super::limits::{AXES, JERK_WINDOW, Limits};
use super::planner::Plan;
use super::smooth::{self, State};
use crate::path::PathPiece;
use crate::vector::Vector;

/// How far a law may be from the speeds that it follows, as a part of the speed, and of the acceleration limit.
const SPEED_TOLERANCE: f64 = 5e-4;
const ACCELERATION_TOLERANCE: f64 = 4e-3;

/// By how much the middle of a step may be above a cap and an acceleration that a plan uses.
const MIDDLE_SPEED: f64 = 2e-3;
const MIDDLE_ACCELERATION: f64 = 6e-3;

/// The same of a jerk: where an acceleration turns within a step, its change seems larger than it is.
const MIDDLE_JERK: f64 = 0.06;

/// What a step without a law counts as: too much.
const WITHOUT_LAW: f64 = 1.3;

/// What the law of a step does in its middle.
#[derive(Clone, Copy)]
struct Middle {
    speed: f64,
    /// Of all axes.
    acceleration: Vector,
    /// The time that the whole step takes.
    duration: f64,
}

/// The accelerations of all axes at a time, in front of it and behind it.
struct Sample {
    /// The place there, or at the end of the step.
    place: usize,
    time: f64,
    acceleration: [Vector; 2],
}

/// The larger part that an acceleration is of what the axes bear.
fn part(acceleration: Vector, limits: &Limits) -> f64 {
    acceleration.0.into_iter().zip(limits.acceleration).map(|(a, most)| a.abs() / most).fold(0.0, f64::max)
}

/// One attempt.
pub(super) struct Draft {
    course: Course,
    caps: Vec<Cap>,
    states: Vec<State>,
    /// By what factor all of it is run slower.
    slower: f64,
}

impl Draft {
    pub(super) fn new(course: Course, limits: &Limits, bends: Bends, scale: &[f64]) -> Self {
        let caps = caps(&course, limits, bends, scale);
        let allowed = allowed(&course, &caps, limits, scale);
        let found = bound::within(&course, limits, &allowed);
        let states = if limits.jerk.iter().all(|jerk| jerk.is_infinite()) {
            smooth::as_it_is(&course, &found.speed)
        } else {
            let jerk = along(&course, &found.speed, limits, scale);
            smooth::smooth(&course, &caps, &allowed, &found.speed, &jerk)
        };
        Self { course, caps, states, slower: 1.0 }
    }

    /// All of it so much slower that what asks for too much by a factor does not.
    pub(super) fn slowed(self, over: f64) -> Self {
        Self { slower: if over > 1.0 { over.cbrt().max(over.sqrt()) } else { 1.0 }, ..self }
    }

    /// About the time that it takes, in s.
    pub(super) fn time(&self) -> f64 {
        let steps = self.course.places.iter().skip(1).zip(self.states.windows(2));
        let of = |(place, ends): (&Place, &[State])| match ends {
            [from, to] if place.step > 0.0 => 2.0 * place.step / (from.speed + to.speed),
            _ => 0.0,
        };
        self.slower * steps.map(of).sum::<f64>()
    }

    /// By what factor each place asks for more than it bears; 1 where it does not.
    pub(super) fn over(&self, limits: &Limits, lengths: &[f64]) -> Vec<f64> {
        let accelerations = self.accelerations();
        let mut over: Vec<f64> = accelerations
            .iter()
            .map(|sides| part(sides[0], limits).max(part(sides[1], limits)).max(1.0))
            .map(|over| if over < 1.0 + 4e-3 { 1.0 } else { over })
            .collect();
        let middles = self.middles(lengths);
        self.steps(limits, &middles, &mut over);
        if limits.jerk.iter().any(|jerk| jerk.is_finite()) {
            self.jerks(limits, &accelerations, &middles, &mut over);
        }
        over
    }

    /// What the law of the step to each place does in its middle; none where there is no step, or no law.
    fn middles(&self, lengths: &[f64]) -> Vec<Option<Middle>> {
        let places = &self.course.places;
        let of = |k: usize| {
            let (before, after) = (&places[k.checked_sub(1)?], &places[k]);
            if after.step == 0.0 {
                return None;
            }
            let (from, to) = (&self.states[k - 1], &self.states[k]);
            let way = (after.fraction - before.fraction) * lengths.get(after.piece).copied().unwrap_or(0.0);
            let law = Law::between(law::contact(before, from, 1), law::contact(after, to, 0), way)?;
            let [feed, slope, behind] = law.at(0.5 * law.duration);
            let part = behind / way;
            let mean = |a: f64, b: f64| a + (b - a) * part;
            let stretch = mean(before.stretch, after.stretch);
            let speed = feed * stretch;
            let along = slope * stretch + mean(before.stretching, after.stretching) * feed * feed;
            let direction = before.direction + (after.direction - before.direction) * part;
            let bend = (before.bend + (after.bend - before.bend) * part) * (speed * speed);
            Some(Middle { speed, acceleration: direction * along + bend, duration: law.duration })
        };
        (0..places.len()).map(of).collect()
    }

    /// Speeds and accelerations in the middle of steps.
    fn steps(&self, limits: &Limits, middles: &[Option<Middle>], over: &mut [f64]) {
        for (k, middle) in middles.iter().enumerate().skip(1) {
            if self.course.places[k].step == 0.0 {
                continue;
            }
            let asked = middle.map_or(WITHOUT_LAW, |middle| {
                let cap = self.caps[k - 1].speed.max(self.caps[k].speed);
                let fast = (middle.speed / cap / (1.0 + MIDDLE_SPEED)).powi(2);
                fast.max(part(middle.acceleration, limits) / (1.0 + MIDDLE_ACCELERATION))
            });
            if asked > 1.0 {
                over[k - 1] = over[k - 1].max(asked);
                over[k] = over[k].max(asked);
            }
        }
    }

    /// The accelerations of all axes in front of and behind each place.
    fn accelerations(&self) -> Vec<[Vector; 2]> {
        let of = |(place, state): (&Place, &State)| {
            let bend = place.bend * (state.speed * state.speed);
            state.acceleration.map(|along| place.direction * along + bend)
        };
        self.course.places.iter().zip(&self.states).map(of).collect()
    }

    /// Changes of acceleration over the window of a jerk, at places and in the middle of steps, but across corners.
    fn jerks(&self, limits: &Limits, accelerations: &[[Vector; 2]], middles: &[Option<Middle>], over: &mut [f64]) {
        let places = &self.course.places;
        let mut samples: Vec<Sample> = Vec::with_capacity(2 * places.len());
        let (mut time, mut from) = (0.0, 0);
        for k in 0..places.len() {
            if smooth::parts(places, k) {
                samples.clear();
                from = 0;
            }
            if let Some(middle) = middles[k] {
                let half = 0.5 * middle.duration;
                samples.push(Sample { place: k, time: time + half, acceleration: [middle.acceleration; 2] });
                self.window(&samples, &mut from, limits, over);
                time += middle.duration;
            } else if k > 0 && places[k].step > 0.0 {
                time += 2.0 * places[k].step / (self.states[k - 1].speed + self.states[k].speed);
            }
            samples.push(Sample { place: k, time, acceleration: accelerations[k] });
            self.window(&samples, &mut from, limits, over);
        }
    }

    /// The change of acceleration up to the last sample; `from` is the one at or before the start of its window.
    fn window(&self, samples: &[Sample], from: &mut usize, limits: &Limits, over: &mut [f64]) {
        let Some(last) = samples.last() else { return };
        while last.time - samples[*from].time > JERK_WINDOW && last.time - samples[*from + 1].time >= JERK_WINDOW {
            *from += 1;
        }
        let first = &samples[*from];
        // The time is the window or a little more.
        let time = (last.time - first.time).max(JERK_WINDOW);
        let change = last.acceleration[1] - first.acceleration[0];
        let asked = change
            .0
            .into_iter()
            .zip(limits.jerk)
            .map(|(change, jerk)| change.abs() / (jerk * time))
            .fold(0.0, f64::max);
        if asked > 1.0 + MIDDLE_JERK {
            for over in &mut over[first.place..=last.place] {
                *over = over.max(asked);
            }
        }
    }

    /// The pieces.
    pub(super) fn finish(self, pieces: &[PathPiece], limits: &Limits) -> Plan {
        let least = limits.acceleration.into_iter().fold(f64::INFINITY, f64::min);
        let tolerance = Tolerance { speed: SPEED_TOLERANCE, acceleration: ACCELERATION_TOLERANCE * least };
        let slower = self.slower;
        let (mut planned, mut from, mut time) =
            (Vec::with_capacity(pieces.len()), Vec::with_capacity(pieces.len()), 0.0);
        let mut start = 0;
        for (number, piece) in pieces.iter().enumerate() {
            let end = start + self.course.places[start..].iter().take_while(|place| place.piece == number).count();
            let (places, states) = (&self.course.places[start..end], &self.states[start..end]);
            start = end;
            let Parts { laws } = Parts::of(piece, places, states, tolerance);
            let (mut first, count) = (0, laws.len());
            for (k, (last, law)) in laws.into_iter().enumerate() {
                let interval = [places[first].xi, places[last].xi];
                push(&mut planned, piece, interval, &law, slower, [k == 0, k + 1 == count]);
                from.push(number);
                time += law.duration * slower;
                first = last;
            }
        }
        let speed: Vec<f64> = self.states.iter().map(|state| state.speed / slower).collect();
        let reason = self.reasons(limits);
        Plan { pieces: planned, from, time, course: self.course, speed, reason }
    }

    /// What limits each place: its cap where it is reached, else the acceleration or the jerk of an axis.
    fn reasons(&self, limits: &Limits) -> Vec<Reason> {
        let accelerations = self.accelerations();
        let of = |((cap, state), sides): ((&Cap, &State), &[Vector; 2])| {
            if state.speed >= cap.speed * (1.0 - 1e-3) {
                return cap.reason;
            }
            let part = |axis: usize| sides[0].0[axis].abs().max(sides[1].0[axis].abs()) / limits.acceleration[axis];
            let axis = (1..AXES).fold(0, |most, axis| if part(axis) > part(most) { axis } else { most });
            if part(axis) > 0.97 { Reason::Acceleration(axis) } else { Reason::Jerk(axis) }
        };
        self.caps.iter().zip(&self.states).zip(&accelerations).map(of).collect()
    }
}

fn push(all: &mut Vec<PathPiece>, piece: &PathPiece, interval: [f64; 2], law: &Law, slower: f64, whole: [bool; 2]) {
    let (feed, profile) = law.profile();
    let mut part = if whole == [true; 2] { *piece } else { piece.over(interval) };
    (part.feed, part.profile, part.start, part.end) = (feed / slower, Some(profile), None, None);
    part.start_corner = piece.start_corner.filter(|_| whole[0]);
    part.end_corner = piece.end_corner.filter(|_| whole[1]);
    all.push(part);
}

/// What places bear below their caps.
pub(super) fn allowed(course: &Course, caps: &[Cap], limits: &Limits, scale: &[f64]) -> Vec<Allowed> {
    let places = &course.places;
    let of = |k: usize| {
        let place = Place { feed: caps[k].speed, ..places[k] };
        Allowed::at(&place, places.get(k + 1), &limits.with_margin([1.0, scale[k], 1.0]))
    };
    (0..places.len()).map(of).collect()
}

/// The jerk along the way that the axes leave at each place beside what the bend takes.
fn along(course: &Course, speed: &[f64], limits: &Limits, scale: &[f64]) -> Vec<f64> {
    /// What is left at least.
    const LEAST: f64 = 0.2;
    let places = &course.places;
    (0..places.len())
        .map(|k| {
            let place = &places[k];
            let v = speed[k];
            let before = k.saturating_sub(1);
            let (step, kappa) = (place.step, place.curvature());
            let bends = place.bending(&places[before]);
            let bending = if step > 0.0 { bends * (1.0 / step.max(v * JERK_WINDOW)) } else { Vector::default() };
            let a = if step > 0.0 { (v * v - speed[before] * speed[before]) / (2.0 * step) } else { 0.0 };
            let Vector(along) = place.direction;
            let Vector(turning) = (bending - place.direction * (kappa * kappa)) * v.powi(3);
            let Vector(across) = place.bend * (3.0 * v * a);
            (0..AXES)
                .map(|axis| {
                    let taken = turning[axis].abs() + across[axis].abs();
                    let jerk = limits.jerk[axis];
                    (jerk - taken).max(LEAST * jerk) * scale[k] / along[axis].abs()
                })
                .fold(f64::INFINITY, f64::min)
        })
        .collect()
}

/// Gives less to the places that ask for too much, and to their neighbours.
pub(super) fn lessen(scale: &mut [f64], over: &[f64]) {
    /// Places on each side that share it.
    const NEAR: usize = 6;
    let mut next = scale.to_vec();
    for (k, &over) in over.iter().enumerate() {
        if over > 1.0 {
            let less = (1.0 / over).max(0.7) * 0.995;
            let (low, high) = (k.saturating_sub(NEAR), (k + NEAR + 1).min(scale.len()));
            for j in low..high {
                next[j] = next[j].min(scale[j] * less);
            }
        }
    }
    scale.copy_from_slice(&next);
}

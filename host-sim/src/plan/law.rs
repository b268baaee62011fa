//! From speeds at places to the profiles of pieces.
//!
//! Between two places the feed of the contact point is the cubic in time that has its value and its slope at both of them
//! ([`shared::profile`]); its duration D is the root of L = D (p0 + p1)/2 + D^2 (p0' - p1')/12, with L the contact length. A piece is cut
//! where one cubic does not follow the speeds: as rarely as possible, from its start on.

use shared::profile::Profile;

use super::course::Place;
use super::smooth::State;
use crate::path::PathPiece;

/// The feed of the contact point over time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// The Bernstein coefficients of the feed, in mm/s.
    pub feeds: [f64; 4],
    /// In s.
    pub duration: f64,
}

impl Law {
    /// Between two feeds with their slopes over a contact length. None where no cubic does it without standing still or turning back.
    pub(super) fn between([p0, a0]: [f64; 2], [p1, a1]: [f64; 2], length: f64) -> Option<Self> {
        let duration = Self::duration([p0, a0], [p1, a1], length);
        if !(duration.is_finite() && duration > 0.0) {
            return None;
        }
        let third = duration / 3.0;
        // A slope of rounding at a rest may be below zero.
        let tidy = |feed: f64| if feed.abs() < 1e-9 * (p0 + p1) { 0.0 } else { feed };
        let feeds = [p0, tidy(p0 + a0 * third), tidy(p1 - a1 * third), p1];
        (feeds.iter().all(|&feed| feed >= 0.0) && feeds[1] + feeds[2] > 0.0).then_some(Self { feeds, duration })
    }

    /// The root of the equation of the text above; not a number where there is none.
    pub(super) fn duration([p0, a0]: [f64; 2], [p1, a1]: [f64; 2], length: f64) -> f64 {
        let (mean, bend) = (0.5 * (p0 + p1), (a0 - a1) / 12.0);
        2.0 * length / (mean + (mean * mean + 4.0 * bend * length).sqrt())
    }

    /// Between two feeds at constant slope, whatever the slopes at their ends; between two rests as if from one to the other at
    /// `acceleration` at the most.
    pub(super) fn plain(p0: f64, p1: f64, length: f64, acceleration: f64) -> Self {
        if p0 + p1 > 0.0 {
            let third = (p1 - p0) / 3.0;
            return Self { feeds: [p0, p0 + third, p1 - third, p1], duration: 2.0 * length / (p0 + p1) };
        }
        // b = (0, x, x, 0) has the slope 3 x/D at its ends, and L = D x/2.
        let duration = (6.0 * length / acceleration).sqrt();
        let most = 2.0 * length / duration;
        Self { feeds: [0.0, most, most, 0.0], duration }
    }

    /// The feed in mm/s, its slope in mm/s^2 and the way in mm at a time from 0 to the duration.
    pub fn at(&self, time: f64) -> [f64; 3] {
        let [b0, b1, b2, b3] = self.feeds;
        let t = time / self.duration;
        let s = 1.0 - t;
        let feed = s * s * (s * b0 + 3.0 * t * b1) + t * t * (3.0 * s * b2 + t * b3);
        let slope = 3.0 * (s * s * (b1 - b0) + 2.0 * s * t * (b2 - b1) + t * t * (b3 - b2)) / self.duration;
        let (q, half) = (t * t, 0.5);
        // The integral of the powers of t.
        let powers = [b0, 3.0 * (b1 - b0), 3.0 * (b0 - 2.0 * b1 + b2), b3 - b0 + 3.0 * (b1 - b2)];
        let way = t * (powers[0] + t * powers[1] * half + q * powers[2] / 3.0 + q * t * powers[3] * 0.25);
        [feed, slope, way * self.duration]
    }

    /// The time at which a way lies behind.
    fn time_of(&self, way: f64, start: f64) -> f64 {
        let mut t = start;
        for _ in 0..8 {
            let [feed, _, behind] = self.at(t);
            let off = behind - way;
            if off.abs() < 1e-12 * way || feed <= 0.0 {
                break;
            }
            t = (t - off / feed).clamp(0.0, self.duration);
        }
        t
    }

    /// V and the profile in parts of it.
    pub(super) fn profile(&self) -> (f64, Profile<f64>) {
        let most = self.feeds.iter().copied().fold(0.0, f64::max);
        // A quotient by the largest is one at most.
        (most, Profile { factors: self.feeds.map(|feed| feed / most) })
    }
}

/// The feed of the contact point at a place, and its slope: of the centre's speed v and acceleration a on the side that is asked.
pub(super) fn contact(place: &Place, state: &State, side: usize) -> [f64; 2] {
    let feed = state.speed / place.stretch;
    // v = m p, a = m p' + m_s p^2.
    [feed, (state.acceleration[side] - place.stretching * feed * feed) / place.stretch]
}

/// How far a law may be from the speeds: a part of the speed, and of the acceleration in mm/s^2.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tolerance {
    pub speed: f64,
    pub acceleration: f64,
}

/// One piece with the law on each of its parts: parameters of the segment, and the law.
pub(super) struct Parts {
    pub laws: Vec<(usize, Law)>,
}

impl Parts {
    /// As few as follow the speeds: each entry is the place up to which the law holds.
    pub(super) fn of(piece: &PathPiece, places: &[Place], states: &[State], tolerance: Tolerance) -> Self {
        let length = piece.way();
        let plain = |i: usize, j: usize| {
            let way = (places[j].fraction - places[i].fraction) * length;
            let feed = |k: usize| states[k].speed / places[k].stretch;
            // So slow that nothing tells the difference.
            Law::plain(feed(i), feed(j), way, tolerance.acceleration)
        };
        let law = |i: usize, j: usize| {
            let way = (places[j].fraction - places[i].fraction) * length;
            Law::between(contact(&places[i], &states[i], 1), contact(&places[j], &states[j], 0), way)
        };
        let fits = |i: usize, j: usize| {
            let found = law(i, j)?;
            let mut time = 0.0;
            for k in i + 1..j {
                let way = (places[k].fraction - places[i].fraction) * length;
                time = found.time_of(way, time);
                let [feed, slope, _] = found.at(time);
                let ([wanted, before], [_, behind]) =
                    (contact(&places[k], &states[k], 0), contact(&places[k], &states[k], 1));
                let near = |slope: f64| (slope - before).abs().min((slope - behind).abs()) * places[k].stretch;
                if (feed / wanted - 1.0).abs() > tolerance.speed || near(slope) > tolerance.acceleration {
                    return None;
                }
            }
            Some(found)
        };
        let last = places.len() - 1;
        let mut laws = Vec::new();
        let mut i = 0;
        while i < last {
            // The farthest place, by doubling and then halving the stride.
            let (mut best, mut stride) = ((i + 1, law(i, i + 1).unwrap_or_else(|| plain(i, i + 1))), 1);
            while best.0 < last {
                let j = (best.0 + stride).min(last);
                match fits(i, j) {
                    Some(found) => {
                        best = (j, found);
                        stride *= 2;
                    }
                    None => break,
                }
            }
            while stride > 1 {
                stride /= 2;
                let j = best.0 + stride;
                if j <= last
                    && let Some(found) = fits(i, j)
                {
                    best = (j, found);
                }
            }
            laws.push(best);
            i = best.0;
        }
        Self { laws }
    }
}

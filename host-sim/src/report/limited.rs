//! What limits a planned motion, where, and what that costs: the numbers of the plan's report.

use super::geometry::Place;
use crate::plan::caps::Reason;
use crate::plan::{Limits, Plan};

/// By what part of itself the speed rises on both sides of a slow place.
const DIP: f64 = 0.02;
/// By what part of it speeds on the floor of a dip differ.
const FLOOR: f64 = 2e-3;
/// The way in mm from which a floor is long: the place in its middle stands for it.
const LONG: f64 = 1.0;
/// How many slow places have a number.
pub const NUMBERED: usize = 12;
/// The least way between two of them, as a part of the diagonal of the extent.
const APART: f64 = 0.03;

/// An axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Axis {
    /// Axis 0.
    X,
    /// Axis 1.
    Y,
    /// Axis 2.
    Z,
}

impl Axis {
    fn of(number: usize) -> Self {
        match number {
            0 => Self::X,
            1 => Self::Y,
            _ => Self::Z,
        }
    }

    /// Its number.
    pub fn number(self) -> usize {
        self as usize
    }
}

/// What limits the speed, in the order of a legend: [`Reason`], with the job's feed told from the machine's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cause {
    /// The feed that the job asks for.
    Job,
    /// The largest feed of the machine.
    Machine,
    /// The velocity of an axis.
    Velocity(Axis),
    /// The acceleration of an axis.
    Acceleration(Axis),
    /// The acceleration across the path.
    Centripetal,
    /// The jerk of an axis.
    Jerk(Axis),
    /// The step of an axis' velocity at a corner.
    Corner(Axis),
    /// A rest.
    Rest,
}

impl Cause {
    fn of(reason: Reason, feed: f64, limits: &Limits) -> Self {
        match reason {
            Reason::Feed if feed > limits.feed => Self::Machine,
            Reason::Feed => Self::Job,
            Reason::Velocity(axis) => Self::Velocity(Axis::of(axis)),
            Reason::Acceleration(axis) => Self::Acceleration(Axis::of(axis)),
            Reason::Centripetal => Self::Centripetal,
            Reason::Jerk(axis) => Self::Jerk(Axis::of(axis)),
            Reason::Corner(axis) => Self::Corner(Axis::of(axis)),
            Reason::Rest => Self::Rest,
        }
    }
}

/// What one cause takes of all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// The cause.
    pub cause: Cause,
    /// The time in s for which it limits the speed.
    pub time: f64,
    /// The way in mm on which it does.
    pub way: f64,
    /// The time in s that the way takes longer than at the job's own feed.
    pub lost: f64,
}

/// A place that is slower than what is before and behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slow {
    /// The number of the place of the grid.
    pub at: usize,
    /// From 1, the slowest first; none for a place that is not among them, or is beside a slower one.
    pub number: Option<usize>,
    /// The time in s that its surroundings, from the fastest place before it to the one behind it, take longer than at the job's own feed.
    pub lost: f64,
}

/// A planned motion place by place, and what limits it.
#[derive(Clone, Debug, PartialEq)]
pub struct Limited {
    /// The time at each place, in s.
    pub times: Vec<f64>,
    /// The way up to each place, in mm.
    pub ways: Vec<f64>,
    /// Each place in the plane.
    pub points: Vec<Place>,
    /// What limits the speed at each place.
    pub causes: Vec<Cause>,
    /// What each cause that occurs takes of time and way; the largest part of the time first.
    pub shares: Vec<Share>,
    /// The slow places along the way, without those where the motion begins or ends at rest.
    pub slow: Vec<Slow>,
    /// The time that the job's own feed takes, in s.
    pub own_time: f64,
    /// The largest speed, in mm/s.
    pub fastest: f64,
}

impl Limited {
    /// Of a plan within limits. None where the plan has no motion.
    pub fn new(plan: &Plan, limits: &Limits) -> Option<Self> {
        let places = &plan.course.places;
        let (mut times, mut ways) = (Vec::with_capacity(places.len()), Vec::with_capacity(places.len()));
        let (mut time, mut way, mut own_time) = (0.0, 0.0, 0.0);
        let mut own_times = Vec::with_capacity(places.len());
        for (k, place) in places.iter().enumerate() {
            if place.step > 0.0 && k > 0 {
                time += 2.0 * place.step / (plan.speed[k - 1] + plan.speed[k]);
                way += place.step;
                own_time += 2.0 * place.step / (places[k - 1].feed + place.feed);
            }
            times.push(time);
            ways.push(way);
            own_times.push(own_time);
        }
        if !(time > 0.0 && time.is_finite() && plan.time > 0.0) {
            return None;
        }
        // Between two places the grid takes an even acceleration; the laws of the plan know better by a little.
        let exact = plan.time / time;
        times.iter_mut().for_each(|time| *time *= exact);
        // Up to each place, as the times.
        let lost: Vec<f64> = times.iter().zip(&own_times).map(|(time, own)| time - own).collect();
        let causes: Vec<Cause> =
            plan.reason.iter().zip(places).map(|(reason, place)| Cause::of(*reason, place.feed, limits)).collect();
        let points = points(plan);
        let slow = slow(plan, &ways, &points, &causes, &lost);
        let shares = shares(&causes, &times, &ways, &lost);
        let fastest = plan.speed.iter().copied().fold(0.0, f64::max);
        Some(Self { times, ways, points, causes, shares, slow, own_time, fastest })
    }

    /// The time that all takes, in s.
    pub fn time(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// All the way, in mm.
    pub fn way(&self) -> f64 {
        self.ways.last().copied().unwrap_or(0.0)
    }

    /// The numbered slow places, the slowest first.
    pub fn numbered(&self) -> Vec<(usize, Slow)> {
        let mut all: Vec<(usize, Slow)> =
            self.slow.iter().filter_map(|slow| slow.number.map(|number| (number, *slow))).collect();
        all.sort_by_key(|numbered| numbered.0);
        all
    }

    /// The causes that occur, in the order of a legend.
    pub fn occurring(&self) -> Vec<Cause> {
        let mut all: Vec<Cause> = self.shares.iter().map(|share| share.cause).collect();
        all.sort_unstable();
        all
    }
}

/// The places in the plane: the parts of a piece have its segment and offset.
fn points(plan: &Plan) -> Vec<Place> {
    let mut part = 0;
    let point = |place: &crate::plan::course::Place| {
        while part + 1 < plan.pieces.len() && plan.from[part] < place.piece {
            part += 1;
        }
        plan.pieces[part].point(place.xi)
    };
    plan.course.places.iter().map(point).collect()
}

/// Each place has half of the steps at its sides.
fn shares(causes: &[Cause], times: &[f64], ways: &[f64], lost: &[f64]) -> Vec<Share> {
    let mut shares: Vec<Share> = Vec::new();
    let last = causes.len().saturating_sub(1);
    for (k, &cause) in causes.iter().enumerate() {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
        let half = |values: &[f64]| 0.5 * (values[after] - values[before]);
        let at = shares.iter().position(|share| share.cause == cause).unwrap_or_else(|| {
            shares.push(Share { cause, time: 0.0, way: 0.0, lost: 0.0 });
            shares.len() - 1
        });
        let share = &mut shares[at];
        share.time += half(times);
        share.way += half(ways);
        share.lost += half(lost);
    }
    shares.sort_by(|a, b| b.time.total_cmp(&a.time).then(a.cause.cmp(&b.cause)));
    shares
}

fn slow(plan: &Plan, ways: &[f64], points: &[Place], causes: &[Cause], lost: &[f64]) -> Vec<Slow> {
    let last = plan.speed.len() - 1;
    let mut all: Vec<Slow> = dips(&plan.speed)
        .into_iter()
        .map(|[from, low, to]| (from, floor(&plan.speed, ways, [from, low, to]), to))
        .filter(|&(_, at, _)| !(causes[at] == Cause::Rest && (at == 0 || at == last)))
        .map(|(from, at, to)| Slow { at, number: None, lost: lost[to] - lost[from] })
        .collect();
    let (low, high) = points.iter().fold((points[0], points[0]), |(low, high), p| {
        (Place::new(low.re.min(p.re), low.im.min(p.im)), Place::new(high.re.max(p.re), high.im.max(p.im)))
    });
    let apart = APART * (high - low).norm();
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.sort_by(|&a, &b| plan.speed[all[a].at].total_cmp(&plan.speed[all[b].at]).then(a.cmp(&b)));
    let mut chosen: Vec<usize> = Vec::new();
    for k in order {
        let at = all[k].at;
        if chosen.iter().all(|&other| (ways[other] - ways[at]).abs() >= apart) {
            chosen.push(at);
            all[k].number = Some(chosen.len());
            if chosen.len() == NUMBERED {
                break;
            }
        }
    }
    all
}

/// Where values are lower than before and behind, by more than [`DIP`] of them: from the highest one before, over the lowest one, to the
/// highest one behind.
fn dips(values: &[f64]) -> Vec<[usize; 3]> {
    let mut dips: Vec<[usize; 3]> = Vec::new();
    let (mut from, mut low, mut high) = (0, 0, 0);
    let mut is_falling = true;
    for (k, &value) in values.iter().enumerate() {
        if is_falling {
            if value < values[low] {
                low = k;
            } else if value > values[low] * (1.0 + DIP) {
                (is_falling, high) = (false, k);
            }
        } else if value > values[high] {
            high = k;
        } else if value * (1.0 + DIP) < values[high] {
            dips.push([from, low, high]);
            (is_falling, from, low) = (true, high, k);
        }
    }
    // What never rises again, or never falls again, ends with the last value.
    let last = values.len().saturating_sub(1);
    if !is_falling || values.get(low).is_some_and(|&value| value * (1.0 + DIP) < values[from]) {
        dips.push([from, low, last]);
    }
    dips
}

/// The place in the middle of a long floor, else the lowest.
fn floor(speed: &[f64], ways: &[f64], [from, low, to]: [usize; 3]) -> usize {
    let is_floor = |&k: &usize| speed[k] <= speed[low] * (1.0 + FLOOR);
    let first = (from..=low).rev().take_while(is_floor).last().unwrap_or(low);
    let last = (low..=to).take_while(is_floor).last().unwrap_or(low);
    if ways[last] - ways[first] < LONG {
        return low;
    }
    let middle = 0.5 * (ways[first] + ways[last]);
    let off = |k: usize| (ways[k] - middle).abs();
    (first..=last).min_by(|&a, &b| off(a).total_cmp(&off(b))).unwrap_or(low)
}

#[cfg(test)]
mod tests {
    use shared::piece::Order;

    use super::super::plan::tests::{SQUARE, limits, planned};
    use super::*;

    /// Time and way are each shared out without a rest, and so is the time that is lost.
    #[test]
    fn shares_sum_to_all() {
        for text in [SQUARE, include_str!("../../../examples/fan.toml"), include_str!("../../../examples/bracket.toml")]
        {
            let (_, path, plan) = planned(text, Order::First);
            let limited = Limited::new(&plan, &limits()).unwrap();
            let sum = |of: fn(&Share) -> f64| limited.shares.iter().map(of).sum::<f64>();
            // Rounding of some thousand additions.
            assert!((sum(|share| share.time) / plan.time - 1.0).abs() < 1e-9);
            assert!((sum(|share| share.way) / path.centre_length() - 1.0).abs() < 1e-6, "Simpson's rule");
            assert!((sum(|share| share.lost) - (plan.time - limited.own_time)).abs() < 1e-9);
        }
    }

    /// Nothing on the sides of a square is slower than its corners, which let x step by what the limits say; all four cost alike.
    #[test]
    fn the_slowest_places_of_a_square_are_its_corners() {
        let (_, _, plan) = planned(SQUARE, Order::First);
        let limited = Limited::new(&plan, &limits()).unwrap();
        let numbered = limited.numbered();
        assert_eq!(numbered.len(), 4);
        for (corner, (_, slow)) in [(20.0, 0.0), (20.0, 20.0), (0.0, 20.0), (0.0, 0.0)].into_iter().zip(&numbered) {
            assert!((limited.points[slow.at] - Place::new(corner.0, corner.1)).norm() < 1e-9);
            assert!(matches!(limited.causes[slow.at], Cause::Corner(_)));
            assert!((plan.speed[slow.at] / limits().corner_step[0] - 1.0).abs() < 1e-2);
            assert!((slow.lost / numbered[0].1.lost - 1.0).abs() < 0.05);
        }
    }

    /// By hand: a start and an end are dips as well, a ripple is none.
    #[test]
    fn dips_are_deeper_than_a_ripple() {
        assert_eq!(dips(&[0.0, 5.0, 9.0, 8.95, 9.0, 4.0, 7.0, 0.0]), [[0, 0, 2], [2, 5, 6], [6, 7, 7]]);
        assert_eq!(dips(&[3.0; 4]), [[0; 3]; 0]);
    }

    /// The middle of a floor that is longer than 1 mm, the lowest place of a short one.
    #[test]
    fn a_long_floor_is_named_by_its_middle() {
        let speed = [9.0, 5.001, 5.0, 5.001, 5.0015, 9.0];
        let at = |width: f64| {
            let ways: Vec<f64> = (0..6).map(|k| f64::from(k) * width).collect();
            floor(&speed, &ways, [0, 2, 5])
        };
        assert_eq!(at(0.1), 2);
        let ways = [0.0, 1.0, 2.0, 6.0, 11.0, 12.0];
        assert_eq!(floor(&speed, &ways, [0, 2, 5]), 3);
    }
}

//! The least time within limits of velocity and acceleration: two passes over a grid, as in TOPP-RA (Pham & Pham 2018).
//!
//! With x = v^2 and u = dv/dt along the way, an axis of direction t bears |v t| <= V and |u t + x kappa n| <= A, both linear in x and u, and
//! from place to place x grows by 2 u times the step. The pass from the end finds the largest x at each place from which the rest can
//! be run; the pass from the start takes as much of it as there is. No jerk is limited, so that no plan within the same limits is
//! faster but for the grid: velocities hold at its places and accelerations in the middle between them (test `the_grid_converges`).

use super::course::{Course, Place};
use super::limits::{AXES, Limits};
use crate::vector::Vector;

/// The fastest motion that velocities and accelerations leave.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    /// From the start to the end, in s; infinite where the way cannot be run to its end.
    pub time: f64,
    /// The speed at each place of the course, in mm/s.
    pub speed: Vec<f64>,
}

/// A line u = offset + slope x, above or below which u must stay.
#[derive(Clone, Copy)]
struct Line {
    offset: f64,
    slope: f64,
}

/// Lines between which u must stay.
#[derive(Clone, Copy)]
struct Lines {
    upper: [Line; AXES],
    lower: [Line; AXES],
}

/// What one place allows: u at it, u over the step behind it, and x up to a number.
pub(super) struct Allowed {
    here: Lines,
    ahead: Lines,
    most: f64,
}

/// A direction this small does not move its axis.
const STILL: f64 = 1e-12;

impl Lines {
    /// From |c u + n x| <= A of all axes.
    fn new(Vector(c): Vector, Vector(n): Vector, limits: &Limits) -> Self {
        let free = |offset: f64| Line { offset, slope: 0.0 };
        let (mut upper, mut lower) = ([free(f64::INFINITY); AXES], [free(f64::NEG_INFINITY); AXES]);
        for axis in 0..AXES {
            let (c, n, a) = (c[axis].abs(), n[axis] * c[axis].signum(), limits.acceleration[axis]);
            if c >= STILL {
                upper[axis] = Line { offset: a / c, slope: -n / c };
                lower[axis] = Line { offset: -a / c, slope: -n / c };
            }
        }
        Self { upper, lower }
    }

    fn most_at(&self, x: f64) -> f64 {
        self.upper.iter().map(|line| line.offset + line.slope * x).fold(f64::INFINITY, f64::min)
    }

    fn least_at(&self, x: f64) -> f64 {
        self.lower.iter().map(|line| line.offset + line.slope * x).fold(f64::NEG_INFINITY, f64::max)
    }
}

impl Allowed {
    /// At a place in front of another one. In the middle of the step between them x is greater by u times the step: |t u + (x + u step) n|
    /// is asked there, so that the error is of second order.
    pub(super) fn at(place: &Place, next: Option<&Place>, limits: &Limits) -> Self {
        let (along, across) = (place.direction, place.bend);
        let here = Lines::new(along, across, limits);
        let ahead = next.filter(|next| next.step > 0.0).map_or(here, |next| {
            let direction = (place.direction + next.direction) * 0.5;
            let across = (place.bend + next.bend) * 0.5;
            Lines::new(direction + across * next.step, across, limits)
        });
        let mut most = (place.feed * place.feed).min(limits.centripetal / place.curvature());
        for axis in 0..AXES {
            let t = along.0[axis].abs();
            most = if t < STILL {
                most.min(limits.acceleration[axis] / across.0[axis].abs())
            } else {
                most.min((limits.velocity[axis] / t).powi(2))
            };
        }
        Self { here, ahead, most }
    }

    /// The largest u at x.
    pub(super) fn most_at(&self, x: f64) -> f64 {
        self.here.most_at(x)
    }

    /// The least u at x.
    pub(super) fn least_at(&self, x: f64) -> f64 {
        self.here.least_at(x)
    }

    /// The largest x from which a step with some allowed u leads to at most `next` and not below 0: a linear program of two unknowns,
    /// solved by asking every pair of an upper and a lower line. None where there is no x.
    fn controllable(&self, step: f64, next: f64) -> Option<f64> {
        if step == 0.0 {
            return self.within(self.most.min(next), &self.here.upper, &self.here.lower);
        }
        let twice = 2.0 * step;
        let [a, b, c] = self.ahead.upper;
        let upper = [a, b, c, Line { offset: next / twice, slope: -1.0 / twice }];
        let [a, b, c] = self.ahead.lower;
        let lower = [a, b, c, Line { offset: 0.0, slope: -1.0 / twice }];
        self.within(self.most, &upper, &lower)
    }

    fn within(&self, most: f64, upper: &[Line], lower: &[Line]) -> Option<f64> {
        let (mut low, mut high) = (0.0_f64, most);
        for up in upper.iter().filter(|line| line.offset.is_finite()) {
            for down in lower.iter().filter(|line| line.offset.is_finite()) {
                // down <= up: (slope difference) x <= offset difference.
                let (slope, room) = (down.slope - up.slope, up.offset - down.offset);
                if slope > 0.0 {
                    high = high.min(room / slope);
                } else if slope < 0.0 {
                    low = low.max(room / slope);
                } else if room < 0.0 {
                    return None;
                }
            }
        }
        // Limits that meet in one point do so to rounding.
        (low <= high * (1.0 + 1e-12) + 1e-15).then_some(high.max(0.0))
    }
}

/// The largest x on a corner, by the steps of the axes' velocities.
fn corner(before: &Place, after: &Place, limits: &Limits) -> f64 {
    let turn = after.direction - before.direction;
    let of_axis = |step: f64, turn: f64| if turn.abs() < STILL { f64::INFINITY } else { (step / turn.abs()).powi(2) };
    limits.corner_step.into_iter().zip(turn.0).map(|(step, turn)| of_axis(step, turn)).fold(f64::INFINITY, f64::min)
}

/// The least time of a course within limits.
pub fn bound(course: &Course, limits: &Limits) -> Bound {
    let places = &course.places;
    let allowed: Vec<Allowed> = (0..places.len()).map(|k| Allowed::at(&places[k], places.get(k + 1), limits)).collect();
    within(course, limits, &allowed)
}

/// The same for what every place allows.
pub(super) fn within(course: &Course, limits: &Limits, allowed: &[Allowed]) -> Bound {
    let places = &course.places;
    let mut reachable = vec![0.0; places.len()];
    let square = |speed: Option<f64>| speed.map_or(f64::MAX, |speed| speed * speed);
    let mut next = square(course.ends[1]);
    for k in (0..places.len()).rev() {
        let step = places.get(k + 1).map_or(0.0, |after| after.step);
        let corner_of = |after: &Place| if after.is_corner { corner(&places[k], after, limits) } else { f64::INFINITY };
        let most = places.get(k + 1).map_or(f64::INFINITY, corner_of);
        next = allowed[k].controllable(step, next.min(most)).unwrap_or(0.0).min(most);
        reachable[k] = next;
    }
    let mut x = reachable.first().copied().unwrap_or(0.0).min(square(course.ends[0]));
    let (mut speed, mut time) = (Vec::with_capacity(places.len()), 0.0);
    for (k, place) in places.iter().enumerate() {
        if k > 0 {
            let before: f64 = x;
            x = (before + 2.0 * place.step * allowed[k - 1].ahead.most_at(before)).min(reachable[k]).max(0.0);
            if place.step > 0.0 {
                time += 2.0 * place.step / (before.sqrt() + x.sqrt());
            }
        }
        speed.push(x.sqrt());
    }
    Bound { time, speed }
}

#[cfg(test)]
mod tests {
    use shared::piece::Order;

    use super::*;
    use crate::job::Job;
    use crate::path::Path;

    fn path(feed: f64, rest: bool, segments: &str) -> Path {
        let closed = segments.contains("closed");
        let text = format!(
            "units = \"mm\"\nclosed = {closed}\nrest = {rest}\n[feed]\nrate = {}\n{}",
            feed * 60.0,
            segments.replace("closed", "")
        );
        Path::new(&Job::from_toml("job.toml", &text).unwrap(), Order::First).unwrap()
    }

    fn limits(acceleration: f64) -> Limits {
        Limits {
            velocity: [1e3; 3],
            acceleration: [acceleration; 3],
            jerk: [f64::INFINITY; 3],
            corner_step: [0.0; 3],
            feed: f64::INFINITY,
            centripetal: f64::INFINITY,
        }
    }

    const LINE: &str = "[[segment]]\nline = { start = [0.0, 0.0], to = [100.0, 0.0] }\n";

    /// From rest to rest along x: L/V + V/A where V is reached, 2 sqrt(L/A) where it is not.
    #[test]
    fn a_straight_move_is_a_trapezoid_or_a_triangle() {
        for (feed, acceleration) in [(50.0, 400.0), (200.0, 100.0)] {
            let found = bound(&Course::new(&path(feed, true, LINE), 0.01), &limits(acceleration)).time;
            let reached = feed * feed / acceleration <= 100.0;
            let exact =
                if reached { 100.0 / feed + feed / acceleration } else { 2.0 * f64::sqrt(100.0 / acceleration) };
            assert!((found / exact - 1.0).abs() < 1e-4, "{feed}: {found} {exact}");
        }
        // Along a diagonal the axes bear sqrt(2) times as much together, and the slower axis' velocity limits both.
        let diagonal = path(1e3, true, "[[segment]]\nline = { start = [0.0, 0.0], to = [60.0, 80.0] }\n");
        let found = bound(&Course::new(&diagonal, 0.01), &Limits { velocity: [90.0, 40.0, 1e3], ..limits(400.0) });
        assert!((found.speed.iter().copied().fold(0.0, f64::max) - 50.0).abs() < 1e-9);
        assert!((found.time / (100.0 / 50.0 + 50.0 / 500.0) - 1.0).abs() < 1e-4, "{}", found.time);
    }

    /// On a whole circle that is run on and on, an axis needs v^2/r where it turns around: v = sqrt(A r).
    #[test]
    fn a_circle_is_limited_where_an_axis_turns() {
        let circle = "[[segment]]\narc = { start = [10.0, 0.0], to = [10.0, 0.0], centre = [0.0, 0.0], ccw = true }\n";
        let circle = path(1e3, false, &format!("{circle}closed"));
        let found = bound(&Course::new(&circle, 0.01), &limits(300.0));
        let least = found.speed.iter().copied().fold(f64::INFINITY, f64::min);
        let slowest = f64::sqrt(300.0 * 10.0);
        assert!(least <= slowest * (1.0 + 1e-6) && least > 0.99 * slowest, "{least}");
        // Between them both axes have something left for speeding up: the time is below that at constant speed, but not by half.
        let constant = std::f64::consts::TAU * 10.0 / slowest;
        assert!(found.time < constant && found.time > 0.6 * constant, "{} {constant}", found.time);
    }

    /// No place of any example asks an axis for more than its limits.
    #[test]
    fn limits_hold_at_every_place() {
        let curve = "[[segment]]\nhermite = { start = [0.0, 0.0], to = [40.0, 10.0], d0 = [80.0, 60.0], d1 = [60.0, -50.0] }\n\
                     [[segment]]\nline = { to = [70.0, 40.0] }\n[[segment]]\narc = { to = [70.0, 80.0], centre = [70.0, 60.0], ccw = true }\n";
        let course = Course::new(&path(300.0, true, curve), 0.01);
        let limits = Limits { corner_step: [5.0, 8.0, 0.0], velocity: [120.0, 90.0, 1e3], ..limits(500.0) };
        let Bound { time, speed } = bound(&course, &limits);
        assert!(time.is_finite());
        let mut corners = 0;
        for (k, pair) in course.places.windows(2).enumerate() {
            let (v, next) = (speed[k], speed[k + 1]);
            if pair[1].is_corner {
                corners += 1;
                let step = pair[1].direction * next - pair[0].direction * v;
                assert!(step.0[0].abs() <= 5.0 * (1.0 + 1e-9) && step.0[1].abs() <= 8.0 * (1.0 + 1e-9));
            }
            assert!(
                v * pair[0].direction.0[0].abs() <= 120.0 * (1.0 + 1e-9)
                    && v * pair[0].direction.0[1].abs() <= 90.0 * (1.0 + 1e-9)
            );
            if pair[1].step > 0.0 {
                let u = (next * next - v * v) / (2.0 * pair[1].step);
                let direction = (pair[0].direction + pair[1].direction) * 0.5;
                let a = direction * u + (pair[0].bend + pair[1].bend) * (0.25 * (v * v + next * next));
                assert!(a.0[0].abs() <= 500.0 * (1.0 + 1e-6) && a.0[1].abs() <= 500.0 * (1.0 + 1e-6), "{k}: {a:?}");
            }
        }
        assert_eq!(corners, 2);
    }

    /// Half the step, half the error at most.
    #[test]
    fn the_grid_converges() {
        let curve =
            "[[segment]]\nhermite = { start = [0.0, 0.0], to = [40.0, 10.0], d0 = [80.0, 60.0], d1 = [60.0, -50.0] }\n";
        let path = path(300.0, true, curve);
        let times = [0.2, 0.1, 0.05, 0.0125].map(|step| bound(&Course::new(&path, step), &limits(500.0)).time);
        let errors = [0, 1, 2].map(|k| (times[k] / times[3] - 1.0).abs());
        assert!(errors[0] < 5e-3 && errors[2] < 0.6 * errors[0] + 1e-6, "{errors:?}");
    }
}

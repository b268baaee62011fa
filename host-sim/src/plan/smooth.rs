//! Limits the jerk of a speed profile, by lowering it.
//!
//! Two passes let the speed grow, forwards and backwards from every valley, no faster than a jerk allows: each step is exact motion at
//! constant jerk, up to the acceleration that the place bears. What is left are peaks at which the acceleration drops at once. They are
//! cut by arcs of constant falling acceleration: with x = v^2, a profile with x'' >= -C is one for which x + D, D'' = C, is convex, so the
//! largest such profile below x is the convex hull of x + D, less D. Both are linear in the number of places.

use super::bound::Allowed;
use super::caps::{Cap, Reason};
use super::course::{Course, Place};

/// The state at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct State {
    /// The speed in mm/s.
    pub speed: f64,
    /// The acceleration along the way in front of the place and behind it, in mm/s^2.
    pub acceleration: [f64; 2],
}

/// The profile with its accelerations from differences: where no jerk is limited, they may step at every place.
pub(super) fn as_it_is(course: &Course, speed: &[f64]) -> Vec<State> {
    let mean = |k: usize| {
        let step = course.places.get(k)?.step;
        (k > 0 && step > 0.0).then(|| (speed[k] * speed[k] - speed[k - 1] * speed[k - 1]) / (2.0 * step))
    };
    let sides = (0..speed.len()).map(|k| {
        let (before, behind) = (mean(k), mean(k + 1));
        State { speed: speed[k], acceleration: [before.or(behind).unwrap_or(0.0), behind.or(before).unwrap_or(0.0)] }
    });
    let mut states: Vec<State> = sides.collect();
    for k in 1..states.len() {
        // Both sides of a node.
        if course.places[k].step == 0.0 {
            states[k - 1].acceleration[1] = states[k].acceleration[1];
            states[k].acceleration[0] = states[k - 1].acceleration[0];
        }
    }
    states
}

/// The motion over a way of `step` from speed `v` and acceleration `a` at a constant jerk, up to the acceleration `top`: speed and
/// acceleration at its end.
fn climb([v, a]: [f64; 2], step: f64, jerk: f64, top: f64) -> [f64; 2] {
    if a >= top {
        return [(v * v + 2.0 * top.max(0.0) * step).sqrt(), top.max(0.0)];
    }
    // Until the top is reached, and the way of that.
    let until = (top - a) / jerk;
    let way = until * (v + until * (0.5 * a + until * jerk / 6.0));
    if way < step {
        let reached = v + until * (a + 0.5 * until * jerk);
        return [(reached * reached + 2.0 * top * (step - way)).sqrt(), top];
    }
    // step = v t + a t^2/2 + J t^3/6 grows and bends upwards: Newton's method from above never leaves it.
    let bounds = [step / v, (2.0 * step / a).sqrt(), (6.0 * step / jerk).cbrt(), until];
    let mut t = bounds.into_iter().filter(|t| t.is_finite()).fold(f64::INFINITY, f64::min);
    for _ in 0..20 {
        let excess = t * (v + t * (0.5 * a + t * jerk / 6.0)) - step;
        let rate = v + t * (a + 0.5 * t * jerk);
        if excess <= 1e-13 * step || rate <= 0.0 {
            break;
        }
        t -= excess / rate;
    }
    [v + t * (a + 0.5 * t * jerk), a + jerk * t]
}

/// Lowers `speed` so that the acceleration along the way changes by `jerk` at most, which holds on the way to each place.
pub(super) fn smooth(course: &Course, caps: &[Cap], allowed: &[Allowed], speed: &[f64], jerk: &[f64]) -> Vec<State> {
    let places = &course.places;
    let count = places.len();
    let mut lowered = speed.to_vec();
    // The acceleration with which a pass came to a place, where the pass decided.
    let mut known: Vec<Option<f64>> = vec![None; count];
    let mut a = 0.0;
    for k in 1..count {
        let step = places[k].step;
        if step == 0.0 {
            if places[k].is_rest {
                a = 0.0;
            }
            lowered[k] = lowered[k].min(lowered[k - 1]);
            known[k] = known[k - 1];
            continue;
        }
        let v = lowered[k - 1];
        let top = allowed[k - 1].most_at(v * v).min(allowed[k].most_at(v * v));
        let [reached, grown] = climb([v, a], step, jerk[k], top);
        if reached < lowered[k] {
            known[k - 1].get_or_insert(a);
            (lowered[k], a, known[k]) = (reached, grown, Some(grown));
        } else {
            a = ((lowered[k] * lowered[k] - v * v) / (2.0 * step)).clamp(0.0, grown);
        }
    }
    a = 0.0;
    for k in (1..count).rev() {
        let step = places[k].step;
        if step == 0.0 {
            if places[k].is_rest {
                a = 0.0;
            }
            if lowered[k] < lowered[k - 1] {
                (lowered[k - 1], known[k - 1]) = (lowered[k], known[k]);
            }
            continue;
        }
        let v = lowered[k];
        let top = (-allowed[k].least_at(v * v)).min(-allowed[k - 1].least_at(v * v));
        let [reached, grown] = climb([v, a], step, jerk[k], top);
        if reached < lowered[k - 1] {
            known[k].get_or_insert(-a);
            (lowered[k - 1], a, known[k - 1]) = (reached, grown, Some(-grown));
        } else {
            a = ((lowered[k - 1] * lowered[k - 1] - v * v) / (2.0 * step)).clamp(0.0, grown);
        }
    }
    // Both sides of a node once more: the pass backwards may have lowered the one behind.
    for k in 1..count {
        if places[k].step == 0.0 && lowered[k - 1] < lowered[k] {
            (lowered[k], known[k]) = (lowered[k - 1], known[k - 1]);
        }
    }
    // A corner that is passed as fast as it can be parts the motion: its velocity steps, and its acceleration may too.
    let at_corner = |k: usize| {
        places[k].is_rest
            || (parts(places, k)
                && matches!(caps[k].reason, Reason::Corner(_))
                && lowered[k] >= caps[k].speed * (1.0 - 1e-9))
    };
    let parted: Vec<bool> = (0..count).map(at_corner).collect();
    round_peaks(course, &lowered, &known, jerk, &parted)
}

/// Whether the way turns so sharply in front of place `k`, or rests, that the step of the velocity is what counts there.
pub(super) fn parts(places: &[Place], k: usize) -> bool {
    /// The sine of a turn from which on that is so: below it a chain of lines is run like a curve.
    const TURN: f64 = 0.1;
    let turn = |before: &Place| places[k].direction.cross(before.direction).abs();
    let before = k.checked_sub(1).and_then(|before| places.get(before));
    places[k].is_rest || (places[k].is_corner && before.is_some_and(|before| turn(before) > TURN))
}

/// The convex hull of x + D between corners, less D.
fn round_peaks(course: &Course, speed: &[f64], known: &[Option<f64>], jerk: &[f64], parted: &[bool]) -> Vec<State> {
    let mut states: Vec<State> = speed.iter().map(|&speed| State { speed, acceleration: [0.0; 2] }).collect();
    let mut from = 0;
    let borders = parted.iter().enumerate().skip(1).filter(|&(_, &parted)| parted).map(|(k, _)| k);
    for to in borders.chain([speed.len()]) {
        hull(course, &mut states, known, jerk, from, to);
        from = to;
    }
    states
}

/// A point of the way: one place, or the two that stand at a node.
struct Point {
    /// The way to it.
    way: f64,
    /// D and its slope.
    d: [f64; 2],
    /// v^2.
    square: f64,
    /// The acceleration that a pass knows.
    known: Option<f64>,
    first: usize,
    last: usize,
}

/// One stretch between corners: places `from..to`.
fn hull(course: &Course, states: &mut [State], known: &[Option<f64>], jerk: &[f64], from: usize, to: usize) {
    let mut points: Vec<Point> = Vec::with_capacity(to - from);
    let (mut way, mut slope, mut d) = (0.0, 0.0, 0.0);
    for k in from..to {
        let step = course.places[k].step;
        if k > from && step == 0.0 {
            if let Some(point) = points.last_mut() {
                point.last = k;
            }
            continue;
        }
        if k > from {
            // D'' = 2 J/v, with v = sqrt(x) and x linear: its mean over the step is 4 J/(v0 + v1), which is finite at a rest.
            let bend = 4.0 * jerk[k] / (states[k - 1].speed + states[k].speed);
            d += step * (slope + 0.5 * bend * step);
            slope += bend * step;
            way += step;
        }
        let square = states[k].speed * states[k].speed;
        points.push(Point { way, d: [d, slope], square, known: known[k], first: k, last: k });
    }
    let height = |point: &Point| point.square + point.d[0];
    let mut chain: Vec<usize> = Vec::with_capacity(points.len());
    for (k, point) in points.iter().enumerate() {
        while let [.., i, j] = chain[..] {
            let (before, middle) = (&points[i], &points[j]);
            let (left, right) = (middle.way - before.way, point.way - middle.way);
            // By more than its rounding above the chord: places on it stay.
            let above = (height(middle) - height(before)) * right - (height(point) - height(middle)) * left;
            if above <= 1e-12 * (height(before) + height(point)) * (left + right) {
                break;
            }
            chain.pop();
        }
        chain.push(k);
    }
    // The slope of the hull over each step that it lowers, by the point behind it.
    let mut rises: Vec<Option<f64>> = vec![None; points.len() + 1];
    for pair in chain.windows(2) {
        let &[i, j] = pair else { continue };
        if j == i + 1 {
            continue;
        }
        let start = height(&points[i]);
        let rise = (height(&points[j]) - start) / (points[j].way - points[i].way);
        rises[i + 1..=j].fill(Some(rise));
        let origin = points[i].way;
        for point in &mut points[i + 1..j] {
            let lowered = start + rise * (point.way - origin) - point.d[0];
            point.square = point.square.min(lowered.max(0.0));
        }
    }
    for k in 0..points.len() {
        // On the hull its own slope; elsewhere what the pass knows that made the profile, or a parabola through the neighbours.
        let elsewhere = points[k].known.unwrap_or_else(|| parabola(&points, k));
        let [before, behind] =
            [k, k + 1].map(|step| rises[step].map_or(elsewhere, |rise| 0.5 * (rise - points[k].d[1])));
        // Where the hull leaves the profile, the point of contact lies within a step: the mean is nearer to it than either.
        let state = State { speed: points[k].square.sqrt(), acceleration: [0.5 * (before + behind); 2] };
        states[points[k].first..=points[k].last].fill(state);
    }
}

/// The acceleration at a point from the mean ones of the steps before and behind it.
fn parabola(points: &[Point], k: usize) -> f64 {
    let mean = |i: usize, j: usize| {
        let (from, to) = (points.get(i)?, points.get(j)?);
        let way = to.way - from.way;
        Some(((to.square - from.square) / (2.0 * way), way))
    };
    match (k.checked_sub(1).and_then(|before| mean(before, k)), mean(k, k + 1)) {
        (Some((before, back)), Some((behind, on))) => (before * on + behind * back) / (back + on),
        (Some((mean, _)), None) | (None, Some((mean, _))) => mean,
        (None, None) => 0.0,
    }
}

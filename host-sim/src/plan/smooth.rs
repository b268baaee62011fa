//! Limits the jerk of a speed profile, by lowering it.
//!
//! Two passes let the speed grow, forwards and backwards from every valley, no faster than a jerk allows: each step is exact motion at
//! constant jerk, up to the acceleration that the place bears. What is left are peaks at which the acceleration drops at once. They are
//! cut by arcs of constant falling acceleration: with x = v^2, a profile with x'' >= -C is one for which x + D, D'' = C, is convex, so the
//! largest such profile below x is the convex hull of x + D, less D. C = 2 J/v depends on the speed that comes out: the hull is taken some
//! times, peak by peak, at last with the steps cut small where it touches the profile. All of it is linear in the number of places.

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
///
/// Over a step the acceleration goes on as it does to the neighbouring steps, by the less of the two differences, and not at all where they
/// have different signs.
pub(super) fn as_it_is(course: &Course, speed: &[f64]) -> Vec<State> {
    let places = &course.places;
    let steps: Vec<usize> = (1..places.len()).filter(|&k| places[k].step > 0.0).collect();
    let mean = |k: usize| (speed[k] * speed[k] - speed[k - 1] * speed[k - 1]) / (2.0 * places[k].step);
    let mut states: Vec<State> = speed.iter().map(|&speed| State { speed, acceleration: [f64::NAN; 2] }).collect();
    for (number, &k) in steps.iter().enumerate() {
        let here = mean(k);
        let slope = |before: usize, after: usize| {
            2.0 * (mean(after) - mean(before)) / (places[before].step + places[after].step)
        };
        let before = number.checked_sub(1).map(|before| slope(steps[before], k));
        let after = steps.get(number + 1).map(|&after| slope(k, after));
        let slope = match (before, after) {
            (Some(a), Some(b)) if a * b > 0.0 => a.abs().min(b.abs()) * a.signum(),
            _ => 0.0,
        };
        let half = 0.5 * places[k].step * slope;
        states[k - 1].acceleration[1] = here - half;
        states[k].acceleration[0] = here + half;
    }
    // Both sides of a node, and both ends.
    for k in 1..states.len() {
        if places[k].step == 0.0 {
            states[k - 1].acceleration[1] = states[k].acceleration[1];
            states[k].acceleration[0] = states[k - 1].acceleration[0];
        }
    }
    for state in &mut states {
        let [before, behind] = state.acceleration;
        let other = |a: f64, b: f64| if a.is_nan() { if b.is_nan() { 0.0 } else { b } } else { a };
        state.acceleration = [other(before, behind), other(behind, before)];
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
    /// A turn in radians from which on that is so: below it a chain of lines is run like a curve.
    const TURN: f64 = 0.1;
    let turn = |before: &Place| (places[k].direction - before.direction).norm();
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

/// A point of the way: one place, the two that stand at a node, or one within a step.
#[derive(Clone, Copy)]
struct Point {
    /// The way to it.
    way: f64,
    /// The jerk on the way to it.
    jerk: f64,
    /// The speed before the rounding, and after it.
    speed: [f64; 2],
    /// The acceleration before the rounding, and that of the hull where the hull lowers a step beside it.
    acceleration: (f64, Option<f64>),
    /// D and its slope.
    d: [f64; 2],
    /// The slope of the hull over the step to it, where the hull lowers that.
    rise: Option<f64>,
    /// The places: none within a step.
    places: Option<[usize; 2]>,
}

impl Point {
    fn height(&self) -> f64 {
        self.speed[0] * self.speed[0] + self.d[0]
    }
}

/// How often a peak is rounded: each time with the jerk that its speeds then allow.
const ROUNDINGS: usize = 4;

/// The part of a change of speeds that the next rounding goes by. Lower speeds make a sharper peak and that makes higher speeds: each
/// whole change is taken back by about a third in the next one.
const DAMPING: f64 = 0.75;

/// Steps near a point of contact, on each side of it, and the parts that each of them is cut into: the hull leaves the profile at a point, and
/// there the acceleration is off by what the jerk makes on a part.
const CONTACT: usize = 2;
const CUTS: usize = 8;

/// One stretch between corners: places `from..to`.
fn hull(course: &Course, states: &mut [State], known: &[Option<f64>], jerk: &[f64], from: usize, to: usize) {
    let mut points = points(course, states, known, jerk, from, to);
    let mut chain = Vec::with_capacity(points.len());
    lower(&mut points, &mut chain);
    // Peak by peak once more, from where the first rounding, which is the gentlest, leaves the profile.
    let mut start = 0;
    while start < points.len() {
        let lowered = points[start..].iter().take_while(|point| point.rise.is_some()).count();
        if lowered > 0 {
            let (low, high) = (start.saturating_sub(CONTACT), (start + lowered + 1).min(points.len()));
            round(&mut points[low..high], &mut chain);
        }
        start += lowered + 1;
    }
    for point in &points {
        let Some([first, last]) = point.places else { continue };
        let acceleration = point.acceleration.1.unwrap_or(point.acceleration.0);
        states[first..=last].fill(State { speed: point.speed[1], acceleration: [acceleration; 2] });
    }
}

fn points(
    course: &Course,
    states: &[State],
    known: &[Option<f64>],
    jerk: &[f64],
    from: usize,
    to: usize,
) -> Vec<Point> {
    let mut points: Vec<Point> = Vec::with_capacity(to - from);
    let mut way = 0.0;
    for k in from..to {
        let step = course.places[k].step;
        if k > from && step == 0.0 {
            if let Some(Point { places: Some([_, last]), .. }) = points.last_mut() {
                *last = k;
            }
            continue;
        }
        way += if k > from { step } else { 0.0 };
        points.push(Point {
            way,
            jerk: jerk[k],
            speed: [states[k].speed; 2],
            acceleration: (known[k].unwrap_or(f64::NAN), None),
            d: [0.0; 2],
            rise: None,
            places: Some([k; 2]),
        });
    }
    // Where no pass made the profile, it is a parabola through the neighbours.
    for k in 0..points.len() {
        if points[k].acceleration.0.is_nan() {
            points[k].acceleration.0 = parabola(&points, k);
        }
    }
    points
}

/// Rounds a peak that was rounded once, and whatever else the hull lowers there.
fn round(peak: &mut [Point], chain: &mut Vec<usize>) {
    let mut assumed: Vec<f64> = peak.iter().map(|point| point.speed[0]).collect();
    let mut assume = |peak: &mut [Point]| {
        for (assumed, point) in assumed.iter_mut().zip(peak.iter_mut()) {
            *assumed += DAMPING * (point.speed[1] - *assumed);
            point.speed[1] = *assumed;
            point.rise = None;
        }
    };
    for _ in 2..ROUNDINGS {
        assume(peak);
        lower(peak, chain);
    }
    // Steps that are lowered, or not, unlike a neighbour of theirs.
    let is_lowered = |k: usize| peak.get(k).is_some_and(|point| point.rise.is_some());
    let is_contact = |k: usize| (k.saturating_sub(CONTACT)..k + CONTACT).any(|k| is_lowered(k) != is_lowered(k + 1));
    let cuts: Vec<bool> = (0..peak.len()).map(is_contact).collect();
    assume(peak);
    let mut fine: Vec<Point> = Vec::with_capacity(peak.len() + 4 * CONTACT * CUTS);
    for (k, point) in peak.iter().enumerate() {
        if k > 0 && cuts[k] {
            fine.extend((1..CUTS).map(|cut| between(&peak[k - 1], point, cut as f64 / CUTS as f64)));
        }
        fine.push(*point);
    }
    lower(&mut fine, chain);
    let mut real = peak.iter_mut();
    for (k, point) in fine.iter().enumerate() {
        if point.places.is_none() {
            continue;
        }
        if let Some(real) = real.next() {
            *real = *point;
            let on_hull = |rise: f64| 0.5 * (rise - point.d[1]);
            let behind = fine.get(k + 1).and_then(|point| point.rise).map(on_hull);
            let elsewhere = point.acceleration.0;
            real.acceleration.1 = match (point.rise.map(on_hull), behind) {
                (None, None) => None,
                (before, behind) => Some(0.5 * (before.unwrap_or(elsewhere) + behind.unwrap_or(elsewhere))),
            };
        }
    }
}

/// A point within the step from one to another: v^2 is a cubic of the way.
fn between(before: &Point, after: &Point, part: f64) -> Point {
    let step = after.way - before.way;
    let mean = |a: f64, b: f64| a + (b - a) * part;
    let squares = [before, after].map(|point| point.speed[0] * point.speed[0]);
    // Off the chord, by the slopes 2 a at both ends.
    let chord = squares[1] - squares[0];
    let [low, high] = [2.0 * before.acceleration.0 * step - chord, chord - 2.0 * after.acceleration.0 * step];
    let rest = 1.0 - part;
    let square = mean(squares[0], squares[1]) + part * rest * (rest * low + part * high);
    Point {
        way: mean(before.way, after.way),
        speed: [square.max(0.0).sqrt(), mean(before.speed[1], after.speed[1])],
        places: None,
        rise: None,
        ..*after
    }
}

/// Lowers points to the hull: of the first speeds, with the jerk that the second ones allow.
fn lower(points: &mut [Point], chain: &mut Vec<usize>) {
    let (mut slope, mut d) = (0.0, 0.0);
    for k in 1..points.len() {
        let step = points[k].way - points[k - 1].way;
        // D'' = 2 J/v, with v = sqrt(x) and x linear: its mean over the step is 4 J/(v0 + v1), which is finite at a rest.
        let bend = 4.0 * points[k].jerk / (points[k - 1].speed[1] + points[k].speed[1]);
        d += step * (slope + 0.5 * bend * step);
        slope += bend * step;
        points[k].d = [d, slope];
    }
    chain.clear();
    for (k, point) in points.iter().enumerate() {
        while let [.., i, j] = chain[..] {
            let (before, middle) = (&points[i], &points[j]);
            let (left, right) = (middle.way - before.way, point.way - middle.way);
            // By more than its rounding above the chord: places on it stay.
            let above = (middle.height() - before.height()) * right - (point.height() - middle.height()) * left;
            if above <= 1e-12 * (before.height() + point.height()) * (left + right) {
                break;
            }
            chain.pop();
        }
        chain.push(k);
    }
    points.iter_mut().for_each(|point| point.speed[1] = point.speed[0]);
    for pair in chain.windows(2) {
        let &[i, j] = pair else { continue };
        if j == i + 1 {
            continue;
        }
        let (origin, start) = (points[i].way, points[i].height());
        let rise = (points[j].height() - start) / (points[j].way - origin);
        points[i + 1..=j].iter_mut().for_each(|point| point.rise = Some(rise));
        for point in &mut points[i + 1..j] {
            let lowered = start + rise * (point.way - origin) - point.d[0];
            point.speed[1] = point.speed[0].min(lowered.max(0.0).sqrt());
        }
    }
}

/// The acceleration at a point from the mean ones of the steps before and behind it.
fn parabola(points: &[Point], k: usize) -> f64 {
    let mean = |i: usize, j: usize| {
        let (from, to) = (points.get(i)?, points.get(j)?);
        let way = to.way - from.way;
        Some(((to.speed[1] + from.speed[1]) * (to.speed[1] - from.speed[1]) / (2.0 * way), way))
    };
    match (k.checked_sub(1).and_then(|before| mean(before, k)), mean(k, k + 1)) {
        (Some((before, back)), Some((behind, on))) => (before * on + behind * back) / (back + on),
        (Some((mean, _)), None) | (None, Some((mean, _))) => mean,
        (None, None) => 0.0,
    }
}

//! How far a fitted curve and its polyline are apart, by samples: nothing here is shared with the code that fits.

use host_sim::fit::{Curve, Part};
use host_sim::vector::Vector;

/// Samples of each curve.
const SAMPLES: usize = 48;

/// Points of the polyline looked at on each of its segments, with its start.
const ON_SEGMENT: usize = 3;

/// The largest distance of sampled points of the parts from the polyline, and of sampled points of the polyline from the parts, in mm.
pub fn two_sided(points: &[Vector], parts: &[Part]) -> [f64; 2] {
    let mut worst = [0.0_f64; 2];
    for part in parts {
        // A part's ends lie on the segments at its vertices, or on their neighbours.
        let [first, last] = part.vertices;
        let near = &points[first.saturating_sub(2)..(last + 3).min(points.len())];
        for k in 0..=SAMPLES {
            let point = at(&part.curve, k as f64 / SAMPLES as f64);
            let segments = near.windows(2).map(|ends| distance(point, ends[0], ends[1]));
            worst[0] = worst[0].max(segments.fold(f64::INFINITY, f64::min));
        }
    }
    let mut from = 0;
    for (k, ends) in points.windows(2).enumerate() {
        while from + 1 < parts.len() && parts[from].vertices[1] + 1 < k {
            from += 1;
        }
        let near: Vec<&Part> = parts[from..].iter().take_while(|part| part.vertices[0] <= k + 1).collect();
        for step in 0..ON_SEGMENT {
            let part = step as f64 / ON_SEGMENT as f64;
            let point = mix(ends[0], ends[1], part);
            let nearest = near.iter().map(|part| to_curve(point, &part.curve)).fold(f64::INFINITY, f64::min);
            worst[1] = worst[1].max(nearest);
        }
    }
    worst
}

/// By the nearest of some samples, and thirds of the interval around it.
fn to_curve(point: Vector, curve: &Curve) -> f64 {
    let off = |t: f64| length(sub(at(curve, t), point));
    let best = (0..=SAMPLES).min_by(|&a, &b| off(a as f64 / SAMPLES as f64).total_cmp(&off(b as f64 / SAMPLES as f64)));
    let best = best.unwrap_or(0) as f64;
    let [mut low, mut high] = [best - 1.0, best + 1.0].map(|k| (k / SAMPLES as f64).clamp(0.0, 1.0));
    for _ in 0..80 {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if off(a) < off(b) { high = b } else { low = a }
    }
    off(0.5 * (low + high))
}

/// A point by the Bernstein polynomials themselves.
fn at(curve: &Curve, t: f64) -> Vector {
    let points: Vec<[f64; 3]> = match curve {
        Curve::Line(line) => line.points.iter().map(|p| p.0).collect(),
        Curve::Cubic(cubic) => cubic.points.iter().map(|p| p.0).collect(),
        Curve::Ph(ph) => return preimage(ph, t),
        Curve::Arc(arc) => {
            let [x, y, z] = arc.start.0;
            let (radius, angle) =
                ((x - arc.centre[0]).hypot(y - arc.centre[1]), (y - arc.centre[1]).atan2(x - arc.centre[0]));
            let angle = angle + arc.sweep * t;
            return Vector([
                arc.centre[0] + radius * angle.cos(),
                arc.centre[1] + radius * angle.sin(),
                z + arc.rise * t,
            ]);
        }
    };
    let degree = points.len() as i32 - 1;
    let mut sum = [0.0; 3];
    let mut binomial = 1.0;
    for (k, point) in points.iter().enumerate() {
        let part = binomial * t.powi(k as i32) * (1.0 - t).powi(degree - k as i32);
        for axis in 0..3 {
            sum[axis] += part * point[axis];
        }
        binomial = binomial * f64::from(degree - k as i32) / (k as f64 + 1.0);
    }
    Vector(sum)
}

/// The integral of w^2 by Gauss and Legendre with three points, which is exact for degree 5; z by its polynomial.
fn preimage(ph: &host_sim::fit::ph::RisingPh, t: f64) -> Vector {
    let [w0, w1, w2] = ph.plane.w;
    let half = 0.5 * t;
    let root = (0.6_f64).sqrt();
    let mut sum = [ph.plane.start.re, ph.plane.start.im];
    for (node, weight) in [(-root, 5.0 / 9.0), (0.0, 8.0 / 9.0), (root, 5.0 / 9.0)] {
        let x = half + half * node;
        let w = w0 * ((1.0 - x) * (1.0 - x)) + w1 * (2.0 * x * (1.0 - x)) + w2 * (x * x);
        let square = w * w;
        sum[0] += half * weight * square.re;
        sum[1] += half * weight * square.im;
    }
    let mut z = ph.z;
    for left in (1..z.len()).rev() {
        for k in 0..left {
            z[k] += (z[k + 1] - z[k]) * t;
        }
    }
    Vector([sum[0], sum[1], z[0]])
}

fn sub(a: Vector, b: Vector) -> [f64; 3] {
    [a.0[0] - b.0[0], a.0[1] - b.0[1], a.0[2] - b.0[2]]
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn mix(a: Vector, b: Vector, part: f64) -> Vector {
    let across = sub(b, a);
    Vector([a.0[0] + across[0] * part, a.0[1] + across[1] * part, a.0[2] + across[2] * part])
}

fn distance(point: Vector, a: Vector, b: Vector) -> f64 {
    let (along, off) = (sub(b, a), sub(point, a));
    let square: f64 = along.iter().map(|x| x * x).sum();
    let part: f64 = along.iter().zip(off).map(|(x, y)| x * y).sum::<f64>() / square;
    length(sub(point, mix(a, b, part.clamp(0.0, 1.0))))
}

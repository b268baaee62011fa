//! Closed contours as parts have them, and some with many or extreme segments.

use std::f64::consts::{PI, TAU};

use shared::complex::Complex;

use super::{Drawn, mixed};
use crate::chain::Chain;
use crate::random::{Random, unit};

/// Points around the origin, at growing angles and at radii in `low..high`.
fn around(random: &mut Random, count: usize, low: f64, high: f64) -> Vec<Complex<f64>> {
    let shift = random.within(0.0, TAU);
    (0..count)
        .map(|k| {
            let angle = shift + (k as f64 + random.within(-0.35, 0.35)) * TAU / count as f64;
            unit(angle) * random.within(low, high)
        })
        .collect()
}

/// A mix of everything around a middle.
pub(super) fn blob(random: &mut Random) -> Drawn {
    let count = random.whole(2, 14);
    let low = random.pick(&[0.2, 0.5, 0.8]);
    let points = around(random, count.max(3), low, 1.0);
    let smooth = random.pick(&[0.0, 0.3, 0.8]);
    Drawn { contour: mixed(random, &points, true, smooth, 0.0), special: Vec::new() }
}

/// Every node smooth where it can be.
pub(super) fn smooth_blob(random: &mut Random) -> Drawn {
    let count = random.whole(3, 10);
    let points = around(random, count, 0.4, 1.0);
    Drawn { contour: mixed(random, &points, true, 1.0, 0.0), special: Vec::new() }
}

/// Nodes that turn by 1e-12 to 1e-3.
pub(super) fn nearly_smooth_blob(random: &mut Random) -> Drawn {
    let count = random.whole(3, 10);
    let points = around(random, count, 0.4, 1.0);
    let angle = random.scale(1e-12, 1e-3);
    Drawn { contour: mixed(random, &points, true, 1.0, angle), special: Vec::new() }
}

/// A polygon with tangent fillets of one radius at most corners; convex and concave ones.
pub(super) fn filleted_polygon(random: &mut Random) -> Drawn {
    let count = random.whole(3, 9);
    let corners = around(random, count, 0.4, 1.0);
    let radius = random.scale(0.01, 0.2);
    let share = random.pick(&[0.5, 1.0]);
    let second = random.pick(&[1.0, 1.0, 0.5, 2.0]);
    let radii: Vec<_> = (0..count)
        .map(|_| if random.chance(share) { radius * if random.chance(0.5) { 1.0 } else { second } } else { 0.0 })
        .collect();
    Drawn { contour: filleted(&corners, |k| radii[k]), special: vec![radius, radius, second * radius] }
}

/// The polygon through `corners` with a fillet of its own radius at each one; no fillet for the radius zero. Fillets that do
/// not fit make it cross itself.
fn filleted(corners: &[Complex<f64>], radius: impl Fn(usize) -> f64) -> crate::Contour {
    let count = corners.len();
    let heading = |k: usize| {
        let chord = corners[(k + 1) % count] - corners[k % count];
        chord * (1.0 / chord.norm())
    };
    let tangent = |k: usize| {
        let turn = (heading(k + count - 1).conj() * heading(k)).arg();
        (turn, radius(k % count) * (0.5 * turn).tan().abs())
    };
    let mut chain = Chain::at(corners[0] + heading(0) * tangent(0).1);
    for k in 1..=count {
        let (turn, cut) = tangent(k % count);
        let corner = corners[k % count];
        chain = chain.line(corner - heading(k - 1) * cut);
        if cut > 0.0 {
            chain = chain.bow(corner + heading(k % count) * cut, turn);
        }
    }
    chain.closed_as_it_is()
}

/// A regular star; every event happens at all its points at once.
pub(super) fn star(random: &mut Random) -> Drawn {
    let points = random.whole(3, 9);
    let inner = random.within(0.2, 0.8);
    let turn = random.pick(&[0.0, PI / 2.0, 0.1]);
    let corners: Vec<_> = (0..2 * points)
        .map(|k| unit(turn + PI * k as f64 / points as f64) * if k % 2 == 0 { 1.0 } else { inner })
        .collect();
    // The distance of the inner corners' neighbours from the centre line, and of the edges from the centre.
    let edge = (corners[1] - corners[0]) * (1.0 / (corners[1] - corners[0]).norm());
    let special = vec![edge.cross(corners[0]).abs(), inner * (PI / points as f64).sin()];
    let contour = match random.whole(0, 2) {
        0 => Chain::through(&corners).close(),
        1 => {
            let sweep = random.within(-0.8, 0.8);
            bowed(&corners, |k| if k % 2 == 0 { sweep } else { -sweep })
        }
        _ => {
            let sweep = random.within(-0.8, 0.8);
            bowed(&corners, |_| sweep)
        }
    };
    Drawn { contour, special }
}

/// The polygon with an arc instead of every edge.
fn bowed(corners: &[Complex<f64>], sweep: impl Fn(usize) -> f64) -> crate::Contour {
    (0..corners.len())
        .fold(Chain::at(corners[0]), |chain, k| chain.bow(corners[(k + 1) % corners.len()], sweep(k)))
        .closed_as_it_is()
}

/// Long thin points outwards and inwards.
pub(super) fn spikes(random: &mut Random) -> Drawn {
    let count = random.whole(2, 5);
    let mut points = Vec::new();
    for k in 0..count {
        let middle = TAU * k as f64 / count as f64;
        let width = random.scale(1e-3, 0.2) * TAU / count as f64;
        let tip = if random.chance(0.5) { random.within(1.3, 3.0) } else { random.within(0.05, 0.7) };
        points.extend([unit(middle - width), unit(middle) * tip, unit(middle + width)]);
    }
    let smooth = random.pick(&[0.0, 0.0, 0.5]);
    let contour =
        if random.chance(0.5) { Chain::through(&points).close() } else { mixed(random, &points, true, smooth, 0.0) };
    Drawn { contour, special: Vec::new() }
}

/// Teeth between two circles, with arcs along both.
pub(super) fn gear(random: &mut Random) -> Drawn {
    let teeth = random.whole(3, 16);
    let (inner, outer) = (random.within(0.5, 0.95), 1.0);
    let pitch = TAU / teeth as f64;
    let share = random.within(0.25, 0.7);
    let lean = random.within(0.0, 0.15) * pitch;
    let mut chain = Chain::at(unit(0.0) * outer);
    for k in 0..teeth {
        let angle = k as f64 * pitch;
        chain = chain
            .bow(unit(angle + share * pitch - lean) * outer, share * pitch - lean)
            .line(unit(angle + share * pitch) * inner)
            .bow(unit(angle + pitch - lean) * inner, (1.0 - share) * pitch - lean)
            .line(unit(if k + 1 == teeth { 0.0 } else { angle + pitch }) * outer);
    }
    let gap = inner * (0.5 * ((1.0 - share) * pitch - lean)).sin();
    let tooth = outer * (0.5 * (share * pitch - lean)).sin();
    Drawn { contour: chain.closed_as_it_is(), special: vec![gap, tooth, inner, outer - inner] }
}

/// Fingers of one width and gaps of one width, with flat or round ends.
pub(super) fn comb(random: &mut Random) -> Drawn {
    let fingers = random.whole(2, 8);
    let [finger, gap, depth] = [random.scale(0.05, 0.3), random.scale(0.05, 0.3), random.within(0.3, 1.5)];
    let back = random.within(0.1, 0.5);
    let round = random.pick(&[0, 1, 2, 3]);
    let at = |x: f64, y: f64| Complex::new(x, y);
    let mut chain = Chain::at(at(0.0, depth));
    let mut x = 0.0;
    for k in 0..fingers {
        x += finger;
        chain = if round & 1 == 1 { chain.bow(at(x, depth), -PI) } else { chain.line(at(x, depth)) };
        if k + 1 == fingers {
            break;
        }
        chain = chain.line(at(x, 0.0));
        x += gap;
        chain = if round & 2 == 2 { chain.bow(at(x, 0.0), PI) } else { chain.line(at(x, 0.0)) };
        chain = chain.line(at(x, depth));
    }
    let far = -back - gap;
    let contour = chain.line(at(x, far)).line(at(0.0, far)).close();
    Drawn { contour, special: vec![0.5 * finger, 0.5 * gap, 0.5 * gap, 0.5 * (back + gap)] }
}

/// A smooth figure as a polygon of up to 120 edges, as CAM programs write it, or a noisy one.
pub(super) fn fine_polygon(random: &mut Random) -> Drawn {
    let count = random.whole(20, 120);
    let noise = random.pick(&[0.0, 1e-9, 1e-3, 0.02]);
    let (lobes, depth) = (random.whole(1, 5) as f64, random.within(0.0, 0.5));
    let points: Vec<_> = (0..count)
        .map(|k| {
            let angle = TAU * k as f64 / count as f64;
            unit(angle) * (1.0 + depth * (lobes * angle).cos() + noise * random.within(-1.0, 1.0))
        })
        .collect();
    Drawn { contour: Chain::through(&points).close(), special: vec![1.0 - depth] }
}

/// A wavy ring of many segments of all kinds.
pub(super) fn many(random: &mut Random) -> Drawn {
    let count = random.whole(60, 250);
    let (waves, depth) = (random.whole(2, 9) as f64, random.within(0.05, 0.4));
    let noise = 0.5 / count as f64;
    let points: Vec<_> = (0..count)
        .map(|k| {
            let angle = TAU * k as f64 / count as f64;
            unit(angle) * (1.0 + depth * (waves * angle).cos() + noise * random.within(-1.0, 1.0))
        })
        .collect();
    let smooth = random.pick(&[0.0, 0.7, 1.0]);
    Drawn { contour: mixed(random, &points, true, smooth, 0.0), special: vec![1.0 - depth, TAU / count as f64] }
}

/// A figure whose edges are cut, some of them into very short segments: nodes that nearly repeat.
pub(super) fn tiny_segments(random: &mut Random) -> Drawn {
    let count = random.whole(3, 7);
    let corners = around(random, count, 0.5, 1.0);
    let mut points = Vec::new();
    let jitter = random.pick(&[0.0, 0.0, 0.3]);
    for (k, corner) in corners.iter().enumerate() {
        let chord = corners[(k + 1) % count] - *corner;
        points.push(*corner);
        let mut cuts: Vec<f64> = (0..random.whole(0, 4)).map(|_| random.unit()).collect();
        if random.chance(0.7) {
            let tiny = random.scale(1e-7, 1e-3);
            let near = random.pick(&[0.0, 0.5, 0.99]);
            cuts.extend([near + tiny, near + 2.0 * tiny]);
        }
        cuts.sort_by(f64::total_cmp);
        for pair in 0..cuts.len() {
            // Off the edge by less than the distance to the next cut.
            let room = cuts.get(pair + 1).map_or(1.0 - cuts[pair], |next| next - cuts[pair]).min(cuts[pair]);
            let aside = chord.left() * (jitter * room * random.within(-1.0, 1.0));
            points.push(*corner + chord * cuts[pair] + aside);
        }
    }
    let contour =
        if random.chance(0.6) { Chain::through(&points).close() } else { mixed(random, &points, true, 0.5, 0.0) };
    Drawn { contour, special: Vec::new() }
}

/// A polygon whose edges are arcs of radii up to 1e9 sizes.
pub(super) fn flat_arcs(random: &mut Random) -> Drawn {
    let count = random.whole(3, 8);
    let corners = around(random, count, 0.5, 1.0);
    let sweeps: Vec<f64> = (0..count).map(|_| random.sign() * random.scale(1e-9, 0.1)).collect();
    Drawn { contour: bowed(&corners, |k| sweeps[k]), special: Vec::new() }
}

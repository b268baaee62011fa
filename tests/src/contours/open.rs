//! Open contours: their offsets end square, and are trimmed against themselves.

use std::f64::consts::{PI, TAU};

use shared::complex::Complex;

use super::{Drawn, mixed};
use crate::chain::Chain;
use crate::contours::closed;
use crate::random::{Random, unit};

/// Points that wander on without turning back much.
fn wander(random: &mut Random, count: usize, most: f64) -> Vec<Complex<f64>> {
    let mut at = Complex::ZERO;
    let mut heading = random.within(0.0, TAU);
    let mut points = vec![at];
    for _ in 1..count {
        heading += random.within(-most, most);
        at = at + unit(heading) * random.scale(0.1, 1.0);
        points.push(at);
    }
    points
}

/// A mix of everything along a way.
pub(super) fn walk(random: &mut Random) -> Drawn {
    let count = random.whole(2, 12);
    let points = wander(random, count, 1.6);
    let smooth = random.pick(&[0.0, 0.4, 0.9]);
    Drawn { contour: mixed(random, &points, false, smooth, 0.0), special: vec![] }
}

/// A smooth or nearly smooth way.
pub(super) fn smooth_walk(random: &mut Random) -> Drawn {
    let count = random.whole(3, 9);
    let points = wander(random, count, 1.2);
    let angle = if random.chance(0.5) { 0.0 } else { random.scale(1e-12, 1e-3) };
    Drawn { contour: mixed(random, &points, false, 1.0, angle), special: vec![] }
}

/// Forth and back, regular or not.
pub(super) fn zigzag(random: &mut Random) -> Drawn {
    let count = random.whole(2, 9);
    let (pitch, height) = (random.scale(0.02, 1.0), 1.0);
    let irregular = random.pick(&[0.0, 0.0, 0.3]);
    let points: Vec<_> = (0..=count)
        .map(|k| {
            let y = if k % 2 == 0 { 0.0 } else { height };
            Complex::new(k as f64 * pitch, y * (1.0 - irregular * random.unit()))
        })
        .collect();
    // The inscribed circle of a triangle of two edges and the line across.
    let edge = (pitch * pitch + height * height).sqrt();
    Drawn { contour: Chain::through(&points).open(), special: vec![pitch * height / (edge + pitch), 0.5 * pitch] }
}

/// Half circles of growing radius: one gap all the way; or a polygon or a PH chain along a spiral.
pub(super) fn spiral(random: &mut Random) -> Drawn {
    let halves = random.whole(2, 7);
    let pitch = random.within(0.1, 0.5);
    let first = random.within(0.2, 1.0);
    let style = random.whole(0, 2);
    if style == 0 {
        let mut chain = Chain::at(Complex::new(first, 0.0));
        for k in 0..halves {
            let radius = first + 0.5 * pitch * k as f64;
            let centre = Complex::new(if k % 2 == 0 { chain.end().re - radius } else { chain.end().re + radius }, 0.0);
            chain = chain.turn(centre, PI);
        }
        return Drawn { contour: chain.open(), special: vec![0.5 * pitch, first] };
    }
    let steps = halves * random.whole(2, 8);
    let at = |k: usize| {
        let angle = PI * halves as f64 * k as f64 / steps as f64;
        unit(angle) * (first + pitch * angle / TAU)
    };
    let points: Vec<_> = (0..=steps).map(at).collect();
    let contour = if style == 1 { Chain::through(&points).open() } else { mixed(random, &points, false, 1.0, 0.0) };
    Drawn { contour, special: vec![0.5 * pitch, first] }
}

/// Most of a circle.
pub(super) fn ring(random: &mut Random) -> Drawn {
    let mouth = random.scale(1e-3, 2.0);
    let mut chain = Chain::at(unit(0.5 * mouth));
    let parts = random.whole(1, 3);
    for _ in 0..parts {
        chain = chain.turn(Complex::ZERO, (TAU - mouth) / parts as f64);
    }
    if random.chance(0.3) {
        // A straight lip on one end.
        let lip = unit(-0.5 * mouth).left() * random.pick(&[0.2, 1.0]);
        let end = chain.end() + lip;
        chain = chain.line(end);
    }
    Drawn { contour: chain.open(), special: vec![1.0, (0.5 * mouth).sin(), (0.5 * mouth).tan()] }
}

/// One segment.
pub(super) fn single(random: &mut Random) -> Drawn {
    let start = Chain::at(Complex::ZERO);
    let (contour, special) = match random.whole(0, 3) {
        0 => (start.line(Complex::new(1.0, 0.0)), vec![]),
        1 => (start.bow(Complex::new(1.0, 0.0), random.sign() * random.within(0.01, 6.0)), vec![]),
        2 => {
            let d0 = random.direction() * random.within(0.5, 4.0);
            (start.hermite(Complex::new(1.0, 0.0), d0, random.direction() * random.within(0.5, 4.0)), vec![])
        }
        _ => {
            // A symmetric bend.
            let a = random.within(0.2, 3.0);
            let at = |x: f64| Complex::new(1.0, a * x);
            (start.ph([at(-1.0), at(0.0), at(1.0)]), vec![0.25 / a])
        }
    };
    Drawn { contour: contour.open(), special }
}

/// A closed figure that lacks its last segment.
pub(super) fn opened(random: &mut Random) -> Drawn {
    let mut drawn = match random.whole(0, 3) {
        0 => closed::blob(random),
        1 => closed::filleted_polygon(random),
        2 => closed::comb(random),
        _ => closed::smooth_blob(random),
    };
    drawn.contour.closed = false;
    if drawn.contour.segments.len() > 1 {
        drawn.contour.segments.pop();
    }
    drawn
}

//! Contours that are as wide as the tool in places, and symmetric ones: where events fall together.

use std::f64::consts::{PI, TAU};

use shared::complex::Complex;
use shared::curve::{Curve as _, Segment, hermite};

use super::Drawn;
use crate::Contour;
use crate::chain::{Chain, Placing, reversed};
use crate::random::{Random, unit};

fn at(x: f64, y: f64) -> Complex<f64> {
    Complex::new(x, y)
}

/// The outline of some joined squares of a lattice: everything is a multiple of one length. Corners are sharp or all rounded.
pub(super) fn polyomino(random: &mut Random) -> Drawn {
    const SIDE: usize = 9;
    let mut cells = [[false; SIDE]; SIDE];
    cells[SIDE / 2][SIDE / 2] = true;
    let mut left = random.whole(0, 14);
    for _ in 0..400 {
        let (i, j) = (random.whole(1, SIDE - 2), random.whole(1, SIDE - 2));
        // A square may join if its neighbours around it are one run: then there is neither a hole nor a touching corner.
        let ring = [(0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1)]
            .map(|(di, dj): (i32, i32)| cells[i.wrapping_add_signed(di as isize)][j.wrapping_add_signed(dj as isize)]);
        let changes = (0..8).filter(|&k| ring[k] != ring[(k + 1) % 8]).count();
        let joins = ring[0] || ring[2] || ring[4] || ring[6];
        if left > 0 && !cells[i][j] && changes == 2 && joins {
            cells[i][j] = true;
            left -= 1;
        }
    }
    let corners = outline(&cells, random.chance(0.3));
    let contour = if random.chance(0.7) {
        Chain::through(&corners).close()
    } else {
        rounded(&corners, random.pick(&[0.25, 0.5, 0.1]))
    };
    Drawn { contour, special: vec![0.5, 0.5, 1.0, 0.25, 1.5] }
}

/// The boundary of a set of squares, anticlockwise; with every lattice node, or its corners only.
fn outline<const N: usize>(cells: &[[bool; N]; N], every: bool) -> Vec<Complex<f64>> {
    let filled = |x: isize, y: isize| {
        let range = 0..N as isize;
        range.contains(&x) && range.contains(&y) && cells[x as usize][y as usize]
    };
    // From the left side of the lowest square of the leftmost column that has any, down that side.
    let first = (0..N as isize * N as isize).map(|k| (k / N as isize, k % N as isize)).find(|(x, y)| filled(*x, *y));
    let Some((x0, y0)) = first else { return Vec::new() };
    let (mut x, mut y, mut dx, mut dy) = (x0, y0, 1, 0);
    let mut corners = vec![at(x as f64, y as f64)];
    loop {
        (x, y) = (x + dx, y + dy);
        // The squares ahead on the left and on the right of travel.
        let cell = |side: isize| {
            let (ahead_x, ahead_y) = (2 * x + dx - side * dy, 2 * y + dy + side * dx);
            filled((ahead_x - 1).div_euclid(2), (ahead_y - 1).div_euclid(2))
        };
        let before = (dx, dy);
        if !cell(1) {
            (dx, dy) = (-dy, dx);
        } else if cell(-1) {
            (dx, dy) = (dy, -dx);
        }
        if (x, y) == (x0, y0) {
            return corners;
        }
        if every || before != (dx, dy) {
            corners.push(at(x as f64, y as f64));
        }
    }
}

/// A lattice polygon with quarter circles at its corners.
fn rounded(corners: &[Complex<f64>], radius: f64) -> Contour {
    let count = corners.len();
    let heading = |k: usize| {
        let chord = corners[(k + 1) % count] - corners[k % count];
        chord * (1.0 / chord.norm())
    };
    let mut chain = Chain::at(corners[0] + heading(0) * radius);
    for k in 1..=count {
        let corner = corners[k % count];
        let (before, after) = (heading(k - 1), heading(k % count));
        let start = corner - before * radius;
        if (start - chain.end()).norm() > 1e-9 {
            chain = chain.line(start);
        }
        let turn = (before.conj() * after).arg();
        chain = if turn.abs() > 0.1 {
            chain.bow(corner + after * radius, turn)
        } else {
            chain.line(corner + after * radius)
        };
    }
    chain.closed_as_it_is()
}

/// Two half circles and two lines, which may be cut; its width is everywhere the same.
pub(super) fn slot(random: &mut Random) -> Drawn {
    let (width, length) = (1.0, random.scale(0.1, 20.0));
    let cuts = random.whole(1, 4);
    let side = |mut chain: Chain, to: Complex<f64>, cuts: usize| {
        let from = chain.end();
        for k in 1..=cuts {
            chain = chain.line(from + (to - from) * (k as f64 / cuts as f64));
        }
        chain
    };
    let square = random.chance(0.2);
    let end = |chain: Chain, to: Complex<f64>| if square { chain.line(to) } else { chain.bow(to, PI) };
    let chain = side(Chain::at(at(0.0, 0.0)), at(length, 0.0), cuts);
    let chain = end(chain, at(length, width));
    let chain = side(chain, at(0.0, width), cuts + random.whole(0, 1));
    Drawn { contour: end(chain, at(0.0, 0.0)).closed_as_it_is(), special: vec![0.5 * width] }
}

/// Two discs and a straight neck between them.
pub(super) fn bone(random: &mut Random) -> Drawn {
    let neck = random.scale(1e-9, 0.8);
    let second = if random.chance(0.6) { 1.0 } else { random.within(0.5, 2.0) };
    let length = random.scale(0.05, 4.0);
    // A disc's arc from neck side to neck side.
    let angle = |radius: f64| (0.5 * neck / radius).asin();
    let (a, b) = (angle(1.0), angle(second));
    let right = length + second * b.cos();
    let chain = Chain::at(at(0.0, -0.5 * neck))
        .line(at(length, -0.5 * neck))
        .turn(at(right, 0.0), TAU - 2.0 * b)
        .line(at(0.0, 0.5 * neck))
        .bow(at(0.0, -0.5 * neck), TAU - 2.0 * a);
    Drawn { contour: chain.closed_as_it_is(), special: vec![0.5 * neck, 0.5 * neck, 1.0, second] }
}

/// A waist between two smooth sides that mirror each other.
pub(super) fn hourglass(random: &mut Random) -> Drawn {
    let waist = random.scale(1e-6, 0.5);
    let height = random.within(0.5, 2.0);
    let foot = waist + random.within(0.1, 1.0);
    let up = at(0.0, random.within(0.5, 1.5) * height);
    let side = Chain::at(at(foot, -height));
    let lean = at(-random.within(0.0, 1.0), 1.0) * height;
    let side = match random.whole(0, 2) {
        0 => side.hermite(at(waist, 0.0), lean, up).hermite(at(foot, height), up, at(-lean.re, lean.im)),
        1 => {
            // One arc over the whole side, touching the waist in its middle.
            let rise = foot - waist;
            side.bow(at(foot, height), -4.0 * (rise / height).atan())
        }
        _ => side.line(at(waist, 0.0)).line(at(foot, height)),
    };
    let right = side.open();
    let left = reversed(&Placing::mirror_x().contour(&right));
    let contour =
        Chain::at(at(-foot, -height)).line(at(foot, -height)).then(&right).line(at(-foot, height)).then(&left);
    Drawn { contour: contour.closed_as_it_is(), special: vec![waist, waist, 0.9 * waist, 1.1 * waist] }
}

/// A thick ring with a mouth: outside, the mouth closes behind a tool that is too large for it.
pub(super) fn ring(random: &mut Random) -> Drawn {
    let inner = random.within(0.4, 0.95);
    let mouth = random.scale(1e-3, 1.0);
    let mut chain = Chain::at(unit(0.5 * mouth)).turn(Complex::ZERO, TAU - mouth);
    chain = if random.chance(0.3) {
        chain.bow(unit(-0.5 * mouth) * inner, PI)
    } else {
        chain.line(unit(-0.5 * mouth) * inner)
    };
    chain = chain.bow(unit(0.5 * mouth) * inner, mouth - TAU);
    chain = if random.chance(0.3) { chain.bow(unit(0.5 * mouth), PI) } else { chain.line(unit(0.5 * mouth)) };
    let gap = (0.5 * mouth).sin() * inner;
    Drawn { contour: chain.closed_as_it_is(), special: vec![gap, (0.5 * mouth).sin(), 0.5 * (1.0 - inner), inner] }
}

/// A notch between two walls that mirror each other, as wide as it must be for a chosen point of the offset wall to lie on the
/// axis: a node, an inflection, a point of a fill arc, or any.
pub(super) fn notch(random: &mut Random) -> Drawn {
    let rim = at(random.within(-0.1, 0.8), random.within(0.6, 1.4));
    let bottom = at(0.0, 0.0);
    let wall: Segment<f64> = match random.whole(0, 2) {
        0 => Segment::Line(shared::curve::Line { start: bottom, end: rim }),
        1 => Chain::at(bottom).bow(rim, random.within(-1.2, 1.2)).segments()[0],
        _ => {
            let mut tangent = || at(random.within(-0.8, 0.8), 1.0) * random.within(0.6, 1.6);
            match hermite(bottom, rim, tangent(), tangent()) {
                Ok(curve) => Segment::Ph(curve),
                Err(_) => Segment::Line(shared::curve::Line { start: bottom, end: rim }),
            }
        }
    };
    // The walls are travelled upwards on the right side, with the notch to their left: negative distances.
    let distance = -random.scale(0.05, 0.5);
    let inflection = match &wall {
        Segment::Ph(curve) => curve.inflections().first().copied(),
        _ => None,
    };
    let out = rim + at(random.within(0.3, 1.0), random.within(-0.3, 0.3));
    let meeting = match random.whole(0, 4) {
        0 => wall.offset_point(1.0, distance),
        1 => wall.offset_point(0.0, distance),
        2 => {
            // On the fill arc at the rim, which reaches from the wall's normal to that of the way out.
            let after = out - rim;
            let (a, b) = (wall.tangent(1.0), after * (1.0 / after.norm()));
            let middle = a * (1.0 - 0.4) + b * 0.4;
            rim + middle.right() * (distance / middle.norm())
        }
        3 => wall.offset_point(inflection.unwrap_or(0.7), distance),
        _ => wall.offset_point(random.within(0.2, 0.9), distance),
    };
    let shift = at(-meeting.re, 0.0);
    let (low, deep) = (at(1.0, -0.5), at(0.0, -0.8));
    let far = |z: Complex<f64>| at(z.re.max(out.re + shift.re), z.im);
    let right = Chain::at(bottom + shift)
        .segment(Placing::shift(shift).segment(&wall))
        .line(out + shift)
        .line(far(low))
        .line(deep)
        .open();
    let left = reversed(&Placing::mirror_x().contour(&right));
    let mut chain = Chain::at(bottom + shift).then(&right).then(&left);
    if shift.re != 0.0 {
        chain = chain.line(bottom + shift);
    }
    Drawn { contour: chain.closed_as_it_is(), special: vec![distance, distance, bottom.re + shift.re] }
}

/// A lobe with the sharpest bend on its axis: a parabola-like PH curve, closed by a line or by its mirror image.
pub(super) fn lobe(random: &mut Random) -> Drawn {
    let a = random.within(0.3, 4.0);
    let b = if random.chance(0.6) { 0.0 } else { random.within(-0.5, 0.5) };
    let w = |x: f64| Complex::new(1.0 + b * x * x, a * x);
    // Bernstein coefficients of w on -1..=1.
    let coefficients = [w(-1.0), Complex::new(1.0 - b, 0.0), w(1.0)];
    let chain = Chain::at(Complex::ZERO).ph(coefficients);
    let end = chain.end();
    let contour = if random.chance(0.5) {
        chain.line(Complex::ZERO).closed_as_it_is()
    } else {
        let back = random.direction() * end.norm();
        chain.hermite(Complex::ZERO, back, back.conj()).closed_as_it_is()
    };
    // At the vertex w = 1 and w' = 2 a i, so that equation (1) gives kappa = 4 a.
    let vertex = 0.25 / a;
    Drawn { contour, special: vec![vertex, vertex, 1.2 * vertex, 2.0 * vertex] }
}

/// A slot along a spiral: half circles out, around the end, and back.
pub(super) fn spiral_slot(random: &mut Random) -> Drawn {
    let halves = random.whole(1, 6);
    let (slot, wall) = (random.within(0.1, 0.4), random.within(0.1, 0.4));
    let first = random.within(0.3, 1.0);
    let mut out = Chain::at(at(first + slot, 0.0));
    let mut back = Chain::at(at(first, 0.0));
    for k in 0..halves {
        let grow = 0.5 * (slot + wall) * k as f64;
        for (chain, radius) in [(&mut out, first + slot + grow), (&mut back, first + grow)] {
            let end = chain.end();
            let centre = at(if k % 2 == 0 { end.re - radius } else { end.re + radius }, 0.0);
            *chain = chain.clone().turn(centre, PI);
        }
    }
    let (out, back) = (out.open(), back.open());
    let inside = reversed(&back);
    let start = out.segments[0].point(0.0);
    let round = random.chance(0.5);
    let cap = |chain: Chain, to: Complex<f64>| if round { chain.bow(to, PI) } else { chain.line(to) };
    let chain = Chain::at(start).then(&out);
    let chain = cap(chain, inside.segments[0].point(0.0)).then(&inside);
    Drawn { contour: cap(chain, start).closed_as_it_is(), special: vec![0.5 * slot, 0.5 * wall, first] }
}

/// Two figures that have one node in common.
pub(super) fn touching(random: &mut Random) -> Drawn {
    let petal = |random: &mut Random, middle: f64| {
        let half = random.within(0.2, 0.7);
        let reach = random.within(0.5, 1.0);
        [unit(middle - half) * reach, unit(middle) * (reach * random.within(1.0, 1.6)), unit(middle + half) * reach]
    };
    let second = PI + random.within(-0.5, 0.5);
    let mut points = vec![Complex::ZERO];
    points.extend(petal(random, 0.0));
    points.push(Complex::ZERO);
    points.extend(petal(random, second));
    let contour = Chain::through(&points).close();
    Drawn { contour, special: vec![] }
}

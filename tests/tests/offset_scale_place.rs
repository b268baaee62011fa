//! The same contour in other units, turned, mirrored, and far away: the same trimmed offset, within 1e-9 of its size.
#![allow(clippy::panic, reason = "a failed test says where")]

use host_sim::contour::{Along, Contour};
use host_sim::job::Job;
use host_sim::offset::{Offset, OffsetError, trim};
use host_sim::reproduce::farouki2018::CONTOUR;
use shared::complex::Complex;
use tests::chain::{Chain, Placing, size};
use tests::contours::case;
use tests::random::unit;

/// The project's bar, in parts of the size.
const BAR: f64 = 1e-9;

fn at(x: f64, y: f64) -> Complex<f64> {
    Complex::new(x, y)
}

/// Contours with distances at which nothing hangs by a roundoff: what happens is the same after any small change.
fn figures() -> Vec<(&'static str, Contour, Vec<f64>)> {
    let job = Job::from_toml("farouki2018.toml", CONTOUR);
    let paper = job.unwrap_or_else(|error| panic!("{error}")).contour;
    let bracket = Chain::through(&[at(0.0, 0.0), at(60.0, 0.0), at(60.0, 20.0), at(28.0, 20.0)])
        .turn(at(28.0, 28.0), -std::f64::consts::FRAC_PI_2)
        .line(at(20.0, 50.0))
        .hermite(at(0.0, 50.0), at(0.0, 30.0), at(0.0, -40.0))
        .close();
    let ring = Chain::at(unit(0.2) * 10.0).turn(Complex::ZERO, std::f64::consts::TAU - 0.4).line(unit(-0.2) * 6.0);
    let ring = ring.turn(Complex::ZERO, 0.4 - std::f64::consts::TAU).close();
    let zigzag = Chain::through(&[at(0.0, 0.0), at(1.0, 2.0), at(2.1, 0.0), at(3.0, 2.2), at(4.0, 0.1)]).open();
    let wave = Chain::at(at(0.0, 0.0))
        .hermite(at(10.0, 0.0), at(8.0, 20.0), at(8.0, 20.0))
        .hermite(at(20.0, 3.0), at(8.0, 20.0), at(8.0, -15.0))
        .bow(at(25.0, 3.0), -2.0)
        .open();
    vec![
        ("the paper's", paper, vec![25.4, 3.0, -9.0, -20.0, 400.0]),
        ("bracket", bracket, vec![3.0, 11.0, -4.0, -8.7, 250.0]),
        ("ring with a mouth", ring, vec![0.5, 3.0, 5.5, -1.1, 31.0]),
        ("zigzag", zigzag, vec![0.2, -0.2, 0.7, -1.4, 30.0]),
        ("wave", wave, vec![1.0, -1.0, 6.0, -6.0]),
    ]
}

fn placings(size: f64) -> Vec<(&'static str, Placing)> {
    let factor = |factor: Complex<f64>| Placing::factor(factor);
    let far = unit(2.2) * (1e4 * size);
    vec![
        ("in um", factor(at(1e3, 0.0))),
        ("in inch", factor(at(1.0 / 25.4, 0.0))),
        ("in km", factor(at(1e-6, 0.0))),
        ("turned", factor(unit(1.234))),
        ("turned by a quadrant", factor(at(0.0, 1.0))),
        ("mirrored", Placing::mirror_x()),
        ("far away", Placing::shift(far)),
        ("turned, small and far away", Placing { factor: unit(-2.0) * 1e-3, shift: far * 1e-3, mirror: true }),
    ]
}

/// Compares loop by loop and piece by piece. `Err` says the first difference.
fn compare(contour: &Contour, offset: &Offset, image: &Offset, placing: &Placing) -> Result<(), String> {
    let scale = placing.factor.norm();
    let size = size(contour).max(offset.distance.abs()) * scale;
    if image.loops.len() != offset.loops.len() {
        return Err(format!("{} loops instead of {}", image.loops.len(), offset.loops.len()));
    }
    for (number, (ring, image)) in offset.loops.iter().zip(&image.loops).enumerate() {
        if ring.pieces.len() != image.pieces.len() {
            return Err(format!("loop {number}: {} pieces instead of {}", image.pieces.len(), ring.pieces.len()));
        }
        let nesting = (ring.closed, ring.depth, ring.parent);
        if nesting != (image.closed, image.depth, image.parent) {
            return Err(format!("loop {number}: {nesting:?} became {image:?}"));
        }
        let area = ring.area * scale * scale * if placing.mirror { -1.0 } else { 1.0 };
        if (ring.length * scale - image.length).abs() > BAR * (ring.length * scale).max(size) {
            return Err(format!("loop {number}: length {} instead of {}", image.length, ring.length * scale));
        }
        if (area - image.area).abs() > BAR * area.abs().max(size * size) {
            return Err(format!("loop {number}: area {} instead of {area}", image.area));
        }
        for (piece, image) in ring.pieces.iter().zip(&image.pieces) {
            let same = match (piece.along, image.along) {
                (Along::Segment { segment: a, .. }, Along::Segment { segment: b, .. }) => a == b,
                (Along::Fill { node: a, .. }, Along::Fill { node: b, .. }) => a == b,
                _ => false,
            };
            let near = |p: Complex<f64>, q: Complex<f64>| (placing.point(p) - q).norm() <= BAR * size;
            if !(same && near(piece.start, image.start) && near(piece.end, image.end)) {
                return Err(format!("loop {number}: {piece:?} became {image:?}"));
            }
        }
    }
    Ok(())
}

#[test]
fn scale_and_place_change_nothing() {
    let mut differences = Vec::new();
    for (name, contour, distances) in figures() {
        for d in distances.iter().flat_map(|d| [*d, -*d]) {
            let found = trim(&contour, d);
            for (place, placing) in placings(size(&contour)) {
                let image = trim(&placing.contour(&contour), placing.distance(d));
                let same = match (&found, &image) {
                    (Ok(offset), Ok(image)) => compare(&contour, offset, image, &placing),
                    (Err(OffsetError::Empty { largest: a }), Err(OffsetError::Empty { largest: b })) => {
                        let a = a * placing.factor.norm();
                        // Told to 1e-7 of itself.
                        let same = (a / b - 1.0).abs() < 2e-7;
                        same.then_some(()).ok_or_else(|| format!("the largest is {b} instead of {a}"))
                    }
                    (found, image) => Err(format!("{} became {}", brief(found), brief(image))),
                };
                differences.extend(same.err().map(|difference| format!("{name}, d = {d}, {place}: {difference}")));
            }
        }
    }
    assert!(differences.is_empty(), "{} differ:\n{}", differences.len(), differences.join("\n"));
}

fn brief(found: &Result<Offset, OffsetError>) -> String {
    found.as_ref().map_or_else(|error| format!("{error:?}"), |offset| format!("{} loops", offset.loops.len()))
}

/// Random contours of the kinds that people cut. In place they are what they are; at powers of two every number is the same but
/// for its exponent, so that the result is the same bit by bit.
#[test]
fn powers_of_two_change_no_bit() {
    for seed in 0..400 {
        let case = case(seed);
        let scale = 4.0_f64.powi(seed as i32 % 21 - 10);
        let placing = Placing::factor(at(scale, 0.0));
        let image = trim(&placing.contour(&case.contour), placing.distance(case.distance));
        match (&trim(&case.contour, case.distance), &image) {
            (Ok(offset), Ok(image)) => {
                let points = |offset: &Offset, scale: f64| -> Vec<Complex<f64>> {
                    let pieces = offset.loops.iter().flat_map(|ring| &ring.pieces);
                    pieces.flat_map(|piece| [piece.start * scale, piece.end * scale]).collect()
                };
                assert_eq!(points(offset, scale), points(image, 1.0), "seed {seed}, {}", case.family);
            }
            (Err(a), Err(b)) => {
                assert_eq!(std::mem::discriminant(a), std::mem::discriminant(b), "seed {seed}: {a:?} became {b:?}");
            }
            (found, image) => panic!("seed {seed}, {}: {} became {}", case.family, brief(found), brief(image)),
        }
    }
}

//! Offsets of a PH lobe past its curvature limit, where the offset crosses itself: everything in closed form.
//!
//! The preimage 1 + i a x is linear on -1..=1, so that r' = w^2 gives r(x) = x - a^2 x^3/3 + i a x^2: like a parabola at its
//! vertex, where it bends with the radius 1/(2a). On the inside the offset at D has the real part
//! x - a^2 x^3/3 - 2 a D x/(1 + a^2 x^2); its zeros beside x = 0 are where the offset meets its mirror image. With t = a^2 x^2
//! that is (1 - t/3)(1 + t) = 2 a D, or t = 1 - sqrt(4 - 6 a D).
#![allow(clippy::panic, reason = "a failed test says where")]

use host_sim::contour::Contour;
use host_sim::offset::{largest_reaching, trim, undercuts};
use shared::complex::Complex;
use tests::chain::Chain;
use tests::expected::{Ring, assert_empty, assert_rings, each_way};
use tests::oracle::integral;

/// A lobe that turns by 4 atan(a) in all.
const A: f64 = 0.9;

fn at(x: f64, y: f64) -> Complex<f64> {
    Complex::new(x, y)
}

/// The point of C.
fn point(x: f64) -> Complex<f64> {
    at(x - A * A * x * x * x / 3.0, A * x * x)
}

/// The point of the offset inside.
fn inside(x: f64, d: f64) -> Complex<f64> {
    let w = at(1.0, A * x);
    // i w^2/|w|^2 is the left normal.
    point(x) + (w * w).left() * (d / w.norm_sqr())
}

/// The length of C from its vertex, and the angle of its tangent.
fn length_and_angle(x: f64) -> (f64, f64) {
    (x + A * A * x * x * x / 3.0, 2.0 * (A * x).atan())
}

fn lobe() -> Chain {
    // xi runs half as fast as x: the preimage in xi is larger by the root of two.
    let w = |x: f64| at(1.0, A * x) * std::f64::consts::SQRT_2;
    Chain::at(point(-1.0)).ph([w(-1.0), w(0.0), w(1.0)])
}

fn open() -> Contour {
    lobe().open()
}

/// Closed by the line between its ends.
fn closed() -> Contour {
    lobe().line(point(-1.0)).closed_as_it_is()
}

#[test]
fn the_lobe_is_the_curve_of_the_closed_form() {
    use shared::curve::Curve as _;
    let curve = open().segments[0];
    for xi in [0.0, 0.3, 0.5, 0.9, 1.0] {
        let x = 2.0 * xi - 1.0;
        assert!((curve.point(xi) - point(x)).norm() < 1e-15);
        assert!((curve.offset_point(xi, -0.3) - inside(x, 0.3)).norm() < 1e-15);
    }
}

/// Up to the radius of curvature at the vertex, the offset is one piece; outside always.
#[test]
fn within_the_curvature_limit_nothing_is_trimmed() {
    let (length, angle) = length_and_angle(1.0);
    for d in [0.1, 0.5, 0.5 / A - 1e-3, -0.2, -7.0] {
        let points = vec![inside(-1.0, d), inside(1.0, d)];
        assert_rings(&open(), -d, &[Ring { length: 2.0 * (length - d * angle), area: None, points }]);
    }
    each_way(&open(), -0.5, |contour, distance, _| {
        let limit = largest_reaching(contour, distance);
        assert!((limit * 2.0 * A - 1.0).abs() < 1e-7, "{limit} instead of {}", 0.5 / A);
        let offset = trim(contour, distance).unwrap_or_else(|error| panic!("{error:?}"));
        assert_eq!(undercuts(contour, &offset), []);
    });
}

/// Beyond it, two pieces meet on the axis, and the vertex keeps material.
#[test]
fn past_the_curvature_limit_the_offset_meets_itself() {
    for d in [0.5 / A + 1e-6, 0.57, 0.6, 0.7, 0.73] {
        let t = 1.0 - (4.0 - 6.0 * A * d).sqrt();
        let x = t.sqrt() / A;
        let trim_point = inside(x, d);
        assert!(trim_point.re.abs() < 1e-12 && x < 1.0);
        let ((all, turned), (from, at_trim)) = (length_and_angle(1.0), length_and_angle(x));
        let length = 2.0 * ((all - from) - d * (turned - at_trim));
        let points = vec![inside(-1.0, d), at(0.0, trim_point.im), inside(1.0, d)];
        assert_rings(&open(), -d, &[Ring { length, area: None, points }]);
        each_way(&open(), -d, |contour, distance, placing| {
            let offset = trim(contour, distance).unwrap_or_else(|error| panic!("{error:?}"));
            let found = undercuts(contour, &offset);
            assert_eq!(found.len(), 1, "{found:?}");
            assert!((found[0].depth - (trim_point.im - d)).abs() < 1e-9, "{found:?} instead of {}", trim_point.im - d);
            // Around the vertex, from one foot of the trim point to the other.
            let [a, b] = [found[0].from.1, found[0].to.1];
            // The offset runs x^2 times as fast as C here and meets itself at the angle x: that magnifies roundoffs of its points.
            let rounding = 1e-16 / (x * x * x);
            assert!((b - a - x).abs() < 1e-9 + rounding, "{found:?} instead of {x}");
            assert!((0.5 * (a + b) - 0.5).abs() < 1e-9 + rounding, "{found:?} instead of {x}");
            assert!((found[0].deepest - placing.point(Complex::ZERO)).norm() < 1e-5, "{found:?}");
        });
    }
    // The last disc touches both ends.
    let largest = (1.0 - A * A / 3.0) * (1.0 + A * A) / (2.0 * A);
    assert_empty(&open(), -largest * (1.0 + 1e-6), largest);
    assert_empty(&open(), -3.0, largest);
}

/// Closed by a line: the offset of the lobe meets that of the line where a x^2 + 2 D/(1 + t) = a, which is
/// t^2 + (1 - a^2) t - a^2 + 2 a D = 0.
#[test]
fn between_lobe_and_line() {
    for d in [0.02, 0.1, 0.2, 0.3] {
        let b = 1.0 - A * A;
        let t = 0.5 * ((b * b + 4.0 * (A * A - 2.0 * A * d)).sqrt() - b);
        let x = t.sqrt() / A;
        let corner = inside(x, d);
        assert!((corner.im - (A - d)).abs() < 1e-12);
        let (length, angle) = length_and_angle(x);
        // Twice the area from the axis to the right half, below the line: the x of the offset over its height.
        let rise = |x: f64| {
            let t = A * A * x * x;
            // d(im)/dx of the offset.
            2.0 * A * x - d * 4.0 * A * A * x / ((1.0 + t) * (1.0 + t))
        };
        let area = 2.0 * integral(&|x| inside(x, d).re * rise(x), 0.0, x);
        let ring = Ring {
            length: 2.0 * (length - d * angle) + 2.0 * corner.re,
            area: Some(area),
            points: vec![corner, at(-corner.re, corner.im)],
        };
        assert_rings(&closed(), -d, &[ring]);
    }
}

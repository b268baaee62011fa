//! Foot points: where on a stretch a point is nearest.

use shared::complex::Complex;

use super::stretch::{At, Stretch};

/// The nearest place on a stretch.
#[derive(Clone, Copy, Debug)]
pub struct Foot {
    /// Its parameter, -1/2..=1/2.
    pub tau: f64,
    /// The distance; good to rounding, since it changes with the square of an error of `tau` inside the stretch.
    pub distance: f64,
}

/// The nearest point of `stretch` to `point`.
///
/// Along a stretch the slope of the distance, (r - p).t, changes its sign at most twice: once into a nearest and once into a
/// farthest point. So a nearest point inside is either bracketed by the ends, or lies on that side of the place where the slope is
/// extreme.
pub fn foot(stretch: &Stretch, point: Complex<f64>) -> Foot {
    let slope = |at: &At| (at.point - point).dot(at.tangent);
    // The derivative of the slope for a unit of tau: speed plus turning times the distance along the left normal.
    let bend = |at: &At| at.speed + at.turning * (at.point - point).dot(at.tangent.left());
    let (first, last) = (stretch.at(-0.5), stretch.at(0.5));
    let distance = |tau: f64, at: &At| Foot { tau, distance: (at.point - point).norm() };
    let mut nearest = distance(-0.5, &first);
    let other = distance(0.5, &last);
    if other.distance < nearest.distance {
        nearest = other;
    }
    let bracket = match (slope(&first) < 0.0, slope(&last) > 0.0) {
        (true, true) => Some([-0.5, 0.5]),
        // Nearest at an end, and nothing but a farthest point between.
        (false, false) => None,
        // The slope has one sign at both ends. It must rise from below zero and fall again, or the other way round.
        (rising, _) => {
            let sign = if rising { 1.0 } else { -1.0 };
            let (a, b) = (bend(&first), bend(&last));
            if a > 0.0 && b < 0.0 && rising || a < 0.0 && b > 0.0 && !rising {
                let extreme = bisect(|tau| sign * bend(&stretch.at(tau)), [-0.5, 0.5]);
                let inside = slope(&stretch.at(extreme)) * sign > 0.0;
                inside.then_some(if rising { [-0.5, extreme] } else { [extreme, 0.5] })
            } else {
                None
            }
        }
    };
    if let Some(bracket) = bracket {
        let tau = rising_zero(stretch, bracket, slope, bend);
        let inside = distance(tau, &stretch.at(tau));
        if inside.distance < nearest.distance {
            nearest = inside;
        }
    }
    nearest
}

/// The zero of a slope that rises through the bracket: Newton's method, kept inside by halving.
fn rising_zero(
    stretch: &Stretch,
    [mut low, mut high]: [f64; 2],
    slope: impl Fn(&At) -> f64,
    bend: impl Fn(&At) -> f64,
) -> f64 {
    let mut tau = 0.5 * (low + high);
    for _ in 0..60 {
        let at = stretch.at(tau);
        let value = slope(&at);
        if value < 0.0 {
            low = tau
        } else {
            high = tau
        }
        let newton = tau - value / bend(&at);
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - tau).abs() < 1e-15 || high - low < 1e-15 {
            return next;
        }
        // The distance is flat here: an error of 1e-9 changes it by less than rounding.
        let settled = (next - tau).abs() < 1e-9;
        tau = next;
        if settled {
            return tau;
        }
    }
    tau
}

/// A zero of a function that falls through the bracket.
fn bisect(function: impl Fn(f64) -> f64, [mut low, mut high]: [f64; 2]) -> f64 {
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if function(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

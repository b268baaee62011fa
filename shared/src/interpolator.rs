//! Moves the parameter along one piece by some time: equation (21), to first, second or third order or exactly, or along a profile.

use crate::accumulator::Accumulator;
use crate::active::ActivePiece;
use crate::jet::Jet;
use crate::piece::Order;
use crate::real::Real;

/// Moves `tau` along `piece` for `time` seconds, and `theta` where the piece has a profile. `rate` is the rate of (21) at `tau`, along a profile
/// that of F = 1, and `order` is what [`ActivePiece::order`] makes of that of the path.
///
/// Returns the time that is left when the end of the piece comes first; `tau` then says nothing any more. The step is the
/// same function of time whether or not the piece ends within it, so that a node changes nothing but the curve.
#[inline(always)]
pub fn advance<T: Real, const F: usize>(
    piece: &ActivePiece<T, F>,
    tau: &mut Accumulator<T>,
    theta: &mut Accumulator<T>,
    rate: T,
    order: Option<Order>,
    time: T,
) -> Option<T> {
    match order {
        Some(Order::First) => first(tau, rate, time),
        Some(Order::Second) => taylor(piece, tau, time, false),
        Some(Order::Third) => taylor(piece, tau, time, true),
        Some(Order::Exact) => exact(piece, tau, time),
        None => timed(piece, tau, theta, rate, time),
    }
}

/// Along a profile: the step of equation (22) with the mean of F, and to where the time says.
#[inline(never)]
fn timed<T: Real, const F: usize>(
    piece: &ActivePiece<T, F>,
    tau: &mut Accumulator<T>,
    theta: &mut Accumulator<T>,
    rate: T,
    time: T,
) -> Option<T> {
    let profile = piece.profile()?;
    let before = profile.fraction(theta.value());
    let left = profile.advance(theta, time);
    if left.is_none() {
        let fraction = profile.fraction(theta.value());
        piece.seek(tau, rate * profile.way(fraction - before), fraction);
    }
    left
}

/// The first-order step of equation (22). A division only where the piece ends.
#[inline(always)]
fn first<T: Real>(tau: &mut Accumulator<T>, rate: T, time: T) -> Option<T> {
    let step = rate * time;
    let room = tau.left_to(T::HALF);
    if step < room {
        tau.add(step);
        return None;
    }
    Some((time - room / rate).most(T::ZERO))
}

/// With tau' = R(tau): tau'' = R' R and tau''' = (R'' R + R'^2) R.
#[inline(never)]
fn taylor<T: Real, const F: usize>(
    piece: &ActivePiece<T, F>,
    tau: &mut Accumulator<T>,
    time: T,
    third: bool,
) -> Option<T> {
    let Jet([rate, slope, bend]) = piece.rate(Jet::variable(tau.value()));
    let c2 = T::HALF * slope * rate;
    let c3 = if third { (T::TWO * bend * rate + slope * slope) * rate * T::lit(1.0 / 6.0) } else { T::ZERO };
    let mean = |t: T| rate + t * (c2 + t * c3);
    // Where a tick is long beside a ramp the series says nothing; half and double the Euler step keep the motion defined.
    let step = |t: T| (mean(t).most(T::HALF * rate).least(T::TWO * rate)) * t;
    let room = tau.left_to(T::HALF);
    let whole = step(time);
    if whole < room {
        tau.add(whole);
        return None;
    }
    // The instant of the end: the step grows with time, so that secants through the origin close in on it.
    let mut spent = time;
    for _ in 0..6 {
        let covered = step(spent);
        if covered > T::ZERO {
            spent = (spent * (room / covered)).least(time);
        }
    }
    Some((time - spent).most(T::ZERO))
}

/// The integral of (21): a tick's substeps, each across the knots of F.
#[inline(never)]
fn exact<T: Real, const F: usize>(piece: &ActivePiece<T, F>, tau: &mut Accumulator<T>, time: T) -> Option<T> {
    let (substeps, part) = piece.substeps();
    let substep = time * part;
    for done in 1..=substeps {
        if let Some(left) = cross_knots(piece, tau, substep) {
            return Some(left + substep * T::from_int((substeps - done) as i32));
        }
    }
    None
}

/// One substep: at most three stretches on which the rate is smooth, a ramp, the middle and a ramp.
fn cross_knots<T: Real, const F: usize>(piece: &ActivePiece<T, F>, tau: &mut Accumulator<T>, time: T) -> Option<T> {
    let mut left = time;
    for knot in piece.knots().into_iter().chain([T::HALF]) {
        let room = tau.left_to(knot);
        if room <= T::ZERO {
            continue;
        }
        match smooth(piece, tau.value(), room, left) {
            Stretch::Within(step) => {
                tau.add(step);
                return None;
            }
            Stretch::Across(spent) => {
                // The knot itself, not a sum that rounds to one side of it.
                *tau = Accumulator::new(knot);
                left = (left - spent).most(T::ZERO);
            }
        }
    }
    Some(left)
}

enum Stretch<T> {
    /// The time ends within the stretch, after this step of tau.
    Within(T),
    /// The stretch ends first, after this time.
    Across(T),
}

/// Solves integral of d(tau)/R = `time` for the step from `tau`, over at most `room`. Newton's method in a bracket.
fn smooth<T: Real, const F: usize>(piece: &ActivePiece<T, F>, tau: T, room: T, time: T) -> Stretch<T> {
    let duration =
        |step: T| T::GAUSS.iter().fold(T::ZERO, |sum, &(x, weight)| sum + weight / piece.rate(tau + x * step)) * step;
    let (mut low, mut high) = (T::ZERO, room);
    let mut step = piece.rate(tau) * time;
    let mut across_is_known = false;
    for _ in 0..12 {
        if step >= high {
            if !across_is_known {
                let across = duration(room);
                if across <= time {
                    return Stretch::Across(across);
                }
                across_is_known = true;
            }
            step = (low + high) * T::HALF;
        }
        if step <= low {
            step = (low + high) * T::HALF;
        }
        let late = duration(step) - time;
        if late > T::ZERO {
            high = step;
        } else {
            low = step;
        }
        step -= late * piece.rate(tau + step);
        // Newton's method squares the relative error: once the square is a roundoff, this was the last correction. To ask for
        // less than the rounding of `duration` would never end.
        if late * late <= T::ROUNDOFF * (time * time) {
            break;
        }
    }
    Stretch::Within(step.most(T::ZERO).least(room))
}

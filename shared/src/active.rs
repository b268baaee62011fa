//! A piece as the tick executes it: validated, with every coefficient that can be computed before.
//!
//! Writing h = 2 d Im(conj w w'), which is a quadratic, and g = sigma^2 + h, so that |1 + kappa d| = |g|/sigma^2, equations
//! (19)-(21) become
//!
//! d(tau)/dt = F V ((1 - w)|g| + w sigma^2) / (|g| sigma)
//!
//! and the point of (2) is r + (d/sigma)(-i w^2): both from the one division 1/(|g| sigma). The parameter is tau in -1/2..=1/2.

use crate::accumulator::Accumulator;
use crate::complex::Complex;
use crate::duration;
use crate::error::PathError;
use crate::feed::FeedLaw;
use crate::fixed::{Fixed, REACH_MM};
use crate::further::{Linear, Travel};
use crate::jet::Number;
use crate::piece::{Order, Piece, Shape};
use crate::profile::ActiveProfile;
use crate::real::Real;
use crate::supply::PathTime;

mod ph;
mod spline;

use ph::Ph;
use spline::Spline;

/// The shortest piece that is taken for a motion, in mm: a setpoint could not show less.
const SHORTEST_MM: f64 = 4e-6;

/// A piece that the tick may execute. Made by [`ActivePiece::activate`] only, so that no evaluation of it can fail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActivePiece<T, const F: usize = 1> {
    curve: Curve<T>,
    law: Law<T>,
    /// The knots of F as parameters tau: both ends where there are no ramps.
    knots: [T; 2],
    origin: [Fixed; 2],
    /// Into how many equal parts order "exact" divides a tick on this piece, and the inverse of that number.
    substeps: u8,
    substep: T,
    /// The rate of (21) at the start, which a tick that crosses a node needs besides that of its end.
    start_rate: T,
    /// A bound of the inverse of the rate from below, in s.
    least_slowness: T,
    until: PathTime,
    goes_on: bool,
    /// How the further axes move, if they do.
    further: Linear<T, F>,
    travels: bool,
    /// Where the path ends, if it does here.
    last: [Fixed; 2],
    is_last: bool,
}

/// F of equation (21): of the arc length, or of time.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Law<T> {
    Ramps(FeedLaw<T>),
    Profile(ActiveProfile<T>),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Curve<T> {
    Ph(Ph<T>),
    Line { chord: Complex<T>, base: T },
    Arc { radius: Complex<T>, sweep: T, base: T },
    Spline(Spline<T>),
}

impl<T: Real, const F: usize> ActivePiece<T, F> {
    /// Checks a piece and prepares it for the tick; `weight` is the path's, `tick` the period in s. Load time.
    ///
    /// Errors: what [`PathError`] says of a single piece.
    pub fn activate(piece: &Piece<T, F>, weight: T, tick: T) -> Result<Self, PathError> {
        let [from, to] = piece.interval;
        if !(from >= T::ZERO && from < to && to <= T::ONE) {
            return Err(PathError::Interval { from: from.to_f32(), to: to.to_f32() });
        }
        if !(piece.feed > T::ZERO && piece.feed.is_finite()) {
            return Err(PathError::Feed { feed: piece.feed.to_f32() });
        }
        if !piece.origin.iter().chain(piece.last.iter().flatten()).all(|c| c.is_in_reach()) {
            return Err(PathError::Reach);
        }
        if !piece.further.is_none_or(|travel| travel.is_in_reach()) {
            return Err(PathError::Reach);
        }
        let further = piece.further.as_ref().map(Linear::activate);
        let law = FeedLaw::activate(piece.start, piece.end)?;
        // A profile is that of the contact point.
        let weight = if piece.profile.is_some() { T::ZERO } else { weight };
        let contact = piece.feed * (T::ONE - weight);
        let centre = piece.feed * weight;
        let curve = match piece.shape {
            Shape::Ph { preimage, offset } => Curve::Ph(Ph::activate(preimage, offset, contact, centre)?),
            Shape::Line { chord } => {
                let plane = chord.norm();
                let length = match &further {
                    Some(further) if plane < T::lit(SHORTEST_MM) => further.length(),
                    _ => plane,
                };
                Curve::Line { chord, base: piece.feed / check_length(length)? }
            }
            Shape::Arc { radius, sweep, ratio } => {
                let turn = T::lit(core::f64::consts::TAU * 1.000_001);
                if !(sweep.abs() > T::ZERO && sweep.abs() <= turn) {
                    return Err(PathError::Sweep { sweep: sweep.to_f32() });
                }
                if !(ratio > T::ZERO && ratio.is_finite()) {
                    return Err(PathError::Cusp);
                }
                let length = check_length(radius.norm() * sweep.abs())? / ratio;
                // sigma_w of (20) with the constant |1 + kappa d|.
                Curve::Arc { radius, sweep, base: (contact + centre / ratio) / length }
            }
            Shape::Spline(shape) => Curve::Spline(Spline::activate(&shape, further.as_ref(), piece.feed)?),
        };
        let mut active = Self {
            curve,
            law: Law::Ramps(law),
            knots: [-T::HALF, T::HALF],
            origin: piece.origin,
            substeps: 1,
            substep: T::ONE,
            start_rate: T::ZERO,
            least_slowness: T::ZERO,
            until: PathTime::START,
            goes_on: false,
            further: further.unwrap_or(Linear::activate(&Travel { from: [Fixed(0); F], to: [Fixed(0); F] })),
            travels: further.is_some(),
            last: piece.last.map_or([Fixed(0); 2], |[x, y, _]| [x, y]),
            is_last: piece.last.is_some(),
        };
        active.check_points()?;
        let fastest = active.fastest();
        active.law = match piece.profile {
            Some(profile) if piece.start.is_some() || piece.end.is_some() => {
                return Err(PathError::Profile { factors: profile.factors.map(T::to_f32) });
            }
            Some(profile) => Law::Profile(ActiveProfile::activate(&profile, active.mean_rate())?),
            None => Law::Ramps(law),
        };
        active.knots = law.knots().map(|u| active.tau_at(u));
        active.substeps = choose_substeps(fastest * tick, law.shortest_ramp());
        active.substep = T::ONE / T::from_int(i32::from(active.substeps));
        active.start_rate = active.rate(-T::HALF);
        active.least_slowness = T::ONE / fastest;
        active.until = PathTime::after(duration::of(&active));
        Ok(active)
    }

    /// The same as a part of a path: behind pieces that end at `before`. Load time.
    pub fn behind(self, before: PathTime) -> Self {
        Self { until: before.and(self.until), ..self }
    }

    /// The same as the end of a path that ends at its feed, for which the pace need not come to 0. Load time.
    pub fn and_on(self) -> Self {
        Self { goes_on: true, ..self }
    }

    /// d(tau)/dt of equation (21), in 1/s: above zero. One division. Along a profile that of F = 1.
    #[inline(always)]
    pub fn rate<N: Number<T>>(&self, tau: N) -> N {
        match &self.curve {
            Curve::Ph(ph) => self.factor(tau) * ph.base(tau),
            Curve::Line { base, .. } | Curve::Arc { base, .. } => self.factor(tau) * *base,
            Curve::Spline(spline) => self.factor(tau) * spline.base,
        }
    }

    /// The point relative to the origin in mm, and the rate of (21) in 1/s; along a profile that of F = 1.
    #[inline(always)]
    pub fn point_and_rate(&self, tau: T) -> (Complex<T>, T) {
        let factor = self.factor(tau);
        match &self.curve {
            Curve::Ph(ph) => {
                let (point, base) = ph.point_and_base(tau);
                (point, factor * base)
            }
            Curve::Line { chord, base } => (*chord * tau, factor * *base),
            Curve::Arc { radius, sweep, base } => {
                let (sine, versine) = (*sweep * tau).sin_versin();
                (*radius * Complex::new(-versine, sine), factor * *base)
            }
            Curve::Spline(spline) => (spline.point(tau), factor * spline.base),
        }
    }

    /// F of equation (21). The arc length is evaluated within a ramp only.
    #[inline(always)]
    pub fn factor<N: Number<T>>(&self, tau: N) -> N {
        let [first, second] = self.knots;
        match &self.law {
            Law::Ramps(law) if tau.value() < first || tau.value() > second => law.factor(self.fraction(tau)),
            _ => N::constant(T::ONE),
        }
    }

    /// The feed over time, where the piece has one.
    #[inline(always)]
    pub fn profile(&self) -> Option<&ActiveProfile<T>> {
        match &self.law {
            Law::Profile(profile) => Some(profile),
            Law::Ramps(_) => None,
        }
    }

    /// How (21) is integrated here on a path of this order: not at all along a profile.
    #[inline(always)]
    pub fn order(&self, order: Order) -> Option<Order> {
        self.profile().is_none().then_some(order)
    }

    /// Moves `tau` on by `step`, and then to where the fraction is `fraction` + 1/2, by Newton's method. Along a profile.
    ///
    /// Each step squares what is left. A piece of many ticks takes one; where the speed of the curve changes much within some ticks, up to
    /// three. What the way is off in f32 on pieces of 10, 50 and 100 mm is 3, 22 and 42 nm at most, rounding of u for the most part;
    /// at an even feed second differences of setpoints have a noise of 4.1, 5.3 and 8.4 nm, and along ramps of 4.0, 4.8 and 7.2 nm
    /// (test `the_way_is_the_integral_of_the_profile`). A single step would be 130 nm off on
    /// 10 mm at 120 mm/s, and 5 um on 2 mm.
    #[inline(always)]
    pub fn seek(&self, tau: &mut Accumulator<T>, step: T, fraction: T) {
        /// A correction whose square is nothing in f32, however the curve's speed changes.
        const SMALL: f64 = 1e-4;
        let before = tau.value();
        let at = match &self.curve {
            Curve::Ph(ph) => {
                let mut at = before + step;
                for _ in 0..3 {
                    let (u, slope) = ph.fraction_and_slope(at);
                    let correction = (fraction - u) / slope;
                    at += correction;
                    if correction.abs() < T::lit(SMALL) {
                        break;
                    }
                }
                at
            }
            Curve::Line { .. } | Curve::Arc { .. } | Curve::Spline(_) => fraction,
        };
        // Backwards and beyond the end by rounding only, or by no number where the curve all but stands still.
        *tau = Accumulator::new(at.most(before).least(T::HALF));
    }

    /// The arc-length fraction u of equations (6) and (9), on C.
    #[inline(always)]
    pub fn fraction<N: Number<T>>(&self, tau: N) -> N {
        match &self.curve {
            Curve::Ph(ph) => ph.u.at(tau, N::constant(T::ZERO)),
            Curve::Line { .. } | Curve::Arc { .. } | Curve::Spline(_) => tau + T::HALF,
        }
    }

    /// The parameter on the curve, in -1/2..=1/2: tau itself, but on a spline, where tau is the fraction of the way.
    pub fn parameter(&self, tau: T) -> T {
        match &self.curve {
            Curve::Spline(spline) => spline.parameter(tau),
            Curve::Ph(_) | Curve::Line { .. } | Curve::Arc { .. } => tau,
        }
    }

    /// The speed of the centre for a unit rate, |dr_d/d(tau)| in mm: times [`ActivePiece::rate`] the centre feed V_d of (15).
    /// Not for the tick: it takes a root.
    pub fn centre_speed(&self, tau: T) -> T {
        match &self.curve {
            Curve::Ph(ph) => {
                let at = ph.local(tau);
                at.g / at.sigma
            }
            Curve::Line { chord, .. } => chord.norm(),
            Curve::Arc { radius, sweep, .. } => radius.norm() * sweep.abs(),
            Curve::Spline(spline) => spline.speed(tau),
        }
    }

    /// The parameters tau between which the rate is one smooth function.
    pub fn knots(&self) -> [T; 2] {
        self.knots
    }

    /// The rate of (21) at the start of the piece, in 1/s; along a profile that of F = 1.
    #[inline(always)]
    pub fn start_rate(&self) -> T {
        self.start_rate
    }

    /// How long a part of the piece takes at least, for a parameter of 1, in s: 1 over the largest rate of (21), as found in 64 parts.
    #[inline(always)]
    pub fn least_slowness(&self) -> T {
        self.least_slowness
    }

    /// The path time at which the piece ends.
    #[inline(always)]
    pub fn until(&self) -> PathTime {
        self.until
    }

    /// How far the path reaches with this piece as its last one that has come: to its end, or on from there where the path ends at
    /// its feed.
    pub fn reach(&self) -> PathTime {
        if self.goes_on { self.until.and_on() } else { self.until }
    }

    /// Where the further axes are at parameter `tau`; none where the piece leaves them where they are.
    #[inline(always)]
    pub fn further(&self, tau: T) -> Option<[Fixed; F]> {
        self.travels.then(|| match &self.curve {
            Curve::Ph(ph) => self.further.before_end(T::ONE - ph.u.at(tau, T::ZERO)),
            Curve::Line { .. } | Curve::Arc { .. } => self.further.before_end(T::HALF - tau),
            Curve::Spline(spline) => spline.further(tau, &self.further),
        })
    }

    /// Where the further axes are at the end of the piece, to the unit.
    #[inline(always)]
    pub fn further_end(&self) -> Option<[Fixed; F]> {
        self.travels.then(|| self.further.end())
    }

    /// Where the local frame stands.
    pub fn origin(&self) -> [Fixed; 2] {
        self.origin
    }

    /// The exact end of the path in the plane, on its last piece.
    #[inline(always)]
    pub fn last(&self) -> Option<[Fixed; 2]> {
        self.is_last.then_some(self.last)
    }

    /// Into how many parts order "exact" divides a tick here, and the inverse of that number.
    pub fn substeps(&self) -> (u32, T) {
        (u32::from(self.substeps), self.substep)
    }

    /// The machine coordinates of a point that is relative to the origin.
    #[inline(always)]
    pub fn place(&self, point: Complex<T>) -> [Fixed; 2] {
        let [x, y] = self.origin;
        [x.offset_by(point.re), y.offset_by(point.im)]
    }

    /// Refuses a piece that has no point or no rate somewhere, or leaves the machine's reach: what lies between these points
    /// cannot leave the range of [`Fixed`], which is twice as wide.
    fn check_points(&self) -> Result<(), PathError> {
        const HALF_PARTS: i32 = 4;
        let [x, y] = self.origin.map(|c| c.minus::<T>(Fixed(0)));
        let reach = T::lit(REACH_MM);
        for k in -HALF_PARTS..=HALF_PARTS {
            let (point, rate) = self.point_and_rate(T::from_int(k) * T::lit(0.5 / f64::from(HALF_PARTS)));
            if !(point.is_finite() && rate.is_finite() && rate > T::ZERO) {
                return Err(PathError::NotFinite);
            }
            if (x + point.re).abs() > reach || (y + point.im).abs() > reach {
                return Err(PathError::Reach);
            }
        }
        Ok(())
    }

    /// The parameter where the fraction is `u`: bisection, since u grows all along. Load time.
    fn tau_at(&self, u: T) -> T {
        if u <= T::ZERO {
            return -T::HALF;
        }
        if u >= T::ONE {
            return T::HALF;
        }
        let (mut low, mut high) = (-T::HALF, T::HALF);
        for _ in 0..60 {
            let middle = (low + high) * T::HALF;
            if self.fraction(middle) < u {
                low = middle;
            } else {
                high = middle;
            }
        }
        (low + high) * T::HALF
    }

    /// The largest rate that there would be without ramps, in 1/s.
    fn fastest(&self) -> T {
        /// Half as many parts as the rate is looked for in: a curve that nearly stands still somewhere has a sharp peak there.
        const HALF_PARTS: i32 = 32;
        match &self.curve {
            Curve::Ph(ph) => (-HALF_PARTS..=HALF_PARTS)
                .fold(T::ZERO, |most: T, k| most.most(ph.base(T::from_int(k) * T::lit(0.5 / f64::from(HALF_PARTS))))),
            Curve::Line { base, .. } | Curve::Arc { base, .. } => *base,
            Curve::Spline(spline) => spline.base,
        }
    }

    /// V/S in 1/s, for a profile: the rate of u at F = 1.
    fn mean_rate(&self) -> T {
        match &self.curve {
            Curve::Ph(ph) => ph.mean_rate(),
            Curve::Line { base, .. } | Curve::Arc { base, .. } => *base,
            Curve::Spline(spline) => spline.base,
        }
    }
}

/// As many as keep a substep to a quarter of a ramp and a sixteenth of a piece at its fastest, where the Gauss rule is exact to
/// rounding; 8 at most, so that the tick stays bounded. `share` is the part of the piece that a tick covers at its fastest, `ramp`
/// the shortest ramp as a part of the piece.
fn choose_substeps<T: Real>(share: T, ramp: T) -> u8 {
    let wanted = share * T::lit(16.0).most(T::lit(4.0) / ramp);
    (wanted + T::HALF).least(T::lit(8.0)).to_int().clamp(1, 8) as u8
}

fn check_length<T: Real>(length: T) -> Result<T, PathError> {
    if !length.is_finite() {
        return Err(PathError::NotFinite);
    }
    if length < T::lit(SHORTEST_MM) {
        return Err(PathError::Length { length: length.to_f32() });
    }
    Ok(length)
}

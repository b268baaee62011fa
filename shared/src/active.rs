//! A piece as the tick executes it: validated, with every coefficient that can be computed before.
//!
//! Writing h = 2 d Im(conj w w'), which is a quadratic, and g = sigma^2 + h, so that |1 + kappa d| = |g|/sigma^2, equations
//! (19)-(21) become
//!
//! d(tau)/dt = F V ((1 - w)|g| + w sigma^2) / (|g| sigma)
//!
//! and the point of (2) is r + (d/sigma)(-i w^2): both from the one division 1/(|g| sigma). The parameter is tau in -1/2..=1/2.

use crate::complex::Complex;
use crate::curve::speed_bernstein;
use crate::error::PathError;
use crate::feed::FeedLaw;
use crate::fixed::{Fixed, Position, REACH_MM};
use crate::jet::Number;
use crate::piece::{Piece, Shape};
use crate::polynomial::{Polynomial, Sign, bernstein_product, sign};
use crate::real::Real;

/// The shortest piece that is taken for a motion, in mm: a setpoint could not show less.
const SHORTEST_MM: f64 = 4e-6;

/// A piece that the tick may execute. Made by [`ActivePiece::activate`] only, so that no evaluation of it can fail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActivePiece<T> {
    curve: Curve<T>,
    law: FeedLaw<T>,
    origin: [Fixed; 2],
    /// The knots of F as parameters tau.
    knots: [T; 2],
    /// Into how many equal parts order "exact" divides a tick on this piece, and the inverse of that number.
    substeps: (u32, T),
    /// The rate of (21) at the start, which a tick that crosses a node needs besides that of its end.
    start_rate: T,
    last: Option<Position>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Curve<T> {
    Ph(Ph<T>),
    Line { chord: Complex<T>, base: T },
    Arc { radius: Complex<T>, sweep: T, base: T },
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Ph<T> {
    w_re: Polynomial<T, 3>,
    w_im: Polynomial<T, 3>,
    /// h of the module's text.
    h: Polynomial<T, 3>,
    /// r/tau.
    x: Polynomial<T, 5>,
    y: Polynomial<T, 5>,
    /// u of equations (6) and (9).
    u: Polynomial<T, 6>,
    offset: T,
    /// V (1 - w) and V w.
    contact: T,
    centre: T,
}

/// What is needed of a PH curve at one parameter, for the feed and for the point.
struct Local<N> {
    re: N,
    im: N,
    re_sqr: N,
    im_sqr: N,
    sigma: N,
    sigma_sqr: N,
    /// |g|.
    g: N,
}

impl<T: Real> Ph<T> {
    #[inline(always)]
    fn local<N: Number<T>>(&self, tau: N) -> Local<N> {
        let re = self.w_re.at(tau, N::constant(T::ZERO));
        let im = self.w_im.at(tau, N::constant(T::ZERO));
        let (re_sqr, im_sqr) = (re * re, im * im);
        let sigma = re_sqr + im_sqr;
        let sigma_sqr = sigma * sigma;
        let g = sigma_sqr + self.h.at(tau, N::constant(T::ZERO));
        // The sign of g is the same all over a validated piece.
        let g = if g.value() < T::ZERO { -g } else { g };
        Local { re, im, re_sqr, im_sqr, sigma, sigma_sqr, g }
    }

    /// V/sigma_w of equation (20), in 1/s.
    #[inline(always)]
    fn base<N: Number<T>>(&self, tau: N) -> N {
        let at = self.local(tau);
        (at.g * self.contact + at.sigma_sqr * self.centre) / (at.g * at.sigma)
    }

    /// The point of the offset relative to the origin in mm, and V/sigma_w. One division.
    #[inline(always)]
    fn point_and_base(&self, tau: T) -> (Complex<T>, T) {
        let at = self.local(tau);
        let inverse = T::ONE / (at.g * at.sigma);
        let base = (at.g * self.contact + at.sigma_sqr * self.centre) * inverse;
        let reach = self.offset * (at.g * inverse);
        let x = self.x.at(tau, T::ZERO) * tau + reach * (T::TWO * (at.re * at.im));
        let y = self.y.at(tau, T::ZERO) * tau + reach * (at.im_sqr - at.re_sqr);
        (Complex::new(x, y), base)
    }
}

impl<T: Real> ActivePiece<T> {
    /// Checks a piece and prepares it for the tick; `weight` is the path's, `tick` the period in s. Load time.
    ///
    /// Errors: what [`PathError`] says of a single piece.
    pub fn activate(piece: &Piece<T>, weight: T, tick: T) -> Result<Self, PathError> {
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
        let law = FeedLaw::activate(piece.start, piece.end)?;
        let contact = piece.feed * (T::ONE - weight);
        let centre = piece.feed * weight;
        let curve = match piece.shape {
            Shape::Ph { preimage, offset } => Curve::Ph(activate_ph(preimage, offset, contact, centre)?),
            Shape::Line { chord } => {
                let length = check_length(chord.norm())?;
                Curve::Line { chord, base: piece.feed / length }
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
        };
        let mut active = Self {
            curve,
            law,
            origin: piece.origin,
            knots: [T::ZERO; 2],
            substeps: (1, T::ONE),
            start_rate: T::ZERO,
            last: piece.last,
        };
        active.check_points()?;
        active.knots = law.knots().map(|u| active.tau_at(u));
        active.substeps = active.choose_substeps(tick);
        active.start_rate = active.rate(-T::HALF);
        Ok(active)
    }

    /// d(tau)/dt of equation (21), in 1/s: above zero. One division.
    #[inline(always)]
    pub fn rate<N: Number<T>>(&self, tau: N) -> N {
        match &self.curve {
            Curve::Ph(ph) => self.factor(tau) * ph.base(tau),
            Curve::Line { base, .. } | Curve::Arc { base, .. } => self.factor(tau) * *base,
        }
    }

    /// The point relative to the origin in mm, and the rate of (21) in 1/s.
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
        }
    }

    /// F of equation (21). The arc length is evaluated within a ramp only.
    #[inline(always)]
    pub fn factor<N: Number<T>>(&self, tau: N) -> N {
        let [first, second] = self.knots;
        if tau.value() >= first && tau.value() <= second {
            N::constant(T::ONE)
        } else {
            self.law.factor(self.fraction(tau))
        }
    }

    /// The arc-length fraction u of equations (6) and (9), on C.
    #[inline(always)]
    pub fn fraction<N: Number<T>>(&self, tau: N) -> N {
        match &self.curve {
            Curve::Ph(ph) => ph.u.at(tau, N::constant(T::ZERO)),
            Curve::Line { .. } | Curve::Arc { .. } => tau + T::HALF,
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
        }
    }

    /// The parameters tau between which the rate is one smooth function.
    pub fn knots(&self) -> [T; 2] {
        self.knots
    }

    /// The rate of (21) at the start of the piece, in 1/s.
    #[inline(always)]
    pub fn start_rate(&self) -> T {
        self.start_rate
    }

    /// Where the local frame stands.
    pub fn origin(&self) -> [Fixed; 2] {
        self.origin
    }

    /// The exact end of the path, on its last piece.
    pub fn last(&self) -> Option<Position> {
        self.last
    }

    /// Into how many parts order "exact" divides a tick here, and the inverse of that number.
    pub fn substeps(&self) -> (u32, T) {
        self.substeps
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

    /// As many as keep a substep to a quarter of a ramp and a sixteenth of a piece at its fastest, where the Gauss rule is exact to
    /// rounding; 8 at most, so that the tick stays bounded.
    fn choose_substeps(&self, tick: T) -> (u32, T) {
        /// Half as many parts as the rate is looked for in: a curve that nearly stands still somewhere has a sharp peak there.
        const HALF_PARTS: i32 = 32;
        let fastest = match &self.curve {
            Curve::Ph(ph) => (-HALF_PARTS..=HALF_PARTS)
                .fold(T::ZERO, |most: T, k| most.most(ph.base(T::from_int(k) * T::lit(0.5 / f64::from(HALF_PARTS))))),
            Curve::Line { base, .. } | Curve::Arc { base, .. } => *base,
        };
        let share = fastest * tick;
        let wanted = share * T::lit(16.0).most(T::lit(4.0) / self.law.shortest_ramp());
        let count = (wanted + T::HALF).least(T::lit(8.0)).to_int().clamp(1, 8);
        (count.unsigned_abs(), T::ONE / T::from_int(count))
    }
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

/// The coefficients of a PH piece from its preimage A + B tau + C tau^2.
fn activate_ph<T: Real>(preimage: [Complex<T>; 3], offset: T, contact: T, centre: T) -> Result<Ph<T>, PathError> {
    let [a, b, c] = preimage;
    if !(a.is_finite() && b.is_finite() && c.is_finite() && offset.is_finite()) {
        return Err(PathError::NotFinite);
    }
    if offset.abs() > T::lit(REACH_MM) {
        return Err(PathError::Reach);
    }
    // sigma = |A|^2 + 2 Re(conj A B) tau + (|B|^2 + 2 Re(conj A C)) tau^2 + 2 Re(conj B C) tau^3 + |C|^2 tau^4, integrated.
    let arc = [
        a.norm_sqr(),
        a.dot(b),
        (b.norm_sqr() + T::TWO * a.dot(c)) * T::lit(1.0 / 3.0),
        b.dot(c) * T::HALF,
        c.norm_sqr() * T::lit(0.2),
    ];
    let even = arc[0] + arc[2] * T::lit(0.25) + arc[4] * T::lit(0.0625);
    let odd = arc[1] * T::HALF + arc[3] * T::lit(0.125);
    let length = check_length(even)?;
    let per_length = T::ONE / length;
    // s(tau) - s(-1/2); the odd powers of s make half the length each, the even powers are subtracted at the end.
    let start = (even - odd) * T::HALF;
    let u = [
        start * per_length,
        arc[0] * per_length,
        arc[1] * per_length,
        arc[2] * per_length,
        arc[3] * per_length,
        arc[4] * per_length,
    ];

    let double = T::TWO * offset;
    let h = [double * a.cross(b), double * (T::TWO * a.cross(c)), double * b.cross(c)];
    check_sign(preimage, h)?;

    let third = T::lit(1.0 / 3.0);
    let r = [a.square(), a * b, (b.square() + (a * c) * T::TWO) * third, (b * c) * T::HALF, c.square() * T::lit(0.2)];
    Ok(Ph {
        w_re: Polynomial([a.re, b.re, c.re]),
        w_im: Polynomial([a.im, b.im, c.im]),
        h: Polynomial(h),
        x: Polynomial(r.map(|z| z.re)),
        y: Polynomial(r.map(|z| z.im)),
        u: Polynomial(u),
        offset,
        contact,
        centre,
    })
}

/// Refuses a piece on which g = sigma^2 + h vanishes: 1 + kappa d = 0 there, or the curve itself stands still.
fn check_sign<T: Real>([a, b, c]: [Complex<T>; 3], [h0, h1, h2]: [T; 3]) -> Result<(), PathError> {
    let quarter = T::lit(0.25);
    let w = [a - b * T::HALF + c * quarter, a - c * quarter, a + b * T::HALF + c * quarter];
    let sigma = speed_bernstein(w);
    let h = [h0 - h1 * T::HALF + h2 * quarter, h0 - h2 * quarter, h0 + h1 * T::HALF + h2 * quarter];
    let mut g: [T; 9] = bernstein_product(sigma, sigma);
    let raised: [T; 9] = bernstein_product(h, [T::ONE; 7]);
    for (g, h) in g.iter_mut().zip(raised) {
        *g += h;
    }
    match sign(g) {
        Sign::Vanishing => Err(PathError::Cusp),
        Sign::Positive | Sign::Negative => Ok(()),
    }
}

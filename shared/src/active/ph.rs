//! The PH curve of a piece: coefficients, and its evaluation for the feed and for the point together.

use super::check_length;
use crate::complex::Complex;
use crate::curve::speed_bernstein;
use crate::error::PathError;
use crate::fixed::REACH_MM;
use crate::jet::Number;
use crate::polynomial::{Polynomial, Sign, bernstein_product, sign};
use crate::real::Real;

/// With h and g as in the text of [`super`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ph<T> {
    w_re: Polynomial<T, 3>,
    w_im: Polynomial<T, 3>,
    h: Polynomial<T, 3>,
    /// r/tau.
    x: Polynomial<T, 5>,
    y: Polynomial<T, 5>,
    /// u of equations (6) and (9).
    pub(super) u: Polynomial<T, 6>,
    offset: T,
    /// V (1 - w) and V w.
    contact: T,
    centre: T,
}

/// What is needed of a PH curve at one parameter, for the feed and for the point.
pub(super) struct Local<N> {
    re: N,
    im: N,
    re_sqr: N,
    im_sqr: N,
    pub(super) sigma: N,
    sigma_sqr: N,
    /// |g|.
    pub(super) g: N,
}

impl<T: Real> Ph<T> {
    /// The coefficients from its preimage A + B tau + C tau^2.
    pub(super) fn activate(preimage: [Complex<T>; 3], offset: T, contact: T, centre: T) -> Result<Self, PathError> {
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
        let r =
            [a.square(), a * b, (b.square() + (a * c) * T::TWO) * third, (b * c) * T::HALF, c.square() * T::lit(0.2)];
        Ok(Self {
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

    /// V/S in 1/s, where w = 0: what u grows by in a second at the feed.
    pub(super) fn mean_rate(&self) -> T {
        let (_, slope) = self.fraction_and_slope(T::ZERO);
        self.base(T::ZERO) * slope
    }

    /// u - 1/2 and its derivative by tau. 9 multiplications and additions.
    #[inline(always)]
    pub(super) fn fraction_and_slope(&self, tau: T) -> (T, T) {
        let Polynomial([u0, u1, u2, u3, u4, u5]) = self.u;
        Polynomial([u0 - T::HALF, u1, u2, u3, u4, u5]).value_and_slope(tau)
    }

    #[inline(always)]
    pub(super) fn local<N: Number<T>>(&self, tau: N) -> Local<N> {
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
    pub(super) fn base<N: Number<T>>(&self, tau: N) -> N {
        let at = self.local(tau);
        (at.g * self.contact + at.sigma_sqr * self.centre) / (at.g * at.sigma)
    }

    /// The point of the offset relative to the origin in mm, and V/sigma_w. One division.
    #[inline(always)]
    pub(super) fn point_and_base(&self, tau: T) -> (Complex<T>, T) {
        let at = self.local(tau);
        let inverse = T::ONE / (at.g * at.sigma);
        let base = (at.g * self.contact + at.sigma_sqr * self.centre) * inverse;
        let reach = self.offset * (at.g * inverse);
        let x = self.x.at(tau, T::ZERO) * tau + reach * (T::TWO * (at.re * at.im));
        let y = self.y.at(tau, T::ZERO) * tau + reach * (at.im_sqr - at.re_sqr);
        (Complex::new(x, y), base)
    }
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

//! Equation (21) from the paper's formulas, in f64 and in the segment's own parameter xi.
//!
//! Nothing here is shared with the kernel but the numbers that define a segment: Bernstein preimage instead of a centred
//! polynomial, curvature instead of g, published Bernstein ramps instead of their common polynomial, arc length and points by
//! quadrature (exact: the integrands are quartics), time by adaptive quadrature.

use std::sync::LazyLock;

use shared::complex::Complex;
use shared::curve::Segment;
use shared::feed::Ramp;

use crate::Draft;

/// Gauss-Legendre nodes in 0..1 with weights, by Newton's method on the Legendre polynomial.
fn legendre<const N: usize>() -> [(f64, f64); N] {
    core::array::from_fn(|i| {
        let mut x = (core::f64::consts::PI * (i as f64 + 0.75) / (N as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..8 {
            let (mut before, mut value) = (1.0, x);
            for k in 2..=N {
                let k = k as f64;
                (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
            }
            slope = N as f64 * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        ((1.0 - x) / 2.0, 1.0 / ((1.0 - x * x) * slope * slope))
    })
}

static EXACT_FOR_QUARTICS: LazyLock<[(f64, f64); 3]> = LazyLock::new(legendre);
static FINE: LazyLock<[(f64, f64); 10]> = LazyLock::new(legendre);

fn rule(f: &impl Fn(f64) -> f64, a: f64, b: f64) -> f64 {
    FINE.iter().map(|&(x, weight)| weight * f(a + (b - a) * x)).sum::<f64>() * (b - a)
}

/// The integral of a smooth positive `f` over a..b to 1e-13 of itself: halving until halves agree with the whole.
pub fn integral(f: &impl Fn(f64) -> f64, a: f64, b: f64) -> f64 {
    fn refine(f: &impl Fn(f64) -> f64, a: f64, b: f64, whole: f64, depth: u32) -> f64 {
        let middle = (a + b) / 2.0;
        let (left, right) = (rule(f, a, middle), rule(f, middle, b));
        if depth == 0 || (left + right - whole).abs() <= 1e-13 * whole.abs() {
            return left + right;
        }
        refine(f, a, middle, left, depth - 1) + refine(f, middle, b, right, depth - 1)
    }
    refine(f, a, b, rule(f, a, b), 40)
}

/// F of (7) with (8), at the length 1 - u from the corner; (10) with (11) is its mirror image.
fn modulation(ramp: Option<Ramp<f64>>, from_corner: f64) -> f64 {
    let Some(Ramp { length, factor }) = ramp else { return 1.0 };
    if from_corner >= length {
        return 1.0;
    }
    let (near, far) = (from_corner / length, 1.0 - from_corner / length);
    [(1.0, 1.0), (5.0, 1.0), (10.0, 1.0), (10.0, factor), (5.0, factor), (1.0, factor)]
        .iter()
        .zip(0..)
        .map(|(&(binomial, coefficient), k)| coefficient * binomial * near.powi(5 - k) * far.powi(k))
        .sum()
}

/// I(f) = integral of du/F over a ramp.
pub fn ramp_integral(factor: f64) -> f64 {
    integral(&|u| 1.0 / modulation(Some(Ramp { length: 1.0, factor }), u), 0.0, 1.0)
}

/// The control points of the derivative.
fn steps(points: &[Complex<f64>]) -> Vec<Complex<f64>> {
    let degree = (points.len() - 1) as f64;
    points.windows(2).map(|pair| (pair[1] - pair[0]) * degree).collect()
}

/// The sum of control points with Bernstein's polynomials.
fn bernstein(points: &[Complex<f64>], xi: f64) -> Complex<f64> {
    let degree = points.len() as i32 - 1;
    let mut binomial = 1.0;
    let mut sum = Complex::ZERO;
    for (k, point) in (0..).zip(points) {
        sum = sum + *point * (binomial * xi.powi(k) * (1.0 - xi).powi(degree - k));
        binomial *= f64::from(degree - k) / f64::from(k + 1);
    }
    sum
}

impl Draft {
    /// w and w' of a PH segment.
    fn preimage(&self, xi: f64) -> Option<[Complex<f64>; 2]> {
        let Segment::Ph(curve) = self.segment else { return None };
        let [w0, w1, w2] = curve.w;
        let eta = 1.0 - xi;
        Some([w0 * (eta * eta) + w1 * (2.0 * xi * eta) + w2 * (xi * xi), ((w1 - w0) * eta + (w2 - w1) * xi) * 2.0])
    }

    /// The parametric speed sigma of (12).
    pub fn sigma(&self, xi: f64) -> f64 {
        match self.segment {
            Segment::Ph(_) => self.preimage(xi).map_or(0.0, |[w, _]| w.re.powi(2) + w.im.powi(2)),
            Segment::Line(line) => (line.end.re - line.start.re).hypot(line.end.im - line.start.im),
            Segment::Arc(arc) => arc.radius.re.hypot(arc.radius.im) * arc.sweep.abs(),
            Segment::Spline(spline) => bernstein(&steps(&spline.points), xi).norm(),
        }
    }

    /// 1 + kappa d.
    pub fn stretch(&self, xi: f64) -> f64 {
        let kappa = match self.segment {
            Segment::Ph(_) => self.preimage(xi).map_or(0.0, |[w, slope]| {
                2.0 * (w.re * slope.im - w.im * slope.re) / (w.re.powi(2) + w.im.powi(2)).powi(2)
            }),
            Segment::Line(_) => 0.0,
            Segment::Arc(arc) => arc.sweep.signum() / arc.radius.re.hypot(arc.radius.im),
            Segment::Spline(spline) => {
                let slopes = steps(&spline.points);
                let slope = bernstein(&slopes, xi);
                slope.cross(bernstein(&steps(&slopes), xi)) / slope.norm().powi(3)
            }
        };
        1.0 + kappa * self.offset
    }

    /// The arc length on C between two parameters.
    pub fn length(&self, a: f64, b: f64) -> f64 {
        EXACT_FOR_QUARTICS.iter().map(|&(x, weight)| weight * self.sigma(a + (b - a) * x)).sum::<f64>() * (b - a)
    }

    /// F(u) of (21).
    pub fn modulation(&self, xi: f64) -> f64 {
        let [from, to] = self.interval;
        let whole = self.length(from, to);
        modulation(self.start, self.length(from, xi) / whole) * modulation(self.end, self.length(xi, to) / whole)
    }

    /// d(xi)/dt of (21), with sigma_w of (20).
    pub fn rate(&self, xi: f64, weight: f64) -> f64 {
        let stretch = self.stretch(xi).abs();
        let sigma_w = stretch / ((1.0 - weight) * stretch + weight) * self.sigma(xi);
        self.modulation(xi) * self.feed / sigma_w
    }

    /// The parameters where F passes from one formula to the next.
    fn knots(&self) -> [f64; 2] {
        let [from, to] = self.interval;
        let whole = self.length(from, to);
        let at = |u: f64| {
            let (mut low, mut high) = (from, to);
            for _ in 0..80 {
                let middle = (low + high) / 2.0;
                if self.length(from, middle) < u * whole { low = middle } else { high = middle }
            }
            high
        };
        [at(self.start.map_or(0.0, |r| r.length)), at(1.0 - self.end.map_or(0.0, |r| r.length))]
    }

    /// The time from parameter `a` to `b`: the integral of (21).
    pub fn time(&self, a: f64, b: f64, weight: f64) -> f64 {
        let [first, second] = self.knots();
        let mut marks = vec![a];
        marks.extend([first, second].into_iter().filter(|&k| k > a && k < b));
        marks.push(b);
        marks
            .windows(2)
            .map(|ends| match ends {
                &[a, b] => integral(&|xi| 1.0 / self.rate(xi, weight), a, b),
                _ => 0.0,
            })
            .sum()
    }

    /// The time of the whole piece: along a profile S/V over the mean of F, which is that of its coefficients.
    pub fn duration(&self, weight: f64) -> f64 {
        let [from, to] = self.interval;
        if let Some(profile) = self.profile {
            return integral(&|xi| self.sigma(xi), from, to) / self.feed * 4.0 / profile.factors.iter().sum::<f64>();
        }
        self.time(from, to, weight)
    }

    /// The point of C.
    pub fn contact(&self, xi: f64) -> Complex<f64> {
        match self.segment {
            Segment::Ph(curve) => EXACT_FOR_QUARTICS.iter().fold(curve.start, |sum, &(x, weight)| {
                let w = self.preimage(x * xi).map_or(Complex::ZERO, |[w, _]| w);
                sum + Complex::new(w.re * w.re - w.im * w.im, 2.0 * w.re * w.im) * (weight * xi)
            }),
            Segment::Line(line) => line.start + (line.end - line.start) * xi,
            Segment::Arc(arc) => {
                let (sine, cosine) = (arc.sweep * xi).sin_cos();
                arc.centre() + arc.radius * Complex::new(cosine, sine)
            }
            Segment::Spline(spline) => bernstein(&spline.points, xi),
        }
    }

    /// The unit tangent of C.
    pub fn direction(&self, xi: f64) -> Complex<f64> {
        let along = match self.segment {
            Segment::Ph(_) => self.preimage(xi).map_or(Complex::ZERO, |[w, _]| w * w),
            Segment::Line(line) => line.end - line.start,
            Segment::Arc(arc) => {
                let (sine, cosine) = (arc.sweep * xi).sin_cos();
                arc.radius * Complex::new(cosine, sine) * Complex::new(0.0, arc.sweep.signum())
            }
            Segment::Spline(spline) => bernstein(&steps(&spline.points), xi),
        };
        along * (1.0 / along.re.hypot(along.im))
    }

    /// The tool centre, the point of (2).
    pub fn centre(&self, xi: f64) -> Complex<f64> {
        let t = self.direction(xi);
        self.contact(xi) + Complex::new(t.im, -t.re) * self.offset
    }

    /// The distance of `p` from the tool centre's path near parameter `guess`: Newton's method for the foot point, which is
    /// where p - r is along the normal. Where it is not the nearest foot of all, this is more than the true distance.
    pub fn distance(&self, p: Complex<f64>, guess: f64) -> f64 {
        let [from, to] = self.interval;
        let mut xi = guess.clamp(from, to);
        for _ in 0..4 {
            // The centre moves by stretch sigma along the tangent; near the path that is the whole derivative.
            let ahead = (p - self.centre(xi)).dot(self.direction(xi));
            xi = (xi + ahead / (self.stretch(xi) * self.sigma(xi))).clamp(from, to);
        }
        let off = p - self.centre(xi);
        off.re.hypot(off.im)
    }
}

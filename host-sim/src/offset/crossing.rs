//! Where two stretches cross.
//!
//! Two stretches are graphs over one axis: a direction within 45 degrees of both (one of them read backwards where they run
//! against each other). Their crossings are the zeros of the difference of two heights. The slopes at the ends of any part bound
//! the slope in it, so a part is either shown to hold no zero, or one, or is halved. A near-tangency whose gap is g takes about
//! log2(1/sqrt g) halvings. What counts is the sign of the difference at common places, so that a pair has as many crossings as its
//! ends demand, however near to each other the two are.

use shared::complex::Complex;

use super::stretch::Stretch;

/// Parts narrower than this, in units of the contour's size, are not halved any more: they hold a crossing if the sign changes.
const NARROWEST: f64 = 1e-11;

/// Parts that a pair may be halved into. Curves that run along each other this long do not separate for any d nearby.
const MOST_PARTS: usize = 4096;

/// A crossing of two stretches.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    /// The parameter on each stretch, -1/2..=1/2.
    pub tau: [f64; 2],
    /// Whether the first stretch passes to the left of the second one's travel there (else to its right).
    pub to_left: bool,
}

/// A common place of the two graphs.
#[derive(Clone, Copy)]
struct Place {
    along: f64,
    tau: [f64; 2],
    /// Height of the first above the second.
    apart: f64,
    slope: [f64; 2],
}

struct Pair<'a> {
    stretch: [&'a Stretch; 2],
    axis: Complex<f64>,
    /// -1 where the second one runs against the axis.
    sense: f64,
}

/// Appends the crossings of `first` and `second` to `found`, in order along the first one.
pub fn crossings(first: &Stretch, second: &Stretch, found: &mut Vec<Crossing>) {
    if apart(first, second) {
        return;
    }
    let Some(pair) = Pair::new(first, second) else { return };
    let Some((from, to)) = pair.common() else { return };
    let mut pending = vec![(from, to)];
    let mut parts = 0;
    while let Some((a, b)) = pending.pop() {
        parts += 1;
        let narrow = b.along - a.along < NARROWEST || parts > MOST_PARTS;
        match pair.zeros(&a, &b) {
            Zeros::None => {}
            Zeros::One => found.push(pair.crossing(a, b)),
            Zeros::Perhaps if narrow => {
                if (a.apart < 0.0) != (b.apart < 0.0) {
                    found.push(pair.crossing(a, b));
                }
            }
            Zeros::Perhaps => {
                let middle = pair.place(0.5 * (a.along + b.along), &a, &b);
                pending.push((middle, b));
                pending.push((a, middle));
            }
        }
    }
}

/// Whether two arcs lie on circles that do not meet: concentric ones would otherwise be halved for long.
fn apart(first: &Stretch, second: &Stretch) -> bool {
    let (Some((c, r)), Some((d, s))) = (first.circle(), second.circle()) else { return false };
    let distance = (c - d).norm();
    let rounding = 1e-15 * (r + s + distance);
    distance > r + s + rounding || distance < (r - s).abs() - rounding
}

/// How many zeros a part holds.
enum Zeros {
    None,
    One,
    Perhaps,
}

impl<'a> Pair<'a> {
    /// The common axis; none where a stretch has no length.
    fn new(first: &'a Stretch, second: &'a Stretch) -> Option<Self> {
        let direction = |s: &Stretch| {
            let sum = s.at(-0.5).tangent + s.at(0.5).tangent;
            sum * (1.0 / sum.norm())
        };
        let (a, b) = (direction(first), direction(second));
        let sense = if a.dot(b) < 0.0 { -1.0 } else { 1.0 };
        let sum = a + b * sense;
        let axis = sum * (1.0 / sum.norm());
        axis.is_finite().then_some(Self { stretch: [first, second], axis, sense })
    }

    /// The first and last place that both graphs stand over.
    fn common(&self) -> Option<(Place, Place)> {
        let [a, b] = self.stretch;
        let along = |s: &Stretch, tau: f64| self.axis.dot(s.at(tau).point);
        let (a0, a1) = (along(a, -0.5), along(a, 0.5));
        let (b0, b1) = (along(b, -0.5 * self.sense), along(b, 0.5 * self.sense));
        let (from, to) = (a0.max(b0), a1.min(b1));
        if from.is_nan() || to.is_nan() || from >= to {
            return None;
        }
        let ends = [-0.5, 0.5];
        let whole = |side: usize| if self.sense < 0.0 && side == 1 { [0.5, -0.5] } else { ends };
        let at = |along: f64, own: f64, other: f64, end: usize| {
            let first = if along == own { ends[end] } else { self.inverse(0, along, ends) };
            let second = if along == other { whole(1)[end] } else { self.inverse(1, along, whole(1)) };
            self.place_at(along, [first, second])
        };
        Some((at(from, a0, b0, 0), at(to, a1, b1, 1)))
    }

    /// The place at `along`, between two known ones.
    fn place(&self, along: f64, a: &Place, b: &Place) -> Place {
        let [first, second] = [0, 1].map(|side| self.inverse(side, along, [a.tau[side], b.tau[side]]));
        self.place_at(along, [first, second])
    }

    fn place_at(&self, along: f64, tau: [f64; 2]) -> Place {
        let [a, b] = [self.stretch[0].at(tau[0]), self.stretch[1].at(tau[1])];
        let up = self.axis.left();
        let slope = |tangent: Complex<f64>| up.dot(tangent) / self.axis.dot(tangent);
        Place { along, tau, apart: up.dot(a.point - b.point), slope: [slope(a.tangent), slope(b.tangent)] }
    }

    /// The parameter at which a graph stands over `along`: Newton's method, kept inside `from..to` by halving.
    fn inverse(&self, side: usize, along: f64, [from, to]: [f64; 2]) -> f64 {
        let stretch = self.stretch[side];
        let sense = if side == 1 { self.sense } else { 1.0 };
        // `low` lies before the place along the axis, `high` behind it.
        let (mut low, mut high) = (from, to);
        let mut tau = 0.5 * (from + to);
        for _ in 0..60 {
            let at = stretch.at(tau);
            let value = self.axis.dot(at.point) - along;
            if value < 0.0 {
                low = tau
            } else {
                high = tau
            }
            let newton = tau - value / (at.speed * self.axis.dot(at.tangent));
            let inside = (newton - low) * sense > 0.0 && (high - newton) * sense > 0.0;
            let next = if inside { newton } else { 0.5 * (low + high) };
            let step = (next - tau).abs();
            tau = next;
            if step < 1e-16 || (inside && step < 1e-9) && at.speed * step * step < 1e-18 {
                break;
            }
        }
        tau
    }

    /// What the slopes at its ends tell of the zeros of the part between two places.
    fn zeros(&self, a: &Place, b: &Place) -> Zeros {
        let width = b.along - a.along;
        let [first, second] = [0, 1].map(|side| {
            let (a, b) = (a.slope[side], b.slope[side]);
            (a.min(b), a.max(b))
        });
        // The slope of the difference lies between these two.
        let (least, most) = (first.0 - second.1, first.1 - second.0);
        let monotone = least > 0.0 || most < 0.0;
        let changes = (a.apart < 0.0) != (b.apart < 0.0);
        if changes {
            return if monotone { Zeros::One } else { Zeros::Perhaps };
        }
        if monotone {
            return Zeros::None;
        }
        // Seen from above zero: it cannot fall below the two lines that its ends and its slopes allow.
        let (h0, h1, fall, rise) =
            if a.apart < 0.0 { (-a.apart, -b.apart, -most, -least) } else { (a.apart, b.apart, least, most) };
        if rise <= fall {
            return Zeros::None;
        }
        let lowest = (h0 * rise - h1 * fall + rise * fall * width) / (rise - fall);
        if lowest > 0.0 { Zeros::None } else { Zeros::Perhaps }
    }

    /// The one crossing between two places of different sign.
    fn crossing(&self, mut a: Place, mut b: Place) -> Crossing {
        let rising = a.apart < 0.0;
        let to_left = rising == (self.sense > 0.0);
        for round in 0..60 {
            // False position, and a halving now and then so that no end stays where it is.
            let share = a.apart / (a.apart - b.apart);
            let share = if round % 3 == 2 || !(share > 0.0 && share < 1.0) { 0.5 } else { share };
            let along = a.along + (b.along - a.along) * share;
            if !(along > a.along && along < b.along) {
                break;
            }
            let at = self.place(along, &a, &b);
            if (at.apart < 0.0) == rising {
                a = at
            } else {
                b = at
            }
            if let Some(tau) = self.newton(at.tau, &a, &b) {
                return Crossing { tau, to_left };
            }
        }
        let nearer = if a.apart.abs() < b.apart.abs() { a } else { b };
        Crossing { tau: nearer.tau, to_left }
    }

    /// Newton's method for the two parameters from `tau`, if it ends within the bracket.
    fn newton(&self, mut tau: [f64; 2], a: &Place, b: &Place) -> Option<[f64; 2]> {
        let mut before = f64::INFINITY;
        for _ in 0..10 {
            let step = newton_step(self.stretch, tau)?;
            let moved = [0, 1].map(|side| (step[side] * self.stretch[side].at(tau[side]).speed).abs());
            let moved = moved[0].max(moved[1]);
            tau = [tau[0] + step[0], tau[1] + step[1]];
            let within = |side: usize| {
                let (a, b) = (a.tau[side], b.tau[side]);
                let slack = 1e-12;
                tau[side] >= a.min(b) - slack && tau[side] <= a.max(b) + slack
            };
            if !(within(0) && within(1)) {
                return None;
            }
            // At the end only rounding moves it, which does not shrink.
            if moved < 1e-16 || before < 1e-9 && moved > 0.25 * before {
                return Some(tau.map(|t| t.clamp(-0.5, 0.5)));
            }
            before = moved;
        }
        None
    }
}

/// The correction of two parameters towards r_d,i(xi) - r_d,j(eta) = 0; none where the tangents are parallel.
pub fn newton_step([first, second]: [&Stretch; 2], [xi, eta]: [f64; 2]) -> Option<[f64; 2]> {
    let (a, b) = (first.at(xi), second.at(eta));
    let gap = b.point - a.point;
    let sine = a.tangent.cross(b.tangent);
    let step = [gap.cross(b.tangent) / (sine * a.speed), gap.cross(a.tangent) / (sine * b.speed)];
    step.iter().all(|s| s.is_finite()).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::curve::{Arc, Line, Segment};

    fn line(from: (f64, f64), to: (f64, f64)) -> Stretch {
        let (start, end) = (Complex::new(from.0, from.1), Complex::new(to.0, to.1));
        Stretch::new(&Segment::Line(Line { start, end }), 0.0, 1.0, 0.0)
    }

    fn all(first: &Stretch, second: &Stretch) -> Vec<Crossing> {
        let mut found = Vec::new();
        crossings(first, second, &mut found);
        found
    }

    #[test]
    fn two_lines_cross_once_and_tell_the_side() {
        let (a, b) = (line((0.0, 0.0), (1.0, 0.0)), line((0.25, -1.0), (0.25, 1.0)));
        let found = all(&a, &b);
        // Travelling along x, the first passes to the right of one that travels along y.
        assert!(found.len() == 1 && !found[0].to_left);
        assert!((found[0].tau[0] + 0.25).abs() < 1e-15 && found[0].tau[1].abs() < 1e-15);
        let found = all(&b, &a);
        assert!(found.len() == 1 && found[0].to_left);
        assert!(all(&a, &line((0.0, 0.1), (1.0, 0.1))).is_empty());
        assert!(all(&a, &line((1.1, -1.0), (1.1, 1.0))).is_empty());
    }

    /// A chord at distance 1 - g from the centre of a unit circle crosses it at +-sqrt(2 g - g^2); outside it not at all.
    #[test]
    fn a_chord_however_flat_crosses_its_circle_twice() {
        let arc = |turn: f64| {
            let radius = Complex::new((-0.3 + turn).sin(), -(-0.3 + turn).cos());
            Stretch::new(&Segment::Arc(Arc { start: radius, radius, sweep: 0.6 }), 0.0, 1.0, 0.0)
        };
        for gap in [1e-2, 1e-4, 1e-8, 1e-11, 1e-13] {
            for (height, count) in [(-1.0 + gap, 2), (-1.0 - gap, 0)] {
                for (from, to) in [(-0.5, 0.5), (0.5, -0.5)] {
                    let chord = line((from, height), (to, height));
                    let found = all(&chord, &arc(0.0));
                    assert_eq!(found.len(), count, "{gap}");
                    for crossing in &found {
                        let x = chord.at(crossing.tau[0]).point.re;
                        let expected = (2.0 * gap - gap * gap).sqrt();
                        assert!((x.abs() - expected).abs() < 1e-15 / expected + 1e-15, "{gap}: {x} {expected}");
                    }
                }
            }
        }
    }

    #[test]
    fn concentric_arcs_and_parallel_lines_are_told_apart_at_once() {
        let arc = |radius: f64| {
            let radius = Complex::new(0.0, -radius);
            Stretch::new(&Segment::Arc(Arc { start: radius, radius, sweep: 0.7 }), 0.0, 1.0, 0.0)
        };
        assert!(all(&arc(1.0), &arc(1.0 + 1e-12)).is_empty());
        assert!(all(&line((0.0, 0.0), (1.0, 0.3)), &line((1.0, 0.3 + 1e-12), (0.0, 1e-12))).is_empty());
    }
}

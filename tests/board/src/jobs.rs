//! Small jobs of one kind of piece each: what budgets are counted on.

use shared::active::ActivePiece;
use shared::complex::Complex;
use shared::feed::Ramp;
use shared::fixed::{Fixed, round_point};
use shared::further::Travel;
use shared::pace::PaceLimits;
use shared::piece::{Header, Order, Piece, Shape, SplineShape};
use shared::profile::Profile;
use shared::spline::CorrectionOrder;

/// The kinds of pieces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A quintic PH curve at an offset distance.
    Ph,
    /// A line.
    Line,
    /// An arc.
    Arc,
    /// A polynomial cubic under a feed correction polynomial of the seventh order.
    Spline,
    /// The PH curve with a profile.
    TimedPh,
    /// The line with a profile.
    TimedLine,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 6] = [Self::Ph, Self::Line, Self::Arc, Self::Spline, Self::TimedPh, Self::TimedLine];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ph | Self::TimedPh => "ph",
            Self::Line | Self::TimedLine => "line",
            Self::Arc => "arc",
            Self::Spline => "spline",
        }
    }

    /// The orders that are told apart on such pieces, and their names in tables: none of them along a profile.
    pub fn orders(self) -> &'static [(Order, &'static str)] {
        if self.is_timed() { &[(Order::First, "profile")] } else { &ORDERS }
    }

    /// Whether its pieces have profiles.
    fn is_timed(self) -> bool {
        matches!(self, Self::TimedPh | Self::TimedLine)
    }
}

/// The orders and their names in tables.
pub const ORDERS: [(Order, &str); 4] =
    [(Order::First, "1"), (Order::Second, "2"), (Order::Third, "3"), (Order::Exact, "exact")];

/// Two pieces of about 20 mm at 50 mm/s, half a second each, with ramps at both ends, so that the path has a node, or with profiles that
/// begin and end at the same speed as these; the weight is in the middle, so that no term of the feed law vanishes.
pub fn job(kind: Kind, order: Order) -> (Header<f32>, Vec<Piece<f32>>) {
    let header = Header { weight: 0.5, order, closed: false, tolerance: 1e-3, rest: false, pace: PaceLimits::USUAL };
    let shape = match kind {
        Kind::Ph | Kind::TimedPh => Shape::Ph {
            preimage: [Complex::new(4.2, 0.3), Complex::new(-0.4, 1.1), Complex::new(0.2, -0.3)],
            offset: -3.0,
        },
        Kind::Line | Kind::TimedLine => Shape::Line { chord: Complex::new(16.0, 12.0) },
        Kind::Arc => Shape::Arc { radius: Complex::new(10.0, 0.0), sweep: 2.0, ratio: 1.25 },
        Kind::Spline => Shape::Spline(flat([(16.0, 9.0), (-4.0, 7.0), (6.0, -5.0)], CorrectionOrder::Seventh)),
    };
    let ramp = (!kind.is_timed()).then_some(Ramp { length: 0.25, factor: 0.25 });
    let profile = kind.is_timed().then_some(Profile { factors: [0.25, 1.0, 1.0, 0.25] });
    let origin = round_point(Complex::new(30.0, 20.0));
    let first = Piece {
        origin,
        shape,
        interval: [0.0, 1.0],
        feed: 50.0,
        start: ramp,
        end: ramp,
        profile,
        further: None,
        last: None,
    };
    twice(header, first)
}

/// A polynomial curve in the plane with these coefficients of v, v^2, ..; the higher ones are zero.
fn flat<const N: usize>(coefficients: [(f32, f32); N], correction: CorrectionOrder) -> SplineShape<f32> {
    let mut plane = [Complex::ZERO; 5];
    for (slot, (x, y)) in plane.iter_mut().zip(coefficients) {
        *slot = Complex::new(x, y);
    }
    SplineShape { plane, bow: [0.0; 4], correction }
}

/// A piece, and again where it ended.
fn twice(header: Header<f32>, first: Piece<f32>) -> (Header<f32>, Vec<Piece<f32>>) {
    let origin = first.origin;
    let Some(ends) = ends(&header, &first) else { return (header, Vec::new()) };
    // The second piece is the first one moved to where that ended.
    let way = |axis: usize| ends[1][axis].0 - ends[0][axis].0;
    let moved = |from: [Fixed; 2]| [Fixed(from[0].0 + way(0)), Fixed(from[1].0 + way(1))];
    let [x, y] = moved(ends[1]);
    let on = |travel: Travel| Travel { from: travel.to, to: [Fixed(2 * travel.to[0].0 - travel.from[0].0)] };
    let further = first.further.map(on);
    let z = further.map_or(Fixed(0), |travel| travel.to[0]);
    let second = Piece { origin: moved(origin), further, last: Some([x, y, z]), ..first };
    (header, vec![first, second])
}

/// The speed of each of x and y at which a step axis of the firmware makes one step a second, in mm/s; see `examples/mill-steps.toml`.
const MM_PER_STEP: f64 = 1.0 / 8_000.0;

/// Two offset PH pieces that go along the diagonal, within three degrees of it, at full speed from the first tick: x, y and z make
/// `steps_per_s` each, for about a quarter of a second.
pub fn diagonal(steps_per_s: f64) -> (Header<f32>, Vec<Piece<f32>>) {
    let header = Header {
        weight: 0.5,
        order: Order::First,
        closed: false,
        tolerance: 1e-3,
        rest: false,
        pace: PaceLimits::USUAL,
    };
    let feed = steps_per_s * MM_PER_STEP * std::f64::consts::SQRT_2;
    // The square of the preimage is the hodograph: its length is that of an eighth of a second, its direction is twice the angle.
    let (sin, cos) = (std::f64::consts::PI / 8.0).sin_cos();
    let turned = |along: f64, across: f64| {
        Complex::new((along * cos - across * sin) as f32, (along * sin + across * cos) as f32)
    };
    let size = (feed / 8.0).sqrt();
    let preimage = [turned(size, 0.0), turned(0.0, size * 0.03), turned(0.0, 0.0)];
    let first = Piece {
        origin: round_point(Complex::new(30.0, 20.0)),
        shape: Shape::Ph { preimage, offset: -0.2 },
        interval: [0.0, 1.0],
        feed: feed as f32,
        start: None,
        end: None,
        profile: None,
        further: Some(Travel { from: [Fixed(0)], to: [Fixed::from_mm(steps_per_s * MM_PER_STEP / 8.0)] }),
        last: None,
    };
    twice(header, first)
}

/// A circle of 2 mm radius anticlockwise, a quarter of a smaller one back, a needle and its way back: every axis turns around several
/// times, in all pairs of directions, slowly on the circle and at once at the needle's ends. At 25 mm/s, about 0.8 s.
pub fn all_ways() -> (Header<f32>, Vec<Piece<f32>>) {
    let header = Header {
        weight: 0.5,
        order: Order::First,
        closed: false,
        tolerance: 1e-3,
        rest: false,
        pace: PaceLimits::USUAL,
    };
    let arc = |x: f32, y: f32, sweep| Shape::Arc { radius: Complex::new(x, y), sweep, ratio: 1.0 };
    let line = |x: f32, y: f32| Shape::Line { chord: Complex::new(x, y) };
    let half = std::f32::consts::PI;
    let shapes =
        [arc(2.0, 0.0, half), arc(-2.0, 0.0, half), arc(-1.0, 0.0, -half / 2.0), line(1.5, -0.4), line(-1.5, 0.4)];
    chain(header, round_point(Complex::new(12.0, -7.0)), 25.0, shapes.map(|shape| (shape, None)))
}

/// Polynomial curves of every kind, beside a line and a PH curve, at 30 mm/s: a cubic that bends in z, a quintic whose z goes straight, a
/// quintic that leaves z alone, a cubic of a lower order; about 1.5 s.
pub fn splines(order: Order) -> (Header<f32>, Vec<Piece<f32>>) {
    let header = Header { weight: 0.5, order, closed: false, tolerance: 1e-3, rest: false, pace: PaceLimits::USUAL };
    let bent = SplineShape {
        bow: [6.0, -2.0, 1.0, 0.5],
        ..flat([(9.0, 4.0), (-2.0, 5.0), (3.0, -4.0)], CorrectionOrder::Seventh)
    };
    let quintic = [(8.0, -3.0), (1.0, 4.0), (-2.0, 3.0), (1.5, -2.0), (1.0, 2.5)];
    let ph = Shape::Ph {
        preimage: [Complex::new(3.0, 0.3), Complex::new(-0.4, 1.1), Complex::new(0.2, -0.3)],
        offset: -1.0,
    };
    let travel = |from: f64, to: f64| Some(Travel { from: [Fixed::from_mm(from)], to: [Fixed::from_mm(to)] });
    let shapes = [
        (Shape::Spline(bent), travel(1.0, 3.5)),
        (Shape::Line { chord: Complex::new(3.0, 4.0) }, None),
        (Shape::Spline(flat(quintic, CorrectionOrder::Ninth)), travel(3.5, 2.0)),
        (ph, None),
        (Shape::Spline(flat(quintic.map(|(x, y)| (-y, x)), CorrectionOrder::Ninth)), None),
        (Shape::Spline(flat([(7.0, 1.0), (0.5, -2.0)], CorrectionOrder::FifthFitted)), travel(2.0, 2.0)),
    ];
    let (header, mut pieces) = chain(header, round_point(Complex::new(5.0, 8.0)), 30.0, shapes);
    let ramp = Some(Ramp { length: 0.25, factor: 0.5 });
    for piece in pieces.iter_mut().step_by(2) {
        (piece.start, piece.end) = (ramp, ramp);
    }
    (header, pieces)
}

/// Pieces of every shape with profiles, from rest to rest at 30 mm/s: an offset PH curve, a line, an arc whose centre goes farther than the
/// contact point, a cubic that bends in z, a short PH curve whose speed changes much in a few ticks; about 1.5 s.
pub fn profiles(order: Order) -> (Header<f32>, Vec<Piece<f32>>) {
    let header = Header { weight: 0.5, order, closed: false, tolerance: 1e-3, rest: false, pace: PaceLimits::USUAL };
    let ph =
        |preimage: [(f32, f32); 3], offset| Shape::Ph { preimage: preimage.map(|(x, y)| Complex::new(x, y)), offset };
    let bent = SplineShape {
        bow: [6.0, -2.0, 1.0, 0.5],
        ..flat([(9.0, 4.0), (-2.0, 5.0), (3.0, -4.0)], CorrectionOrder::Seventh)
    };
    let travel = |from: f64, to: f64| Some(Travel { from: [Fixed::from_mm(from)], to: [Fixed::from_mm(to)] });
    let shapes = [
        (ph([(3.0, 0.3), (-0.4, 1.1), (0.2, -0.3)], -1.0), travel(1.0, 1.0)),
        (Shape::Line { chord: Complex::new(3.0, 4.0) }, travel(1.0, 2.0)),
        (Shape::Arc { radius: Complex::new(5.0, 0.0), sweep: 2.0, ratio: 1.25 }, None),
        (Shape::Spline(bent), travel(2.0, 3.5)),
        (ph([(0.5, 0.0), (0.6, 0.3), (0.2, 0.2)], 0.0), None),
    ];
    let (header, mut pieces) = chain(header, round_point(Complex::new(5.0, 8.0)), 30.0, shapes);
    let speeds = [0.0, 1.0, 0.4, 0.8, 0.6, 0.0];
    let inner = [[0.1, 0.9], [0.9, 0.5], [0.4, 0.6], [1.0, 0.7], [0.6, 0.0]];
    for ((piece, ends), [b1, b2]) in pieces.iter_mut().zip(speeds.windows(2)).zip(inner) {
        piece.profile = Some(Profile { factors: [ends[0], b1, b2, ends[1]] });
    }
    (header, pieces)
}

/// Shapes one behind the other from the point `at`, with the ways of z.
fn chain(
    header: Header<f32>,
    mut at: [Fixed; 2],
    feed: f32,
    shapes: impl IntoIterator<Item = (Shape<f32>, Option<Travel>)>,
) -> (Header<f32>, Vec<Piece<f32>>) {
    let mut pieces: Vec<Piece<f32>> = Vec::new();
    for (shape, further) in shapes {
        let interval = [0.0, 1.0];
        let mut piece =
            Piece { origin: at, shape, interval, feed, start: None, end: None, profile: None, further, last: None };
        let Some([start, _]) = ends(&header, &piece) else { return (header, Vec::new()) };
        for (origin, (at, start)) in piece.origin.iter_mut().zip(at.into_iter().zip(start)) {
            origin.0 += at.0 - start.0;
        }
        let Some([_, end]) = ends(&header, &piece) else { return (header, Vec::new()) };
        at = end;
        pieces.push(piece);
    }
    let z = pieces.iter().rev().find_map(|piece| piece.further).map_or(Fixed(0), |travel| travel.to[0]);
    if let Some(last) = pieces.last_mut() {
        last.last = Some([at[0], at[1], z]);
    }
    (header, pieces)
}

/// Where a piece begins and where it ends: what a planner would know.
fn ends(header: &Header<f32>, piece: &Piece<f32>) -> Option<[[Fixed; 2]; 2]> {
    let active = ActivePiece::activate(piece, header.weight, shared::TICK).ok()?;
    Some([-0.5, 0.5].map(|tau| active.place(active.point_and_rate(tau).0)))
}

/// About how long a job takes, in s: each piece at its slowest.
pub fn expected_seconds(header: &Header<f32>, pieces: &[Piece<f32>]) -> f64 {
    let slowest = |piece: &Piece<f32>| {
        let active = ActivePiece::activate(piece, header.weight, shared::TICK).ok()?;
        if let Some(profile) = active.profile() {
            return Some(f64::from(profile.duration()));
        }
        // Sixteen looks along the piece; the caller has patience beside this.
        let rates = (0..=16).map(|k| active.rate(k as f32 / 16.0 - 0.5));
        rates.reduce(f32::min).map(|rate| 1.0 / f64::from(rate))
    };
    pieces.iter().filter_map(slowest).sum()
}

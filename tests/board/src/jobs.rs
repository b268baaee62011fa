//! Small jobs of one kind of piece each: what budgets are counted on.

use shared::active::ActivePiece;
use shared::complex::Complex;
use shared::feed::Ramp;
use shared::fixed::{Fixed, round_point};
use shared::pace::PaceLimits;
use shared::piece::{Header, Order, Piece, Shape};

/// The kinds of pieces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A quintic PH curve at an offset distance.
    Ph,
    /// A line.
    Line,
    /// An arc.
    Arc,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Ph, Self::Line, Self::Arc];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ph => "ph",
            Self::Line => "line",
            Self::Arc => "arc",
        }
    }
}

/// The orders and their names in tables.
pub const ORDERS: [(Order, &str); 4] =
    [(Order::First, "1"), (Order::Second, "2"), (Order::Third, "3"), (Order::Exact, "exact")];

/// Two pieces of about 20 mm at 50 mm/s, half a second each, with ramps at both ends, so that the path has a node; the weight is in
/// the middle, so that no term of the feed law vanishes.
pub fn job(kind: Kind, order: Order) -> (Header<f32>, Vec<Piece<f32>>) {
    let header = Header {
        weight: 0.5,
        order,
        closed: false,
        tolerance: 1e-3,
        rest: false,
        pace: PaceLimits::USUAL,
    };
    let shape = match kind {
        Kind::Ph => Shape::Ph {
            preimage: [Complex::new(4.2, 0.3), Complex::new(-0.4, 1.1), Complex::new(0.2, -0.3)],
            offset: -3.0,
        },
        Kind::Line => Shape::Line { chord: Complex::new(16.0, 12.0) },
        Kind::Arc => Shape::Arc { radius: Complex::new(10.0, 0.0), sweep: 2.0, ratio: 1.25 },
    };
    let ramp = Some(Ramp { length: 0.25, factor: 0.25 });
    let origin = round_point(Complex::new(30.0, 20.0));
    let first = Piece {
        origin,
        shape,
        interval: [0.0, 1.0],
        feed: 50.0,
        start: ramp,
        end: ramp,
        further: None,
        last: None,
    };
    let Some(ends) = ends(&header, &first) else { return (header, Vec::new()) };
    // The second piece is the first one moved to where that ended.
    let way = |axis: usize| ends[1][axis].0 - ends[0][axis].0;
    let moved = |from: [Fixed; 2]| [Fixed(from[0].0 + way(0)), Fixed(from[1].0 + way(1))];
    let [x, y] = moved(ends[1]);
    let second = Piece { origin: moved(origin), last: Some([x, y, Fixed(0)]), ..first };
    (header, vec![first, second])
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
        // Sixteen looks along the piece; the caller has patience beside this.
        let rates = (0..=16).map(|k| active.rate(k as f32 / 16.0 - 0.5));
        rates.reduce(f32::min).map(|rate| 1.0 / f64::from(rate))
    };
    pieces.iter().filter_map(slowest).sum()
}

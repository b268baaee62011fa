//! Small jobs of one kind of piece each: what budgets are counted on.

use shared::complex::Complex;
use shared::feed::Ramp;
use shared::fixed::round_point;
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

/// A piece of about 20 mm at 50 mm/s, half a second, with ramps at both ends; the weight is in the middle, so that no term of the
/// feed law vanishes.
pub fn job(kind: Kind, order: Order) -> (Header<f32>, Vec<Piece<f32>>) {
    let header = Header { weight: 0.5, order, closed: false, tolerance: 1e-3 };
    let shape = match kind {
        Kind::Ph => Shape::Ph {
            preimage: [Complex::new(4.2, 0.3), Complex::new(-0.4, 1.1), Complex::new(0.2, -0.3)],
            offset: -3.0,
        },
        Kind::Line => Shape::Line { chord: Complex::new(16.0, 12.0) },
        Kind::Arc => Shape::Arc { radius: Complex::new(10.0, 0.0), sweep: 2.0, ratio: 1.25 },
    };
    let ramp = Some(Ramp { length: 0.25, factor: 0.25 });
    let mut piece = Piece {
        origin: round_point(Complex::new(30.0, 20.0)),
        shape,
        interval: [0.0, 1.0],
        feed: 50.0,
        start: ramp,
        end: ramp,
        last: None,
    };
    piece.last = last_point(&header, &piece);
    (header, vec![piece])
}

/// Where a piece ends: what a planner would know.
fn last_point(header: &Header<f32>, piece: &Piece<f32>) -> Option<shared::fixed::Position> {
    let active = shared::active::ActivePiece::activate(piece, header.weight, shared::TICK).ok()?;
    let [x, y] = active.place(active.point_and_rate(0.5).0);
    Some([x, y, shared::fixed::Fixed(0)])
}

/// About how long a job takes, in s: each piece at its slowest.
pub fn expected_seconds(header: &Header<f32>, pieces: &[Piece<f32>]) -> f64 {
    let slowest = |piece: &Piece<f32>| {
        let active = shared::active::ActivePiece::activate(piece, header.weight, shared::TICK).ok()?;
        // Sixteen looks along the piece; the caller has patience beside this.
        let rates = (0..=16).map(|k| active.rate(k as f32 / 16.0 - 0.5));
        rates.reduce(f32::min).map(|rate| 1.0 / f64::from(rate))
    };
    pieces.iter().filter_map(slowest).sum()
}

//! The way to where a job begins: a straight line in the plane, from rest to rest.

use shared::complex::Complex;
use shared::fixed::{Fixed, Position};
use shared::pace::PaceLimits;
use shared::piece::{Header, Order, Piece, Shape};

/// What the way asks of an axis: mm/s^2, and twenty times as much a second. Every machine bears it.
const ACCELERATION: f64 = 200.0;

/// The shortest way, in mm: less than what a job may begin beside the machine (`shared::control::AWAY_MM`).
const SHORTEST: f64 = 0.5e-3;

/// The path from one point to another at so many mm/s; none where the machine is there. z stays where it is.
pub fn line(from: Position, to: [Fixed; 2], feed: f64) -> Option<(Header<f32>, Piece<f32>)> {
    let [x, y, _] = from;
    let [to_x, to_y] = to;
    let way = |from: Fixed, to: Fixed| to.minus::<f32>(from);
    let chord = Complex::new(way(x, to_x), way(y, to_y));
    if f64::from(chord.norm()) < SHORTEST {
        return None;
    }
    let middle = |from: Fixed, to: Fixed| Fixed(from.0.midpoint(to.0));
    let slope = (ACCELERATION / feed) as f32;
    let header = Header {
        weight: 0.0,
        order: Order::First,
        closed: false,
        tolerance: 1e-3,
        rest: true,
        pace: PaceLimits { slope, bend: 20.0 * slope, most: 1.0 },
    };
    let piece = Piece {
        origin: [middle(x, to_x), middle(y, to_y)],
        shape: Shape::Line { chord },
        interval: [0.0, 1.0],
        feed: feed as f32,
        start: None,
        end: None,
        profile: None,
        further: None,
        last: Some([to_x, to_y, Fixed(0)]),
    };
    Some((header, piece))
}

#[cfg(test)]
mod tests {
    use shared::loader::Loader;

    use super::*;

    /// From any point to any other the loader takes the way, begins it there and ends it exactly; from a point to itself there is none.
    #[test]
    fn the_loader_takes_the_way() {
        let at = |mm: f64| Fixed::from_mm(mm);
        let points = [[0.0, 0.0], [2.0, 2.0], [-3_000.0, 3_999.0], [0.123_456_7, -7.0], [600.0, 400.0]];
        for from in points {
            for to in points {
                let [x, y] = from.map(at);
                let found = line([x, y, at(-5.0)], to.map(at), 30.0);
                assert_eq!(found.is_some(), from != to);
                let Some((header, piece)) = found else { continue };
                let mut loader = Loader::new(&header, shared::TICK).unwrap();
                loader.load(&piece).unwrap();
                let start = loader.start().unwrap();
                for (start, from) in start.into_iter().zip([x, y]) {
                    assert!(start.minus::<f64>(from).abs() < 1e-3, "{from:?} {start:?}");
                }
            }
        }
    }
}

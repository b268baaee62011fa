//! The largest disc inside a closed contour, found by search in the plane: nothing of offsets in it.

use host_sim::contour::Contour;
use host_sim::measure::Nearest;
use shared::complex::Complex;

use crate::winding::Polygon;

/// Points of the first grid in one direction.
const GRID: u32 = 12;
/// Starts that are improved.
const STARTS: usize = 4;
/// Moves and halvings of one search.
const MOVES: u32 = 120;

/// The radius of the largest disc inside `contour`; none if it is open or too thin for the grid. Mostly good to 1e-9, but not
/// certain: good to choose a distance by.
pub fn inside(contour: &Contour) -> Option<f64> {
    if !contour.closed {
        return None;
    }
    let polygon = Polygon::of_contour(contour);
    let nearest = Nearest::new(contour);
    let [low, high] = contour.extent();
    let step = (high - low) * (1.0 / f64::from(GRID));
    let mut starts: Vec<(f64, Complex<f64>)> = (0..GRID * GRID)
        .map(|k| low + Complex::new(step.re * (f64::from(k % GRID) + 0.5), step.im * (f64::from(k / GRID) + 0.5)))
        .filter(|p| polygon.winding(*p) != 0)
        .map(|p| (nearest.at(p).distance, p))
        .collect();
    starts.sort_by(|a, b| b.0.total_cmp(&a.0));
    starts.truncate(STARTS);
    starts.into_iter().map(|start| climb(&nearest, start, step.re.max(step.im))).max_by(f64::total_cmp)
}

/// Pattern search: eight neighbours, nearer and nearer.
fn climb(nearest: &Nearest<'_>, (mut best, mut at): (f64, Complex<f64>), mut step: f64) -> f64 {
    for _ in 0..MOVES {
        let ring = (0..8).map(|k| at + crate::random::unit(f64::from(k) * std::f64::consts::FRAC_PI_4 + 0.1) * step);
        let found = ring.map(|p| (nearest.at(p).distance, p)).max_by(|a, b| a.0.total_cmp(&b.0));
        match found {
            Some((radius, p)) if radius > best => (best, at) = (radius, p),
            _ => step *= 0.5,
        }
    }
    best
}

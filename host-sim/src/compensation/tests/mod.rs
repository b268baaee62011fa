//! Closed forms: paths that can be drawn by hand.

mod rounds;
mod runs;

use shared::complex::Complex;
use shared::curve::Segment;

use super::*;
use crate::contour::Contour;
use crate::measure::Nearest;
use crate::program::rs274;

/// What the sink got.
#[derive(Debug, Default)]
struct Found {
    pieces: Vec<CentrePiece>,
    /// With the number of pieces before each.
    kept: Vec<(usize, Item<'static>)>,
    warnings: Vec<Warning>,
    summary: Summary,
}

fn tools() -> ToolTable {
    let mut tools = ToolTable::default();
    for (number, diameter) in [(1, 2.0), (2, -2.0), (3, 0.0), (4, 12.0)] {
        tools.insert(number, Tool { diameter, ..Tool::default() });
    }
    tools
}

fn try_with(program: &str, options: Options) -> Result<Found, String> {
    let tools = tools();
    let mut found = Found::default();
    let mut sink = |step: Step<'_>| {
        match step {
            Step::Kept(item) => {
                let action = match item.action {
                    Action::Motion(Motion::Rapid { to }) => Action::Motion(Motion::Rapid { to }),
                    Action::Motion(Motion::Line { to }) => Action::Motion(Motion::Line { to }),
                    action => lasting(action).ok_or("no line")?,
                };
                let Item { line, column, from, feed, .. } = *item;
                found.kept.push((found.pieces.len(), Item { line, column, from, feed, action }));
            }
            Step::Centre(pieces) => found.pieces.extend(pieces),
            Step::Warning(warning) => found.warnings.push(*warning),
        }
        Ok(())
    };
    let mut compensator = Compensator::new(&tools, options, &mut sink);
    let text = format!("g21 g17 f600\n{program}\nm2\n");
    let read = rs274::read("t.ngc", text.as_bytes(), &rs274::Settings::default(), &mut |item| compensator.take(item));
    read.map_err(|error| error.to_string())?;
    let summary = compensator.finish()?;
    found.summary = summary;
    for pair in found.pieces.windows(2) {
        let gap = (pair[1].start() - pair[0].end()).norm();
        assert!(gap < 1e-8, "a gap of {gap} between {pair:?}");
    }
    Ok(found)
}

fn with(program: &str) -> Found {
    try_with(program, Options::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn sentence(program: &str) -> String {
    try_with(program, Options::default()).map(|found| format!("{found:?}")).unwrap_err()
}

/// The ends of all pieces.
fn ends(found: &Found) -> Vec<[f64; 2]> {
    found.pieces.iter().map(|piece| [piece.end().re, piece.end().im]).collect()
}

fn assert_ends(found: &Found, wanted: &[[f64; 2]]) {
    let ends = ends(found);
    let near = |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-8;
    assert!(ends.len() == wanted.len() && ends.iter().zip(wanted).all(near), "{ends:?}\nfor {wanted:?}");
}

/// The least distance of the pieces from a contour, on dense samples.
fn clearance(pieces: &[CentrePiece], segments: &[Segment<f64>]) -> f64 {
    let contour = Contour { segments: segments.to_vec(), closed: false };
    let nearest = Nearest::new(&contour);
    let samples = pieces.iter().flat_map(|piece| {
        let [from, to] = piece.interval;
        (0..=200).map(move |k| piece.point(from + (to - from) * f64::from(k) / 200.0))
    });
    samples.map(|point| nearest.at(point).distance).fold(f64::INFINITY, f64::min)
}

fn polygon(corners: &[[f64; 2]]) -> Vec<Segment<f64>> {
    let points: Vec<Complex<f64>> = corners.iter().map(|&[x, y]| Complex::new(x, y)).collect();
    points.windows(2).map(|pair| Segment::Line(shared::curve::Line { start: pair[0], end: pair[1] })).collect()
}

const SQUARE: &str = "g1 x20\ny20\nx0\ny0\n";
const CORNERS: [[f64; 2]; 5] = [[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0], [0.0, 0.0]];

//! What is promised of any bytes behind the readers: strokes, job and path of a program, or one sentence. What a fuzz target and a test have in
//! common.

use host_sim::compensation::{Gouge, Tool, ToolTable};
use host_sim::fit::Kind;
use host_sim::height::Height;
use host_sim::input::InputError;
use host_sim::job::Job;
use host_sim::path::Path;
use host_sim::strokes::{Lines, Pace, Stroke, Tooling, read};
use shared::curve::Segment;
use shared::piece::Order;

/// What becomes of lines, each in turn.
pub const LINES: [Lines; 5] = [
    Lines::Kept,
    Lines::Rounded(0.01),
    Lines::Fitted(Kind::Drivable, 0.01),
    Lines::Fitted(Kind::Arcs, 0.01),
    Lines::Fitted(Kind::Bezier, 0.01),
];

/// Tools as a shop has them, one that is thin, one that is worn beyond its diameter, and one that is wide and long.
pub fn tooling(gouge: Gouge) -> Tooling {
    let mut tools = ToolTable::default();
    let all = [(1, 6.0, 12.5), (2, 0.0, 0.0), (3, -0.2, -1.0), (4, 80.0, 150.0), (5, 1e-4, 1e-7)];
    for (number, diameter, length) in all {
        tools.insert(number, Tool { diameter, length: [0.0, 0.0, length] });
    }
    Tooling { tools, gouge }
}

/// Reads a program, makes its job and the path of it. Panics where what comes is not finite, or an error is no sentence.
pub fn hold(bytes: &[u8], lines: Lines, tooling: &Tooling) -> Result<Path, InputError> {
    let path = path(bytes, lines, tooling);
    if let Err(error) = &path {
        assert!(is_sentence(&error.message), "{error:?}");
    }
    path
}

fn path(bytes: &[u8], lines: Lines, tooling: &Tooling) -> Result<Path, InputError> {
    let (strokes, warnings) = read("program.ngc", bytes, lines, tooling)?;
    warnings.iter().for_each(|warning| assert!(is_sentence(warning), "{warning:?}"));
    strokes.strokes.iter().for_each(|stroke| assert!(is_finite(stroke), "{stroke:?}"));
    assert!(strokes.events.is_sorted_by_key(|event| event.before));
    assert!(strokes.events.iter().all(|event| event.before <= strokes.strokes.len()));
    let path = Path::new(&Job::from_strokes("program.ngc", strokes)?, Order::First)?;
    assert!(!path.pieces.is_empty());
    Ok(path)
}

fn is_sentence(text: &str) -> bool {
    !text.is_empty() && !text.contains('\n')
}

fn is_finite(stroke: &Stroke) -> bool {
    let segment = match stroke.segment {
        Segment::Line(line) => [line.start, line.end].iter().all(|point| point.is_finite()),
        Segment::Arc(arc) => arc.start.is_finite() && arc.radius.is_finite() && arc.sweep.is_finite(),
        Segment::Ph(ph) => ph.start.is_finite() && ph.w.iter().all(|w| w.is_finite()),
        Segment::Spline(spline) => spline.points.iter().all(|point| point.is_finite()),
    };
    let height = match stroke.height {
        Height::Linear { start, slope } => start.is_finite() && slope.is_finite(),
        Height::Bezier(points) => points.iter().all(|z| z.is_finite()),
        Height::Vertical(ends) => ends.iter().all(|z| z.is_finite()),
    };
    let pace = match stroke.pace {
        Pace::Feed(feed) => feed.is_finite() && feed > 0.0,
        Pace::Rapid | Pace::Unset => true,
    };
    let [from, to] = stroke.interval;
    segment && height && pace && stroke.offset.is_finite() && from.is_finite() && to.is_finite() && from < to
}

//! Which curves the tool's centre runs along: the pieces that a job gives, the contour itself, or a loop of its trimmed offset;
//! where they meet in a corner, and how the feed goes down there.

use shared::complex::Complex;

use super::PathPiece;
use super::drivable::drivable;
use super::even::even;
use crate::contour::{Along, SMOOTH};
use crate::input::InputError;
use crate::job::{Corner, Job};
use crate::offset::{Loop, Offset};
use crate::strokes::Pace;
use crate::vector::Vector;

/// How fast a rapid is where nobody plans it, in mm/s.
const RAPID: f64 = 50.0;

/// A trimmed offset, of which a path runs one loop.
#[derive(Clone, Debug, PartialEq)]
pub struct Trimmed {
    /// All of it.
    pub offset: Offset,
    /// The number of the loop that is run.
    pub number: usize,
}

/// The pieces of a path with corners and ramps, not yet checked.
#[derive(Debug)]
pub(super) struct Route {
    pub pieces: Vec<PathPiece>,
    pub closed: bool,
    pub trimmed: Option<Trimmed>,
}

impl Route {
    /// Finds the way of a job. A job that gives its pieces is never trimmed.
    pub(super) fn new(job: &Job) -> Result<Self, InputError> {
        if job.pieces.is_empty() && job.offset != 0.0 {
            return Self::trimmed(job);
        }
        if job.chosen.is_some() {
            let message =
                "there is no loop to choose, because the job gives its pieces or has no offset; leave the choice out";
            return Err(job.choice_error(message));
        }
        let pieces = if !job.strokes.is_empty() {
            strokes(job)?
        } else if job.pieces.is_empty() {
            let whole = |segment| Along::Segment { segment, from: 0.0, to: 1.0 };
            bare(job, (0..job.contour.segments.len()).map(whole)).iter().flat_map(even).collect()
        } else {
            bare(job, job.pieces.iter().map(|given| given.along))
        };
        let closed = job.contour.closed;
        let turns = turns(&pieces, &Vec::from_iter(0..pieces.len()), closed);
        let mut route = Self { pieces, closed, trimmed: None };
        route.mark_corners(job, turns);
        Ok(route)
    }

    fn trimmed(job: &Job) -> Result<Self, InputError> {
        let offset = job.trim()?;
        let (number, Loop { closed, pieces, length, .. }) = choose(job, &offset)?;
        let whole = bare(job, pieces.iter().map(|piece| piece.along));
        let (numbers, pieces): (Vec<usize>, Vec<PathPiece>) =
            drivable(&whole, job.tolerance, job.feed.weight).into_iter().unzip();
        if pieces.is_empty() {
            let length = job.units.length(*length);
            return Err(job.distance_error(format_args!(
                "loop {number} of the trimmed offset is {length} long, too short to be a motion; take a smaller tool or \
                 another loop"
            )));
        }
        let mut route = Self { pieces, closed: *closed, trimmed: None };
        route.mark_corners(job, turns(&whole, &numbers, *closed));
        route.trimmed = Some(Trimmed { offset, number });
        Ok(route)
    }

    /// Sets corners and ramps: where a given piece says so, elsewhere where the way itself turns.
    fn mark_corners(&mut self, job: &Job, turns: Vec<[f64; 2]>) {
        let feed = &job.feed;
        for (number, (piece, turns)) in self.pieces.iter_mut().zip(turns).enumerate() {
            let [start, end] = match job.pieces.get(number) {
                Some(given) => [given.start, given.end],
                None => turns.map(|turn| (turn.abs() > SMOOTH).then(Corner::default)),
            };
            let [into, behind] = turns;
            piece.start_corner = start.map(|_| into);
            piece.end_corner = end.map(|_| behind);
            piece.start = start.and_then(|corner| corner.ramp(feed.reduction, feed.ramp, into));
            piece.end = end.and_then(|corner| corner.ramp(feed.reduction, feed.ramp, behind));
        }
    }
}

/// The turns of the way at both ends of parts of pieces, each given by the number of the piece in `whole`; 0 at free ends.
///
/// Where a piece was cut short or cut in two because of a cusp, its own ends tell: the way is as smooth there as it was.
fn turns(whole: &[PathPiece], numbers: &[usize], closed: bool) -> Vec<[f64; 2]> {
    let turn = |before: usize, after: usize| match (whole.get(before), whole.get(after)) {
        (Some(before), Some(after)) => {
            turn_of(before.space(before.interval[1]).direction, after.space(after.interval[0]).direction)
        }
        _ => 0.0,
    };
    let around = match (numbers.first(), numbers.last()) {
        (Some(&first), Some(&last)) if closed => turn(last, first),
        _ => 0.0,
    };
    let between = numbers.windows(2).map(|pair| match *pair {
        [before, after] if before != after => turn(before, after),
        _ => 0.0,
    });
    let behind: Vec<f64> = between.chain([around]).collect();
    let into = std::iter::once(around).chain(behind.iter().copied());
    into.zip(behind.iter().copied()).map(|(into, behind)| [into, behind]).collect()
}

/// The angle between two directions: signed where both are in the plane, positive anticlockwise.
fn turn_of(before: Vector, after: Vector) -> f64 {
    let (Vector([a, b, 0.0]), Vector([c, d, 0.0])) = (before, after) else { return before.angle(after) };
    (Complex::new(a, b).conj() * Complex::new(c, d)).arg()
}

/// The strokes of a program. Errors: one has no feed.
fn strokes(job: &Job) -> Result<Vec<PathPiece>, InputError> {
    if let Some(stroke) = job.strokes.iter().find(|stroke| stroke.pace == Pace::Unset) {
        let message = "it cuts, and no feed is given for it; give one in units a minute, with F before it in a program, or with --feed";
        return Err(job.line_error(stroke.line, message));
    }
    let piece = |(number, stroke)| PathPiece::of_stroke(number, stroke, RAPID);
    let pieces: Vec<PathPiece> = job.strokes.iter().enumerate().map(piece).flat_map(|piece| even(&piece)).collect();
    if job.strokes.iter().all(|stroke| stroke.offset == 0.0) {
        return Ok(pieces);
    }
    Ok(drivable(&pieces, job.tolerance, job.feed.weight).into_iter().map(|(_, piece)| piece).collect())
}

/// The curves alone.
fn bare(job: &Job, along: impl Iterator<Item = Along>) -> Vec<PathPiece> {
    along.filter_map(|along| PathPiece::new(&job.contour, along, job.offset, job.feed.rate)).collect()
}

/// The loop that a job runs, and its number.
fn choose<'a>(job: &Job, offset: &'a Offset) -> Result<(usize, &'a Loop), InputError> {
    let loops = &offset.loops;
    let last = loops.len().saturating_sub(1);
    if let (None, [only]) = (job.chosen, loops.as_slice()) {
        return Ok((0, only));
    }
    let Some(number) = job.chosen else {
        return Err(job.choice_error(format_args!(
            "the trimmed offset has {} loops, and a run is one of them; choose it with --loop or with `loop` under [offset], \
             from 0 to {last} as `hodograph offset` numbers them",
            loops.len()
        )));
    };
    loops.get(number).map(|found| (number, found)).ok_or_else(|| match last {
        0 => job.choice_error(format_args!("there is no loop {number}; the trimmed offset is the one loop 0")),
        _ => job.choice_error(format_args!(
            "there is no loop {number}; the trimmed offset has {} loops, numbered from 0 to {last}",
            loops.len()
        )),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    fn job(head: &str, rest: &str) -> Job {
        let text = format!("units = \"mm\"\n{head}\n[feed]\nrate = 600.0\nreduction = 0.5\n{rest}");
        Job::from_toml("job.toml", &text).unwrap()
    }

    const SQUARE: &str = "[[segment]]\nline = { start = [0.0, 0.0], to = [10.0, 0.0] }\n\
        [[segment]]\nline = { to = [10.0, 10.0] }\n[[segment]]\nline = { to = [0.0, 10.0] }\n\
        [[segment]]\nline = { to = [0.0, 0.0] }\n";

    /// A closed square turns by a quarter four times, an open one three times.
    #[test]
    fn contour_itself_has_its_corners() {
        let route = Route::new(&job("closed = true", SQUARE)).unwrap();
        for piece in &route.pieces {
            assert!((piece.start_corner.unwrap() - FRAC_PI_2).abs() < 1e-15);
            assert!((piece.end_corner.unwrap() - FRAC_PI_2).abs() < 1e-15);
            assert_eq!(piece.start.unwrap().factor, 0.5);
        }
        let route = Route::new(&job("closed = false", SQUARE)).unwrap();
        assert_eq!(route.pieces.iter().filter(|piece| piece.start_corner.is_some()).count(), 3);
        assert_eq!((route.pieces[0].start_corner, route.pieces[3].end_corner), (None, None));
    }

    /// Half of a fill arc: its tangent is turned by half of the node's angle, and so is the corner there.
    #[test]
    fn given_part_of_a_fill_arc_turns_as_far_as_it_goes() {
        let pieces = "[[piece]]\nsegment = 0\n[[piece]]\nfill = { node = 0, to = 0.5 }\nend_corner = true\n\
            [[piece]]\nsegment = 1\nstart_corner = true\n";
        let job = job("closed = false\n[offset]\ndistance = 2.0", &format!("{SQUARE}{pieces}"));
        let route = Route::new(&job).unwrap();
        assert_eq!(route.pieces[1].along, Along::Fill { node: 0, from: 0.0, to: 0.5 });
        assert!((route.pieces[1].centre_length() - 2.0 * FRAC_PI_4).abs() < 1e-15);
        assert!((route.pieces[1].end_corner.unwrap() - FRAC_PI_4).abs() < 1e-15);
        assert_eq!(route.pieces[0].end_corner, None);
    }

    /// A tool that is just as round as a bend at its tightest: the loop is cut there, for the controller's sake, but it is smooth.
    #[test]
    fn a_cut_at_a_cusp_is_no_corner() {
        use shared::curve::Curve as _;
        let lobe = "[[segment]]\nhermite = { start = [-10.0, 0.0], to = [10.0, 0.0], d0 = [20.0, 60.0], d1 = [20.0, -60.0] }\n";
        let mut job = job("closed = false", lobe);
        job.offset = -1.0 / job.contour.segments[0].curvature(0.5);
        let route = Route::new(&job).unwrap();
        assert!(route.pieces.len() > 1, "no piece goes through the cusp");
        assert!(route.pieces.iter().all(|piece| piece.start_corner.is_none() && piece.end_corner.is_none()));
    }

    #[test]
    fn nothing_to_choose_is_said() {
        let error = Route::new(&job("closed = true", SQUARE).with_loop(Some(0))).unwrap_err();
        assert!(error.to_string().starts_with("--loop: there is no loop to choose"), "{error}");
    }
}

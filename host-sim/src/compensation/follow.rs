//! The centre's path along a chain that may close, overlap and cross itself.
//!
//! A trimmed offset is that of a contour with a tool's side, which does not meet itself. A run is more: an arc leads in, a round closes,
//! runs over its start again, and an arc leads out. What leads in lies on the tool's side, so it must not hold up the tool at the end of
//! the round. The chain is therefore taken apart where it comes back to itself first:
//!
//! - the round, a closed contour, is trimmed as such;
//! - what leads to it is trimmed together with the first half of the round, and the path changes over to that of the round at the first
//!   place that is on both;
//! - what follows is trimmed together with the second half, and the path changes over at the last place on both. It may come back to
//!   itself again.
//!
//! Changing over is exact: the same part of the same segment's offset is in both. A true crossing is made a node first.

use shared::curve::{Arc, Curve as _, Segment};

use super::chain::Chain;
use super::error::{Fault, Warning};
use crate::contour::{Along, Contour};
use crate::offset::{Loop, Offset, OffsetError, Undercut, trim, undercuts};

/// A part of the path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bit {
    /// Where on the chain it begins and ends: number of the link and parameter. A fill arc rests at its node.
    pub at: [f64; 2],
    /// The number of its link; of a fill arc the link before the node.
    pub link: usize,
    /// The arc about a node and the part of it that is run; none along a link.
    pub fill: Option<(Arc<f64>, [f64; 2])>,
}

/// The path along a chain, and what it leaves.
#[derive(Clone, Debug, Default)]
pub(super) struct Course {
    pub bits: Vec<Bit>,
    /// Where on the chain material is left. None is said of an inside corner that keeps the tool's roundness, and no more.
    pub left: Vec<(f64, Option<Warning>)>,
    /// Whether the contour begins with a round.
    pub begins_with_round: bool,
    /// Whether it ends with one.
    pub ends_with_round: bool,
}

/// A fault, and the link that it is about.
pub(super) type Failure = (Fault, usize);

/// How often a chain may cross itself.
const CROSSINGS: usize = 256;

/// Places on the chain that are nearer to each other than this, in parameters, are one.
const CLOSE: f64 = 1e-9;

/// Why a chain is not followed: it crosses itself, or for good.
enum Halt {
    Crossing { links: [usize; 2], at: shared::complex::Complex<f64> },
    Failed(Failure),
}

/// Follows a chain of at least one link at a signed distance; links are split where the chain meets itself.
pub(super) fn follow(chain: &mut Chain, distance: f64) -> Result<Course, Failure> {
    chain.split_at_nodes();
    for _ in 0..CROSSINGS {
        match part(chain, 0, chain.links.len(), distance) {
            Ok(course) => return Ok(course),
            Err(Halt::Failed(failure)) => return Err(failure),
            Err(Halt::Crossing { links: [one, other], at }) => {
                // The later one first: its number is still right then.
                let split = [one.max(other), one.min(other)].map(|link| chain.split_near(link, at));
                if split == [false; 2] || one == other {
                    return Err((Fault::Tangle, one));
                }
            }
        }
    }
    Err((Fault::Tangle, 0))
}

fn part(chain: &Chain, from: usize, to: usize, distance: f64) -> Result<Course, Halt> {
    let Some([start, end]) = chain.first_loop(from, to) else {
        return trimmed(chain, from, to, false, distance);
    };
    let middle = start + (end - start).div_ceil(2);
    let mut course = trimmed(chain, start, end, true, distance)?;
    course.begins_with_round = start == from;
    course.ends_with_round = end == to;
    if start > from {
        let lead = trimmed(chain, from, middle, false, distance)?;
        course = joined(lead, course, Change::First).ok_or_else(|| apart(start, distance))?;
    }
    if end < to {
        let rest = part(chain, middle, to, distance)?;
        course = joined(course, rest, Change::Last).ok_or_else(|| apart(end, distance))?;
    }
    Ok(course)
}

fn apart(link: usize, distance: f64) -> Halt {
    Halt::Failed((Fault::Apart { radius: distance.abs() }, link))
}

/// The part of a trimmed offset that leads along a part of the chain from its start to its end.
fn trimmed(chain: &Chain, from: usize, to: usize, closed: bool, distance: f64) -> Result<Course, Halt> {
    let contour = chain.contour(from, to, closed);
    let offset = trim(&contour, distance).map_err(|error| halt(error, from, distance))?;
    let loops = offset.loops.iter().filter(|l| l.closed == closed);
    let ends = |l: &Loop| {
        let ends = l.pieces.iter().filter_map(|piece| match piece.along {
            Along::Segment { segment, from, to } => Some([segment as f64 + from, segment as f64 + to]),
            Along::Fill { .. } => None,
        });
        ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], [from, to]| [a.min(from), b.max(to)])
    };
    let first = loops.clone().min_by(|a, b| ends(a)[0].total_cmp(&ends(b)[0]));
    let last = loops.max_by(|a, b| ends(a)[1].total_cmp(&ends(b)[1]));
    let (Some(first), Some(last)) = (first, last) else { return Err(apart(from, distance)) };
    if !std::ptr::eq(first, last) {
        return Err(apart(from, distance));
    }
    let bits = bits(&contour, first, from, distance);
    let run = Offset { distance, loops: vec![first.clone()] };
    let left = undercuts(&contour, &run).into_iter().map(|undercut| {
        let (segment, xi) = undercut.from;
        ((from + segment) as f64 + xi, warning(chain, &undercut, [from, to], distance))
    });
    Ok(Course { bits, left: left.collect(), ..Course::default() })
}

fn halt(error: OffsetError, from: usize, distance: f64) -> Halt {
    let link = match error {
        OffsetError::Crossing { segments, at } => {
            return Halt::Crossing { links: segments.map(|segment| from + segment), at };
        }
        OffsetError::Reversal { node: link }
        | OffsetError::Cusp { segment: link }
        | OffsetError::Spline { segment: link } => link,
        OffsetError::Distance | OffsetError::Empty { .. } | OffsetError::Degenerate => 0,
    };
    Halt::Failed((Fault::Offset { error, distance }, from + link))
}

/// A loop in order along the chain. The arc about the node at which a round closes is left out: nothing follows it there.
fn bits(contour: &Contour, run: &Loop, base: usize, distance: f64) -> Vec<Bit> {
    let bit = |along: Along| match along {
        Along::Segment { segment, from, to } => {
            let link = base + segment;
            Some(Bit { at: [link as f64 + from, link as f64 + to], link, fill: None })
        }
        Along::Fill { node, from, to } => {
            let arc = contour.fill_arc(node, distance)?;
            Some(Bit { at: [(base + node + 1) as f64; 2], link: base + node, fill: Some((arc, [from, to])) })
        }
    };
    let mut bits: Vec<Bit> = run.pieces.iter().filter_map(|piece| bit(piece.along)).collect();
    if run.closed {
        let along = |bit: &Bit| if bit.fill.is_some() { f64::INFINITY } else { bit.at[0] };
        let first = (0..bits.len()).min_by(|&a, &b| along(&bits[a]).total_cmp(&along(&bits[b])));
        bits.rotate_left(first.unwrap_or(0));
        let end = (base + contour.segments.len()) as f64;
        bits.retain(|bit| bit.fill.is_none() || bit.at[0] < end);
    }
    bits
}

/// What an undercut is worth: none where it is an inside corner between two motions, both of which are run.
fn warning(chain: &Chain, undercut: &Undercut, [from, to]: [usize; 2], distance: f64) -> Option<Warning> {
    let count = to - from;
    let ahead = (undercut.to.0 + count - undercut.from.0) % count;
    // Around a round, up to where it began.
    let ahead = if ahead == 0 && undercut.to.1 <= undercut.from.1 { count } else { ahead };
    let link = |number: usize| chain.links.get(from + (undercut.from.0 + number) % count);
    let [first, last] = [link(0)?, link(ahead)?];
    let between = (1..ahead).filter_map(link).any(|link| link.motion != first.motion && link.motion != last.motion);
    // Of the first and the last motion something is run before and behind.
    let swallows = |number: f64| number <= CLOSE;
    let is_corner =
        first.motion != last.motion && !between && !swallows(undercut.from.1) && !swallows(1.0 - undercut.to.1);
    if is_corner {
        return None;
    }
    let mut lines = [first.place[0], last.place[0]];
    lines.sort_unstable();
    Some(Warning { lines, column: first.place[1], depth: undercut.depth, at: undercut.deepest, radius: distance.abs() })
}

/// Which place that is on two paths is taken.
#[derive(Clone, Copy, PartialEq)]
enum Change {
    First,
    Last,
}

/// Goes over from one path to the other. None where no place is on both.
fn joined(before: Course, behind: Course, change: Change) -> Option<Course> {
    let along = |bit: &Bit| bit.fill.is_none();
    let common = |b: &Bit| {
        let a = before
            .bits
            .iter()
            .position(|a| along(a) && a.link == b.link && a.at[1].min(b.at[1]) - a.at[0].max(b.at[0]) > CLOSE)?;
        let [low, high] = [before.bits[a].at[0].max(b.at[0]), before.bits[a].at[1].min(b.at[1])];
        Some((a, 0.5 * (low + high)))
    };
    let mut places = behind.bits.iter().enumerate().filter(|(_, bit)| along(bit));
    let found = |(k, bit)| common(bit).map(|(a, at)| (a, k, at));
    let (a, b, place) = match change {
        Change::First => places.find_map(found),
        Change::Last => places.rev().find_map(found),
    }?;
    // One bit along the link, from where the one path has it to where the other does.
    let whole = Bit { at: [before.bits[a].at[0], behind.bits[b].at[1]], ..behind.bits[b] };
    let mut bits = before.bits[..a].to_vec();
    bits.push(whole);
    bits.extend_from_slice(&behind.bits[b + 1..]);
    let left = before.left.into_iter().filter(|(at, _)| *at < place);
    let left = left.chain(behind.left.into_iter().filter(|(at, _)| *at >= place)).collect();
    Some(Course {
        bits,
        left,
        begins_with_round: before.begins_with_round && change == Change::Last,
        ends_with_round: behind.ends_with_round,
    })
}

impl Bit {
    /// The curve, its parameters, and the distance of the centre from it.
    pub fn carrier(&self, chain: &Chain, distance: f64) -> Option<(Segment<f64>, [f64; 2], f64)> {
        match self.fill {
            Some((arc, interval)) => Some((Segment::Arc(arc), interval, 0.0)),
            None => {
                let base = self.link as f64;
                Some((chain.links.get(self.link)?.curve, self.at.map(|at| (at - base).clamp(0.0, 1.0)), distance))
            }
        }
    }

    /// The heights at both ends.
    pub fn z(&self, chain: &Chain) -> Option<[f64; 2]> {
        let link = chain.links.get(self.link)?;
        let [low, high] = link.z;
        Some(match self.fill {
            // A motion straight up or down comes before it.
            Some(_) => [chain.links.get(self.link + 1).map_or(high, |next| next.z[0]); 2],
            None => self.at.map(|at| low + (high - low) * (at - self.link as f64)),
        })
    }

    /// How long the centre's way is, roughly, in mm.
    pub fn length(&self, chain: &Chain, distance: f64) -> f64 {
        let Some((curve, [from, to], offset)) = self.carrier(chain, distance) else { return 0.0 };
        let [a, b] = [from, to].map(|xi| curve.length_to(xi));
        let stretch = 1.0 + offset * curve.curvature(0.5 * (from + to));
        (b - a) * stretch.abs()
    }
}

//! The centre's path along a chain that may close, overlap and cross itself.
//!
//! A trimmed offset is that of a contour with a tool's side, which does not meet itself. A run is more: an arc leads in, a round closes,
//! runs over its start again, and an arc leads out. What leads in lies on the tool's side, so it must not hold up the tool at the end of
//! the round. The chain is therefore taken apart where it comes back to itself first:
//!
//! - the round, a closed contour, is trimmed as such, and run again as far as the chain runs over it again;
//! - what leads to it is trimmed together with the first half of the round, and the path changes over to that of the round at the first
//!   place that is on both;
//! - what follows is trimmed together with the second half, and the path changes over at the last place on both. It may come back to
//!   itself again.
//!
//! Changing over is exact: the same part of the same segment's offset is in both. A true crossing is made a node first.

use shared::complex::Complex;
use shared::curve::{Arc, Curve as _, Segment};

use super::chain::Chain;
use super::error::{Fault, Trouble, WORTH, Warning};
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
    /// The links of its first round.
    pub round: Option<[usize; 2]>,
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
    Crossing { links: [usize; 2], at: Complex<f64> },
    Failed(Failure),
}

/// What is the same for all parts of a chain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    /// The signed distance of the centre.
    pub distance: f64,
    /// Where the tool comes from.
    pub from: Complex<f64>,
}

/// Follows a chain of at least one link at a signed distance; links are split where the chain meets itself.
pub(super) fn follow(chain: &mut Chain, way: Way) -> Result<Course, Failure> {
    chain.split_at_nodes();
    for _ in 0..CROSSINGS {
        match part(chain, [0, chain.links.len()], Need::Both, way) {
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

/// Which of its ends a part of the path has to have. The other one is only there so that the path may change over.
#[derive(Clone, Copy, PartialEq)]
enum Need {
    Start,
    End,
    Both,
}

fn part(chain: &mut Chain, [from, to]: [usize; 2], need: Need, way: Way) -> Result<Course, Halt> {
    let Some([start, end]) = chain.first_loop(from, to) else {
        return trimmed(chain, [from, to], false, need, way);
    };
    let count = end - start;
    chain.close_round(start, end);
    // As far as the chain runs over the round again, the path does, too.
    let again = (end..to).take_while(|&link| chain.run_again(link, start + (link - start) % count)).count();
    let reach = end + again;
    let mut course = trimmed(chain, [start, end], true, Need::Both, way)?;
    course.go_on(count, reach);
    course.round = Some([start, end]);
    course.begins_with_round = start == from;
    course.ends_with_round = reach == to && again % count == 0;
    if start > from {
        let middle = start + count.div_ceil(2);
        let lead = trimmed(chain, [from, middle], false, Need::Start, way)?;
        course = joined(lead, course, Change::First).ok_or_else(|| apart(start, way.distance))?;
    }
    if reach < to {
        let rest = part(chain, [reach - count / 2, to], Need::End, way)?;
        course = joined(course, rest, Change::Last).ok_or_else(|| apart(reach - 1, way.distance))?;
    }
    Ok(course)
}

fn apart(link: usize, distance: f64) -> Halt {
    Halt::Failed((Fault::Apart { radius: distance.abs() }, link))
}

/// The part of a trimmed offset that leads along a part of the chain from its start to its end.
fn trimmed(chain: &Chain, [from, to]: [usize; 2], closed: bool, need: Need, way: Way) -> Result<Course, Halt> {
    let distance = way.distance;
    let contour = chain.contour(from, to, closed);
    let offset = trim(&contour, distance).map_err(|error| halt(error, from, distance))?;
    let loops = offset.loops.iter().filter(|l| l.closed == closed);
    let ends = |l: &Loop| {
        let ends = l.pieces.iter().map(|piece| match piece.along {
            Along::Segment { segment, from, to } => [segment as f64 + from, segment as f64 + to],
            // Where a round closes it also begins.
            Along::Fill { node, .. } if closed && node + 1 == to - from => [0.0, (to - from) as f64],
            Along::Fill { node, .. } => [(node + 1) as f64; 2],
        });
        ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], [from, to]| [a.min(from), b.max(to)])
    };
    // Where the arc about the start of a round is kept in parts, several loops have one: that on the side where the tool comes from is run.
    let off = |l: &Loop| {
        let parts =
            l.pieces.iter().filter(|piece| matches!(piece.along, Along::Fill { node, .. } if node + 1 == to - from));
        let middles = parts.map(|piece| ((piece.start + piece.end) * 0.5 - way.from).norm());
        if closed { middles.fold(f64::INFINITY, f64::min) } else { 0.0 }
    };
    let nearer = |a: &&Loop, b: &&Loop| off(a).total_cmp(&off(b));
    let first = loops.clone().min_by(|a, b| ends(a)[0].total_cmp(&ends(b)[0]).then(nearer(a, b)));
    let last = loops.min_by(|a, b| ends(b)[1].total_cmp(&ends(a)[1]).then(nearer(a, b)));
    let (Some(first), Some(last)) = (first, last) else { return Err(apart(from, distance)) };
    let run = match need {
        Need::Both if !std::ptr::eq(first, last) => return Err(apart(from, distance)),
        Need::Both | Need::Start => first,
        Need::End => last,
    };
    let bits = bits(&contour, run, from, distance);
    let run = Offset { distance, loops: vec![run.clone()] };
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

/// A loop in order along the chain.
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
        // An arc about a node comes before the link behind it.
        let key = |bit: &Bit| (bit.at[0], bit.fill.is_none());
        let before = |a: &Bit, b: &Bit| key(a).0.total_cmp(&key(b).0).then(key(a).1.cmp(&key(b).1));
        let first = (0..bits.len()).min_by(|&a, &b| before(&bits[a], &bits[b]));
        bits.rotate_left(first.unwrap_or(0));
    }
    bits
}

/// What an undercut is worth: none where it is thin, or an inside corner between two motions, both of which are run.
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
    if is_corner || undercut.depth < WORTH {
        return None;
    }
    let mut lines = [first.place[0], last.place[0]];
    lines.sort_unstable();
    Some(Warning {
        trouble: Trouble::Left,
        lines,
        column: first.place[1],
        depth: undercut.depth,
        at: undercut.deepest,
        radius: distance.abs(),
    })
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
        round: before.round.or(behind.round),
        begins_with_round: before.begins_with_round && change == Change::Last,
        ends_with_round: behind.ends_with_round,
    })
}

impl Course {
    /// Makes more of a round of so many links, up to a node. An arc about that node is left out: nothing follows it.
    fn go_on(&mut self, count: usize, reach: usize) {
        let once = std::mem::take(&mut self.bits);
        for round in 0.. {
            let shift = round * count;
            let bits =
                once.iter().map(|bit| Bit { at: bit.at.map(|at| at + shift as f64), link: bit.link + shift, ..*bit });
            let before = self.bits.len();
            self.bits.extend(bits.filter(|bit| bit.link + usize::from(bit.fill.is_some()) < reach));
            if self.bits.len() == before {
                break;
            }
        }
    }
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

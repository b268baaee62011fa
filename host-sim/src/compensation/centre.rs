//! What a run comes to: the pieces of the centre's path from where the tool is to where the run ends.

use shared::curve::{Curve as _, Segment};

use super::Point;
use super::chain::{Chain, Event};
use super::clear::too_near;
use super::curves::SAME;
use super::error::{CompensationError, Trouble, WORTH, Warning};
use super::follow::{Bit, Course, Way, follow};
use super::lead::{self, Entry, First};
use super::piece::CentrePiece;
use super::run::{Lead, Run};
use crate::program::{Action, Feed, Item};

/// The path of a run.
#[derive(Debug)]
pub(super) struct Centre {
    pub pieces: Vec<CentrePiece>,
    /// What happens on the way, and before which piece.
    pub events: Vec<(usize, Item<'static>)>,
    pub left: Vec<Warning>,
    pub corners: usize,
    /// The height where the run begins.
    pub start_z: f64,
    /// Where it begins.
    start: Point,
    pub leaving: Leaving,
}

/// Where the tool is behind a run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaving {
    /// The tool's centre.
    centre: Point,
    /// A node of the part that it touches, the direction there, and the signed distance: where the run ends with a round.
    round: Option<(Point, Point, f64)>,
    feed: Feed,
    place: [usize; 2],
}

impl Leaving {
    /// A programmed point with the tool's centre in the place of x and y.
    pub fn place(&self, [_, _, z]: [f64; 3]) -> [f64; 3] {
        [self.centre.re, self.centre.im, z]
    }

    /// The arc about the corner of a round on the way to a point.
    pub fn rounding(&self, to: Point, z: f64) -> Option<CentrePiece> {
        let (node, tangent, distance) = self.round?;
        let segment = lead::off(node, tangent, distance, to)?;
        let piece = CentrePiece::new(&segment, [0.0, 1.0], 0.0);
        Some(CentrePiece { z: [z; 2], feed: self.feed, place: self.place, ..piece })
    }
}

impl Centre {
    /// Where the piece of this number begins, or the last one ended.
    pub fn point(&self, piece: usize) -> Point {
        match (self.pieces.get(piece), self.pieces.last()) {
            (Some(piece), _) => piece.start(),
            (None, Some(last)) => last.end(),
            (None, None) => self.start,
        }
    }
}

/// Places on the chain that are nearer to each other than this, in parameters, are one.
const CLOSE: f64 = 1e-9;

/// Pieces shorter than this, in mm, are rounding.
const SHORTEST: f64 = 1e-9;

/// The path of a run; none without a motion.
pub(super) fn of(run: &mut Run) -> Result<Option<Centre>, CompensationError> {
    run.close()?;
    let Some(lead) = run.entry else { return Ok(None) };
    let Run { distance, chain, .. } = run;
    let distance = *distance;
    let mut course = Course::default();
    if !chain.links.is_empty() {
        course = follow(chain, Way { distance, from: lead.way.from }).map_err(|(fault, link)| {
            let place = chain.links.get(link).map_or(lead.heading.place, |link| link.place);
            CompensationError { fault, place }
        })?;
    }
    course.bits.retain(|bit| bit.length(chain, distance) > SHORTEST);
    let first = course.bits.first().and_then(|bit| first(bit, &course, chain, &lead.way, distance));
    let mut pieces = Vec::new();
    let onto = lead::onto(&lead.way, distance, first.as_ref())
        .map_err(|fault| CompensationError { fault, place: lead.heading.place })?;
    for segment in &onto {
        pieces.push(leading(&lead, segment, pieces.is_empty()));
    }
    let cut = course.round.and_then(|[from, to]| {
        let round = chain.links[from..to].iter().map(|link| &link.curve);
        too_near(&onto, round, distance.abs()).filter(|(depth, _)| *depth > WORTH)
    });
    let cut = cut.map(|(depth, at)| Warning {
        trouble: Trouble::Entry,
        lines: [lead.heading.place[0]; 2],
        column: lead.heading.place[1],
        depth,
        at,
        radius: distance.abs(),
    });
    let before = pieces.len();
    let along: Vec<CentrePiece> = course.bits.iter().filter_map(|bit| piece(bit, chain, distance)).collect();
    pieces.extend(along);
    let mut events: Vec<(usize, Item<'static>)> = chain
        .events
        .iter()
        .map(|event| (before + course.bits.partition_point(|bit| bit.at[0] < event.node as f64 - CLOSE), event.item))
        .collect();
    level(&mut pieces, &chain.events, &events);
    let pieces = whole(&pieces, &mut events);
    let end = pieces.last().map_or(lead.way.from, CentrePiece::end);
    let leaving = Leaving {
        centre: end,
        round: course.bits.last().filter(|_| course.ends_with_round).and_then(|bit| last(bit, chain, distance)),
        feed: pieces.last().map_or(lead.heading.feed, |piece| piece.feed),
        place: pieces.last().map_or(lead.heading.place, |piece| piece.place),
    };
    let corners = course.left.iter().filter(|(_, warning)| warning.is_none()).count();
    let left = cut.into_iter().chain(course.left.iter().filter_map(|(_, warning)| *warning)).collect();
    Ok(Some(Centre { pieces, events, left, corners, start_z: lead.z[0], start: lead.way.from, leaving }))
}

fn first(bit: &Bit, course: &Course, chain: &Chain, way: &Entry, distance: f64) -> Option<First> {
    let (curve, [from, _], offset) = bit.carrier(chain, distance)?;
    let point = curve.offset_point(from, offset);
    if !course.begins_with_round {
        return Some(First { point, tangent: curve.tangent(from), at_start: bit.at[0] <= CLOSE, is_round: false });
    }
    // Where the arc about the start of a round is kept in part, the tool touches the start, too.
    let radius = point - way.to;
    let at_start = (radius.norm() - distance.abs()).abs() <= SAME;
    Some(First { point, tangent: radius.left() * (1.0 / distance), at_start, is_round: true })
}

/// The node at the end of the chain, if the tool touches it, and the direction there.
fn last(bit: &Bit, chain: &Chain, distance: f64) -> Option<(Point, Point, f64)> {
    let link = chain.links.last()?;
    let is_end = bit.at[1] >= chain.links.len() as f64 - CLOSE;
    is_end.then(|| (link.curve.point(1.0), link.curve.tangent(1.0), distance))
}

/// A curve of the first motion; the arc about its end is at the height of that.
fn leading(lead: &Lead, segment: &Segment<f64>, is_first: bool) -> CentrePiece {
    let heading = lead.heading;
    let [from, to] = lead.z;
    let piece = CentrePiece::new(segment, [0.0, 1.0], 0.0);
    CentrePiece {
        z: [if is_first { from } else { to }, to],
        feed: heading.feed,
        is_rapid: heading.is_rapid && matches!(segment, Segment::Line(_)),
        place: heading.place,
        ..piece
    }
}

fn piece(bit: &Bit, chain: &Chain, distance: f64) -> Option<CentrePiece> {
    let (curve, interval, offset) = bit.carrier(chain, distance)?;
    let link = chain.links.get(bit.link)?;
    // A fill arc has the feed of the motion before it; a rapid has none that an arc could have.
    let paced = match chain.links.get(bit.link + 1) {
        Some(next) if link.is_rapid && bit.fill.is_some() => next,
        _ => link,
    };
    Some(CentrePiece {
        z: bit.z(chain)?,
        feed: paced.feed,
        is_rapid: link.is_rapid && bit.fill.is_none(),
        place: link.place,
        ..CentrePiece::new(&curve, interval, offset)
    })
}

/// Makes heights meet where something between two pieces cannot be reached, unless the program moves up or down just there.
fn level(pieces: &mut [CentrePiece], events: &[Event], places: &[(usize, Item<'static>)]) {
    let rises = events.iter().zip(places).filter(|(event, _)| matches!(event.item.action, Action::Motion(_)));
    let rises: Vec<usize> = rises.map(|(_, &(before, _))| before).collect();
    for after in 1..pieces.len() {
        if !rises.contains(&after) {
            let mean = 0.5 * (pieces[after - 1].z[1] + pieces[after].z[0]);
            pieces[after - 1].z[1] = mean;
            pieces[after].z[0] = mean;
        }
    }
}

/// The same with one piece for all parts of a motion that were cut only to find the path.
fn whole(pieces: &[CentrePiece], events: &mut [(usize, Item<'static>)]) -> Vec<CentrePiece> {
    let mut found: Vec<CentrePiece> = Vec::new();
    let mut left = events.iter_mut().peekable();
    for (number, piece) in pieces.iter().enumerate() {
        let mut is_parted = false;
        while let Some((before, _)) = left.next_if(|(before, _)| *before <= number) {
            *before = found.len();
            is_parted = true;
        }
        match found.last_mut().and_then(|last| Some((last.with(piece)?, last))).filter(|_| !is_parted) {
            Some((both, last)) => *last = both,
            None => found.push(*piece),
        }
    }
    left.for_each(|(before, _)| *before = found.len());
    found
}

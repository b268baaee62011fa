//! What is covered so deeply that nothing of it can be kept: left out before crossings are looked for.
//!
//! A distance changes no faster than the place it is taken at. So where the middle of a strand is nearer to C than |d| by more than
//! the way to its ends, all of the strand is. Where it is nearer, but not by so much, halves are looked at. Of a finely divided
//! contour with a tool much larger than its segments, only strands along the trimmed offset remain.

use super::ground::Ground;
use super::strand::{Source, Strand, Untrimmed};
use super::stretch::Stretch;
use super::trace::ROUNDING;

/// How often a strand is halved.
const HALVINGS: u32 = 2;

/// What is known of a strand from its middle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cover {
    /// Nothing of it can be kept.
    Buried,
    /// Its middle is covered, but what lies beside it may be kept.
    Partly,
    /// Its middle is to be kept.
    Clear,
}

impl Cover {
    /// Whether anything of the strand may be kept.
    pub fn lives(self) -> bool {
        self != Self::Buried
    }
}

/// The same strands, some of them halved, and what covers each.
pub fn bury(ground: &Ground, untrimmed: Untrimmed, distance: f64) -> (Untrimmed, Vec<Cover>) {
    let Untrimmed { strands, own } = untrimmed;
    let mut halved = Untrimmed { strands: Vec::with_capacity(strands.len()), own: 0 };
    let mut covers = Vec::with_capacity(strands.len());
    for (number, strand) in strands.into_iter().enumerate() {
        sift(ground, strand, distance, HALVINGS, &mut |strand: Strand, cover: Cover| {
            halved.strands.push(strand);
            covers.push(cover);
        });
        if number < own {
            halved.own = halved.strands.len();
        }
    }
    (halved, covers)
}

/// Keeps a strand, leaves it out, or looks at its halves.
fn sift(ground: &Ground, strand: Strand, distance: f64, halvings: u32, keep: &mut impl FnMut(Strand, Cover)) {
    let stretch = &strand.stretch;
    let middle = stretch.at(0.0).point;
    // Over a turn of 45 degrees an arc is less than 1.1 times as long as its chord.
    let way = 1.1 * (stretch.start() - middle).norm().max((stretch.end() - middle).norm());
    let limit = distance.abs() - ROUNDING;
    let slack = |stretch: usize| ground.slack(strand.source, stretch);
    let Some((_, foot)) = ground.field.nearest_but(middle, limit, slack) else { return keep(strand, Cover::Clear) };
    if foot.distance < limit - way {
        return keep(strand, Cover::Buried);
    }
    match halves(ground, &strand, distance).filter(|_| halvings > 0) {
        Some(halves) => halves.into_iter().for_each(|half| sift(ground, half, distance, halvings - 1, keep)),
        None => keep(strand, Cover::Partly),
    }
}

/// Both halves of a strand; none of a border, which is kept whole.
fn halves(ground: &Ground, strand: &Strand, distance: f64) -> Option<[Strand; 2]> {
    let (curve, offset) = match strand.source {
        Source::Segment(number) => (*ground.contour.segments.get(number)?, distance),
        Source::Fill(node) => (shared::curve::Segment::Arc(ground.contour.fill_arc(node, distance)?), 0.0),
        Source::Border => return None,
    };
    let Stretch { from, to, .. } = strand.stretch;
    let middle = 0.5 * (from + to);
    let half = |from: f64, to: f64, follows: bool| Strand {
        stretch: Stretch::new(&curve, from, to, offset),
        follows,
        ..*strand
    };
    Some([half(from, middle, strand.follows), half(middle, to, true)])
}

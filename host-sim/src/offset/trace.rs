//! From strands to loops: find where they cross, keep what is nowhere nearer to C than |d|, and follow it from crossing to crossing.
//!
//! At a crossing one strand passes into the reach of the other, which comes out of the reach of the first: what is kept ends on the
//! one and goes on along the other. So a fragment is worth a look only if it begins where its strand comes out and ends where it
//! passes in; whether something else covers it is decided in its middle, far from the crossings, where the distance from C
//! tells clearly.

use std::collections::{HashMap, HashSet};

use super::bury::{Cover, bury};
use super::crossing::{Crossing, crossings};
use super::field::Field;
use super::flat::Flat;
use super::ground::Ground;
use super::strand::Untrimmed;

/// A distance from C that falls short of |d| by less than this, in the unit of the frame, is a rounding.
pub const ROUNDING: f64 = 1e-14;

/// What is kept, not yet polished.
#[derive(Debug)]
pub struct Traced {
    /// The distance that it was traced at, in the frame.
    pub distance: f64,
    /// The untrimmed offset.
    pub untrimmed: Untrimmed,
    /// The crossings of its strands, and what is joined without one.
    pub joints: Vec<Joint>,
    /// Runs of fragments, each beginning where the one before it ends.
    pub loops: Vec<TracedLoop>,
    /// How many strands are to be kept as far as their middles tell, but are part of no fragment: a crossing was not seen.
    pub lost: usize,
}

/// Where two strands cross.
#[derive(Clone, Copy, Debug)]
pub struct Joint {
    /// The strand that what is kept comes along, and its parameter there.
    pub ends: (usize, f64),
    /// The strand that it goes on along.
    pub begins: (usize, f64),
    /// Whether Newton's method could only spoil it.
    pub exact: bool,
}

/// A run of fragments.
#[derive(Clone, Debug)]
pub struct TracedLoop {
    /// In order of travel.
    pub fragments: Vec<Fragment>,
    /// Whether the last one ends where the first one begins.
    pub closed: bool,
}

/// A part of the offset along strands that follow each other.
#[derive(Clone, Debug)]
pub struct Fragment {
    /// The strands, in order along C.
    pub strands: Vec<usize>,
    /// How it begins.
    pub start: End,
    /// How it ends.
    pub end: End,
}

/// An end of a fragment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// At the joint of this number.
    Joint(usize),
    /// With its strand: at an end of an open contour, or nowhere at all on a loop without joints.
    Free,
}

/// Fragments that do not join: a decision fell within rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Undecided;

/// A crossing as it is met on the way along a strand.
#[derive(Clone, Copy, Debug)]
struct Event {
    tau: f64,
    joint: usize,
    /// Whether the strand comes out of another one's reach here (else it passes in).
    begins: bool,
}

/// The trimmed offset at `distance`, in the frame of `ground`. Errors: what is found does not join to loops.
///
/// With `mouths`, necks are taken to be as narrow as rounding where they may be ([`Flat::mouths`]).
pub fn trace(ground: &Ground, distance: f64, mouths: bool) -> Result<Traced, Undecided> {
    let (untrimmed, covers) = bury(ground, Untrimmed::new(ground, distance), distance);
    let limit = distance.abs();
    let flat = Flat::new(ground, &untrimmed, &covers, limit);
    let mut given = flat.ends();
    if mouths {
        given.extend(flat.mouths());
    }
    let (joints, events) = meet(&untrimmed, &covers, given);
    let tracer = Tracer { ground, untrimmed: &untrimmed, covers: &covers, joints: &joints, events: &events, limit };
    let fragments: Vec<Fragment> =
        tracer.candidates().into_iter().filter(|fragment| tracer.is_clear(fragment)).collect();
    let lost = tracer.lost(&fragments);
    let loops = chain(fragments, &joints, &untrimmed)?;
    Ok(Traced { distance, untrimmed, joints, loops, lost })
}

/// All crossings of strands that are not buried, and the joints that are `given`; the strands of these are not asked.
fn meet(untrimmed: &Untrimmed, covers: &[Cover], given: Vec<Joint>) -> (Vec<Joint>, Vec<Vec<Event>>) {
    let strands = &untrimmed.strands;
    let numbers: Vec<usize> =
        (0..strands.len()).filter(|&k| covers.get(k).is_some_and(|cover| cover.lives())).collect();
    let field = Field::new(numbers.iter().filter_map(|&k| Some(strands.get(k)?.stretch)).collect());
    let joined: HashSet<(usize, usize)> =
        given.iter().map(|joint| (joint.ends.0.min(joint.begins.0), joint.ends.0.max(joint.begins.0))).collect();
    let mut joints = Vec::new();
    let mut events: Vec<Vec<Event>> = vec![Vec::new(); strands.len()];
    let mut found: Vec<Crossing> = Vec::new();
    field.pairs(|i, j| {
        let [Some(&a), Some(&b)] = [i, j].map(|k| numbers.get(k)) else { return };
        let [Some(first), Some(second)] = [a, b].map(|k| strands.get(k)) else { return };
        if untrimmed.is_border(a) || untrimmed.neighbours(a, b) || joined.contains(&(a, b)) {
            return;
        }
        found.clear();
        crossings(&first.stretch, &second.stretch, &mut found);
        for crossing in &found {
            // The first strand passes into the reach of the second if it passes to that side of it where C lies.
            let into = crossing.to_left == second.left;
            let [xi, eta] = crossing.tau;
            let joint = joints.len();
            let sides = [(a, xi), (b, eta)];
            joints.push(if into {
                Joint { ends: sides[0], begins: sides[1], exact: false }
            } else {
                Joint { ends: sides[1], begins: sides[0], exact: false }
            });
            for (side, (strand, tau)) in sides.into_iter().enumerate() {
                if let Some(events) = events.get_mut(strand) {
                    events.push(Event { tau, joint, begins: into != (side == 0) });
                }
            }
        }
    });
    for joint in given {
        for ((strand, tau), begins) in [(joint.ends, false), (joint.begins, true)] {
            if let Some(events) = events.get_mut(strand) {
                events.push(Event { tau, joint: joints.len(), begins });
            }
        }
        joints.push(joint);
    }
    for events in &mut events {
        events.sort_by(|a, b| a.tau.total_cmp(&b.tau));
    }
    (joints, events)
}

struct Tracer<'a> {
    ground: &'a Ground,
    untrimmed: &'a Untrimmed,
    covers: &'a [Cover],
    joints: &'a [Joint],
    events: &'a [Vec<Event>],
    limit: f64,
}

impl Tracer<'_> {
    /// Strands that follow each other, as long as none is buried; and whether such a run is a ring.
    fn runs(&self) -> Vec<(Vec<usize>, bool)> {
        let alive = |k: usize| self.covers.get(k).is_some_and(|cover| cover.lives());
        let mut runs: Vec<Vec<usize>> = Vec::new();
        for (k, strand) in self.untrimmed.strands.iter().enumerate().take(self.untrimmed.own) {
            if !alive(k) {
                continue;
            }
            let goes_on = strand.follows && k > 0 && alive(k - 1);
            match runs.last_mut().filter(|_| goes_on) {
                Some(run) => run.push(k),
                None => runs.push(vec![k]),
            }
        }
        let last = self.untrimmed.own.saturating_sub(1);
        let joined = self.untrimmed.strands.first().is_some_and(|first| first.follows) && alive(0) && alive(last);
        if joined && runs.len() > 1 {
            // The last run goes on in the first one.
            if let Some(mut head) = runs.pop() {
                head.append(&mut runs[0]);
                runs[0] = head;
            }
        }
        let ring = joined && runs.len() == 1 && runs.first().is_some_and(|run| run.len() == last + 1);
        runs.into_iter().map(|run| (run, ring)).collect()
    }

    /// Fragments that begin where their strand comes out of another one's reach and end where it passes in.
    fn candidates(&self) -> Vec<Fragment> {
        let mut fragments = Vec::new();
        let last = self.untrimmed.own.saturating_sub(1);
        for (run, ring) in self.runs() {
            let way: Vec<(usize, Option<Event>)> = run
                .iter()
                .flat_map(|&k| {
                    let events = self.events.get(k).into_iter().flatten();
                    std::iter::once((k, None)).chain(events.map(move |&event| (k, Some(event))))
                })
                .collect();
            let first = way.iter().position(|(_, event)| event.is_some_and(|event| event.begins));
            if ring && way.iter().all(|(_, event)| event.is_none()) {
                fragments.push(Fragment { strands: run, start: End::Free, end: End::Free });
                continue;
            }
            // A ring is walked from the first place where it comes out, once around.
            let rotate = if ring { first.unwrap_or(0) } else { 0 };
            let mut current: Option<Fragment> = None;
            let free = !ring && !self.ground.contour.closed;
            if free && run.first() == Some(&0) {
                current = Some(Fragment { strands: Vec::new(), start: End::Free, end: End::Free });
            }
            for &(k, event) in way.iter().skip(rotate).chain(way.iter().take(rotate)) {
                match event {
                    None => {
                        if let Some(fragment) = &mut current {
                            fragment.strands.push(k);
                        }
                    }
                    Some(Event { joint, begins: true, .. }) => {
                        current = Some(Fragment { strands: vec![k], start: End::Joint(joint), end: End::Free });
                    }
                    Some(Event { joint, begins: false, .. }) => {
                        fragments
                            .extend(current.take().map(|fragment| Fragment { end: End::Joint(joint), ..fragment }));
                    }
                }
            }
            if free && run.last() == Some(&last) {
                fragments.extend(current.take());
            }
        }
        fragments
    }

    /// How many clear strands are part of no fragment; those count that are longer than what rounding may take from them.
    fn lost(&self, fragments: &[Fragment]) -> usize {
        const LONG: f64 = 1e-7;
        let kept: HashSet<usize> = fragments.iter().flat_map(|fragment| fragment.strands.iter().copied()).collect();
        let strands = self.untrimmed.strands.iter().zip(self.covers).take(self.untrimmed.own).enumerate();
        let lost = strands.filter(|(number, (strand, cover))| {
            let long = (strand.stretch.start() - strand.stretch.end()).norm() > LONG;
            **cover == Cover::Clear && long && !kept.contains(number)
        });
        lost.count()
    }

    /// Whether no point of a fragment is nearer to C than |d|: looked up in its middle and in that of each of its strands.
    fn is_clear(&self, fragment: &Fragment) -> bool {
        let count = fragment.strands.len();
        let whole = fragment.strands.iter().enumerate().all(|(position, &k)| {
            let [from, to] = interval(fragment, self.joints, position);
            // A short fragment is looked at where it is farthest from its ends; a long one in each strand.
            let shares: &[f64] = if count <= 2 { &[0.5, 0.2, 0.8] } else { &[0.5] };
            shares.iter().all(|share| {
                let Some(strand) = self.untrimmed.strands.get(k) else { return false };
                let point = strand.stretch.at(from + (to - from) * share).point;
                let slack = |stretch: usize| self.ground.slack(strand.source, stretch);
                !self.ground.field.any_nearer(point, self.limit - ROUNDING, slack)
            })
        });
        whole && count > 0
    }
}

/// The parameters between which `fragment` runs on its strand at `position`.
pub fn interval(fragment: &Fragment, joints: &[Joint], position: usize) -> [f64; 2] {
    let from = match fragment.start {
        End::Joint(joint) if position == 0 => joints.get(joint).map(|joint| joint.begins.1),
        _ => None,
    };
    let to = match fragment.end {
        End::Joint(joint) if position + 1 == fragment.strands.len() => joints.get(joint).map(|joint| joint.ends.1),
        _ => None,
    };
    [from.unwrap_or(-0.5), to.unwrap_or(0.5)]
}

/// Joins fragments to loops. Errors: a fragment ends at a joint where none begins, or begins where none ends.
fn chain(fragments: Vec<Fragment>, joints: &[Joint], untrimmed: &Untrimmed) -> Result<Vec<TracedLoop>, Undecided> {
    let on_border = |(strand, _): (usize, f64)| untrimmed.is_border(strand);
    // At a border an open offset ends; there is nothing to go on along.
    let goes_on = |end: End| match end {
        End::Joint(joint) => joints.get(joint).filter(|at| !on_border(at.ends) && !on_border(at.begins)).map(|_| joint),
        End::Free => None,
    };
    let mut beginning: HashMap<usize, usize> = HashMap::new();
    let mut ending: HashMap<usize, usize> = HashMap::new();
    for (number, fragment) in fragments.iter().enumerate() {
        if let Some(joint) = goes_on(fragment.start) {
            beginning.insert(joint, number);
        }
        if let Some(joint) = goes_on(fragment.end) {
            ending.insert(joint, number);
        }
    }
    if beginning.len() != ending.len() || beginning.keys().any(|joint| !ending.contains_key(joint)) {
        return Err(Undecided);
    }
    let next = |fragment: &Fragment| goes_on(fragment.end).and_then(|joint| beginning.get(&joint).copied());
    let before = |fragment: &Fragment| goes_on(fragment.start).and_then(|joint| ending.get(&joint).copied());
    let mut used = vec![false; fragments.len()];
    let mut loops = Vec::new();
    for seed in 0..fragments.len() {
        if used.get(seed) != Some(&false) {
            continue;
        }
        // Back to where an open run begins; around a loop once.
        let mut first = seed;
        while let Some(earlier) = fragments.get(first).and_then(before) {
            first = earlier;
            if first == seed {
                break;
            }
        }
        let mut run = Vec::new();
        let mut closed = false;
        let mut at = Some(first);
        while let Some(number) = at {
            if used.get(number) != Some(&false) {
                closed = number == first;
                break;
            }
            used[number] = true;
            let Some(fragment) = fragments.get(number) else { break };
            run.push(fragment.clone());
            at = next(fragment);
        }
        let ring = run.len() == 1 && run[0].start == End::Free && run[0].end == End::Free;
        let around = ring && run[0].strands.first().and_then(|&k| untrimmed.strands.get(k)).is_some_and(|s| s.follows);
        loops.push(TracedLoop { fragments: run, closed: closed || around });
    }
    Ok(loops)
}

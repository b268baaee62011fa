//! A compensated run: its motions as they are collected.

use shared::complex::Complex;
use shared::curve::Curve as _;

use super::chain::{Chain, Event, Link};
use super::curves::{self, Rising, SAME, flat};
use super::error::{CompensationError, Fault};
use super::lead::Entry;
use crate::program::{Feed, Item, Motion};

/// The motions and events between G41 or G42 and G40.
#[derive(Debug)]
pub(super) struct Run {
    /// The signed distance of the centre from the contour in mm, positive right of travel.
    pub distance: f64,
    /// The first motion; none yet.
    pub entry: Option<Lead>,
    pub chain: Chain,
    /// How far curves may be from those of the program.
    tolerance: f64,
    /// The same for chains of lines, where they become curves.
    lines: Option<f64>,
    /// Lines that wait for the end of their chain: its points, and a link for each line, of which the curve is still missing.
    points: Vec<[f64; 3]>,
    waiting: Vec<Heading>,
    motions: usize,
}

/// The first motion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lead {
    pub way: Entry,
    pub heading: Heading,
    /// The heights at its ends.
    pub z: [f64; 2],
}

/// What all curves of a motion share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Heading {
    pub feed: Feed,
    pub is_rapid: bool,
    pub place: [usize; 2],
    motion: usize,
}

impl Run {
    pub fn new(distance: f64, tolerance: f64, lines: Option<f64>) -> Self {
        Self {
            distance,
            entry: None,
            chain: Chain::default(),
            tolerance,
            lines,
            points: Vec::new(),
            waiting: Vec::new(),
            motions: 0,
        }
    }

    /// The first motion, which begins with the tool's centre at `centre`. Errors: it is a spline, or an arc in another plane.
    pub fn enter(&mut self, centre: Complex<f64>, item: &Item<'_>, motion: &Motion<'_>) -> Result<(), Fault> {
        let (to, arc) = match *motion {
            Motion::Rapid { to } | Motion::Line { to } => (to, None),
            Motion::Arc(arc) => {
                if arc.plane != crate::program::Plane::Xy {
                    return Err(Fault::Plane);
                }
                (arc.to, Some((Complex::new(arc.centre[0], arc.centre[1]), arc.sweep)))
            }
            Motion::Bezier { .. } | Motion::Nurbs(_) => return Err(Fault::EntryCurve),
        };
        let way = Entry { from: centre, to: flat(to), arc };
        self.entry = Some(Lead { way, heading: self.heading(item, motion), z: [item.from[2], to[2]] });
        Ok(())
    }

    fn heading(&mut self, item: &Item<'_>, motion: &Motion<'_>) -> Heading {
        self.motions += 1;
        let is_rapid = matches!(motion, Motion::Rapid { .. });
        Heading { feed: item.feed, is_rapid, place: [item.line, item.column], motion: self.motions }
    }

    /// A motion behind the first one. Errors: it is none that can be offset.
    pub fn take(&mut self, item: &Item<'_>, motion: &Motion<'_>) -> Result<(), Fault> {
        let heading = self.heading(item, motion);
        let from = item.from;
        match *motion {
            Motion::Line { to } if self.waits(&heading, from, to) => {
                if self.points.is_empty() {
                    self.points.push(from);
                }
                self.points.push(to);
                self.waiting.push(heading);
                return Ok(());
            }
            _ => self.close().map_err(|error| error.fault)?,
        }
        let links = match *motion {
            Motion::Rapid { to } | Motion::Line { to } => match curves::line(from, to) {
                Some(line) => vec![line],
                None => {
                    let action = crate::program::Action::Motion(if heading.is_rapid {
                        Motion::Rapid { to }
                    } else {
                        Motion::Line { to }
                    });
                    if from[2] != to[2] {
                        let Item { line, column, feed, .. } = *item;
                        self.event(Item { line, column, from, feed, action })?;
                    }
                    Vec::new()
                }
            },
            Motion::Arc(arc) => curves::arc(from, &arc)?,
            Motion::Bezier { points } => curves::bezier(from, points, self.tolerance)?,
            Motion::Nurbs(curve) => curves::nurbs(&curve, self.tolerance)?,
        };
        self.links(links, heading);
        Ok(())
    }

    /// Whether a line waits for others, to become curves with them.
    fn waits(&self, heading: &Heading, from: [f64; 3], to: [f64; 3]) -> bool {
        let goes_on = self.waiting.last().is_none_or(|last| last.feed == heading.feed);
        let moves = (flat(to) - flat(from)).norm() > SAME;
        let is_level = from[2] == to[2];
        self.lines.is_some() && goes_on && moves && is_level && !matches!(heading.feed, Feed::Duration(_))
    }

    fn links(&mut self, curves: Vec<Rising>, heading: Heading) {
        let Heading { feed, is_rapid, place, motion } = heading;
        let feed = match feed {
            // What took so long as a whole has this rate along the contour; the centre's way has another length.
            Feed::Duration(time) => {
                let flat: f64 = curves.iter().map(|(curve, _)| curve.length()).sum();
                let rise = match (curves.first(), curves.last()) {
                    (Some((_, [low, _])), Some((_, [_, high]))) => high - low,
                    _ => 0.0,
                };
                Feed::Rate(flat.hypot(rise) / time)
            }
            feed => feed,
        };
        let links = curves.into_iter().map(|(curve, z)| Link { curve, z, feed, is_rapid, place, motion });
        self.chain.links.extend(links);
    }

    /// Something that happens where the contour is now. Errors: as those of [`Self::close`].
    pub fn event(&mut self, item: Item<'static>) -> Result<(), Fault> {
        self.close().map_err(|error| error.fault)?;
        self.chain.events.push(Event { node: self.chain.links.len(), item });
        Ok(())
    }

    /// Ends a chain of lines. Errors: no curve follows it, at the place of its first line.
    pub fn close(&mut self) -> Result<(), CompensationError> {
        let points = std::mem::take(&mut self.points);
        let waiting = std::mem::take(&mut self.waiting);
        let (Some(tolerance), Some(first)) = (self.lines, waiting.first()) else { return Ok(()) };
        let z = points.first().map_or(0.0, |point| point[2]);
        let segments =
            curves::polyline(&points, tolerance).map_err(|fault| CompensationError { fault, place: first.place })?;
        for (number, segment) in segments {
            let heading = waiting.get(number).unwrap_or(first);
            self.links(vec![(segment, [z; 2])], *heading);
        }
        Ok(())
    }
}

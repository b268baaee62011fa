//! Small programs whose results are known by other means.

mod curves;
mod events;
mod frames;
mod random;
mod refusals;
mod values;

use super::{Settings, read};
use crate::program::{Action, Arc, Feed, Motion};

/// An item without what it borrows.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Got {
    Rapid([f64; 3]),
    Line([f64; 3]),
    Arc(Arc),
    Bezier(Vec<[f64; 3]>),
    Nurbs { order: usize, points: Vec<[f64; 3]>, weights: Vec<f64>, knots: Vec<f64> },
    Event(Action<'static>),
}

/// An item and where it stands.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    pub place: (usize, usize),
    pub from: [f64; 3],
    pub feed: Feed,
    pub got: Got,
}

/// Everything of a program, and the error that ended it.
pub(super) fn all(program: &str, settings: &Settings) -> (Vec<Placed>, Option<String>) {
    let mut items = Vec::new();
    let result = read("part.ngc", program.as_bytes(), settings, &mut |item| {
        let got = match item.action {
            Action::Motion(Motion::Rapid { to }) => Got::Rapid(to),
            Action::Motion(Motion::Line { to }) => Got::Line(to),
            Action::Motion(Motion::Arc(arc)) => Got::Arc(arc),
            Action::Motion(Motion::Bezier { points }) => Got::Bezier(points.to_vec()),
            Action::Motion(Motion::Nurbs(curve)) => Got::Nurbs {
                order: curve.order,
                points: curve.points.to_vec(),
                weights: curve.weights.to_vec(),
                knots: curve.knots.to_vec(),
            },
            Action::Further { axis, to } => Got::Event(Action::Further { axis, to }),
            Action::Dwell(seconds) => Got::Event(Action::Dwell(seconds)),
            Action::PathMode(mode) => Got::Event(Action::PathMode(mode)),
            Action::Compensation(compensation) => Got::Event(Action::Compensation(compensation)),
            Action::ToolLength(length) => Got::Event(Action::ToolLength(length)),
            Action::ToolSelect(tool) => Got::Event(Action::ToolSelect(tool)),
            Action::ToolChange(tool) => Got::Event(Action::ToolChange(tool)),
            Action::Spindle(spindle) => Got::Event(Action::Spindle(spindle)),
            Action::Coolant(coolant) => Got::Event(Action::Coolant(coolant)),
            Action::Stop { optional } => Got::Event(Action::Stop { optional }),
            Action::End => Got::Event(Action::End),
        };
        items.push(Placed { place: (item.line, item.column), from: item.from, feed: item.feed, got });
        Ok(())
    });
    (items, result.err().map(|error| error.to_string()))
}

/// The items of a program that is right, without its end.
pub(super) fn good(program: &str) -> Vec<Placed> {
    good_with(program, &Settings::default())
}

pub(super) fn good_with(program: &str, settings: &Settings) -> Vec<Placed> {
    let (mut items, error) = all(program, settings);
    assert_eq!(error, None, "{program}");
    assert_eq!(items.pop().map(|item| item.got), Some(Got::Event(Action::End)), "{program}");
    items
}

/// The ends of the motions of a program.
pub(super) fn ends(program: &str) -> Vec<[f64; 3]> {
    ends_with(program, &Settings::default())
}

pub(super) fn ends_with(program: &str, settings: &Settings) -> Vec<[f64; 3]> {
    let end = |item: Placed| match item.got {
        Got::Rapid(to) | Got::Line(to) => Some(to),
        Got::Arc(arc) => Some(arc.to),
        Got::Bezier(points) | Got::Nurbs { points, .. } => points.last().copied(),
        Got::Event(_) => None,
    };
    good_with(program, settings).into_iter().filter_map(end).collect()
}

/// The events of a program.
pub(super) fn events(program: &str) -> Vec<Action<'static>> {
    let event = |item: Placed| if let Got::Event(action) = item.got { Some(action) } else { None };
    good(program).into_iter().filter_map(event).collect()
}

//! The experiments of the feed correction paper: how far the feed fluctuates on its fan and on an airfoil under every way to
//! interpolate, and what the fits of the correction polynomial cost.
//!
//! Everything is in f64, as in the paper; what the controller makes of the same curves in f32 is what `simulate` shows. The feed of a tick
//! is the arc length between two setpoints over the time, so that it says nothing but how well the arc length was met.

mod cost;
mod curves;
mod fits;

use serde::Serialize;
use shared::spline::CorrectionOrder;

use super::Row;
use crate::spline::methods::{Method, drive, feeds};
use crate::spline::{Interpolant, SplineError};

pub use cost::{Term, Times, Total};
pub use curves::{AIRFOIL_SEGMENTS, Airfoil, fan_points};
pub use fits::LEAST_DIVISIONS;

/// The commanded feed, in mm/s.
pub const FEED: f64 = 100.0;

/// The tick of the paper, in s.
pub const TICK: f64 = 1e-3;

/// How often `done` is called by [`reproduce`].
pub const STEPS: u64 = RUNS as u64 + cost::TIMING_ROUNDS + 2;

const RUNS: usize = 14;

/// One curve under one method.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Run {
    /// Fan or airfoil.
    pub curve: &'static str,
    /// How it was interpolated.
    pub method: &'static str,
    /// The paper's figure; empty where it shows none.
    pub figure: &'static str,
    /// The largest departure of the feed from the commanded one below and above, in per cent.
    pub fluctuation_percent: [f64; 2],
    /// The root of the mean square of it, in per cent.
    pub rms_percent: f64,
    /// Ticks.
    pub ticks: usize,
    /// The feed of each tick, in mm/s, for pictures.
    #[serde(skip)]
    pub feeds: Vec<f64>,
}

impl Run {
    /// The largest departure either way, in per cent.
    pub fn largest(&self) -> f64 {
        let [low, high] = self.fluctuation_percent;
        high.max(-low)
    }
}

/// The seventh order from so many samples, with so many nodes of a Gauss rule between two of them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sparse {
    /// Samples of (s, u).
    pub samples: usize,
    /// Where they are: at the nodes of the rule for the fit's own weight, or evenly.
    pub at: &'static str,
    /// Nodes between two samples.
    pub nodes: u32,
    /// The largest fluctuation on the fan, in per cent.
    pub fluctuation_percent: f64,
    /// Operations a segment, the arc length included.
    pub operations: u64,
}

/// All of it.
#[derive(Clone, Debug, Serialize)]
pub struct Reproduction {
    /// What was published, beside what came out here.
    pub rows: Vec<Row>,
    /// Every curve under every method.
    pub runs: Vec<Run>,
    /// Table 2, line by line, at any M.
    pub terms: Vec<Term>,
    /// Operations for a segment of the paper's M.
    pub totals: Vec<Total>,
    /// How the number of samples changes quality and cost.
    pub sparse: Vec<Sparse>,
    /// Times a segment, from this run on this machine.
    pub times: Times,
    /// The airfoil's name.
    pub airfoil: String,
    /// The fan's curve, for pictures.
    #[serde(skip)]
    pub fan: Interpolant<2>,
    /// The airfoil's curve, for pictures.
    #[serde(skip)]
    pub section: Interpolant<2>,
}

/// Runs the experiments; `done` is called [`STEPS`] times. Errors: a sentence, should a curve or a fit be impossible.
pub fn reproduce(airfoil: &Airfoil, mut done: impl FnMut()) -> Result<Reproduction, String> {
    let told = |what: &str, error: SplineError| format!("{what}: {error}");
    let fan = curves::fan().map_err(|error| told("the fan", error))?;
    let section = airfoil.spline().map_err(|error| told(&airfoil.name, error))?;
    let mut runs = Vec::with_capacity(RUNS);
    for (curve, spline, methods) in [("fan", &fan, FAN.as_slice()), ("airfoil", &section, AIRFOIL.as_slice())] {
        let sampled = fits::sampled(spline);
        for &(method, figure, way) in methods {
            let run = run(spline, &sampled, way).ok_or_else(|| format!("{curve}, {method}: there is no such fit"))?;
            runs.push(Run { curve, method, figure, ..run });
            done();
        }
    }
    let sampled = fits::sampled(&fan);
    let mean = sampled.iter().map(|one| one.divisions() as f64).sum::<f64>() / sampled.len() as f64;
    let none = || "the fan has no segments".to_string();
    let first = sampled.first().ok_or_else(none)?;
    // The paper counts for the mean of M, which no segment has.
    let of_mean = fits::divided(&first.segment, first.span, mean.round());
    let terms = cost::terms(&of_mean).ok_or_else(none)?;
    let totals = cost::totals(&of_mean).ok_or_else(none)?;
    done();
    let sparse = sparse(&fan).ok_or_else(none)?;
    done();
    let times = cost::times(&sampled, done);
    let rows = rows(&sampled, mean, &runs, &totals, &times);
    let airfoil = airfoil.name.clone();
    Ok(Reproduction { rows, runs, terms, totals, sparse, times, airfoil, fan, section })
}

/// A way to interpolate.
#[derive(Clone, Copy, Debug)]
enum Way {
    Natural,
    FirstTaylor,
    SecondTaylor,
    Corrected(fits::Kind),
    Iterative,
}

const FAN: [(&str, &str, Way); 10] = {
    use CorrectionOrder as Order;
    use fits::Kind::{Centred, ClosedForm, Controller, Fourteen};
    [
        ("natural", "4(b)", Way::Natural),
        ("first-order Taylor", "4(c)", Way::FirstTaylor),
        ("second-order Taylor", "", Way::SecondTaylor),
        ("seventh order, 14 equations", "4(d)", Way::Corrected(Fourteen)),
        ("seventh order, closed form", "4(e), 5(a)", Way::Corrected(ClosedForm)),
        ("fifth order, u and u_s met", "5(b)", Way::Corrected(Centred(Order::FifthFitted))),
        ("fifth order, u, u_s and u_ss met", "5(c)", Way::Corrected(Centred(Order::FifthJoined))),
        ("seventh order, two samples", "", Way::Corrected(Controller(Order::Seventh))),
        ("ninth order, two samples", "", Way::Corrected(Controller(Order::Ninth))),
        ("iterative", "", Way::Iterative),
    ]
};

const AIRFOIL: [(&str, &str, Way); 4] = {
    use fits::Kind::{ClosedForm, Controller};
    [
        ("natural", "7(b)", Way::Natural),
        ("seventh order, closed form", "7(c)", Way::Corrected(ClosedForm)),
        ("seventh order, two samples", "", Way::Corrected(Controller(CorrectionOrder::Seventh))),
        ("iterative", "", Way::Iterative),
    ]
};

fn run(spline: &Interpolant<2>, sampled: &[fits::Sampled], way: Way) -> Option<Run> {
    let mappings = match way {
        Way::Corrected(kind) => fits::mappings(sampled, kind)?,
        Way::Iterative => fits::mappings(sampled, fits::Kind::Controller(CorrectionOrder::Seventh))?,
        Way::Natural | Way::FirstTaylor | Way::SecondTaylor => Vec::new(),
    };
    let method = match way {
        Way::Natural => Method::Natural,
        Way::FirstTaylor => Method::FirstTaylor,
        Way::SecondTaylor => Method::SecondTaylor,
        Way::Corrected(_) => Method::Corrected(&mappings),
        Way::Iterative => Method::Iterative(&mappings),
    };
    let feeds = feeds(spline, &drive(spline, method, FEED, TICK), TICK);
    let percent = |feed: &f64| 100.0 * (feed / FEED - 1.0);
    let [low, high] = feeds.iter().map(percent).fold([0.0_f64; 2], |[low, high], p| [low.min(p), high.max(p)]);
    let square = feeds.iter().map(percent).map(|p| p * p).sum::<f64>() / feeds.len() as f64;
    let ticks = feeds.len();
    Some(Run {
        curve: "",
        method: "",
        figure: "",
        fluctuation_percent: [low, high],
        rms_percent: square.sqrt(),
        ticks,
        feeds,
    })
}

/// From two samples up to many, and from two nodes up.
fn sparse(fan: &Interpolant<2>) -> Option<Vec<Sparse>> {
    use crate::spline::counted::{Counted, count};
    use crate::spline::methods::{Form, Mapping};

    let even = |count: u32| (1..=count).map(|k| f64::from(k) / f64::from(count + 1) - 0.5).collect::<Vec<_>>();
    // The rule for the weight (1/4 - tau^2)^6: see `shared::spline::fit`.
    let rule = 0.5 / 15.0_f64.sqrt();
    let mut settings = vec![(vec![-rule, rule], "the rule's nodes")];
    settings.extend([2, 3, 4, 8, 16, 99].map(|count| (even(count), "even steps")));
    let mut found = Vec::new();
    for (samples, at) in &settings {
        for nodes in 2..=5 {
            let gauss = fits::gauss(nodes);
            let mapping = |segment| {
                let (length, correction) = fits::sparse(segment, samples, &gauss)?;
                Some(Mapping { length, polynomial: Form::Centred(correction) })
            };
            let mappings: Vec<Mapping> = fan.segments.iter().map(mapping).collect::<Option<_>>()?;
            let feeds = feeds(fan, &drive(fan, Method::Corrected(&mappings), FEED, TICK), TICK);
            let fluctuation_percent = feeds.iter().map(|feed| 100.0 * (feed / FEED - 1.0).abs()).fold(0.0, f64::max);
            let segment = shared::spline::PolynomialSegment(fan.segments.first()?.0.map(|c| c.map(Counted)));
            let (operations, _) = count(|| fits::sparse(&segment, samples, &gauss));
            let operations = operations.sum();
            found.push(Sparse { samples: samples.len(), at, nodes, fluctuation_percent, operations });
        }
    }
    Some(found)
}

fn rows(sampled: &[fits::Sampled], mean: f64, runs: &[Run], totals: &[Total], times: &Times) -> Vec<Row> {
    let largest = |curve: &str, method: &str| {
        runs.iter().find(|run| run.curve == curve && run.method == method).map_or(f64::NAN, Run::largest)
    };
    let row = |name: &str, published, measured| Row::new(name.to_string(), published, measured);
    let mut rows = vec![
        row("fan: segments", 88.0, sampled.len() as f64),
        row("fan: mean M", 440.0, mean),
        row("fan: fluctuation, natural, % (read off figure 4)", 2.0, largest("fan", "natural")),
        row("fan: fluctuation, first-order Taylor, % (read off figure 4)", 0.3, largest("fan", "first-order Taylor")),
        row(
            "fan: fluctuation, closed form, % (read off figure 4)",
            0.005,
            largest("fan", "seventh order, closed form"),
        ),
        row("airfoil: fluctuation, natural, %", 0.5, largest("airfoil", "natural")),
        row("airfoil: fluctuation, closed form, % (at most)", 0.1, largest("airfoil", "seventh order, closed form")),
    ];
    for total in totals {
        if let Some(published) = total.published {
            let name = format!("operations a segment at M = {}, {}", total.divisions, total.name);
            rows.push(Row::new(name, published as f64, total.counted.sum() as f64));
        }
    }
    let published = 123.0 / 214.0;
    rows.push(row("time, closed form about the middle over 14 equations", published, times.centred / times.fourteen));
    rows.push(row(
        "time, closed form in powers as published over 14 equations",
        published,
        times.closed_form / times.fourteen,
    ));
    rows
}

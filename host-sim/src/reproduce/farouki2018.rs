//! The twelve runs of Farouki & Srinathu (2018), section 5: three weights, four reductions, one contour, one mill.
//!
//! The contour is the reconstructed one of `examples/farouki2018.toml`, the machine the drive of
//! `examples/farouki2018-mill.toml` that was fitted to Tables 2 to 4. Table 3 gives measured feeds; the commanded ones stand
//! beside them.

use serde::{Deserialize, Serialize};
use shared::piece::Order;

use super::Row;
use crate::job::{FeedOverride, Job, Reduction};
use crate::measure::exact_time;
use crate::path::Path;
use crate::plant::Plant;
use crate::simulate::{Outcome, SETTLING_TICKS, Sample, simulate};

/// The contour with its trimmed pieces.
pub const CONTOUR: &str = include_str!("../../../examples/farouki2018.toml");
/// The weights w of the runs, as the tables' rows.
pub const WEIGHTS: [f64; 3] = [0.0, 0.5, 1.0];
/// The reductions f of the runs, as the tables' columns.
pub const REDUCTIONS: [f64; 4] = [0.25, 0.5, 0.75, 1.0];

const PUBLISHED: &str = include_str!("farouki2018-tables.json");

/// A row of a published table a weight.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
struct ByWeight {
    #[serde(rename = "w0.0")]
    contact: [f64; 4],
    #[serde(rename = "w0.5")]
    even: [f64; 4],
    #[serde(rename = "w1.0")]
    centre: [f64; 4],
}

#[derive(Deserialize)]
struct Published {
    traversal_time_s: ByWeight,
    max_contour_error_in: ByWeight,
    max_feed_in_per_min: ByWeight,
    max_acceleration_in_s2: ByWeight,
}

/// One of the published tables with what came out here; `[weight][reduction]`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Table {
    /// As the paper names it.
    pub title: &'static str,
    /// The unit of its figures.
    pub unit: &'static str,
    /// How many decimals say what there is to say.
    pub decimals: usize,
    /// The paper's figures.
    pub published: [[f64; 4]; 3],
    /// Those of this run.
    pub measured: [[f64; 4]; 3],
    /// A figure of this run that the paper does not give: its name and its values.
    pub beside: Option<(&'static str, [[f64; 4]; 3])>,
}

/// One of the twelve runs.
#[derive(Clone, Debug, Serialize)]
pub struct Experiment {
    /// w.
    pub weight: f64,
    /// f.
    pub reduction: f64,
    /// The exact integral of equation (21), in s.
    pub exact_time_s: f64,
    /// The result.
    pub outcome: Outcome,
    /// All ticks, for pictures.
    #[serde(skip)]
    pub samples: Vec<Sample>,
}

/// All of it.
#[derive(Clone, Debug, Serialize)]
pub struct Reproduction {
    /// Every figure beside its published one.
    pub rows: Vec<Row>,
    /// Tables 1 to 4.
    pub tables: Vec<Table>,
    /// The runs, weight by weight.
    pub runs: Vec<Experiment>,
    /// What the paper's machine is replaced by.
    pub plant: String,
    /// The job, for pictures.
    #[serde(skip)]
    pub job: Job,
    /// The path of the first run, for pictures.
    #[serde(skip)]
    pub path: Path,
}

/// Runs the experiment; `done` is called after each of the twelve runs. Errors: a sentence, should a run not end.
pub fn reproduce(mut done: impl FnMut()) -> Result<Reproduction, String> {
    let job = Job::from_toml("examples/farouki2018.toml", CONTOUR).map_err(|e| e.to_string())?;
    let mill = Plant::default_mill(f64::from(shared::TICK)).map_err(|e| e.to_string())?;
    let path = Path::new(&job, Order::First).map_err(|e| e.to_string())?;
    let mut runs = Vec::with_capacity(WEIGHTS.len() * REDUCTIONS.len());
    for weight in WEIGHTS {
        for reduction in REDUCTIONS {
            runs.push(experiment(&job, &mill, weight, reduction)?);
            done();
        }
    }
    let published: Published = serde_json::from_str(PUBLISHED).map_err(|e| e.to_string())?;
    let tables = tables(&published, &runs);
    let rows = tables.iter().flat_map(rows).collect();
    Ok(Reproduction { rows, tables, runs, plant: mill.name().to_string(), job, path })
}

/// One run on a copy of `mill`.
fn experiment(job: &Job, mill: &Plant, weight: f64, reduction: f64) -> Result<Experiment, String> {
    let by =
        FeedOverride { weight: Some(weight), reduction: Some(Reduction::Fixed(reduction)), ..FeedOverride::default() };
    let job = job.clone().with_feed(by).map_err(|e| e.to_string())?;
    let path = Path::new(&job, Order::First).map_err(|e| e.to_string())?;
    let mut mill = mill.clone();
    mill.rest_at(path.start());
    let mut samples = Vec::new();
    let drive = |setpoint| mill.advance(setpoint);
    let outcome = simulate(&path, job.units, SETTLING_TICKS, drive, |sample| samples.push(*sample))
        .ok_or("the path does not end")?;
    Ok(Experiment { weight, reduction, exact_time_s: exact_time(&path), outcome, samples })
}

fn tables(published: &Published, runs: &[Experiment]) -> Vec<Table> {
    let measured = |figure: fn(&Experiment) -> f64| {
        let mut cells = [[0.0; 4]; 3];
        for (cell, run) in cells.iter_mut().flatten().zip(runs) {
            *cell = figure(run);
        }
        cells
    };
    let by_weight = |table: &ByWeight| [table.contact, table.even, table.centre];
    vec![
        Table {
            title: "Table 1: traversal time",
            unit: "s",
            decimals: 3,
            published: by_weight(&published.traversal_time_s),
            measured: measured(|run| run.outcome.time_s),
            beside: Some(("exact integral of (21)", measured(|run| run.exact_time_s))),
        },
        Table {
            title: "Table 2: largest contour error",
            unit: "in",
            decimals: 4,
            published: by_weight(&published.max_contour_error_in),
            measured: measured(|run| run.outcome.max_contour_error),
            beside: None,
        },
        Table {
            title: "Table 3: largest measured feed",
            unit: "in/min",
            decimals: 1,
            published: by_weight(&published.max_feed_in_per_min),
            measured: measured(|run| run.outcome.max_measured_feed),
            beside: Some(("commanded", measured(|run| run.outcome.max_feed))),
        },
        Table {
            title: "Table 4: largest acceleration",
            unit: "in/s²",
            decimals: 1,
            published: by_weight(&published.max_acceleration_in_s2),
            measured: measured(|run| run.outcome.max_acceleration),
            beside: None,
        },
    ]
}

fn rows(table: &Table) -> impl Iterator<Item = Row> {
    let cells = table.published.iter().flatten().zip(table.measured.iter().flatten());
    let names = WEIGHTS.iter().flat_map(|w| REDUCTIONS.iter().map(move |f| (w, f)));
    names.zip(cells).map(|((w, f), (&published, &measured))| {
        Row::new(format!("{}, w = {w}, f = {f}", table.title), published, measured)
    })
}

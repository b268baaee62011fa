//! `hodograph plan`: the feed of a job within a machine's limits.

use clap::Args;
use host_sim::job::{Job, Units};
use host_sim::measure::peaks::Verdict;
use host_sim::measure::piece_time;
use host_sim::offset::Along;
use host_sim::path::{Path, PathPiece};
use host_sim::plan::caps::Reason;
use host_sim::plan::{Course, Demand, Recorder, bound};
use host_sim::report;
use host_sim::simulate::run;
use host_sim::strokes::Event;
use serde::Serialize;
use shared::machine::MachineSettings;

use super::Failure;
use super::motion::Motion;
use super::output::{failed, json, write};
use super::planning::Planned;

/// Plan a job's feed within the limits of a machine, run it through the tick, and measure what it asks of the axes
#[derive(Args)]
#[command(
    after_help = "Example:\n  hodograph plan examples/fan.toml --machine examples/machine.toml --bound --report plan.html\n  hodograph plan examples/bracket.toml --machine examples/machine.toml --contour-error 0.005"
)]
pub struct PlanVerb {
    #[command(flatten)]
    motion: Motion,
    /// The plant that a contour error is that of: a TOML file, or `farouki2018-mill`, which is built in
    #[arg(long, value_name = "FILE")]
    plant: Option<String>,
    /// The least time that velocities and accelerations alone would leave, beside that of the plan
    #[arg(long)]
    bound: bool,
    /// Write the result as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<String>,
    /// Write as one HTML file what limits the feed where
    #[arg(long, value_name = "FILE.html")]
    report: Option<String>,
}

/// What `--json` writes.
#[derive(Serialize)]
struct Found {
    time_s: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    bound_s: Option<f64>,
    pieces: usize,
    planned_pieces: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    contour_error: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    contour_error_budget: Option<f64>,
    limited_by: Vec<Share>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    events: Vec<Happening>,
    demand: Option<Demand>,
    units: Units,
}

/// Something that a program does beside moving: it is for a person, or for what stands around the controller.
#[derive(Serialize)]
struct Happening {
    /// When the path is there, in s; the time that it takes itself is not in the plan.
    time_s: f64,
    line: usize,
    what: String,
}

/// How much of the time something limits.
#[derive(Serialize)]
struct Share {
    #[serde(flatten)]
    reason: Reason,
    time_s: f64,
}

impl PlanVerb {
    /// Plans, runs, and writes what was asked for.
    pub fn run(self) -> Result<(), Failure> {
        let (job, original) = self.motion.unplanned()?;
        let planned = self.motion.plan(&original, &job, self.plant.as_deref())?;
        let machine = self.motion.machine()?;
        let demand = machine.as_ref().and_then(|machine| demand(&planned.path, machine, job.units));
        let Planned { path, plan, limits, contour_error } = &planned;
        let bound_s = self.bound.then(|| {
            let course = Course { ends: plan.course.ends, ..Course::new(&original, STEP_MM) };
            bound(&course, limits).time
        });
        if let Some(name) = &self.report {
            let html = report::plan(&job, path, plan, limits).map_err(|error| failed(name, error))?;
            write(name, html.as_bytes())?;
        }
        let mm = job.units.mm();
        let found = Found {
            time_s: plan.time,
            bound_s,
            pieces: original.pieces.len(),
            planned_pieces: path.pieces.len(),
            contour_error: contour_error.map(|[found, _]| found / mm),
            contour_error_budget: contour_error.map(|[_, budget]| budget / mm),
            limited_by: plan.shares().into_iter().map(|(reason, time_s)| Share { reason, time_s }).collect(),
            events: events(&job, path),
            demand,
            units: job.units,
        };
        if let Some(name) = &self.json {
            json(name, &found)?;
        }
        if self.json.as_deref() != Some("-") {
            print(&job, &found);
        }
        Ok(())
    }
}

/// Events that are printed.
const SHOWN: usize = 12;

/// When a planned path is where a program does something.
fn events(job: &Job, path: &Path) -> Vec<Happening> {
    let stroke = |piece: &PathPiece| match piece.along {
        Along::Segment { segment, .. } => segment,
        Along::Fill { node, .. } => node,
    };
    let (mut time, mut pieces) = (0.0, path.pieces.iter().peekable());
    let of = |event: &Event| {
        while let Some(piece) = pieces.next_if(|piece| stroke(piece) < event.before) {
            time += piece_time(piece, path.weight);
        }
        Happening { time_s: time, line: event.line, what: event.what.to_string() }
    };
    job.events.iter().map(of).collect()
}

/// The step of the grid of the bound, in mm.
const STEP_MM: f64 = 0.02;

/// Runs the path through the tick and differentiates its setpoints.
fn demand(path: &Path, machine: &MachineSettings, units: Units) -> Option<Demand> {
    let bar = super::progress(host_sim::measure::exact_time(path));
    let mut recorder = Recorder::new(path);
    let whole = run(path, |tick, executor| {
        if tick.is_multiple_of(1024) {
            bar.set_position(tick / 1024);
        }
        recorder.record(executor.setpoint(), executor.place().map_or(0, |place| place.piece as usize));
    });
    bar.finish_and_clear();
    whole.and_then(|_| recorder.demand(machine, units))
}

fn print(job: &Job, found: &Found) {
    let unit = job.units.short();
    println!("time                {:>12.3} s", found.time_s);
    if let Some(bound) = found.bound_s {
        let percent = 100.0 * (found.time_s / bound - 1.0);
        println!("bound               {bound:>12.3} s  without jerk; the plan takes {percent:.1} % more");
    }
    println!("pieces              {:>12}    of {} of the path", found.planned_pieces, found.pieces);
    if let (Some(error), Some(budget)) = (found.contour_error, found.contour_error_budget) {
        println!("contour error       {error:>12.6} {unit}  of {budget} on the plant");
    }
    for Happening { time_s, line, what } in found.events.iter().take(SHOWN) {
        println!("at {time_s:>12.3} s        line {line}: {what}");
    }
    if found.events.len() > SHOWN {
        println!("                        and {} more; --json has them all", found.events.len() - SHOWN);
    }
    println!("limited by");
    for Share { reason, time_s } in &found.limited_by {
        println!("  {:26}{:>6.1} % of the time", reason.to_string(), 100.0 * time_s / found.time_s);
    }
    if let Some(demand) = &found.demand {
        print_demand(demand, job.units);
    }
}

/// What a run asks of a machine, quantity by quantity.
pub fn print_demand(demand: &Demand, units: Units) {
    let unit = units.short();
    println!("asked of the machine");
    for axis in &demand.axes {
        for (name, asked, per) in
            [("velocity", &axis.velocity, "s"), ("acceleration", &axis.acceleration, "s2"), ("jerk", &axis.jerk, "s3")]
        {
            let percent = 100.0 * asked.peak / asked.limit;
            let verdict = match asked.verdict {
                Verdict::Kept => "",
                Verdict::Exceeded => ", MORE THAN IT BEARS",
                Verdict::Open => ", not certain",
            };
            println!(
                "  {} {name:13} {:>12.1} of {:.1} {unit}/{per}, {percent:.0} % at {:.3} s{verdict}",
                axis.axis, asked.peak, asked.limit, asked.at_s
            );
        }
        println!("  {} corner step   {:>12.1} {unit}/s", axis.axis, axis.corner_step);
    }
    println!(
        "  least time    {:>14.3} s within its velocities and accelerations, at the job's feed and these corner steps",
        demand.least_time_s
    );
}

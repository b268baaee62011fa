//! `hodograph simulate`: one job through the tick and a plant.

use std::io::Write;

use clap::Args;
use host_sim::job::{Job, Units};
use host_sim::path::Path;
use host_sim::plan::{Demand, Recorder};
use host_sim::plant::{Measured, Plant};
use host_sim::report;
use host_sim::simulate::{
    Action, Carried, Entry, Outcome, SETTLING_TICKS, Sample, Script, percent_from, simulate_script,
};
use serde::Serialize;
use shared::motion::MotionCommand;

use super::Failure;
use super::motion::Motion;
use super::output::{create, failed, json, write};
use super::plan::print_demand;

/// Run a job through the controller's tick, on a simulated machine or an ideal one
#[derive(Args)]
#[command(
    after_help = "Example:\n  hodograph simulate examples/farouki2018.toml --weight 0.5 --plant examples/farouki2018-mill.toml --report out.html\n  hodograph simulate examples/farouki2018.toml --rest --at 2=hold --at 4=resume --at 6=override:50 --trace trace.csv"
)]
pub struct Simulate {
    #[command(flatten)]
    motion: Motion,
    /// The machine: a TOML file, or `farouki2018-mill`, which is built in; without one the axes are where their setpoints are
    #[arg(long, value_name = "FILE")]
    plant: Option<String>,
    /// Run at so many per cent of the path's feed, 1 to 200
    #[arg(long = "override", value_name = "PERCENT", value_parser = percent_from)]
    percent: Option<u8>,
    /// Let something happen at a time in s: hold, resume, cancel, override:PERCENT, block:on, block:off (run piece by piece, each
    /// after a resume) or starve:SECONDS (no pieces come); may be given often
    #[arg(long, value_name = "TIME=WHAT")]
    at: Vec<Entry>,
    /// How many pieces the controller's queue holds; all of them where it is left out
    #[arg(long, value_name = "PIECES", value_parser = clap::value_parser!(u32).range(1..))]
    queue: Option<u32>,
    /// Write the result as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<String>,
    /// Write every tick: place, feed, commanded and actual position, contour error
    #[arg(long, value_name = "FILE.csv")]
    trace: Option<String>,
    /// Write the integers that every tick put out
    #[arg(long, value_name = "FILE.csv")]
    setpoints: Option<String>,
    /// Write pictures and tables as one HTML file
    #[arg(long, value_name = "FILE.html")]
    report: Option<String>,
    /// Write one picture of the path, coloured by its feed
    #[arg(long, value_name = "FILE.svg")]
    picture: Option<String>,
}

impl Simulate {
    /// Simulates, and writes what was asked for.
    pub fn run(self) -> Result<(), Failure> {
        let (job, path) = self.motion.path(self.plant.as_deref())?;
        let plant = self.plant.as_deref().map(super::read_plant).transpose()?;
        let machine = self.motion.machine()?;
        let mut recorder = machine.as_ref().map(|_| Recorder::new(&path));
        let (outcome, samples) = self.simulate(&job, &path, plant, recorder.as_mut())?;
        let demand = recorder.zip(machine).and_then(|(recorder, machine)| recorder.demand(&machine, job.units));
        if let Some(name) = &self.report {
            let html = report::simulation(&job, &path, &outcome, &samples).map_err(|error| failed(name, error))?;
            write(name, html.as_bytes())?;
        }
        if let Some(name) = &self.picture {
            let svg = report::picture(&job, &path, &samples).map_err(|error| failed(name, error))?;
            write(name, svg.as_bytes())?;
        }
        if let Some(name) = &self.json {
            json(name, &Found { outcome: &outcome, demand: demand.as_ref() })?;
        }
        if self.json.as_deref() != Some("-") {
            print(&outcome);
            if let Some(demand) = &demand {
                print_demand(demand, job.units);
            }
        }
        Ok(())
    }

    fn script(&self) -> Script {
        let percent = self.percent.map(|percent| MotionCommand::Override { percent });
        let first = percent.map(|command| Entry { time: 0.0, action: Action::Command(command) });
        let entries = first.into_iter().chain(self.at.iter().copied()).collect();
        Script { entries, queue: self.queue.map(|queue| queue as usize) }
    }

    fn simulate(
        &self,
        job: &Job,
        path: &Path,
        plant: Option<Plant>,
        mut recorder: Option<&mut Recorder<'_>>,
    ) -> Result<(Outcome, Vec<Sample>), Failure> {
        let mut trace = self.trace.as_deref().map(create).transpose()?;
        let mut setpoints = self.setpoints.as_deref().map(create).transpose()?;
        if let Some(out) = &mut trace {
            writeln!(out, "tick,piece,xi,u,feed,x_cmd,y_cmd,z_cmd,x_act,y_act,z_act,contour_error,pace,state")
                .map_err(|e| failed("--trace", e))?;
        }
        if let Some(out) = &mut setpoints {
            writeln!(out, "tick,x,y,z").map_err(|e| failed("--setpoints", e))?;
        }
        let bar = super::progress(host_sim::measure::exact_time(path));
        let mut samples = Vec::new();
        let mut written = Ok(());
        let keep = self.report.is_some() || self.picture.is_some();
        let look = |sample: &Sample| {
            if sample.tick.is_multiple_of(1024) {
                bar.set_position(sample.tick / 1024);
            }
            if keep {
                samples.push(*sample);
            }
            if let Some(recorder) = &mut recorder {
                recorder.record(sample.commanded, sample.piece);
            }
            if written.is_ok() {
                written = write_sample(&mut trace, &mut setpoints, sample, job.units);
            }
        };
        let script = self.script();
        let outcome = match plant {
            None => simulate_script(path, &script, job.units, 0, Measured::ideal, look),
            Some(mut plant) => {
                plant.rest_at(path.start());
                simulate_script(path, &script, job.units, SETTLING_TICKS, |setpoint| plant.advance(setpoint), look)
            }
        };
        bar.finish_and_clear();
        for out in [trace.as_mut(), setpoints.as_mut()].into_iter().flatten() {
            written = written.and_then(|()| out.flush());
        }
        written.map_err(|e| failed("--trace or --setpoints", e))?;
        let outcome = outcome.ok_or_else(|| Failure::Run(format!("{}: the path does not end", job.name())))?;
        Ok((outcome, samples))
    }
}

/// What `--json` writes.
#[derive(Serialize)]
struct Found<'a> {
    #[serde(flatten)]
    outcome: &'a Outcome,
    #[serde(skip_serializing_if = "Option::is_none")]
    demand: Option<&'a Demand>,
}

type Csv = Option<Box<dyn Write>>;

fn write_sample(trace: &mut Csv, setpoints: &mut Csv, sample: &Sample, units: Units) -> std::io::Result<()> {
    let [x, y, z] = sample.commanded;
    if let Some(out) = setpoints {
        writeln!(out, "{},{},{},{}", sample.tick, x.0, y.0, z.0)?;
    }
    if let Some(out) = trace {
        let length = |mm: f64| mm / units.mm();
        writeln!(
            out,
            "{},{},{},{},{},{},{},{},{},{},{},{},{},{}",
            sample.tick,
            sample.piece,
            sample.xi,
            sample.u,
            length(sample.feed),
            length(x.to_mm()),
            length(y.to_mm()),
            length(z.to_mm()),
            length(sample.actual.re),
            length(sample.actual.im),
            length(z.to_mm()),
            length(sample.contour_error),
            sample.pace,
            sample.state.name(),
        )?;
    }
    Ok(())
}

fn print(outcome: &Outcome) {
    let unit = outcome.units.short();
    println!("time                {:>12.3} s  ({} ticks)", outcome.time_s, outcome.ticks);
    println!("contact length      {:>12.4} {unit}", outcome.contact_length);
    println!("centre length       {:>12.4} {unit}", outcome.centre_length);
    println!(
        "largest feed        {:>12.1} {unit}/min commanded, {:.1} measured",
        outcome.max_feed, outcome.max_measured_feed
    );
    println!("largest acceleration{:>12.1} {unit}/s2", outcome.max_acceleration);
    println!(
        "contour error       {:>12.6} {unit} at most, {:.6} rms",
        outcome.max_contour_error, outcome.rms_contour_error
    );
    println!("setpoints           {}", outcome.setpoint_hash);
    if outcome.state != "finished" {
        println!("the path is {}", outcome.state);
    }
    for Carried { tick, action, refused } in &outcome.script {
        if let Some(refused) = refused {
            println!("warning: {action} was refused in tick {tick}: {refused}");
        }
    }
    for (axis, (saturated, lost)) in ["x", "y"].iter().zip(outcome.saturated_ticks.iter().zip(outcome.lost_steps)) {
        if *saturated > 0 {
            println!("warning: the drive of {axis} is at its limit in {saturated} ticks; it cannot follow this feed");
        }
        if lost > 0 {
            println!("warning: {axis} loses steps, {lost} full steps at the worst; the part would be spoiled");
        }
    }
    for (axis, ticks) in ["x", "y"].iter().zip(outcome.overrun_ticks) {
        if ticks > 0 {
            println!(
                "warning: {axis} is asked for more steps than its pulses allow in {ticks} ticks; lower the feed or the microsteps"
            );
        }
    }
}

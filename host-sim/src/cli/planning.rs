//! Options of a plan: how a path is run within a machine's limits.

use clap::{Args, ValueEnum};
use host_sim::input::InputError;
use host_sim::job::Job;
use host_sim::machine::PathSettings;
use host_sim::path::Path;
use host_sim::plan::{BudgetError, Budgeted, Limits, Manner, Plan, PlanError, Rests, planned, within_budget};
use host_sim::plant::Plant;
use shared::machine::MachineSettings;

/// What the command line says of a plan.
#[derive(Args)]
pub struct Planning {
    /// What happens where one curve ends and another begins
    #[arg(long, value_enum, default_value_t = Mode::Continuous)]
    mode: Mode,
    /// The largest contour error that the drives may make, in the job's units: G64 P. It is that of the plant, or of the built-in mill where none is named;
    /// the table path of the machine's file may say it too
    #[arg(long, value_name = "ERROR", allow_negative_numbers = true)]
    contour_error: Option<f64>,
    /// Keep to the job's own reductions of the feed at corners besides
    #[arg(long)]
    keep_reductions: bool,
    /// Leave the jerks of the machine out
    #[arg(long)]
    no_jerk: bool,
    /// The feed of the tool's centre at which the path begins, in the job's units a minute; at rest where it is left out
    #[arg(long, value_name = "FEED", allow_negative_numbers = true)]
    start_feed: Option<f64>,
    /// The feed of the tool's centre at which the path ends
    #[arg(long, value_name = "FEED", allow_negative_numbers = true)]
    end_feed: Option<f64>,
}

/// The modes of RS-274.
#[derive(Clone, Copy, ValueEnum)]
enum Mode {
    /// Through corners as fast as the axes bear it: G64
    Continuous,
    /// Rest in every corner: G61
    ExactPath,
    /// Rest wherever one segment ends: G61.1
    ExactStop,
}

/// What is said of a machine that cannot run a program.
pub const NO_Z: &str =
    "the machine has no third axis, and the job moves z; take a machine with x, y and z, or a job in the plane";

/// A planned path.
pub struct Planned {
    /// With its profiles.
    pub path: Path,
    /// How it came about.
    pub plan: Plan,
    /// Within these.
    pub limits: Limits,
    /// The contour error on the plant in mm and what it may be, where there is a budget.
    pub contour_error: Option<[f64; 2]>,
}

impl Planning {
    /// Plans a path for a machine, whose file is named `machine`. Errors: limits that are none, a machine without two axes, a feed at an end that
    /// cannot be, a budget that the plant does not keep.
    pub fn plan(
        &self,
        path: &Path,
        job: &Job,
        (name, machine, settings): (&str, &MachineSettings, &PathSettings),
        plant: Option<&str>,
    ) -> Result<Planned, InputError> {
        let mm = job.units.mm();
        let limits = Limits::of(machine, settings)
            .ok_or_else(|| InputError::new(name, "the machine has no two axes; a path in the plane needs x and y"))?;
        let limits = if self.no_jerk { Limits { jerk: [f64::INFINITY; 3], ..limits } } else { limits };
        let end = |option: &str, feed: Option<f64>| match feed {
            Some(feed) if !(feed >= 0.0 && feed.is_finite()) => {
                Err(InputError::new(option, format_args!("the feed is {feed}; it must be a number, zero or above")))
            }
            feed => Ok(Some(feed.map_or(0.0, |feed| feed * mm / 60.0))),
        };
        let manner = Manner {
            rests: match self.mode {
                Mode::Continuous => Rests::Never,
                Mode::ExactPath => Rests::InCorners,
                Mode::ExactStop => Rests::AtNodes,
            },
            reductions: self.keep_reductions,
            ends: [end("--start-feed", self.start_feed)?, end("--end-feed", self.end_feed)?],
        };
        let unplanned = |error: PlanError| {
            let (option, most, what) = match error {
                PlanError::Start { most } => ("--start-feed", most, "begin"),
                PlanError::End { most } => ("--end-feed", most, "end"),
                PlanError::NoLimit => return InputError::new(name, NO_Z),
            };
            let (most, unit) = (most * 60.0 / mm, job.units.short());
            InputError::new(
                option,
                format_args!(
                    "within the limits of {name} the path can {what} at {most:.1} {unit}/min at most; ask for less"
                ),
            )
        };
        let budget = self.contour_error.map(|error| error * mm).or(settings.contour_error);
        let Some(budget) = budget else {
            let (path, plan) = planned(path, &limits, &manner).map_err(unplanned)?;
            return Ok(Planned { path, plan, limits, contour_error: None });
        };
        if !(budget > 0.0 && budget.is_finite()) {
            let given = budget / mm;
            return Err(InputError::new(
                "--contour-error",
                format_args!("the budget is {given}; it must be a number above zero"),
            ));
        }
        let plant_name = plant.unwrap_or("farouki2018-mill");
        let plant: Plant = super::read_plant(plant_name)?;
        let found = within_budget(path, &limits, &manner, &plant, budget).map_err(|error| match error {
            BudgetError::Plan(error) => unplanned(error),
            BudgetError::Never { error } => {
                let asked = if self.contour_error.is_some() { "--contour-error" } else { name };
                let (budget, unit) = (budget / mm, job.units.short());
                let found = error.map_or_else(String::new, |error| format!(", {:.6} {unit} at the least", error / mm));
                InputError::new(
                    asked,
                    format_args!(
                        "no plan was found with which the plant {plant_name} keeps {budget} {unit} on this path{found}; allow more, or take \
                         another plant"
                    ),
                )
            }
        })?;
        let Budgeted { path, plan, limits, error } = found;
        Ok(Planned { path, plan, limits, contour_error: Some([error, budget]) })
    }
}

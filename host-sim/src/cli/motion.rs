//! Options that change the motion, the same for every verb that has one.

use clap::{Args, ValueEnum};
use host_sim::input::InputError;
use host_sim::job::{FeedOverride, Job, Reduction};
use host_sim::path::Path;
use shared::machine::MachineSettings;
use shared::piece::Order;

use super::planning::{NO_Z, Planned, Planning};
use super::tooling::Tools;

/// A job and what the command line says of its motion.
#[derive(Args)]
pub struct Motion {
    /// The job: a contour in TOML
    pub job: String,
    /// w: 0 keeps the feed of the contact point, 1 that of the tool's centre
    #[arg(long, value_name = "W", allow_negative_numbers = true)]
    weight: Option<f64>,
    /// f: what is left of the feed at a corner. `auto` goes by its angle theta, so that the velocity always changes by the same
    /// step: f = 0.177/sin(|theta|/2), which is 0.25 at a right angle, and lambda = ramp (1 - f^2)/0.9375; no ramp below 20.4
    /// degrees
    #[arg(long, value_name = "F|auto", allow_negative_numbers = true)]
    reduction: Option<Reduction>,
    /// lambda: the part of a piece on which the feed changes at a corner
    #[arg(long, value_name = "LAMBDA", allow_negative_numbers = true)]
    ramp: Option<f64>,
    /// Which loop of the trimmed offset to run, by the number that `hodograph offset` lists
    #[arg(long = "loop", value_name = "N")]
    chosen: Option<usize>,
    /// V in the job's units a minute
    #[arg(long, value_name = "V", allow_negative_numbers = true)]
    feed: Option<f64>,
    /// How a tick integrates the feed law
    #[arg(long, value_enum, default_value_t = OrderName::First)]
    order: OrderName,
    /// The machine that shall run it: a job that leaves the machine's travel is refused, and a simulation says what it asks of the axes
    #[arg(long, value_name = "MACHINE.toml")]
    machine: Option<String>,
    /// Where on the machine the job's zero stands, in the job's units, as 100,50 or 100,50,-20: what lies within its travel depends on it
    #[arg(long, value_name = "X,Y,Z", value_parser = zero_from, default_value = "0,0", allow_hyphen_values = true)]
    zero: [f64; 3],
    #[command(flatten)]
    tools: Tools,
    #[command(flatten)]
    pacing: super::pacing::Pacing,
    /// Plan the feed within the limits of --machine: as fast as its axes bear, from rest to rest. Without it the job's own feed law is run
    #[arg(long, requires = "machine")]
    plan: bool,
    #[command(flatten)]
    planning: Planning,
}

/// The interpolator's order as it is written.
#[derive(Clone, Copy, ValueEnum)]
pub enum OrderName {
    /// Equation (22)
    #[value(name = "1")]
    First,
    /// With the term in dt^2
    #[value(name = "2")]
    Second,
    /// With the term in dt^3
    #[value(name = "3")]
    Third,
    /// The integral to rounding
    #[value(name = "exact")]
    Exact,
}

/// Two or three numbers with commas between them; z is 0 where there are two.
fn zero_from(text: &str) -> Result<[f64; 3], String> {
    let number = |part: &str| part.trim().parse().ok().filter(|x: &f64| x.is_finite());
    let numbers: Option<Vec<f64>> = text.split(',').map(number).collect();
    match numbers.as_deref() {
        Some(&[x, y]) => Ok([x, y, 0.0]),
        Some(&[x, y, z]) => Ok([x, y, z]),
        _ => Err("two or three numbers with commas between them are needed, as 100,50 or 100,50,-20".to_string()),
    }
}

impl Motion {
    /// Whether the job's zero is said to stand elsewhere than the machine's.
    pub fn is_elsewhere(&self) -> bool {
        self.zero != [0.0; 3]
    }

    /// The machine that was named.
    pub fn machine(&self) -> Result<Option<MachineSettings>, InputError> {
        self.machine.as_deref().map(host_sim::machine::read).transpose()
    }

    /// Reads the job and makes its path, planned where that is asked for; `plant` is what a budget of contour error is about.
    pub fn path(&self, plant: Option<&str>) -> Result<(Job, Path), InputError> {
        let (job, path) = self.unplanned()?;
        if !self.plan {
            return Ok((job, path));
        }
        let Planned { path, .. } = self.plan(&path, &job, plant)?;
        Ok((job, path))
    }

    /// Plans a path for the machine that was named.
    pub fn plan(&self, path: &Path, job: &Job, plant: Option<&str>) -> Result<Planned, InputError> {
        let Some(name) = &self.machine else {
            return Err(InputError::new("--machine", "a plan needs the limits of a machine; name its file"));
        };
        let (machine, settings) = host_sim::machine::read_for_plan(name)?;
        let planning = super::spinner(&format!("planning {} pieces", path.pieces.len()));
        let planned = self.planning.plan(path, job, (name, &machine, &settings), plant);
        planning.finish_and_clear();
        planned
    }

    /// Reads the job and makes its path, at the job's own feed.
    pub fn unplanned(&self) -> Result<(Job, Path), InputError> {
        let by = FeedOverride { rate: self.feed, weight: self.weight, reduction: self.reduction, ramp: self.ramp };
        // A program of CAM may take seconds to read, fit and check.
        let reading = super::spinner(&format!("reading {}", self.job));
        let job = Job::read_with(&self.job, &self.tools.read()?)?.with_feed(by)?.with_loop(self.chosen);
        reading.finish_and_clear();
        for warning in &job.warnings {
            eprintln!("warning: {warning}");
        }
        let order = match self.order {
            OrderName::First => Order::First,
            OrderName::Second => Order::Second,
            OrderName::Third => Order::Third,
            OrderName::Exact => Order::Exact,
        };
        let checking = super::spinner("making its path");
        let path = self.pacing.apply(Path::new(&job, order)?, &job)?;
        checking.finish_and_clear();
        if let Some(name) = &self.machine {
            let machine = host_sim::machine::read(name)?;
            if path.moves_z() && machine.axes.len() < 3 {
                return Err(InputError::new(name, NO_Z));
            }
            let machine = machine.activate();
            let machine = machine.map_err(|error| InputError::new(name, error))?;
            let [x, y, z] = self.zero.map(|x| x * job.units.mm());
            path.check_travel(&job, &machine.soft_limits().seen_from([x, y], [z]))?;
        }
        Ok((job, path))
    }
}

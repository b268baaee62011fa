//! A plan that keeps a machine's contour error within a budget.
//!
//! A drive follows its setpoint with a lag. On a straight way all axes lag alike and nothing shows; a step of velocity at a corner cuts it
//! or swings beyond it, and across a bend the lag pulls inwards, by the acceleration across. Both are read off the plant itself: the
//! step at a right-angled corner, and the acceleration on a circle, at which its error is the budget. With these as limits the whole
//! job is planned and run on the plant, and what is left of the budget, or goes beyond it, scales them once more.

use shared::complex::Complex;
use shared::fixed::round_point;

use super::limits::Limits;
use super::manner::Manner;
use super::planner::{Plan, PlanError, planned};
use crate::job::Units;
use crate::path::Path;
use crate::plant::{Measured, Plant};
use crate::simulate::{SETTLING_TICKS, simulate};
use shared::fixed::Fixed;

/// A path within a budget of contour error.
#[derive(Clone, Debug)]
pub struct Budgeted {
    /// The path with its profiles, and the plan.
    pub path: Path,
    /// How it came about.
    pub plan: Plan,
    /// The limits that keep the budget.
    pub limits: Limits,
    /// The largest contour error on the plant, in mm.
    pub error: f64,
}

/// Why there is no plan within a budget.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BudgetError {
    /// There is no plan at all.
    Plan(PlanError),
    /// The plant makes a larger error, in mm, also where it crawls.
    Never {
        /// The smallest that was found; none where no run came to its end.
        error: Option<f64>,
    },
}

/// What a plant bears within a budget of contour error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// The step of both axes' velocities at a right-angled corner, in mm/s.
    pub corner_step: f64,
    /// The acceleration across the path, in mm/s^2.
    pub centripetal: f64,
}

/// The radius of the circle on which a plant is tried, in mm.
const RADIUS: f64 = 20.0;

/// Halvings of the range in which a speed is looked for.
const HALVINGS: u32 = 14;

impl Response {
    /// Asks the plant, up to a speed in mm/s and an acceleration in mm/s^2; what keeps the budget up to there is not limited.
    pub fn of(plant: &Plant, budget: f64, fastest: f64, steepest: f64) -> Self {
        let corner_step = largest(fastest, |speed| corner_error(plant, speed) <= budget);
        let speed = largest((steepest * RADIUS).sqrt(), |speed| bend_error(plant, speed) <= budget);
        Self { corner_step, centripetal: speed * speed / RADIUS }
    }
}

/// The largest speed up to `most` that does, if lower ones do; infinite where all do.
fn largest(most: f64, does: impl Fn(f64) -> bool) -> f64 {
    if does(most) {
        return f64::INFINITY;
    }
    let (mut low, mut high) = (0.0, most);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if does(middle) { low = middle } else { high = middle }
    }
    low
}

/// Runs a plant along `at`, a point for each tick, and gives the largest of `error` from tick `from` on.
fn run(
    plant: &Plant,
    ticks: u32,
    from: u32,
    at: impl Fn(f64) -> Complex<f64>,
    error: impl Fn(Complex<f64>) -> f64,
) -> f64 {
    let mut plant = plant.clone();
    let setpoint = |tick: u32| {
        let [x, y] = round_point(at(f64::from(tick) * f64::from(shared::TICK)));
        [x, y, Fixed(0)]
    };
    plant.rest_at(setpoint(0));
    let mut most = 0.0_f64;
    for tick in 1..=ticks {
        let Measured { position: [x, y, _], .. } = plant.advance(setpoint(tick));
        if tick > from {
            most = most.max(error(Complex::new(x, y)));
        }
    }
    most
}

/// The way after `time` that begins at rest and has come to `speed` after `ramp`, both in s, smoothly.
fn way(speed: f64, ramp: f64, time: f64) -> f64 {
    if time >= ramp {
        return speed * (time - 0.5 * ramp);
    }
    let t = time / ramp;
    // The integral of t^2 (3 - 2 t).
    speed * ramp * t * t * t * (1.0 - 0.5 * t)
}

/// The largest distance from a right-angled corner that is run at a constant speed.
fn corner_error(plant: &Plant, speed: f64) -> f64 {
    const RAMP: f64 = 0.25;
    const CORNER: f64 = 0.5;
    let corner = way(speed, RAMP, CORNER);
    let at = |time: f64| {
        let way = way(speed, RAMP, time);
        if way < corner { Complex::new(way - corner, 0.0) } else { Complex::new(0.0, way - corner) }
    };
    run(plant, 768, 410, at, |p| p.re.max(0.0).hypot(p.im).min(p.re.hypot(p.im.min(0.0))))
}

/// The largest distance from a circle on one turn at a constant speed.
fn bend_error(plant: &Plant, speed: f64) -> f64 {
    const RAMP: f64 = 0.5;
    let turn = std::f64::consts::TAU * RADIUS / speed.max(1.0);
    let at = |time: f64| {
        let (sine, cosine) = (way(speed, RAMP, time) / RADIUS).sin_cos();
        Complex::new(RADIUS * cosine, RADIUS * sine)
    };
    let ticks = |time: f64| (time / f64::from(shared::TICK)) as u32;
    run(plant, ticks(2.0 * RAMP + turn), ticks(1.5 * RAMP), at, |p| (p.norm() - RADIUS).abs())
}

/// Plans a path so that its contour error on `plant` is at most `budget` mm, and near to it where the limits do not come first.
///
/// Errors: no plan at all, or a budget that the plant does not keep at any speed.
pub fn within_budget(
    path: &Path,
    limits: &Limits,
    manner: &Manner,
    plant: &Plant,
    budget: f64,
) -> Result<Budgeted, BudgetError> {
    /// Attempts, and how near to the budget is near enough.
    const ATTEMPTS: u32 = 10;
    const SCALED_ALONE: u32 = 2;
    const NEAR: f64 = 0.08;
    /// How many times slower bends are run than the axes bear, at the most. What a plant is off by then has other causes than speed, and a
    /// job that takes so long is no answer. A corner may become a rest.
    const CRAWL: f64 = 30.0;
    let (free, plan) = planned(path, limits, manner).map_err(BudgetError::Plan)?;
    let error = contour_error(&free, plant);
    let fastest = plan.speed.iter().copied().fold(0.0, f64::max);
    if error <= budget {
        return Ok(Budgeted { path: free, plan, limits: *limits, error });
    }
    let [ax, ay, _] = limits.acceleration;
    let steepest = ax.hypot(ay);
    let response = Response::of(plant, budget, fastest, steepest);
    let gentlest = steepest / (CRAWL * CRAWL);
    let (mut scale, mut gentle) = (1.0, 1.0);
    let mut best: Option<Budgeted> = None;
    let mut least = error;
    for attempt in 0..ATTEMPTS {
        let tried = Limits {
            corner_step: limits.corner_step.map(|step| step.min(response.corner_step * scale)),
            centripetal: limits.centripetal.min((response.centripetal * scale).max(gentlest)),
            acceleration: limits.acceleration.map(|a| a * gentle),
            jerk: limits.jerk.map(|j| j * gentle),
            ..*limits
        };
        let (path, plan) = planned(path, &tried, manner).map_err(BudgetError::Plan)?;
        let error = contour_error(&path, plant);
        least = least.min(error);
        let found = Budgeted { path, plan, limits: tried, error };
        if error <= budget && best.as_ref().is_none_or(|best| found.plan.time < best.plan.time) {
            best = Some(found);
        }
        if error <= budget && error >= budget * (1.0 - NEAR) {
            break;
        }
        // The error grows about as the steps and accelerations do; half of the budget's own margin stays. Braking into a corner has a part in
        // it that no corner step tells.
        let ratio = budget * (1.0 - 0.5 * NEAR) / error;
        scale *= ratio.clamp(0.2, 3.0);
        if attempt >= SCALED_ALONE {
            gentle *= ratio.clamp(0.5, 1.0);
        }
    }
    best.ok_or(BudgetError::Never { error: least.is_finite().then_some(least) })
}

/// The largest contour error of a path on a plant, in mm.
fn contour_error(path: &Path, plant: &Plant) -> f64 {
    let mut plant = plant.clone();
    plant.rest_at(path.start());
    let outcome = simulate(path, Units::Mm, SETTLING_TICKS, |setpoint| plant.advance(setpoint), |_| ());
    outcome.map_or(f64::INFINITY, |outcome| outcome.max_contour_error)
}

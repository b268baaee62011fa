//! The nine published runs with f < 1 (Farouki & Srinathu 2018, section 5) beside a plan of the same path.

#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use host_sim::job::{FeedOverride, Job, Reduction, Units};
use host_sim::path::Path;
use host_sim::plan::{Limits, Manner, within_budget};
use host_sim::plant::Plant;
use host_sim::reproduce::farouki2018::{CONTOUR, REDUCTIONS, WEIGHTS};
use host_sim::simulate::{SETTLING_TICKS, simulate};
use shared::piece::Order;

/// In which an acceleration may rise, in s: the published runs leave their jerk to the ramps, and a step of acceleration shakes the mill.
const RISE: f64 = 0.02;

/// With the run's own corner speeds and its simulated peak acceleration as limits, a plan takes less time, at no larger contour error of
/// the same plant. The peak is that of a vector: each axis gets it over the root of two.
#[test]
fn plans_beat_the_published_runs() {
    let plant = Plant::default_mill(f64::from(shared::TICK)).unwrap();
    let mut ratios = Vec::new();
    for weight in WEIGHTS {
        for reduction in REDUCTIONS.into_iter().filter(|&f| f < 1.0) {
            let by = FeedOverride {
                weight: Some(weight),
                reduction: Some(Reduction::Fixed(reduction)),
                ..FeedOverride::default()
            };
            let job = Job::from_toml("farouki2018.toml", CONTOUR).unwrap().with_feed(by).unwrap();
            let path = Path::new(&job, Order::First).unwrap();
            let mut mill = plant.clone();
            mill.rest_at(path.start());
            let run = simulate(&path, Units::Mm, SETTLING_TICKS, |setpoint| mill.advance(setpoint), |_| ()).unwrap();
            let acceleration = run.max_acceleration / f64::sqrt(2.0);
            let limits = Limits {
                velocity: [f64::INFINITY; 3],
                acceleration: [acceleration; 3],
                jerk: [acceleration / RISE; 3],
                corner_step: [f64::INFINITY; 3],
                feed: f64::INFINITY,
                centripetal: f64::INFINITY,
            };
            // The published runs begin and end at their feed.
            let manner = Manner { ends: [None; 2], reductions: true, ..Manner::USUAL };
            let planned = within_budget(&path, &limits, &manner, &plant, run.max_contour_error).unwrap();
            println!(
                "w {weight}, f {reduction}: {:.3} s planned, {:.3} s published law; contour error {:.5} mm, {:.5} mm",
                planned.plan.time, run.time_s, planned.error, run.max_contour_error
            );
            assert!(planned.plan.time < run.time_s && planned.error <= run.max_contour_error);
            ratios.push(planned.plan.time / run.time_s);
        }
    }
    assert_eq!(ratios.len(), 9);
}

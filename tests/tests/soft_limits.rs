//! A job that leaves the machine's travel moves nothing: it is refused on the host at its place in the file, and by the loader.
#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use host_sim::job::Job;
use host_sim::machine;
use host_sim::path::Path;
use shared::TICK;
use shared::error::PathError;
use shared::fixed::Fixed;
use shared::loader::{Bounds, Loader};
use shared::piece::Order;

const ROUTER: &str = include_str!("../../examples/machine.toml");

/// A line and a half circle of radius 5 mm on it, which reaches to y + 5.
fn bow(y: f64) -> String {
    format!(
        "units = \"mm\"\nclosed = false\n[feed]\nrate = 600.0\n\n[[segment]]\nline = {{ start = [10.0, {y:.1}], to = [20.0, {y:.1}] }}\n\n\
         [[segment]]\narc = {{ to = [30.0, {y:.1}], centre = [25.0, {y:.1}], ccw = false }}\n"
    )
}

#[test]
fn a_job_beyond_the_travel_is_refused_at_its_place() {
    let limits = machine::from_toml("machine.toml", ROUTER).unwrap().activate().unwrap().soft_limits();
    let path = |y| {
        let job = Job::from_toml("bow.toml", &bow(y)).unwrap();
        (Path::new(&job, Order::First).unwrap(), job)
    };
    let load = |path: &Path| {
        let mut loader = Loader::new(&path.header, TICK).unwrap().within(Bounds::machine(limits));
        path.wire().try_for_each(|piece| loader.load(&piece).map(|_| ()))
    };

    let (inside, job) = path(395.0);
    inside.check_travel(&job, &limits).unwrap();
    load(&inside).unwrap();

    let (outside, job) = path(396.0);
    let error = outside.check_travel(&job, &limits).unwrap_err();
    assert_eq!(error.position.map(|(line, _)| line), Some(9), "{error}");
    assert!(error.to_string().contains("leaves the travel of axis y by 1"), "{error}");
    assert!(matches!(load(&outside), Err(PathError::SoftLimit { axis: 1, beyond }) if (beyond - 1.0).abs() < 1e-4));
}

/// A job from where the machine stands is held against the travel there, whatever its own coordinates are.
#[test]
fn a_job_from_here_keeps_to_the_travel_too() {
    let limits = machine::from_toml("machine.toml", ROUTER).unwrap().activate().unwrap().soft_limits();
    let job = Job::from_toml("bow.toml", &bow(-77.0)).unwrap();
    let path = Path::new(&job, Order::First).unwrap();
    let load = |[x, y]: [f64; 2]| {
        let bounds = Bounds::from_here(limits, [x, y].map(Fixed::from_mm), [Fixed(0)]);
        let mut loader = Loader::new(&path.header, TICK).unwrap().within(bounds);
        path.wire().try_for_each(|piece| loader.load(&piece).map(|_| ()))
    };
    // It goes 20 mm to the right, and 5 mm up at its end.
    assert_eq!(load([0.0, 0.0]), Ok(()));
    assert_eq!(load([580.0, 395.0]), Ok(()));
    assert!(
        matches!(load([581.0, 395.0]), Err(PathError::SoftLimit { axis: 0, beyond }) if (beyond - 1.0).abs() < 1e-4)
    );
    assert!(matches!(load([0.0, 396.0]), Err(PathError::SoftLimit { axis: 1, beyond }) if (beyond - 1.0).abs() < 1e-4));
    assert!(matches!(load([0.0, -0.5]), Err(PathError::SoftLimit { axis: 1, beyond }) if (beyond + 0.5).abs() < 1e-4));
}

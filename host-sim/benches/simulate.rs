//! How many times faster than real time the simulator is, on one core.
//!
//! `cargo bench -p host-sim --bench simulate` prints the time of one run of the paper's path at w = 0, f = 1/4, which lasts
//! 12 951 ticks; the throughput in elements/s is ticks a second, and 1024 of them are real time.

#![allow(missing_docs, clippy::unwrap_used, reason = "benchmark code")]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use host_sim::job::Job;
use host_sim::path::Path;
use host_sim::plant::Plant;
use host_sim::reproduce::farouki2018::CONTOUR;
use host_sim::simulate::{SETTLING_TICKS, run, simulate};
use shared::piece::Order;

fn benchmark(criterion: &mut Criterion) {
    let job = Job::from_toml("farouki2018.toml", CONTOUR).unwrap();
    let mill = Plant::default_mill(f64::from(shared::TICK)).unwrap();
    for order in [Order::First, Order::Second, Order::Third, Order::Exact] {
        let path = Path::new(&job, order).unwrap();
        let ticks = run(&path, |_, _| ()).unwrap().ticks;
        let mut group = criterion.benchmark_group(format!("{order:?}"));
        group.throughput(Throughput::Elements(ticks));
        group.bench_function("without plant", |b| b.iter(|| run(&path, |_, _| ()).unwrap().hash));
        if order == Order::First {
            group.bench_function("with plant and contour error", |b| {
                b.iter(|| {
                    let mut mill = mill.clone();
                    mill.rest_at(path.start());
                    simulate(&path, job.units, SETTLING_TICKS, |at| mill.advance(at), |_| ()).unwrap().max_contour_error
                });
            });
        }
        group.finish();
    }
}

criterion_group!(benches, benchmark);
criterion_main!(benches);

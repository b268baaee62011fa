//! What a fit costs, and what it comes to beside `kurbo`'s.
//!
//! `cargo bench -p host-sim --bench fits` prints, for the example and for every program beside the project: points/s and segments of each
//! kind of curve; then, for what lies in a plane across z, PH segments beside those of kurbo's simplification of the same lines at the same
//! tolerance, by subdivision and by its optimiser, each timed in the same run; then criterion's measurements of the example.

#![allow(missing_docs, clippy::unwrap_used, reason = "benchmark code")]

use std::fs::{self, File};
use std::hint::black_box;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::time::Instant;

use criterion::{Criterion, Throughput, criterion_group};
use host_sim::fit::{Kind, fit};
use host_sim::program::{Action, Motion, rs274};
use host_sim::vector::Vector;
use kurbo::simplify::{SimplifyOptLevel, SimplifyOptions, simplify_bezpath};

/// In mm.
const TOLERANCE: f64 = 0.01;
/// Runs of which the fastest counts; fewer where one takes long.
const RUNS: u32 = 15;
/// A run that takes longer, in s, is not made again.
const LONG: f64 = 1.0;
/// The most points of programs that kurbo is given by subdivision, and for its optimiser: with more it takes minutes.
const MOST: [usize; 2] = [3_000, 1_000];
/// Where lines turn by more than this, in radians, kurbo begins a new curve. By itself it takes each vertex of a program for a corner.
const CORNER: f64 = 0.4;
/// Programs of fewer points say nothing about time.
const FEWEST: usize = 300;

const KINDS: [(&str, Kind); 5] = [
    ("Bezier", Kind::Bezier),
    ("B-spline", Kind::Bspline),
    ("PH", Kind::Ph),
    ("C2 PH", Kind::PhC2),
    ("arcs", Kind::Arcs),
];

type Chains = Vec<Vec<Vector>>;

/// The chains of lines of a program.
fn chains(file: &Path) -> Chains {
    let mut chains: Chains = vec![Vec::new()];
    let input = BufReader::new(File::open(file).unwrap());
    rs274::read("program", input, &rs274::Settings::default(), &mut |item| {
        let Some(chain) = chains.last_mut() else { return Ok(()) };
        match item.action {
            Action::Motion(Motion::Line { to }) => {
                if chain.is_empty() {
                    chain.push(Vector(item.from));
                }
                if chain.last() != Some(&Vector(to)) {
                    chain.push(Vector(to));
                }
            }
            Action::Motion(_) if !chain.is_empty() => chains.push(Vec::new()),
            _ => {}
        }
        Ok(())
    })
    .unwrap();
    chains.retain(|chain| chain.len() > 1);
    chains
}

/// The shortest of some runs, in s, and what came out.
fn seconds<T>(mut run: impl FnMut() -> T) -> (f64, T) {
    let mut measure = || {
        let start = Instant::now();
        let found = black_box(run());
        (start.elapsed().as_secs_f64(), found)
    };
    let (mut best, found) = measure();
    for _ in 1..RUNS {
        if best > LONG {
            break;
        }
        best = best.min(measure().0);
    }
    (best, found)
}

fn fitted(chains: &Chains, kind: Kind) -> usize {
    chains.iter().map(|chain| fit(black_box(chain), kind, TOLERANCE).parts.len()).sum()
}

fn simplified(chains: &Chains, is_optimised: bool) -> usize {
    let of = |chain: &Vec<Vector>| {
        let mut path = kurbo::BezPath::new();
        path.move_to((chain[0].0[0], chain[0].0[1]));
        chain[1..].iter().for_each(|point| path.line_to((point.0[0], point.0[1])));
        let level = if is_optimised { SimplifyOptLevel::Optimize } else { SimplifyOptLevel::Subdivide };
        let options = SimplifyOptions::default().opt_level(level).angle_thresh(CORNER);
        simplify_bezpath(path, TOLERANCE, &options).elements().len() - 1
    };
    chains.iter().map(of).sum()
}

/// The parts of chains that are at one height.
fn flat(chains: &Chains) -> Chains {
    let parts = chains.iter().flat_map(|chain| chain.chunk_by(|a, b| a.0[2] == b.0[2]));
    parts.filter(|part| part.len() > 1).map(<[Vector]>::to_vec).collect()
}

fn example() -> Chains {
    // The plunge stands in front of the outline.
    let chains = chains(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/heart.ngc"));
    let height = chains[0].last().unwrap().0[2];
    chains.into_iter().map(|chain| chain.into_iter().skip_while(|point| point.0[2] != height).collect()).collect()
}

fn programs() -> Vec<(String, Chains)> {
    let mut all = vec![("heart (this project)".to_string(), example())];
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/gcode");
    let Ok(files) = fs::read_dir(folder) else {
        println!("The programs of others are not beside the project: only the example is measured.\n");
        return all;
    };
    let mut files: Vec<PathBuf> = files.map(|file| file.unwrap().path()).collect();
    files.sort();
    for file in files {
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        if ["nc", "ngc", "gcode"].iter().any(|ending| file.extension().is_some_and(|found| found == *ending)) {
            let chains = chains(&file);
            if points(&chains) >= FEWEST {
                all.push((name, chains));
            }
        }
    }
    all
}

fn points(chains: &Chains) -> usize {
    chains.iter().map(Vec::len).sum()
}

fn tables() {
    let programs = programs();
    println!("segments at {TOLERANCE} mm, and 1000 points/s on one core");
    println!("{:36} {:>6}  {}", "program", "points", KINDS.map(|(name, _)| format!("{name:>16}")).join(""));
    for (name, chains) in &programs {
        let count = points(chains);
        let columns = KINDS.map(|(_, kind)| {
            let (time, segments) = seconds(|| fitted(chains, kind));
            format!("{segments:9}{:7.0}", count as f64 / time * 1e-3)
        });
        println!("{name:36} {count:6}  {}", columns.join(""));
    }
    println!("\nbeside kurbo, what lies in a plane across z: segments and ms");
    println!(
        "{:36} {:>6}  {:>16} {:>18} {:>18} {:>10}",
        "program", "points", "PH", "kurbo, subdivided", "kurbo, optimised", "points/s"
    );
    for (name, chains) in &programs {
        let chains = flat(chains);
        let count = points(&chains);
        if count < FEWEST {
            continue;
        }
        let (time, ours) = seconds(|| fitted(&chains, Kind::Ph));
        let theirs = [false, true].map(|is_optimised| {
            let is_given = count <= MOST[usize::from(is_optimised)];
            let found = is_given.then(|| seconds(|| simplified(&chains, is_optimised)));
            found.map_or(format!("{:>18}", "-"), |(time, segments)| format!("{segments:8}{:10.2}", time * 1e3))
        });
        println!("{name:36} {count:6}  {ours:6}{:10.2} {} {:10.0}", time * 1e3, theirs.join(" "), count as f64 / time);
    }
    println!();
}

fn benchmark(criterion: &mut Criterion) {
    let chains = example();
    let mut group = criterion.benchmark_group("fitting the example");
    group.throughput(Throughput::Elements(points(&chains) as u64));
    for (name, kind) in KINDS {
        group.bench_function(name, |b| b.iter(|| fitted(black_box(&chains), kind)));
    }
    group.finish();
}

criterion_group!(benches, benchmark);

fn main() {
    tables();
    benches();
    Criterion::default().configure_from_args().final_summary();
}

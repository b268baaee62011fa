//! What a trimmed offset costs, how that grows, and what a polyline offset costs beside it.
//!
//! `cargo bench -p host-sim --bench offset` prints three things in one run: time against the number of segments; time and
//! deviation beside `cavalier_contours`, which gets the same contour flattened; and criterion's measurements of the paper's
//! contour and of 2 000 segments.

#![allow(missing_docs, clippy::unwrap_used, reason = "benchmark code")]

mod fingers;

use std::hint::black_box;
use std::time::Instant;

use cavalier_contours::polyline::{PlineSource, PlineSourceMut, PlineVertex, Polyline};
use criterion::{Criterion, criterion_group};
use host_sim::contour::Contour;
use host_sim::job::Job;
use host_sim::measure::Nearest;
use host_sim::offset::{Offset, trim};
use host_sim::reproduce::farouki2018::CONTOUR;
use shared::complex::Complex;
use shared::curve::{Curve as _, Segment};

use fingers::fingers;

/// The tool of the finger contours, in mm: it goes into the gaps and is trimmed at every other node.
const TOOL: f64 = 1.2;
/// Runs of which the fastest counts.
const RUNS: u32 = 7;
/// Samples of each piece of a result.
const SAMPLES: u32 = 16;

fn paper() -> (Contour, f64) {
    (Job::from_toml("farouki2018.toml", CONTOUR).unwrap().contour, 25.4)
}

/// The shortest of some runs, in s.
fn seconds<T>(mut run: impl FnMut() -> T) -> f64 {
    let times = (0..RUNS).map(|_| {
        let start = Instant::now();
        black_box(run());
        start.elapsed().as_secs_f64()
    });
    times.fold(f64::INFINITY, f64::min)
}

fn growth() {
    println!("segments   trimming     segments x ln(segments)");
    let mut before = None;
    for count in [100, 1_000, 10_000] {
        let contour = fingers(count);
        let time = seconds(|| trim(&contour, TOOL).unwrap());
        let law = count as f64 * (count as f64).ln();
        let ratio: Option<(f64, f64)> = before.map(|(t, l): (f64, f64)| (time / t, law / l));
        let ratio = ratio.map_or(String::new(), |(t, l)| format!("   time x {t:.2}, n ln n x {l:.2}: {:.2}", t / l));
        println!("{count:8} {:9.3} ms{ratio}", time * 1e3);
        before = Some((time, law));
    }
}

/// The contour with every PH curve as chords that are nowhere farther off than `tolerance`; lines and arcs stay what they are.
fn flattened(contour: &Contour, tolerance: f64) -> Polyline<f64> {
    let mut flat = Polyline::new_closed();
    for segment in &contour.segments {
        let points = match segment {
            Segment::Line(line) => {
                flat.add_vertex(PlineVertex::new(line.start.re, line.start.im, 0.0));
                continue;
            }
            Segment::Arc(arc) => {
                flat.add_vertex(PlineVertex::new(arc.start.re, arc.start.im, (0.25 * arc.sweep).tan()));
                continue;
            }
            Segment::Ph(curve) => curve.control_points(),
            Segment::Spline(curve) => curve.points,
        };
        let mut add = |point: Complex<f64>| {
            flat.add_vertex(PlineVertex::new(point.re, point.im, 0.0));
        };
        chords(points, tolerance, &mut add);
    }
    flat
}

/// Gives the starts of the fewest chords that halving finds: a curve is no farther from its chord than its control points are.
fn chords(points: [Complex<f64>; 6], tolerance: f64, add: &mut impl FnMut(Complex<f64>)) {
    let [start, .., end] = points;
    let along = (end - start) * (1.0 / (end - start).norm());
    if points.iter().all(|p| along.cross(*p - start).abs() <= tolerance) {
        add(start);
        return;
    }
    let (mut left, mut right) = (points, points);
    for (k, corner) in left.iter_mut().enumerate().skip(1) {
        for j in 0..points.len() - k {
            right[j] = (right[j] + right[j + 1]) * 0.5;
        }
        *corner = right[0];
    }
    chords(left, tolerance, add);
    chords(right, tolerance, add);
}

/// The largest | distance from C - |d| | over points of a path.
fn deviation(contour: &Contour, distance: f64, points: impl Iterator<Item = Complex<f64>>) -> f64 {
    let nearest = Nearest::new(contour);
    points.map(|p| (nearest.at(p).distance - distance.abs()).abs()).fold(0.0, f64::max)
}

fn points_of_offset(contour: &Contour, offset: &Offset) -> Vec<Complex<f64>> {
    let pieces = offset.loops.iter().flat_map(|ring| &ring.pieces);
    let carriers = pieces.filter_map(|piece| contour.carrier(piece.along, offset.distance));
    carriers
        .flat_map(|(segment, [from, to], d)| {
            (0..=SAMPLES).map(move |k| segment.offset_point(from + (to - from) * f64::from(k) / f64::from(SAMPLES), d))
        })
        .collect()
}

fn points_of_polylines(polylines: &[Polyline<f64>]) -> Vec<Complex<f64>> {
    let edges = polylines.iter().flat_map(|polyline| polyline.iter_segments());
    edges
        .flat_map(|(a, b)| {
            let (start, end) = (Complex::new(a.x, a.y), Complex::new(b.x, b.y));
            let sweep = 4.0 * a.bulge.atan();
            (0..=SAMPLES).map(move |k| {
                let x = f64::from(k) / f64::from(SAMPLES);
                if sweep == 0.0 {
                    return start + (end - start) * x;
                }
                let radius = (end - start) * Complex::new(-0.5, -0.5 / (0.5 * sweep).tan());
                Segment::Arc(shared::curve::Arc { start, radius, sweep }).point(x)
            })
        })
        .collect()
}

fn beside_polylines() {
    println!();
    println!("contour, tool                         what            edges     time ms   deviation mm   loops");
    let (contour, distance) = paper();
    let fingers = [-TOOL, TOOL].map(|tool| ("2 000 segments", fingers(2_000), tool));
    for (name, contour, distance) in [("the paper's", contour, distance)].into_iter().chain(fingers) {
        let line = |what: &str, edges: usize, time: f64, off: f64, loops: usize| {
            let tool = format!("{name}, d = {distance} mm");
            println!("{tool:34} {what:18} {edges:6} {:11.3} {off:14.1e} {loops:7}", time * 1e3);
        };
        let [low, high] = contour.extent();
        let size = (high - low).norm();
        let time = seconds(|| trim(&contour, distance).unwrap());
        let offset = trim(&contour, distance).unwrap();
        let off = deviation(&contour, distance, points_of_offset(&contour, &offset).into_iter());
        line("trim", contour.segments.len(), time, off, offset.loops.len());
        for part in [1e-4, 1e-6] {
            let flat = flattened(&contour, part * size);
            // There positive is to the left.
            let time = seconds(|| flat.parallel_offset(-distance));
            let found = flat.parallel_offset(-distance);
            let off = deviation(&contour, distance, points_of_polylines(&found).into_iter());
            line(&format!("cavalier, {part:.0e}"), flat.vertex_count(), time, off, found.len());
        }
    }
    println!("(cavalier: cavalier_contours on the contour flattened to that part of its size)");
    println!();
}

fn benchmark(criterion: &mut Criterion) {
    let (contour, distance) = paper();
    criterion.bench_function("the paper's contour", |b| b.iter(|| trim(black_box(&contour), distance).unwrap()));
    let contour = fingers(2_000);
    let mut group = criterion.benchmark_group("2 000 segments");
    group.sample_size(20);
    group.bench_function("outside", |b| b.iter(|| trim(black_box(&contour), TOOL).unwrap()));
    group.bench_function("inside", |b| b.iter(|| trim(black_box(&contour), -TOOL).unwrap()));
    group.finish();
}

criterion_group!(benches, benchmark);

fn main() {
    growth();
    beside_polylines();
    benches();
    Criterion::default().configure_from_args().final_summary();
}

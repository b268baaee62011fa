//! Curves laid through polylines, measured by samples: of closed forms, at random, and of the programs of others.

#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;

use host_sim::fit::joins::{Joins, break_between, joins};
use host_sim::fit::{Curve, Kind, fit};
use host_sim::program::{Action, Motion, rs274};
use host_sim::vector::Vector;
use kurbo::simplify::{SimplifyOptLevel, SimplifyOptions, simplify_bezpath};
use tests::random::Random;
use tests::two_sided::two_sided;

const KINDS: [Kind; 5] = [Kind::Bezier, Kind::Bspline, Kind::Ph, Kind::PhC2, Kind::Arcs];

/// What samples may be above a tolerance, in mm: they have rounding of their own.
const ROUNDING: f64 = 1e-9;

/// The bars of a curve that is continuous in curvature.
const SMOOTH: f64 = 1e-6;

/// Fits, and measures again: the deviation on both sides, and the joins. How many curves there are.
fn measured(what: &str, points: &[Vector], kind: Kind, tolerance: f64) -> usize {
    let parts = fit(points, kind, tolerance).parts;
    let [curves, lines] = two_sided(points, &parts);
    let bar = tolerance * (1.0 + 1e-9) + ROUNDING;
    assert!(curves <= bar && lines <= bar, "{what}, {kind:?} within {tolerance}: {curves} and {lines}");
    assert!(parts.len() < points.len(), "{what}, {kind:?}: {} curves of {} points", parts.len(), points.len());
    let claimed = parts.iter().map(|part| part.deviation).fold(0.0, f64::max);
    assert!(claimed <= tolerance && curves.max(lines) <= claimed + ROUNDING, "{what}: {claimed} {curves} {lines}");
    let ends = [parts[0].curve.at(0.0).point, parts[parts.len() - 1].curve.at(1.0).point];
    assert!((ends[0] - points[0]).norm() < ROUNDING && (ends[1] - points[points.len() - 1]).norm() < ROUNDING);
    for pair in parts.windows(2) {
        let gap = (pair[1].curve.at(0.0).point - pair[0].curve.at(1.0).point).norm();
        assert!(gap < ROUNDING, "{what}, {kind:?}: a gap of {gap}");
    }
    let Joins { tangent, curvature } = joins(&parts);
    assert!(tangent < SMOOTH, "{what}, {kind:?}: tangent break {tangent}");
    assert!(
        matches!(kind, Kind::Bezier | Kind::Arcs) || curvature < SMOOTH,
        "{what}, {kind:?}: curvature jump {curvature}"
    );
    parts.len()
}

fn rounded(x: f64) -> f64 {
    (x * 1e4).round() * 1e-4
}

/// A circle of 10 000 lines, rounded to four decimals: at most 16 curves at 10 um, and their curvature is that of the circle within a tenth.
#[test]
fn a_circle_of_many_lines_is_few_curves() {
    let on = |k: u32| f64::from(k) * std::f64::consts::TAU / 10_000.0;
    let points: Vec<Vector> =
        (0..=10_000).map(|k| Vector([rounded(25.4 * on(k).sin()), rounded(25.4 * on(k).cos()), 2.0])).collect();
    for (kind, most) in [(Kind::Bezier, 16), (Kind::Bspline, 32), (Kind::Ph, 16), (Kind::PhC2, 32), (Kind::Arcs, 1)] {
        let count = measured("circle", &points, kind, 0.01);
        println!("circle of 10 000 lines: {count} of {kind:?}");
        assert!(count <= most, "{count}");
        for part in fit(&points, kind, 0.01).parts {
            for t in [0.0, 0.25, 0.5, 0.75, 1.0] {
                let curvature = part.curve.at(t).curvature().norm();
                assert!((curvature * 25.4 - 1.0).abs() < 0.1, "{kind:?}: {curvature}");
            }
        }
    }
}

/// Closed loops without a corner, parted where they happen to begin, go on there as smoothly as anywhere: an ellipse, and one with a corner
/// elsewhere.
#[test]
fn closed_loops_have_no_seam() {
    let on = |k: u32| {
        let angle = f64::from(k) * std::f64::consts::TAU / 400.0 + 0.4;
        Vector([rounded(30.0 * angle.cos()), rounded(18.0 * angle.sin()), 1.0])
    };
    let mut ellipse: Vec<Vector> = (0..=400).map(on).collect();
    ellipse[400] = ellipse[0];
    // Its part from 1/4 to 1/2 is cut off by two lines.
    let mut cut = ellipse.clone();
    cut.splice(150..200, [Vector([0.0, 0.0, 1.0])]);
    for (name, points) in [("ellipse", ellipse), ("cut ellipse", cut)] {
        for kind in [Kind::Bspline, Kind::Ph] {
            measured(name, &points, kind, 0.01);
            let parts = fit(&points, kind, 0.01).parts;
            let [first, last] = [parts[0], parts[parts.len() - 1]];
            let seam = break_between(&last.curve.at(1.0), &first.curve.at(0.0));
            assert!(first.is_smooth && seam.tangent < SMOOTH && seam.curvature < SMOOTH, "{name}, {kind:?}: {seam:?}");
        }
    }
}

/// Between two corners the derivatives of a C2 PH spline go on, by a parameter that runs evenly over the whole: at each node the ratio of the
/// first ones is that of the spans, and the second ones have its square.
#[test]
fn c2_splines_have_two_derivatives() {
    let on = |k: u32| f64::from(k) * 6.0 / 2_000.0;
    let points: Vec<Vector> = (0..=2_000)
        .map(|k| {
            let (t, r) = (on(k), 20.0 + 3.0 * (3.0 * on(k)).sin());
            Vector([r * t.cos(), r * t.sin(), 2.0 * (2.0 * t).sin()])
        })
        .collect();
    let parts = fit(&points, Kind::PhC2, 0.01).parts;
    assert!(parts.len() > 4 && parts.len() < 100, "{}", parts.len());
    for pair in parts.windows(2) {
        let (end, start) = (pair[0].curve.at(1.0), pair[1].curve.at(0.0));
        let ratio = start.first.norm() / end.first.norm();
        let jumps = [end.first * ratio - start.first, end.second * (ratio * ratio) - start.second];
        assert!(matches!(pair[0].curve, Curve::Ph(_)));
        assert!(jumps[0].norm() < 1e-9 * start.first.norm(), "{jumps:?}");
        assert!(jumps[1].norm() < 1e-9 * start.second.norm().max(start.first.norm()), "{jumps:?} {start:?}");
    }
}

/// A stadium with corners at one end: its straights stay lines, or lie on them, and what is sharp stays sharp.
#[test]
fn straights_and_corners_stay() {
    let arc = |k: i32| {
        let angle = f64::from(k) * std::f64::consts::PI / 60.0;
        Vector([40.0 + 10.0 * angle.sin(), 10.0 - 10.0 * angle.cos(), 0.0])
    };
    let mut points = vec![Vector([0.0, 0.0, 0.0])];
    points.extend((0..=60).map(arc));
    points.extend([Vector([0.0, 20.0, 0.0]), Vector([0.0, 0.0, 0.0])]);
    for kind in KINDS {
        measured("stadium", &points, kind, 0.01);
        let parts = fit(&points, kind, 0.01).parts;
        let last = parts[parts.len() - 1];
        assert!(matches!(last.curve, Curve::Line(_)) && !last.is_smooth, "{kind:?}: {last:?}");
        // The corner at (0, 20) is a vertex of the fit.
        assert!((last.curve.at(0.0).point - Vector([0.0, 20.0, 0.0])).norm() < 1e-12);
    }
}

/// Smooth ways in space of many sizes, with steps and digits as CAM has them, at tolerances from 1 um to 0.1 mm.
#[test]
fn random_ways_are_fitted_within_tolerance() {
    for seed in 0..300 {
        let mut random = Random::new(seed);
        let size = random.scale(0.5, 200.0);
        let count = random.scale(3.0, 2_000.0) as usize;
        let rise = if random.chance(0.5) { 0.0 } else { random.scale(0.01, 0.5) };
        let waves: Vec<[f64; 3]> = (0..4)
            .map(|k| [random.scale(0.05, 1.0) / f64::from(k + 1), random.scale(0.2, 3.0), random.scale(0.1, 6.0)])
            .collect();
        let on = |t: f64| {
            let sum = |shift: f64| waves.iter().map(|[a, f, p]| a * (f * t + p + shift).sin()).sum::<f64>();
            Vector([rounded(size * (t + sum(0.0))), rounded(size * sum(1.3)), rounded(rise * size * sum(2.9))])
        };
        let mut points: Vec<Vector> = (0..count).map(|k| on(6.0 * k as f64 / count as f64)).collect();
        points.dedup();
        if points.len() < 2 {
            continue;
        }
        let tolerance = random.scale(1e-3, 0.1);
        // C2 splines have many curves, each of which is sampled.
        for kind in KINDS.into_iter().filter(|&kind| kind != Kind::PhC2 || seed % 4 == 0) {
            measured(&format!("seed {seed}"), &points, kind, tolerance);
        }
    }
}

/// Zigzags, spikes and steps at random: nothing that a curve would like.
#[test]
fn rugged_ways_are_fitted_within_tolerance() {
    for seed in 0..300 {
        let mut random = Random::new(seed ^ 0x7275_6767);
        let count = random.scale(2.0, 200.0) as usize;
        let step = random.scale(1e-3, 3.0);
        let mut at = [0.0; 3];
        let mut points = vec![Vector(at)];
        for _ in 0..count {
            for axis in &mut at {
                *axis = rounded(*axis + random.scale(1e-3, 1.0) * step * if random.chance(0.5) { 1.0 } else { -1.0 });
            }
            points.push(Vector(at));
        }
        points.dedup();
        if points.len() < 2 {
            continue;
        }
        for kind in KINDS {
            measured(&format!("seed {seed}"), &points, kind, random.scale(1e-3, 0.1));
        }
    }
}

/// The chains of lines of a program.
fn chains(file: &Path) -> Vec<Vec<Vector>> {
    let mut chains: Vec<Vec<Vector>> = vec![Vec::new()];
    let input = BufReader::new(File::open(file).unwrap());
    rs274::read("program", input, &rs274::Settings::default(), &mut |item| {
        let chain = chains.last_mut().unwrap();
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

/// What `kurbo` makes of the chains that lie in a plane across z, by subdivision, which is the faster of its two ways.
fn kurbo(chains: &[Vec<Vector>], tolerance: f64) -> usize {
    let of = |chain: &Vec<Vector>| {
        let mut path = kurbo::BezPath::new();
        path.move_to((chain[0].0[0], chain[0].0[1]));
        chain[1..].iter().for_each(|point| path.line_to((point.0[0], point.0[1])));
        let options = SimplifyOptions::default().opt_level(SimplifyOptLevel::Subdivide);
        simplify_bezpath(path, tolerance, &options).elements().len() - 1
    };
    chains.iter().map(of).sum()
}

/// Every program at 1 um, 10 um and 0.1 mm; at 10 um a table, and on plane programs no more curves than kurbo.
#[test]
fn programs_are_fitted_within_tolerance() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/gcode");
    let Ok(files) = fs::read_dir(&folder) else {
        println!("SKIPPED: the programs of others are not beside the project");
        return;
    };
    let mut files: Vec<_> = files.map(|file| file.unwrap().path()).collect();
    files.sort();
    let is_program = |file: &&std::path::PathBuf| {
        file.extension().is_some_and(|ending| ["nc", "ngc", "gcode"].iter().any(|known| ending == *known))
    };
    for file in files.iter().filter(is_program) {
        let name = file.file_name().unwrap().to_string_lossy();
        let chains = chains(file);
        let lines: usize = chains.iter().map(|chain| chain.len() - 1).sum();
        for tolerance in [0.001, 0.01, 0.1] {
            let [bezier, bspline, ph, c2, arcs] =
                KINDS.map(|kind| chains.iter().map(|chain| measured(&name, chain, kind, tolerance)).sum::<usize>());
            if tolerance != 0.01 || lines == 0 {
                continue;
            }
            let is_flat = chains.iter().all(|chain| chain.iter().all(|point| point.0[2] == chain[0].0[2]));
            let theirs = is_flat.then(|| kurbo(&chains, tolerance));
            println!(
                "{name:42} {lines:6} lines; {bezier:6} Bezier {bspline:6} B-spline {ph:6} PH {c2:6} C2 PH {arcs:6} arcs, kurbo {theirs:?}"
            );
            if let Some(theirs) = theirs {
                assert!(ph <= theirs, "{name}: {ph} PH, {theirs} of kurbo");
            }
            if name.starts_with("lcnc_circle_small_segments") {
                // The line to the circle, and the circle.
                assert!(ph <= 16 && arcs == 2, "{ph} {arcs}");
            }
        }
    }
}

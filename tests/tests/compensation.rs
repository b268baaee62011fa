//! Cutter compensation of whole programs: LinuxCNC's own paths, and random polygons measured by samples.
#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use std::fs::File;
use std::io::BufReader;
use std::path::PathBuf;

use host_sim::compensation::{CentrePiece, Compensator, Options, Step, Summary, Tool, ToolTable, Trouble, Warning};
use host_sim::program::rs274::{Settings, read};
use host_sim::program::{Action, Item};
use host_sim::units::Units;
use proptest::prelude::*;
use shared::complex::Complex;
use tests::canonical::Canonical;
use tests::random::Random;

/// What comes of a program.
#[derive(Debug, Default)]
struct Found {
    /// All motions: those kept, and the pieces as motions.
    motions: Vec<Canonical>,
    /// The pieces of each run.
    runs: Vec<Vec<CentrePiece>>,
    warnings: Vec<Warning>,
    summary: Summary,
}

/// Compensates a program; with its error, what came before it.
fn compensated(name: &str, input: impl std::io::BufRead, tools: &ToolTable) -> (Found, Option<String>) {
    let mut found = Found::default();
    let mut is_within = false;
    let mut sink = |step: Step<'_>| {
        match step {
            Step::Kept(Item { action: Action::Motion(motion), .. }) => {
                found.motions.push(Canonical::of(motion).unwrap());
                is_within = false;
            }
            Step::Kept(_) => {}
            Step::Centre(pieces) => {
                if !is_within {
                    found.runs.push(Vec::new());
                }
                is_within = true;
                found.runs.last_mut().unwrap().extend(pieces);
                for piece in pieces {
                    let item = piece.item().unwrap();
                    let Action::Motion(motion) = item.action else { panic!("{item:?}") };
                    found.motions.push(Canonical::of(&motion).unwrap());
                }
            }
            Step::Warning(warning) => found.warnings.push(*warning),
        }
        Ok(())
    };
    let mut compensator = Compensator::new(tools, Options::default(), &mut sink);
    let read = read(name, input, &Settings::default(), &mut |item| compensator.take(item));
    let error = match read {
        Ok(_) => match compensator.finish() {
            Ok(summary) => {
                found.summary = summary;
                None
            }
            Err(error) => Some(error),
        },
        Err(error) => Some(error.to_string()),
    };
    for run in &found.runs {
        for pair in run.windows(2) {
            let gap = (pair[1].start() - pair[0].end()).norm();
            assert!(gap < 1e-8, "a gap of {gap} mm between {pair:?}");
        }
    }
    (found, error)
}

/// The folder of programs of others, and the tools that LinuxCNC's test has.
fn folder() -> Option<(PathBuf, ToolTable)> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/gcode");
    if !folder.exists() {
        println!("SKIPPED: the programs of the data folder are not here");
        return None;
    }
    let table = folder.join("lcnc_mill-line-arc-entry.tbl");
    Some((folder, ToolTable::read(&table.to_string_lossy(), Units::Inch).unwrap()))
}

fn of_folder(name: &str) -> Option<(Found, Option<String>)> {
    let (folder, tools) = folder()?;
    Some(compensated(name, BufReader::new(File::open(folder.join(name)).unwrap()), &tools))
}

/// Half of the last digit that is printed.
const PRINTED: f64 = 0.5001e-4;

/// Every motion, compensated and not, is that which LinuxCNC's interpreter prints.
#[test]
fn motions_are_those_of_linuxcnc() {
    let Some((found, error)) = of_folder("lcnc_mill-line-arc-entry.ngc") else { return };
    let (folder, _) = folder().unwrap();
    let expected = std::fs::read_to_string(folder.join("lcnc_mill-line-arc-entry.expected")).unwrap();
    let expected: Vec<Canonical> = expected.lines().filter_map(Canonical::read).collect();
    assert_eq!((error, found.warnings.len(), found.runs.len()), (None, 0, 1));
    let apart: Vec<_> = found.motions.iter().zip(&expected).filter(|(a, b)| !a.is(b, PRINTED)).collect();
    assert!(found.motions.len() == expected.len() && apart.is_empty(), "{apart:#?}");
}

fn assert_ends(run: &[CentrePiece], wanted: &[[f64; 2]]) {
    let ends: Vec<[f64; 2]> = run.iter().map(|piece| [piece.end().re, piece.end().im].map(|mm| mm / 25.4)).collect();
    let near = |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]).hypot(a[1] - b[1]) < 1e-9;
    assert!(ends.len() == wanted.len() && ends.iter().zip(wanted).all(near), "{ends:?}\nfor {wanted:?}");
}

/// A tool of radius 1/32 inch on both sides of a path of lines and two quarter circles, its first corner convex for both sides. Then the
/// program goes on in the XZ plane, where nothing is compensated here: the first arc there is refused.
#[test]
fn both_sides_of_a_path_and_then_another_plane() {
    let Some((found, error)) = of_folder("lcnc_comp.ngc") else { return };
    let (r, h) = (0.03125, 0.03125 * 0.5_f64.sqrt());
    assert_eq!((found.runs.len(), found.warnings.len()), (2, 0));
    assert_ends(
        &found.runs[0],
        &[[h, -h], [r, 0.0], [r, 1.0], [-0.25, 1.25 + r], [-0.5, 1.25 + r], [r - 0.75, 1.5], [r - 0.75, 1.75]],
    );
    assert_ends(
        &found.runs[1],
        &[[-h, -h], [-r, 0.0], [-r, 1.0], [-0.25, 1.25 - r], [-0.5, 1.25 - r], [-r - 0.75, 1.5], [-r - 0.75, 1.75]],
    );
    let error = error.unwrap();
    assert!(error.starts_with("lcnc_comp.ngc:43:1: cutter compensation is in the XY plane here;"), "{error}");
}

/// A round of lines and arcs with a sharp corner, entered and left on straight lines that happen to be tangents of the path. LinuxCNC's
/// remark is that the entry may not be concave. It is, by 14 degrees; here it leads straight to where the path begins.
#[test]
fn a_round_with_straight_ways_in_and_out() {
    let Some((found, error)) = of_folder("lcnc_comp-g1.ngc") else { return };
    assert_eq!((error, found.runs.len(), found.warnings.len()), (None, 1, 0));
    // Half an inch left of the way from (-3, -2) to (1.4, 2.8).
    let (x, y) = (-0.5 * 4.8 / 4.4_f64.hypot(4.8), 0.5 * 4.4 / 4.4_f64.hypot(4.8));
    assert_ends(
        &found.runs[0],
        &[
            [2.0, 3.5],
            [3.5, 2.0],
            [3.5, -1.0],
            [2.0, -2.5],
            [-3.0, -2.5],
            [-3.0 + x, -2.0 + y],
            [1.4 + x, 2.8 + y],
            [1.1, 3.2],
            [2.0, 3.5],
        ],
    );
}

/// A side of a polygon: its ends.
type Side = [Complex<f64>; 2];

/// A polygon around the origin, anticlockwise, every point of which sees the origin.
fn polygon(random: &mut Random) -> Vec<Complex<f64>> {
    let count = random.whole(3, 24);
    let rough = random.within(0.05, 0.9);
    (0..count)
        .map(|k| {
            // Neighbours are seen from the origin within less than half a turn.
            let angle = (k as f64 + random.within(-0.2, 0.2)) / count as f64 * std::f64::consts::TAU;
            let radius = 20.0 * (1.0 + rough * random.within(-1.0, 1.0));
            // Programs have four decimals.
            Complex::new(radius * angle.cos(), radius * angle.sin())
        })
        .map(|p| Complex::new((p.re * 1e4).round() / 1e4, (p.im * 1e4).round() / 1e4))
        .collect()
}

/// The point of a line that is nearest to another point.
fn foot(p: Complex<f64>, [a, b]: Side) -> Complex<f64> {
    let chord = b - a;
    a + chord * ((p - a).dot(chord) / chord.norm_sqr()).clamp(0.0, 1.0)
}

/// How often the sides go around a point.
fn winding(p: Complex<f64>, sides: &[Side]) -> f64 {
    let turn: f64 = sides.iter().map(|[a, b]| ((*a - p).conj() * (*b - p)).arg()).sum();
    (turn / std::f64::consts::TAU).round()
}

/// A round about a polygon, from a place that the tool can touch, and some of it again.
fn round(seed: u64) -> (String, Vec<Side>, f64, bool) {
    let mut random = Random::new(seed);
    let mut corners = polygon(&mut random);
    let is_inside = random.chance(0.5);
    let sides = |corners: &[Complex<f64>]| -> Vec<Side> {
        (0..corners.len()).map(|k| [corners[k], corners[(k + 1) % corners.len()]]).collect()
    };
    let (start, entry, radius) = if is_inside {
        // The nearest point to the origin, in the middle of a side or at a corner: a disc about the origin up to there is free.
        let feet = sides(&corners).into_iter().map(|side| foot(Complex::ZERO, side)).enumerate();
        let (side, nearest) = feet.min_by(|(_, a), (_, b)| a.norm().total_cmp(&b.norm())).unwrap();
        let nearest = Complex::new((nearest.re * 1e4).round() / 1e4, (nearest.im * 1e4).round() / 1e4);
        let at_corner = [side, (side + 1) % corners.len()].into_iter().find(|&k| (corners[k] - nearest).norm() < 0.01);
        let start = match at_corner {
            Some(corner) => corner,
            None => {
                corners.insert(side + 1, nearest);
                side + 1
            }
        };
        let free =
            sides(&corners).into_iter().map(|side| foot(Complex::ZERO, side).norm()).fold(f64::INFINITY, f64::min);
        (start, Complex::ZERO, free * random.within(0.02, 0.98))
    } else {
        // The farthest corner: a disc that touches it from outside is free.
        let start = (0..corners.len()).max_by(|&a, &b| corners[a].norm().total_cmp(&corners[b].norm())).unwrap();
        let radius = random.scale(0.05, 30.0);
        (start, corners[start] * ((corners[start].norm() + 2.0 * radius + 5.0) / corners[start].norm()), radius)
    };
    corners.rotate_left(start);
    let diameter = (2e4 * radius).round() / 1e4;
    let side = if is_inside { "g41.1" } else { "g42.1" };
    let word = |p: Complex<f64>| format!("x{:.4} y{:.4}", p.re, p.im);
    let mut program = format!("g21 f600\ng0 {}\n{side} d{diameter} g1 {}\n", word(entry), word(corners[0]));
    for corner in corners[1..].iter().chain(&corners[..1]) {
        program.push_str(&word(*corner));
        program.push('\n');
    }
    if random.chance(0.5) {
        // Somewhere in the middle of the first side, or on to the second corner.
        let part = random.pick(&[0.3, 1.0]);
        program.push_str(&format!("{}\n", word(corners[0] + (corners[1] - corners[0]) * part)));
    }
    program.push_str(&format!("g40 g1 {}\nm2\n", word(entry)));
    (program, sides(&corners), 0.5 * diameter, is_inside)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    /// The centre is nowhere nearer to the polygon than the tool's radius, and always just as near, and on its side; but for the first
    /// motion. The path is connected (checked for all programs here) and goes around the origin as often as the polygon.
    #[test]
    fn a_tool_never_cuts_into_a_polygon(seed in any::<u64>()) {
        let (program, sides, radius, is_inside) = round(seed);
        let (found, error) = compensated("polygon.ngc", program.as_bytes(), &ToolTable::default());
        prop_assert!(error.is_none(), "{error:?}\n{program}");
        prop_assert_eq!(found.runs.len(), 1);
        prop_assert!(found.warnings.iter().all(|warning| warning.trouble == Trouble::Left), "{:?}\n{program}", found.warnings);
        let run: Vec<CentrePiece> = found.runs[0].iter().copied().filter(|piece| piece.place[0] > 3).collect();
        prop_assert!(!run.is_empty());
        let mut turn = 0.0;
        let mut before = run[0].start();
        for piece in &run {
            let [from, to] = piece.interval;
            for k in 0..=40 {
                let point = piece.point(from + (to - from) * f64::from(k) / 40.0);
                let distance = sides.iter().map(|side| (foot(point, *side) - point).norm()).fold(f64::INFINITY, f64::min);
                prop_assert!((distance - radius).abs() < 1e-6, "{distance} for {radius} at {point:?}\n{program}");
                prop_assert_eq!(winding(point, &sides), if is_inside { 1.0 } else { 0.0 });
                turn += (before.conj() * point).arg();
                before = point;
            }
        }
        let rounds = turn / std::f64::consts::TAU;
        prop_assert!(rounds > 0.5 && rounds < 1.6, "{rounds} rounds\n{program}");
    }
}

/// A pocket around the origin, begun and left on quarter circles at the point of its wall that is nearest to the origin, and some of it run
/// again; none where that is a corner.
fn led_round(seed: u64) -> Option<(String, Vec<Side>, f64)> {
    let mut random = Random::new(seed);
    let corners = polygon(&mut random);
    let sides: Vec<_> = (0..corners.len()).map(|k| [corners[k], corners[(k + 1) % corners.len()]]).collect();
    let feet = sides.iter().map(|&side| foot(Complex::ZERO, side)).enumerate();
    let (side, start) = feet.min_by(|(_, a), (_, b)| a.norm().total_cmp(&b.norm()))?;
    let ahead = sides[side][1] - start;
    let free = start.norm();
    if ahead.norm() < 0.1 * free || (start - sides[side][0]).norm() < 0.1 * free {
        return None;
    }
    let (tangent, normal) = (ahead * (1.0 / ahead.norm()), start * (-1.0 / free));
    let lead = free * random.within(0.05, 0.33);
    let radius = lead * random.within(0.05, 0.95);
    let again = random.pick(&[0.0, (0.3 * free).min(0.9 * ahead.norm())]);
    // Further on the arc that leads out may hit a wall of its own accord.
    let is_clear = |again: f64| {
        (0..=40).all(|k| {
            let (sine, cosine) = (f64::from(k) / 40.0 * std::f64::consts::FRAC_PI_2).sin_cos();
            let off = normal * (lead - (lead - radius) * cosine) + tangent * ((lead - radius) * sine);
            let at = start + tangent * again + off;
            sides.iter().all(|side| (foot(at, *side) - at).norm() > radius - 1e-9)
        })
    };
    let again = if is_clear(again) { again } else { 0.0 };
    let word = |p: Complex<f64>| format!("x{:.6} y{:.6}", p.re, p.im);
    let diameter = (2e6 * radius).round() / 1e6;
    let by =
        |centre: Complex<f64>, from: Complex<f64>| format!("i{:.6} j{:.6}", centre.re - from.re, centre.im - from.im);
    let (before, centre) = (start + (normal - tangent) * lead, start + normal * lead);
    let mut program = format!("g21 f600\ng0 x0 y0\ng41.1 d{diameter} g1 {}\n", word(before));
    program.push_str(&format!("g3 {} {}\ng1 ", word(start), by(centre, before)));
    for k in 1..=corners.len() {
        program.push_str(&format!("{}\n", word(corners[(side + k) % corners.len()])));
    }
    program.push_str(&format!("{}\n", word(start)));
    let end = start + tangent * again;
    if again > 0.0 {
        program.push_str(&format!("{}\n", word(end)));
    }
    let (centre, behind) = (end + normal * lead, end + (normal + tangent) * lead);
    program.push_str(&format!("g3 {} {}\ng40 g1 x0 y0\nm2\n", word(behind), by(centre, end)));
    Some((program, sides, 0.5 * diameter))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    /// Arcs that lead in and out hold up nothing, and nothing is cut; the round is made whole.
    #[test]
    fn a_pocket_is_led_into_and_out_of(seed in any::<u64>()) {
        let Some((program, sides, radius)) = led_round(seed) else { return Ok(()) };
        let (found, error) = compensated("pocket.ngc", program.as_bytes(), &ToolTable::default());
        prop_assert!(error.is_none(), "{error:?}\n{program}");
        prop_assert!(found.warnings.iter().all(|warning| warning.trouble == Trouble::Left), "{:?}\n{program}", found.warnings);
        let run: Vec<CentrePiece> = found.runs[0].iter().copied().filter(|piece| piece.place[0] > 3).collect();
        let (mut turn, mut before) = (0.0, run[0].start());
        for piece in &run {
            let [from, to] = piece.interval;
            for k in 0..=40 {
                let point = piece.point(from + (to - from) * f64::from(k) / 40.0);
                let distance = sides.iter().map(|side| (foot(point, *side) - point).norm()).fold(f64::INFINITY, f64::min);
                // The ends of the arcs have six decimals.
                prop_assert!(distance > radius - 2e-6, "{distance} for {radius} at {point:?}\n{program}");
                turn += (before.conj() * point).arg();
                before = point;
            }
        }
        prop_assert!((turn / std::f64::consts::TAU - 1.0).abs() < 0.5, "{turn}\n{program}");
    }
}

/// Tools other than LinuxCNC's: the table is one's own.
#[test]
fn a_table_may_be_made() {
    let mut tools = ToolTable::default();
    tools.insert(7, Tool { diameter: 3.0, ..Tool::default() });
    let program = "g21 f600\nt7 m6\ng0 x-10 y0\ng41 g1 x0 y0\nx9\ng40 g0 x20\nm2\n";
    let (found, error) = compensated("own.ngc", program.as_bytes(), &tools);
    assert_eq!((error, found.summary.pieces), (None, 2));
    assert!((found.runs[0][1].end() - Complex::new(9.0, 1.5)).norm() < 1e-12);
}

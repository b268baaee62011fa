//! Programs as jobs: every motion of a program, run through the tick, against the program's own geometry.

#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path as FilePath;

use host_sim::fit::Kind;
use host_sim::job::Job;
use host_sim::machine;
use host_sim::measure::peaks::Verdict;
use host_sim::path::Path;
use host_sim::plan::{Limits, Manner, Recorder, planned};
use host_sim::program::{self, Action, Motion, Plane};
use host_sim::simulate::run;
use host_sim::strokes::{self, Entry, Lines, Pace, Tooling, What};
use host_sim::units::Units;
use host_sim::vector::Vector;
use shared::piece::Order;

const MACHINE: &str = include_str!("../../examples/machine.toml");

/// Down, a line, a helix of one turn and a quarter, an arc that stands upright, a cubic that climbs, and away in rapid.
const PROGRAM: &str = "G21 G90 G17 G64 F1500\nG0 Z5\nG0 X10 Y0\nM3 S12000\nG1 Z0\nX20 Y10\nG3 X20 Y10 Z-1 I-5 J0\n\
    G3 X15 Y15 Z-1.25 I-5 J0\nG18 G2 X25 Z-1.25 I5 K0\nG17 G5 X40 Y25 I4 J6 P-5 Q2\nG4 P0.25\nM8\nG1 X45 Z-3\nG0 Z5\nM30\n";

/// The way of [`PROGRAM`], in points that are near to each other, from its closed forms.
fn way() -> Vec<Vector> {
    const PARTS: u32 = 4000;
    let steps = || (0..=PARTS).map(|k| f64::from(k) / f64::from(PARTS));
    let mut points = Vec::new();
    let mut line = |from: [f64; 3], to: [f64; 3]| {
        points.extend(steps().map(|t| Vector(from).toward(Vector(to), t)));
    };
    line([0.0, 0.0, 0.0], [0.0, 0.0, 5.0]);
    line([0.0, 0.0, 5.0], [10.0, 0.0, 5.0]);
    line([10.0, 0.0, 5.0], [10.0, 0.0, 0.0]);
    line([10.0, 0.0, 0.0], [20.0, 10.0, 0.0]);
    let turn = std::f64::consts::TAU;
    points.extend(steps().map(|t| Vector([15.0 + 5.0 * (turn * t).cos(), 10.0 + 5.0 * (turn * t).sin(), -t])));
    let quarter = 0.25 * turn;
    points.extend(steps().map(|t| {
        let (sine, cosine) = (quarter * t).sin_cos();
        Vector([15.0 + 5.0 * cosine, 10.0 + 5.0 * sine, -1.0 - 0.25 * t])
    }));
    // G18 G2 is clockwise from Z to X: from the left end of its circle it dips under.
    points.extend(steps().map(|t| {
        let (sine, cosine) = (0.5 * turn * t).sin_cos();
        Vector([20.0 - 5.0 * cosine, 15.0, -1.25 - 5.0 * sine])
    }));
    let cubic = [[25.0, 15.0], [29.0, 21.0], [35.0, 27.0], [40.0, 25.0]];
    points.extend(steps().map(|t| {
        let s = 1.0 - t;
        let weights = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
        let at = |axis: usize| weights.iter().zip(cubic).map(|(w, point)| w * point[axis]).sum();
        Vector([at(0), at(1), -1.25])
    }));
    points.extend(steps().map(|t| Vector([40.0, 25.0, -1.25]).toward(Vector([45.0, 25.0, -3.0]), t)));
    points.extend(steps().map(|t| Vector([45.0, 25.0, -3.0]).toward(Vector([45.0, 25.0, 5.0]), t)));
    points
}

fn job(text: &str, lines: Lines) -> Job {
    let (strokes, _) = strokes::read("part.ngc", text.as_bytes(), lines, &Tooling::default()).unwrap();
    Job::from_strokes("part.ngc", strokes).unwrap()
}

/// The setpoints of a planned run are on the program's way, all of it is passed, and no axis is asked for more than it bears.
#[test]
fn the_tick_runs_a_whole_program() {
    let job = job(PROGRAM, Lines::FittedAsTold(Kind::Drivable, 0.01));
    let path = Path::new(&job, Order::First).unwrap();
    let machine = machine::from_toml("machine.toml", MACHINE).unwrap();
    let limits = Limits::of(&machine, &Default::default()).unwrap();
    let (path, plan) = planned(&path, &limits, &Manner::USUAL).unwrap();
    let mut recorder = Recorder::new(&path);
    let mut points = vec![Vector([0.0; 3])];
    run(&path, |_, executor| {
        recorder.record(executor.setpoint(), executor.place().map_or(0, |place| place.piece as usize));
        points.push(Vector(executor.setpoint().map(|c| c.to_mm())));
    })
    .unwrap();
    let way = way();
    // Both are in order: the nearest place is not far behind the last one.
    let mut near = 0;
    for (tick, &point) in points.iter().enumerate() {
        let reach = near..(near + 4000).min(way.len() - 1);
        let off = |k: usize| point.from_segment(way[k], way[k + 1]);
        near = reach.min_by(|&a, &b| off(a).total_cmp(&off(b))).unwrap();
        assert!(off(near) < 1e-3, "tick {tick}: {} from the way, {point:?}", off(near));
    }
    assert!(near + 3 > way.len() - 1, "{near}");
    assert!((points[points.len() - 1] - way[way.len() - 1]).norm() < 1e-5);
    let demand = recorder.demand(&machine, Units::Mm).unwrap();
    assert_eq!(demand.axes.len(), 3);
    for axis in &demand.axes {
        for asked in [&axis.velocity, &axis.acceleration, &axis.jerk] {
            assert_ne!(asked.verdict, Verdict::Exceeded, "{}: {asked:?}", axis.axis);
        }
    }
    // z is what rapids wait for, and it is used.
    assert!(demand.axes[2].velocity.peak > 0.8 * machine.axes[2].velocity, "{:?}", demand.axes[2].velocity);
    let least = demand.least_time_s;
    assert!(plan.time < 1.25 * least, "{} {least}", plan.time);
}

/// What is done between motions stands between them: the spindle starts at rest, coolant comes on the way.
#[test]
fn events_keep_their_places() {
    let job = job(PROGRAM, Lines::Kept);
    let found: Vec<(usize, usize, String)> =
        job.events.iter().map(|event| (event.before, event.line, event.what.to_string())).collect();
    let expected = [
        (2, 4, "turn the spindle clockwise at 12000/min"),
        (job.strokes.iter().position(|stroke| stroke.line == 13).unwrap(), 11, "dwell for 0.25 s"),
        (job.strokes.iter().position(|stroke| stroke.line == 13).unwrap(), 12, "coolant on"),
    ];
    assert_eq!(found, expected.map(|(before, line, what)| (before, line, what.to_string())));
    for (number, stroke) in job.strokes.iter().enumerate() {
        let rests = job.events.iter().any(|event| event.before == number && event.what.rests());
        assert_eq!(stroke.entry == Entry::Rest, rests, "{number}");
    }
    assert!(!What::Dwell(0.1).to_string().is_empty());
}

/// G61.1 rests behind every motion, G61 in corners: what one program asks for, another gets by its manner.
#[test]
fn path_modes_are_kept() {
    let time = |mode: &str| {
        let text = format!("G21 F3000 {mode}\nG1 X10\nX20\nY10\nX0\n");
        let path = Path::new(&job(&text, Lines::Kept), Order::First).unwrap();
        let machine = machine::from_toml("machine.toml", MACHINE).unwrap();
        planned(&path, &Limits::of(&machine, &Default::default()).unwrap(), &Manner::USUAL).unwrap().1.time
    };
    let [stop, exact, free] = ["G61.1", "G61", "G64"].map(time);
    assert!(stop > exact * 1.05 && exact > free * 1.01, "{stop} {exact} {free}");
}

/// The length of a tool moves no axis: what follows G43 is shifted, and goes on from where the machine is.
#[test]
fn a_tools_length_is_no_motion() {
    let text = "G21 F600\nG1 X10 Z1\nG43.1 Z30\nX20\nZ31\n";
    let job = job(text, Lines::Kept);
    let heights: Vec<f64> = Path::new(&job, Order::First)
        .unwrap()
        .pieces
        .iter()
        .flat_map(|piece| piece.interval.map(|xi| piece.z(xi).unwrap()))
        .collect();
    for [end, start] in heights[1..].as_chunks::<2>().0 {
        assert!((end - start).abs() < 1e-9, "{heights:?}");
    }
}

/// The programs of others: each that a job can be made of becomes a path that a controller accepts, without a gap, as high and as low as the
/// program goes.
#[test]
fn programs_of_others_become_paths() {
    let folder = FilePath::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/gcode");
    if !folder.is_dir() {
        println!("SKIPPED: there is no ../shared/data/gcode with the programs of others");
        return;
    }
    let mut files: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let mut count = 0;
    for file in files.iter().filter(|file| program::is_one(file.to_str().unwrap())) {
        let name = file.file_name().unwrap().to_str().unwrap();
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        let input = || BufReader::new(File::open(file).unwrap());
        let (mut is_plain, mut is_upright) = (true, false);
        let all = program::read(name, input(), &mut |item| {
            is_plain &=
                !matches!(item.action, Action::Further { .. } | Action::Compensation(_) | Action::ToolLength(_));
            if let Action::Motion(motion) = item.action
                && let Some([.., z]) = motion.to()
            {
                is_upright |= matches!(motion, Motion::Arc(arc) if arc.plane != Plane::Xy);
                range = [range[0].min(z), range[1].max(z)];
            }
            Ok(())
        });
        if all.is_err() || !is_plain {
            continue;
        }
        let lines = Lines::FittedAsTold(Kind::Drivable, 0.01);
        let (strokes, _) =
            strokes::read(name, input(), lines, &Tooling::default()).unwrap_or_else(|error| panic!("{error}"));
        let job = Job::from_strokes(name, strokes);
        let mut job = job.unwrap_or_else(|e| panic!("{e}"));
        for stroke in job.strokes.iter_mut().filter(|stroke| stroke.pace == Pace::Unset) {
            stroke.pace = Pace::Feed(10.0);
        }
        let path = Path::new(&job, Order::First).unwrap_or_else(|e| panic!("{e}"));
        let mut found = [f64::INFINITY, f64::NEG_INFINITY];
        for pair in path.pieces.windows(2) {
            let [end, start] = [(&pair[0], pair[0].interval[1]), (&pair[1], pair[1].interval[0])].map(|(piece, xi)| {
                let point = piece.point(xi);
                Vector([point.re, point.im, piece.z(xi).unwrap()])
            });
            assert!((end - start).norm() < 1e-3, "{name}: {end:?} {start:?}");
            found = [found[0].min(end.0[2]), found[1].max(end.0[2])];
        }
        // An upright arc goes beyond its ends; curves by their tolerance.
        if !is_upright {
            assert!(found[0] > range[0] - 0.011 && found[1] < range[1] + 0.011, "{name}: {found:?} {range:?}");
        }
        count += 1;
    }
    println!("{count} programs of others became paths");
    assert!(count >= 12);
}

//! A plan that is made while the path comes, beside the plan of the whole path.

#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use host_sim::job::Job;
use host_sim::machine;
use host_sim::path::{Path, PathPiece};
use host_sim::plan::{Limits, Manner, Streamed, plan};
use shared::complex::Complex;
use shared::curve::{Line, Segment};
use shared::piece::Order;

const MACHINE: &str = include_str!("../../examples/machine.toml");

fn limits() -> Limits {
    Limits::of(&machine::from_toml("machine.toml", MACHINE).unwrap(), &Default::default()).unwrap()
}

/// One line as a piece, from which others are made.
fn line() -> PathPiece {
    let job = "units = \"mm\"\nclosed = false\n[feed]\nrate = 3000.0\n\
        [[segment]]\nline = { start = [0.0, 0.0], to = [1.0, 0.0] }\n";
    Path::new(&Job::from_toml("job.toml", job).unwrap(), Order::First).unwrap().pieces[0]
}

/// A meandering way of short lines, as a program has them, with a sharp corner now and then.
fn lines(count: usize) -> impl Iterator<Item = PathPiece> {
    let (first, mut at, mut heading) = (line(), Complex::ZERO, 0.0_f64);
    (0..count).map(move |k| {
        heading += 0.02 * (k as f64 * 0.003).sin() + if k % 997 == 996 { 1.2 } else { 0.0 };
        let (start, step) = (at, Complex::new(heading.cos(), heading.sin()) * (0.05 + 0.04 * (k as f64 * 0.11).cos()));
        at = at + step;
        PathPiece { segment: Segment::Line(Line { start, end: at }), ..first }
    })
}

fn duration(piece: &PathPiece) -> f64 {
    piece.way() / (piece.feed * 0.25 * piece.profile.unwrap().factors.iter().sum::<f64>())
}

/// The same pieces at the same feeds, but for what the smoothing takes from farther away than it is asked to look.
#[test]
fn a_stream_is_planned_as_the_whole() {
    let limits = limits();
    let pieces: Vec<PathPiece> = lines(20_000).collect();
    let whole = plan(&pieces, 0.0, &limits, &Manner::USUAL).unwrap();
    let mut streamed = Streamed::new(pieces.iter().copied(), 0.0, &limits, &Manner::USUAL);
    let parts: Vec<PathPiece> = streamed.by_ref().map(Result::unwrap).collect();
    assert!(streamed.most_held() < 4_500, "{}", streamed.most_held());
    let time: f64 = parts.iter().map(duration).sum();
    assert!((time / whole.time - 1.0).abs() < 1e-4, "{time} {}", whole.time);
    // No feed steps at a node, and the way is all of it.
    let (mut most, mut length) = (0.0_f64, 0.0);
    for pair in parts.windows(2) {
        let [_, _, _, before] = pair[0].profile.unwrap().factors.map(|f| f * pair[0].feed);
        let [after, ..] = pair[1].profile.unwrap().factors.map(|f| f * pair[1].feed);
        most = most.max((after - before).abs());
    }
    for part in &parts {
        length += part.way();
    }
    let expected: f64 = pieces.iter().map(PathPiece::way).sum();
    assert!(most < 1e-6 && (length / expected - 1.0).abs() < 1e-12, "{most} {length} {expected}");
}

/// Ten times the path in the same memory.
#[test]
fn the_memory_of_a_stream_is_flat() {
    let limits = limits();
    let held = [30_000, 300_000].map(|count| {
        let mut streamed = Streamed::new(lines(count), 0.0, &limits, &Manner::USUAL);
        assert!(streamed.by_ref().all(|piece| piece.is_ok()));
        streamed.most_held()
    });
    assert_eq!(held[0], held[1]);
}

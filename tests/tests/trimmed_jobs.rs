//! From a random contour to a path that the controller accepts: whatever the trimming finds, a run can be made of it.

#![allow(clippy::unwrap_used, reason = "a failed test says where")]

use host_sim::contour::{Contour, SMOOTH};
use host_sim::job::Job;
use host_sim::offset::trim;
use host_sim::path::Path;
use shared::complex::Complex;
use shared::piece::Order;
use tests::chain::{Placing, size};
use tests::contours::case;

/// The seeds that are tried.
const SEEDS: u64 = 1_500;
/// The size that every contour is brought to, in mm.
const SIZE: f64 = 200.0;

/// A job of any contour; its reader has seen another one.
fn job(contour: Contour, distance: f64) -> Job {
    let text = "units = \"mm\"\nclosed = false\n[feed]\nrate = 600.0\nreduction = \"auto\"\n\
        [[segment]]\nline = { start = [0.0, 0.0], to = [9.0, 0.0] }\n";
    let mut job = Job::from_toml("job.toml", text).unwrap();
    (job.contour, job.offset) = (contour, distance);
    job
}

/// Every loop of every contour passes the loader, whose gaps are the job's tolerance, unless all of it is too small for a
/// motion or it leaves the machine. Where no piece was left out, its corners are those of the offset.
#[test]
fn trimmed_loops_are_paths() {
    let (mut accepted, mut left_out) = (0, 0);
    for seed in 0..SEEDS {
        let case = case(seed);
        // To one size, and to the machine's origin.
        let scale = SIZE / size(&case.contour);
        let [low, _] = case.contour.extent();
        let placing = Placing { factor: Complex::new(scale, 0.0), shift: low * -scale, mirror: false };
        let (contour, distance) = (placing.contour(&case.contour), placing.distance(case.distance));
        let Ok(offset) = trim(&contour, distance) else { continue };
        let job = job(contour, distance);
        for (number, found) in offset.loops.iter().enumerate() {
            let path = match Path::new(&job.clone().with_loop(Some(number)), Order::First) {
                Ok(path) => path,
                Err(error) => {
                    let small = found.length < found.pieces.len() as f64 * 4e-6;
                    let far = found.pieces.iter().any(|piece| piece.start.norm() > 4_000.0 - SIZE);
                    assert!(small || far, "seed {seed}, {}, loop {number}: {error}", case.family);
                    continue;
                }
            };
            accepted += 1;
            assert_eq!(path.header.closed, found.closed);
            if path.pieces.len() != found.pieces.len() {
                left_out += 1;
                continue;
            }
            for (piece, exact) in path.pieces.iter().zip(&found.pieces) {
                let corner = (exact.end_turn.abs() > SMOOTH).then_some(exact.end_turn);
                let near = match (piece.end_corner, corner) {
                    (Some(angle), Some(exact)) => (angle - exact).abs() < 1e-6,
                    (None, None) => true,
                    // Just at the limit one side of a decision is as good as the other.
                    _ => (exact.end_turn.abs() - SMOOTH).abs() < 0.1 * SMOOTH,
                };
                assert!(near, "seed {seed}, {}: {:?} beside {corner:?}", case.family, piece.end_corner);
            }
        }
    }
    assert!(accepted > SEEDS / 2 && left_out > 0, "{accepted} accepted, {left_out} with pieces left out");
}

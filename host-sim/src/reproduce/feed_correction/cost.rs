//! What the fits cost: operations, counted by a scalar, and time.

use std::hint::black_box;
use std::time::Instant;

use serde::Serialize;
use shared::spline::fit::from_two_samples;
use shared::spline::published::{self, Published, Scaled};
use shared::spline::{CorrectionOrder, Ends, Fit, PolynomialSegment};

use super::fits::{Sampled, centred, chord_sums, closed_form, fourteen};
use crate::spline::constrained;
use crate::spline::counted::{Counted, Operations, count};
use crate::spline::methods::ends_by;

/// A line of the paper's Table 2.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Term {
    /// The equation.
    pub equation: &'static str,
    /// What is computed.
    pub term: &'static str,
    /// Whether it is computed for each of M - 1 samples, or once a segment.
    pub each_sample: bool,
    /// Multiplications, divisions, additions and subtractions as published.
    pub published: [u64; 4],
    /// Those of this project's code.
    pub counted: Operations,
    /// Why they differ; empty where they do not.
    pub why: &'static str,
}

/// Operations for one segment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Total {
    /// Which fit.
    pub name: String,
    /// M.
    pub divisions: usize,
    /// As published; none where nothing was.
    pub published: Option<u64>,
    /// Those of this project's code.
    pub counted: Operations,
    /// Why they differ; empty where nothing was published.
    pub why: &'static str,
}

/// Times for one segment, on average over the fan, in microseconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Times {
    /// FC(14) from the paper's samples.
    pub fourteen: f64,
    /// FC(15) to FC(20) from the paper's samples, in powers of s and its operations in the paper's order.
    pub closed_form: f64,
    /// The same closed form from the same samples about the middle of the segment, as [`shared::spline::Fit`] has it.
    pub centred: f64,
    /// Two samples, with the arc length that they need.
    pub two_samples: f64,
    /// The arc length of the paper's samples, which the first two do not hold.
    pub chords: f64,
}

/// Counts every line of Table 2 once.
pub fn terms(sampled: &Sampled) -> Option<Vec<Term>> {
    let ends = counted_ends(sampled)?;
    let sigma = Counted(0.3);
    let powers = published::powers(sigma);
    let scaled = published::scaled(&ends);
    let (phi_i, phi_f, y) = (Counted(0.01), Counted(-0.01), Counted(0.001));
    let one = |equation, term, each_sample, published, counted: Operations, why| Term {
        equation,
        term,
        each_sample,
        published,
        counted,
        why,
    };
    let mut sums = [Counted(0.5); 5];
    let of = |work: &mut dyn FnMut()| count(work).0;
    let remainder = |by: &Scaled<Counted>| published::remainder(&powers, Counted(0.0), Counted(1.0), by);
    Some(vec![
        one("(15)", "1/S .. 1/S^7", false, [6, 1, 0, 0], of(&mut || keep(published::inverse_powers(ends.length))), ""),
        one("(16)", "sigma", true, [1, 0, 0, 0], of(&mut || keep(sigma * Counted(0.5))), ""),
        one(
            "(17)",
            "S^2, S^3",
            false,
            [2, 0, 0, 0],
            of(&mut || keep(published::scaled(&ends))),
            "S u_s and S^2 u_ss are computed here once, not for each sample",
        ),
        one("(17)", "sigma^2 .. sigma^7", true, [6, 0, 0, 0], of(&mut || keep(published::powers(sigma))), ""),
        one(
            "(17)",
            "phi_i",
            true,
            [4, 0, 3, 1],
            of(&mut || keep(published::bump_start(&powers))),
            "equal factors are taken out; S^3 is left to the end",
        ),
        one(
            "(17)",
            "phi_f",
            true,
            [3, 0, 1, 2],
            of(&mut || keep(published::bump_end(&powers))),
            "equal factors are taken out; S^3 is left to the end",
        ),
        one(
            "(17)",
            "u~",
            true,
            [28, 0, 13, 11],
            of(&mut || keep(remainder(&scaled))),
            "without S u_s and S^2 u_ss, and with u_f - u_i as one number",
        ),
        one("(18)", "y", true, [0, 0, 0, 1], of(&mut || keep(y - phi_i)), ""),
        one(
            "(19)",
            "the five sums",
            true,
            [5, 0, 5, 0],
            of(&mut || published::accumulate(&mut sums, phi_i, phi_f, y)),
            "",
        ),
        one(
            "(20)",
            "u_sss at both ends",
            false,
            [6, 1, 0, 3],
            of(&mut || keep(published::solve(&[phi_i, phi_f, Counted(0.02), y, y]))),
            "one inverse and two products in the place of two divisions by one number",
        ),
        one(
            "(15)",
            "A .. H",
            false,
            [42, 0, 18, 12],
            of(&mut || {
                keep(published::coefficients(&powers, Counted(0.0), Counted(1.0), &scaled, [phi_i, phi_f]));
            }),
            "with S u_s, S^2 u_ss and S^3 u_sss at hand, and u_f - u_i as one number",
        ),
    ])
}

fn counted_ends(sampled: &Sampled) -> Option<Ends<Counted>> {
    let ends = ends_by(&sampled.segment, sampled.length(), sampled.span)?;
    Some(Ends {
        length: Counted(ends.length),
        parameter: ends.parameter.map(Counted),
        first: ends.first.map(Counted),
        second: ends.second.map(Counted),
        third: ends.third.map(Counted),
    })
}

/// Counts the three fits of one segment. The samples are given to the first two, as in the paper; the third one makes its own.
pub fn totals(sampled: &Sampled) -> Option<Vec<Total>> {
    let ends = counted_ends(sampled)?;
    let divisions = sampled.divisions();
    let samples: Vec<_> = sampled.samples.iter().map(|&(s, u)| (Counted(s), Counted(u))).collect();
    let (fourteen, _) = count(|| constrained::fit(&ends, samples.iter().copied()));
    let inner = samples.get(1..divisions)?;
    let (closed_form, _) = count(|| {
        let mut fit = Published::new(&ends);
        for &(s, u) in inner {
            fit.sample(s, u);
        }
        fit.finish()
    });
    let (length, span) = (Counted(sampled.length()), Counted(sampled.span));
    let about_middle = Ends {
        parameter: [Counted(-0.5), Counted(0.5)],
        first: ends.first.map(|rate| Counted(rate.0 / span.0)),
        second: ends.second.map(|rate| Counted(rate.0 / span.0)),
        ..ends
    };
    let (centred, _) = count(|| {
        let mut fit = Fit::new(&about_middle, CorrectionOrder::Seventh);
        let (per_length, per_span) = (Counted(1.0) / length, Counted(1.0) / span);
        for &(s, u) in inner {
            fit.sample(s * per_length - Counted(0.5), u * per_span - Counted(0.5));
        }
        fit.finish()
    });
    let segment = PolynomialSegment(sampled.segment.0.map(|c| c.map(Counted)));
    let (two, _) = count(|| from_two_samples(&segment, CorrectionOrder::Seventh));
    let m = divisions as u64;
    let one = |name: &str, divisions, published, counted, why| Total {
        name: name.to_string(),
        divisions,
        published,
        counted,
        why,
    };
    Some(vec![
        one(
            "14 equations",
            divisions,
            Some(144 * m + 2328),
            fourteen,
            "the powers of sigma are counted here, 7 multiplications and a division a sample",
        ),
        one("closed form", divisions, Some(84 * m + 7), closed_form, "see the lines above"),
        one("closed form about the middle", divisions, None, centred, ""),
        one("two samples, arc length included", 2, None, two, ""),
    ])
}

/// Times the three fits over all segments in one run: the least of several rounds, in turn, so that whatever else the machine does
/// meets all alike.
pub fn times(sampled: &[Sampled], mut done: impl FnMut()) -> Times {
    let mut least = [f64::INFINITY; 5];
    let over = |work: &dyn Fn(&Sampled)| {
        let start = Instant::now();
        sampled.iter().for_each(work);
        start.elapsed().as_secs_f64() * 1e6 / sampled.len() as f64
    };
    for _ in 0..TIMING_ROUNDS {
        let found = [
            over(&|one| keep(fourteen(black_box(one)))),
            over(&|one| keep(closed_form(black_box(one)))),
            over(&|one| keep(centred(black_box(one), CorrectionOrder::Seventh))),
            // So short that one pass would measure the clock.
            over(&|one| {
                for _ in 0..100 {
                    keep(from_two_samples(black_box(&one.segment), CorrectionOrder::Seventh));
                }
            }) / 100.0,
            over(&|one| keep(chords(black_box(one)))),
        ];
        for (least, found) in least.iter_mut().zip(found) {
            *least = least.min(found);
        }
        done();
    }
    let [fourteen, closed_form, centred, two_samples, chords] = least;
    Times { fourteen, closed_form, centred, two_samples, chords }
}

/// How many rounds [`times`] runs.
pub const TIMING_ROUNDS: u64 = 9;

/// The arc length as the paper has it.
fn chords(sampled: &Sampled) -> Option<f64> {
    chord_sums(&sampled.segment, sampled.divisions() as u32).last()
}

/// Takes a result that only its making is asked of.
fn keep<T>(result: T) {
    black_box(result);
}

//! Trims the contours of a range of seeds, checks every property of the results, and lists failures by kind.
//!
//! `cargo run --release -p tests --example offset_seeds -- FROM COUNT [SAMPLES]` runs seeds FROM to FROM + COUNT - 1 on all
//! cores. `... -- show SEED` prints one case in full, with what came of it.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use host_sim::offset::trim;
use tests::chain::size;
use tests::contours::{Case, case};
use tests::properties::{Failure, Outcome, check};

/// Samples of each piece unless the command line says.
const SAMPLES: usize = 12;
/// Seeds printed of each kind of failure.
const LISTED: usize = 12;
/// A seed that takes longer is told while it still runs: it may never end.
const PATIENCE: Duration = Duration::from_secs(5);

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize| arguments.get(k).and_then(|text| text.parse::<u64>().ok());
    match (arguments.first().map(String::as_str), number(0), number(1)) {
        (Some("show"), _, Some(seed)) => show(seed),
        (_, Some(from), Some(count)) => run(from, count, number(2).map_or(SAMPLES, |n| n as usize)),
        _ => eprintln!("offset_seeds FROM COUNT [SAMPLES], or offset_seeds show SEED"),
    }
}

/// One case, in a line.
fn describe(case: &Case) -> String {
    let Case { family, contour, distance, .. } = case;
    let form = if contour.closed { "closed" } else { "open" };
    format!("{family}, {form}, {} segments, d = {:.3e} sizes", contour.segments.len(), distance / size(contour))
}

/// What came of a case, and the time that trimming took.
fn attempt(case: &Case, samples: usize, trimmed: impl Fn()) -> (Result<Outcome, Failure>, Duration) {
    let start = Instant::now();
    let result = catch_unwind(AssertUnwindSafe(|| drop(trim(&case.contour, case.distance))));
    let time = start.elapsed();
    trimmed();
    let panicked = |_| Err(Failure { property: "panic", detail: String::new() });
    let result = result
        .and_then(|()| catch_unwind(AssertUnwindSafe(|| check(&case.contour, case.distance, case.touches, samples))))
        .unwrap_or_else(panicked);
    (result, time)
}

fn show(seed: u64) {
    let case = case(seed);
    println!("seed {seed}: {}", describe(&case));
    println!("closed {}, distance {:?}, touches {}", case.contour.closed, case.distance, case.touches);
    for (k, segment) in case.contour.segments.iter().enumerate() {
        println!("  {k}: {segment:?}");
    }
    match trim(&case.contour, case.distance) {
        Ok(offset) => {
            for ring in &offset.loops {
                println!(
                    "loop: closed {}, length {}, area {}, depth {}, parent {:?}",
                    ring.closed, ring.length, ring.area, ring.depth, ring.parent
                );
                for piece in &ring.pieces {
                    println!("  {piece:?}");
                }
            }
        }
        Err(error) => println!("{error:?}"),
    }
    match attempt(&case, 64, || ()) {
        (Ok(outcome), time) => println!("{outcome:?}, trimmed in {time:?}"),
        (Err(failure), time) => println!("FAILED {failure}, trimmed in {time:?}"),
    }
}

/// Failures and outcomes so far.
#[derive(Default)]
struct Tally {
    failures: BTreeMap<&'static str, Vec<(u64, String)>>,
    outcomes: BTreeMap<String, u64>,
    families: BTreeMap<&'static str, [u64; 2]>,
    slowest: (Duration, u64),
    total: Duration,
}

fn run(from: u64, count: u64, samples: usize) {
    std::panic::set_hook(Box::new(|_| ()));
    let next = AtomicU64::new(from);
    let tally = Mutex::new(Tally::default());
    let running: Mutex<BTreeMap<u64, (Instant, &str)>> = Mutex::default();
    let note = |seed: u64, stage: &'static str| {
        if let Ok(mut running) = running.lock() {
            running.insert(seed, (Instant::now(), stage));
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let start = Instant::now();
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let mut told = 0;
            while let Ok(running) = running.lock().map(|running| running.clone()) {
                let late = running.iter().filter(|(_, (since, _))| since.elapsed() > PATIENCE);
                for (seed, (_, stage)) in late.filter(|(seed, _)| **seed >= told).collect::<Vec<_>>() {
                    println!("seed {seed} has been {stage} for {PATIENCE:?}: {}", describe(&case(*seed)));
                    told = seed + 1;
                }
                if running.is_empty() && next.load(Ordering::Relaxed) >= from + count {
                    break;
                }
                std::thread::sleep(Duration::from_millis(50));
            }
        });
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= from + count {
                        break;
                    }
                    note(seed, "drawing");
                    let case = case(seed);
                    note(seed, "trimming");
                    let (result, time) = attempt(&case, samples, || note(seed, "checking"));
                    if let Ok(mut running) = running.lock() {
                        running.remove(&seed);
                    }
                    let Ok(mut tally) = tally.lock() else { break };
                    tally.total += time;
                    tally.slowest = tally.slowest.max((time, seed));
                    let family = tally.families.entry(case.family).or_default();
                    family[1] += 1;
                    family[0] += u64::from(result.is_err());
                    match result {
                        Ok(Outcome::Loops(n)) => {
                            *tally
                                .outcomes
                                .entry(if n > 4 { "5 loops or more".into() } else { format!("{n} loops") })
                                .or_default() += 1;
                        }
                        Ok(outcome) => *tally.outcomes.entry(format!("{outcome:?}")).or_default() += 1,
                        Err(failure) => {
                            let what = format!("{} [{}]", failure.detail, describe(&case));
                            tally.failures.entry(failure.property).or_default().push((seed, what));
                        }
                    }
                }
            });
        }
    });
    let Ok(tally) = tally.into_inner() else { return };
    for (property, mut seeds) in tally.failures {
        seeds.sort();
        println!("{property}: {} seeds", seeds.len());
        for (seed, what) in seeds.iter().take(LISTED) {
            println!("  {seed}: {what}");
        }
    }
    println!("{:?}", tally.outcomes);
    for (family, [failed, all]) in tally.families {
        println!("  {family}: {failed} of {all} failed");
    }
    println!(
        "{:?} in all; trimming took {:?}, at most {:?} (seed {})",
        start.elapsed(),
        tally.total,
        tally.slowest.0,
        tally.slowest.1
    );
}

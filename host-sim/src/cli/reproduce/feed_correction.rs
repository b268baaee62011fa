//! The tables of the feed correction paper, as text.

use host_sim::reproduce::feed_correction::{Reproduction, Term};

/// Prints them.
pub(super) fn print(result: &Reproduction) {
    println!("The feed correction polynomial; 100 mm/s, 1 ms ticks, f64; airfoil: {}", result.airfoil);
    println!("\nfluctuation of the feed, %");
    println!("{:8} {:34} {:>11} {:>11} {:>11} {:>11}", "curve", "method", "figure", "lowest", "highest", "rms");
    for run in &result.runs {
        let [low, high] = run.fluctuation_percent;
        println!(
            "{:8} {:34} {:>11} {low:>+11.5} {high:>+11.5} {:>11.5}",
            run.curve, run.method, run.figure, run.rms_percent
        );
    }
    println!("\noperations of the closed form, line by line (* / + -), M - 1 samples; published: 84 M + 7");
    for term in &result.terms {
        print_term(term);
    }
    println!("\noperations a segment");
    for total in &result.totals {
        let published = total.published.map_or("-".to_string(), |published| published.to_string());
        let (name, divisions, here) = (&total.name, total.divisions, total.counted.sum());
        println!("{name:34} M = {divisions:<4} published {published:>6}, here {here:>6}  {}", total.why);
    }
    println!("\nthe seventh order from fewer samples, on the fan");
    println!(
        "{:>8} {:18} {:>22} {:>15} {:>11}",
        "samples", "at", "Gauss nodes between", "fluctuation, %", "operations"
    );
    for row in &result.sparse {
        println!(
            "{:>8} {:18} {:>22} {:>15.5} {:>11}",
            row.samples, row.at, row.nodes, row.fluctuation_percent, row.operations
        );
    }
    let times = &result.times;
    println!("\ntime a segment in this run, us");
    for (name, time) in [
        ("14 equations", times.fourteen),
        ("closed form in powers, as published", times.closed_form),
        ("closed form about the middle", times.centred),
        ("two samples, arc length included", times.two_samples),
        ("arc length of the first two, beside", times.chords),
    ] {
        println!("{name:36} {time:>9.3}   {:>6.3} of the 14 equations", time / times.fourteen);
    }
    println!("\nhere | published");
    for row in &result.rows {
        println!("{:62} {:>12.5} | {:>9.5}", row.name, row.measured, row.published);
    }
}

fn print_term(term: &Term) {
    let [m, d, a, s] = term.published;
    let here = term.counted;
    let times = if term.each_sample { "x (M - 1)" } else { "" };
    println!(
        "{:5} {:20} {times:9} published {m:>3} {d:>2} {a:>3} {s:>3}, here {:>3} {:>2} {:>3} {:>3}  {}",
        term.equation, term.term, here.multiplications, here.divisions, here.additions, here.subtractions, term.why
    );
}

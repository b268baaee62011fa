//! What `hodograph reproduce spline-fit` prints.

use host_sim::reproduce::spline_fit::Reproduction;

/// The ways beside each other, and what the paper found.
pub fn print(result: &Reproduction) {
    println!("a plate at four levels, {} lines, {} mm/s, within {} mm", result.lines, result.feed, result.tolerance);
    println!("{:30}{:>8}{:>9}{:>8}{:>9}{:>9}{:>16}", "", "curves", "time, s", "%", "corners", "jumps", "fillet, mm/s");
    for run in &result.runs {
        println!(
            "{:30}{:>8}{:>9.3}{:>8.1}{:>9}{:>9}{:>16.1}",
            run.name,
            run.strokes,
            run.time_s,
            run.relative_percent,
            run.corners,
            run.curvature_jumps,
            run.fillet_least_feed
        );
    }
    println!("\n{:70}{:>10}{:>9}", "what the paper found: ratio of", "below", "here");
    for row in &result.rows {
        let verdict = if row.holds { "" } else { "  NOT SO HERE" };
        println!("{:70}{:>10.1}{:>9.3}{verdict}", row.name, row.published, row.measured);
    }
}

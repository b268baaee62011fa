//! The report of one simulation.

use super::ReportError;
use super::figures::{
    Quantity, Series, feed_along_path, milliseconds, offsets, over_time, per_minute, scale_end, spacing, spacing_ticks,
};
use super::geometry::Detail;
use super::page::{Layout, Page, escape};
use super::series::{number, three_figures};
use crate::job::Job;
use crate::offset::undercuts;
use crate::path::Path;
use crate::simulate::{Outcome, Sample};
use crate::trimming::Trimming;

/// The report of one simulation. Errors: a run without samples; a picture that cannot be drawn.
pub fn simulation(job: &Job, path: &Path, outcome: &Outcome, samples: &[Sample]) -> Result<String, ReportError> {
    if samples.is_empty() {
        return Err(ReportError::NoSamples);
    }
    let machine = samples.iter().any(|sample| sample.actual != sample.setpoint);
    let mut page = Page::new(&format!("Simulation of {}", job.name()), &lead(job, path, machine));
    page.facts(&facts(outcome, machine));
    page.paragraph(&format!(
        "Hash of all setpoints: <code>{}</code>. The controller's own tick computes them, so a controller that runs this job \
         puts out the same ones.",
        escape(&outcome.setpoint_hash)
    ));
    if job.offset != 0.0 {
        page.heading("Contour and offset");
        let trimming = path.trimmed.as_ref().map(|trimmed| {
            let undercuts = undercuts(&job.contour, &trimmed.offset);
            let result = Trimming::new(&job.contour, &trimmed.offset, &undercuts, job.units);
            (undercuts, result)
        });
        let undercuts = trimming.as_ref().map_or(&[][..], |(undercuts, _)| undercuts);
        page.figure(&offsets(job, path, undercuts)?, Layout::Pair, OFFSETS);
        if let (Some((_, result)), Some(trimmed)) = (&trimming, &path.trimmed) {
            page.paragraph(&reached(result, trimmed.number));
        }
    }
    page.heading("Feed along the path");
    page.block("<div class=\"charts\">");
    let most = scale_end(job.units, samples.iter().map(|sample| sample.feed));
    page.figure(
        &[feed_along_path(job, path, samples, most)?],
        Layout::Single,
        "The way of the tool's centre in the colour of its commanded feed: dark is slow, light is fast. At corners the factor f reduces it; where the contour is convex the centre must outrun the contact point, the more so \
         the smaller w.",
    );
    if let Some(detail) = Detail::find(path).filter(|_| job.offset != 0.0) {
        let step = spacing_ticks(&detail, samples);
        page.figure(
            &[spacing(job, path, samples, &detail, step)?],
            Layout::Single,
            &format!(
                "Where the two feeds differ most, by a factor of {}: contact points on C and tool centres every {} ms, each pair \
                 joined. Even spacing on C is an even chip load, even spacing of the centres an even motion of the machine.",
                number(detail.stretch, 1),
                milliseconds(step)
            ),
        );
    }
    page.block("</div>");
    page.heading("Over time");
    charts(&mut page, job, outcome, samples, machine)?;
    Ok(page.finish())
}

const OFFSETS: &str = "First the contour C and its untrimmed offset, drawn along the whole of every segment and joined by arcs \
    about the nodes; it crosses itself in loops at concave nodes and where C bends more sharply than the tool. Then the trimmed \
    offset, which is the tool's path; it keeps only what is nowhere nearer to C than the tool's radius. Rings are trim points, \
    where the path turns abruptly.";

/// What the tool leaves, and which loop of several is run.
fn reached(result: &Trimming, run: usize) -> String {
    let unit = result.units.short();
    let loops = match result.loops.len() {
        1 => String::new(),
        count => {
            format!("The trimmed offset has {count} loops; this run is loop {run}, the others are drawn thin. ")
        }
    };
    let left = match result.undercuts.len() {
        0 => "The tool reaches all of the contour.".to_string(),
        count => format!(
            "The tool leaves material in {count} {}, up to {} {unit} thick (shaded).",
            if count == 1 { "place" } else { "places" },
            three_figures(result.largest_undercut),
        ),
    };
    let reaching = match (result.largest_reaching_tool, result.sharp_corners.as_slice()) {
        (None, _) => "A tool of any radius would.".to_string(),
        (Some(0.0), [_, ..]) => {
            "No tool reaches everything, because the contour has sharp concave corners.".to_string()
        }
        (Some(radius), _) => {
            format!("The largest tool that reaches everything has radius {} {unit}.", number(radius, 4))
        }
    };
    format!("{loops}{left} {reaching}")
}

fn lead(job: &Job, path: &Path, machine: bool) -> String {
    let unit = job.units.short();
    let length = |mm: f64| number(mm / job.units.mm(), 3);
    format!(
        "{} pieces along {} segments, offset {} {unit}, feed {} {unit}/min, weight w = {}, reduction f = {}, ramp \u{3bb} = {}; {}.",
        path.pieces.len(),
        job.contour.segments.len(),
        length(job.offset),
        number(per_minute(job.units, job.feed.rate), 1),
        path.weight,
        job.feed.reduction,
        job.feed.ramp,
        if machine { "on a simulated machine" } else { "on an ideal machine" }
    )
}

fn facts(outcome: &Outcome, machine: bool) -> Vec<(&'static str, String, &'static str)> {
    use crate::job::Units;
    let (unit, feed, acceleration) = match outcome.units {
        Units::Mm => ("mm", "mm/min", "mm/s\u{b2}"),
        Units::Inch => ("in", "in/min", "in/s\u{b2}"),
    };
    let mut facts = vec![
        ("Time", number(outcome.time_s, 3), "s"),
        ("Ticks", outcome.ticks.to_string(), ""),
        ("Length on the contour", number(outcome.contact_length, 3), unit),
        ("Length of the centre\u{2019}s way", number(outcome.centre_length, 3), unit),
        ("Largest feed", number(outcome.max_feed, 1), feed),
    ];
    if machine {
        facts.push(("Largest measured feed", number(outcome.max_measured_feed, 1), feed));
    }
    facts.push(("Largest acceleration", number(outcome.max_acceleration, 1), acceleration));
    facts.push(("Largest contour error", small(outcome.max_contour_error), unit));
    facts.push(("Contour error, rms", small(outcome.rms_contour_error), unit));
    if machine {
        let [x, y] = outcome.max_following_error;
        facts.push(("Largest following error, x and y", format!("{} and {}", small(x), small(y)), unit));
    }
    facts
}

/// Three figures, however small; what a rounding alone leaves is named by its power of ten.
fn small(value: f64) -> String {
    const SUPERSCRIPT: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    if value != 0.0 && value.abs() < 1e-5 {
        let power = value.abs().log10().floor();
        let digits = format!("{:.0}", -power);
        let exponent: String = digits.chars().filter_map(|c| SUPERSCRIPT.get(c.to_digit(10)? as usize)).collect();
        return format!("{:.1}\u{b7}10\u{207b}{exponent}", value / 10_f64.powf(power));
    }
    three_figures(value)
}

fn charts(page: &mut Page, job: &Job, outcome: &Outcome, samples: &[Sample], machine: bool) -> Result<(), ReportError> {
    let run = [Series { label: "", samples, settling: outcome.settling_ticks, machine }];
    let over = |quantity, title: &str| over_time(quantity, job.units, &run, title);
    let settling = if outcome.settling_ticks > 0 {
        format!(
            " The drives start at rest while the path moves at once: the shaded first {} ticks count for no maximum.",
            outcome.settling_ticks
        )
    } else {
        String::new()
    };
    let feed = if machine {
        "The feed of the tool's centre: the commanded one broad, on it the one that the encoders show over five ticks."
    } else {
        "The commanded feed of the tool's centre."
    };
    page.block("<div class=\"charts\">");
    page.figure(&[over(Quantity::Feed, "Feed over time")?], Layout::Single, &format!("{feed}{settling}"));
    page.figure(
        &[over(Quantity::Acceleration, "Acceleration over time")?],
        Layout::Single,
        "The magnitude of the acceleration, from second differences of positions five ticks apart. Peaks stand at corners and \
         where the feed changes.",
    );
    let error = if machine {
        "The contour error: how far the machine is from the exact path, along its normal."
    } else {
        "The contour error of the setpoints themselves: how far rounding leaves them from the exact path."
    };
    page.figure(&[over(Quantity::ContourError, "Contour error over time")?], Layout::Single, error);
    if machine {
        page.figure(
            &[over(Quantity::FollowingError, "Following error of x and y over time")?],
            Layout::Single,
            "The following error of each axis: its setpoint less its encoder, x above y on one scale. It may be far larger than \
             the contour error, for a lag along the path does not leave the path.",
        );
    }
    page.block("</div>");
    if !machine {
        page.paragraph(
            "No machine was simulated: the axes are where their setpoints are, so there is no following error to show. \
             Give a machine with <code>--plant FILE</code>.",
        );
    }

    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::page::tests::{assert_balanced, assert_self_contained};
    use super::*;
    use crate::job::FeedOverride;
    use crate::plant::Measured;
    use crate::simulate::simulate;
    use shared::fixed::Position;
    use shared::piece::Order;

    fn report(text: &str, lag: f64) -> String {
        let job = Job::from_toml("part <1>.toml", text).unwrap();
        let job = job.with_feed(FeedOverride { rate: Some(900.0), ..FeedOverride::default() }).unwrap();
        let path = Path::new(&job, Order::First).unwrap();
        let mut samples = Vec::new();
        let drive = |setpoint: Position| {
            let mut measured = Measured::ideal(setpoint);
            measured.encoder[0] += lag;
            measured
        };
        let outcome = simulate(&path, job.units, 0, drive, |sample| samples.push(*sample)).unwrap();
        let html = simulation(&job, &path, &outcome, &samples).unwrap();
        assert_balanced(&html);
        assert_self_contained(&html);
        assert!(html.contains(&outcome.setpoint_hash) && html.contains("part &lt;1&gt;.toml"));
        html
    }

    const LINE: &str = "units = \"mm\"\nclosed = false\n[feed]\nrate = 600.0\n[[segment]]\nline = { start = [0.0, 0.0], to = [9.0, 0.0] }\n";

    #[test]
    fn ideal_machine_has_no_following_error() {
        let html = report(LINE, 0.0);
        assert!(html.contains("No machine was simulated") && !html.contains("Following error of"));
        assert!(!html.contains("untrimmed"), "there is no offset");
    }

    #[test]
    fn machine_has_a_following_error() {
        let html = report(LINE, 0.25);
        assert!(html.contains("Following error of x and y") && html.contains("x: largest 0.250 mm"));
    }

    #[test]
    fn published_contour_has_all_its_pictures() {
        let html = report(crate::reproduce::farouki2018::CONTOUR, 0.001);
        assert_eq!(html.matches("<figure").count(), 7);
        assert_eq!(html.matches("<svg").count(), 8);
        assert!(html.len() < 2_000_000);
    }

    /// Two loops, of which one is run, and four places that the tool does not reach.
    #[test]
    fn trimmed_pocket_says_what_is_left() {
        let html = report(include_str!("../../../examples/pocket.toml"), 0.0);
        for words in
            ["has 2 loops; this run is loop 0", "leaves material in 4 places", "No tool reaches everything", "auto"]
        {
            assert!(html.contains(words), "{words}");
        }
    }

    #[test]
    fn nothing_to_draw_is_said() {
        let job = Job::from_toml("line.toml", LINE).unwrap();
        let path = Path::new(&job, Order::First).unwrap();
        let outcome = simulate(&path, job.units, 0, Measured::ideal, |_| ()).unwrap();
        assert_eq!(simulation(&job, &path, &outcome, &[]), Err(ReportError::NoSamples));
    }

    #[test]
    fn small_values_stay_readable() {
        assert_eq!(small(3.2e-7), "3.2\u{b7}10\u{207b}⁷");
        assert_eq!(small(0.0127), "0.0127");
        assert_eq!(small(0.0), "0");
    }
}

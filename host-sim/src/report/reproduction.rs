//! The report of the published experiment: the paper's figures and tables from our own runs, and what they cannot say.

use shared::piece::Order;

use super::ReportError;
use super::figures::{
    Quantity, Series, feed_along_path, milliseconds, offsets, over_time, scale_end, spacing, spacing_ticks,
};
use super::geometry::Detail;
use super::page::{Layout, Page, escape};
use super::series::{number, three_figures};
use super::tables::{self, LEGEND, signed_percent, worst};
use crate::path::Path;
use crate::reproduce::farouki2018::{Experiment, Reproduction, Table, WEIGHTS};

/// The report of the published experiment. Errors: runs without samples; a picture that cannot be drawn.
pub fn reproduction(result: &Reproduction) -> Result<String, ReportError> {
    if result.runs.is_empty() || result.runs.iter().any(|run| run.samples.is_empty()) {
        return Err(ReportError::NoSamples);
    }
    let mut page = Page::new("Feedrate modulation on a trimmed offset", &lead(result));
    page.facts(&facts(result));
    page.heading("The published tables");
    page.paragraph(
        "Each figure of this run over the one that was published. Under Table 1 stands the exact integral of the paper's \
         equation (21), under Table 3 the commanded feed, which needs no machine.",
    );
    page.block(LEGEND);
    let tables: String =
        result.tables.iter().map(|table| format!("<div class=\"scroll\">{}</div>", tables::html(table))).collect();
    page.block(&format!("<div class=\"tables\">{tables}</div>"));
    limits(&mut page, result);
    page.heading("Contour and offset");
    page.figure(
        &offsets(&result.job, &result.path, &[])?,
        Layout::Pair,
        "As the paper's figure 1. First the contour C and its untrimmed offset, joined by arcs about the nodes; it crosses \
         itself in loops at the concave nodes and where C bends more sharply than the tool. Then the trimmed offset, the path \
         of the tool's centre. Rings mark the trim points, at which the tangent breaks and the factor f reduces the feed.",
    );
    spacings(&mut page, result)?;
    feeds(&mut page, result)?;
    over_the_path(&mut page, result)?;
    runs(&mut page, result);
    Ok(page.finish())
}

fn lead(result: &Reproduction) -> String {
    format!(
        "The twelve runs of Farouki and Srinathu (2018), section 5, again: three weights w, four reductions f, feed V = 200 in/min, \
         ramp \u{3bb} = 0.25, 1024 ticks a second. The controller's own tick gives the setpoints; the machine is simulated ({}).",
        escape(&result.plant)
    )
}

fn facts(result: &Reproduction) -> Vec<(&'static str, String, &'static str)> {
    let outcomes = || result.runs.iter().map(|run| &run.outcome);
    let least = |figure: fn(&Experiment) -> f64| result.runs.iter().map(figure).fold(f64::INFINITY, f64::min);
    let most = |figure: fn(&Experiment) -> f64| result.runs.iter().map(figure).fold(0.0, f64::max);
    let lengths = outcomes().next().map_or((0.0, 0.0), |first| (first.contact_length, first.centre_length));
    let times = result.tables.first().map_or(0.0, |table| worst(table).0);
    vec![
        ("Fastest run", number(least(|run| run.outcome.time_s), 3), "s"),
        ("Slowest run", number(most(|run| run.outcome.time_s), 3), "s"),
        ("Times differ from the paper\u{2019}s by at most", number(100.0 * times.abs(), 2), "%"),
        ("Times differ from the exact ones by at most", three_figures(100.0 * most(time_error)), "%"),
        ("Length on the contour", number(lengths.0, 3), "in"),
        ("Length of the centre\u{2019}s way", number(lengths.1, 3), "in"),
        ("Largest commanded feed", number(most(|run| run.outcome.max_feed), 1), "in/min"),
        ("Largest measured feed", number(most(|run| run.outcome.max_measured_feed), 1), "in/min"),
        ("Largest contour error", number(most(|run| run.outcome.max_contour_error), 4), "in"),
        ("Largest acceleration", number(most(|run| run.outcome.max_acceleration), 0), "in/s\u{b2}"),
    ]
}

fn time_error(run: &Experiment) -> f64 {
    (run.outcome.time_s / run.exact_time_s - 1.0).abs()
}

/// What the tables do not prove, and why cells differ.
fn limits(page: &mut Page, result: &Reproduction) {
    page.heading("What these numbers cannot say");
    page.block("<div class=\"prose\">");
    page.paragraph(
        "<b>The contour is a reconstruction.</b> The paper draws its test curve and gives no coordinates. The curve here has the same \
         make-up (eight quintic PH segments in a closed chain, six concave corners, two smooth nodes, two trims inside segments), \
         but its shape was found by fitting eleven numbers to the published tables, with one half the mirror image of the other. \
         Others would serve as well. That twelve times agree shows that the feed law accounts for the paper's figures, not that \
         this is the paper's curve. The comparison with the exact integral does not depend on the fit.",
    );
    page.paragraph(
        "<b>The drive is fitted too.</b> The paper's mill is not described. One simple servo drive, the same for both axes and with a \
         limit on what it can push, was fitted to Tables 2 to 4: these tables test how well so simple a drive can play that mill, and \
         predict nothing. Here the drives begin at rest while the path moves at once, so the first 150 ticks are left out of the \
         maxima. Nor does the paper say how it formed its accelerations; second differences over five ticks come nearest.",
    );
    let items: String = result.tables.iter().zip(REASONS).map(|(table, reason)| item(table, reason)).collect();
    page.block(&format!("<ul>{items}</ul></div>"));
}

/// Why the cells of each table differ.
const REASONS: [&str; 4] = [
    "What is left is the fit of the contour: a time hardly depends on the machine.",
    "Errors of a few thousandths of an inch may hang on dry friction, play and noise of the one machine, which the drive here lacks. The \
     large ones come from saturation: at w = 0 with f = 1 the drive cannot follow for a moment, whatever its other numbers.",
    "For w below 1 the feed here rises above the published one, as the commanded feed does already: the paper's mill fell short \
     of its command, or its contour bends less where the centre is fastest. At w = 1 the command never exceeds 200 in/min, and \
     everything above is overshoot at corners or noise of the difference.",
    "At f = 0.25 the published maxima are nearly the same for all w, as if something other than the commanded motion had set them; \
     the simulated drive has nothing of the kind. At w = 1 and higher f the real mill seems to have taken its corners more softly.",
];

fn item(table: &Table, reason: &str) -> String {
    let (relative, weight, reduction) = worst(table);
    format!(
        "<li><b>{}.</b> Farthest apart: {} at w = {weight}, f = {reduction}. {reason}</li>",
        escape(table.title),
        signed_percent(relative)
    )
}

/// A detail of the runs without reduction, at the two extreme weights.
fn spacings(page: &mut Page, result: &Reproduction) -> Result<(), ReportError> {
    let Some(detail) = Detail::find(&result.path) else { return Ok(()) };
    page.heading("Contact point and tool centre");
    let job = &result.job;
    let (mut pictures, mut steps) = (Vec::new(), Vec::new());
    for run in result.runs.iter().filter(|run| run.reduction == 1.0 && run.weight != 0.5) {
        let step = spacing_ticks(&detail, &run.samples);
        pictures.push(spacing(job, &weighted(result, run.weight), &run.samples, &detail, step)?);
        steps.push(milliseconds(step));
    }
    page.figure(
        &pictures,
        Layout::Pair,
        &format!(
            "As the paper's figure 3: contact points and tool centres at equal time steps, each pair joined, where the two speeds \
             differ most (by a factor of {}). First w = 0: even steps of the contact point throw the centre round the bend. Then \
             w = 1: even steps of the centre crowd the contact points together in the bend, and the chip load falls there. A step \
             is {} ms; f = 1.",
            number(detail.stretch, 1),
            steps.join(" ms in the first picture and ")
        ),
    );
    Ok(())
}

/// The paths of the smallest reduction.
fn feeds(page: &mut Page, result: &Reproduction) -> Result<(), ReportError> {
    page.heading("Feed along the path");
    let (job, slowest) = (&result.job, result.runs.iter().map(|run| run.reduction).fold(1.0, f64::min));
    let with = |reduction: f64| result.runs.iter().filter(move |run| run.reduction == reduction);
    let most = scale_end(job.units, with(slowest).flat_map(|run| run.samples.iter().map(|sample| sample.feed)));
    let mut pictures = Vec::new();
    for run in with(slowest) {
        pictures.push(feed_along_path(job, &weighted(result, run.weight), &run.samples, most)?);
    }
    page.figure(
        &pictures,
        Layout::Triple,
        &format!(
            "The commanded feed of the tool's centre along the path for w = 0, 0.5 and 1 (from the left, or from the top), all with \
             f = {slowest} and on one scale. The smaller w, the faster the centre runs round the convex ends, to keep the contact point \
             at V; at w = 1 only the corners slow it."
        ),
    );
    Ok(())
}

/// The path with another weight, for its name in a picture.
fn weighted(result: &Reproduction, weight: f64) -> Path {
    let mut path = result.path.clone();
    path.weight = weight;
    path.header.order = Order::First;
    path
}

/// The paper's figures 5 to 13.
fn over_the_path(page: &mut Page, result: &Reproduction) -> Result<(), ReportError> {
    /// Of each weight: the first of its three figures in the paper.
    const FIRST: [u32; 3] = [5, 11, 8];
    let quantities = [
        (Quantity::ContourError, "Contour error", " The smaller f, the smaller the peaks about the trim points."),
        (
            Quantity::Feed,
            "Centre feed",
            " Broad the commanded feed, on it the measured one; at trim points the factor f reduces it.",
        ),
        (
            Quantity::Acceleration,
            "Acceleration magnitude",
            " Spikes stand at trim points, where the direction breaks; they grow with f.",
        ),
    ];
    for (weight, first) in WEIGHTS.into_iter().zip(FIRST) {
        page.block("<section class=\"sheet\">");
        page.heading(&format!("Over time, w = {weight}"));
        let labels: Vec<(String, &Experiment)> = result
            .runs
            .iter()
            .filter(|run| run.weight == weight)
            .map(|run| (format!("f = {}, ", number(run.reduction, 2)), run))
            .collect();
        let series: Vec<Series<'_>> = labels
            .iter()
            .map(|(label, run)| Series {
                label,
                samples: &run.samples,
                settling: run.outcome.settling_ticks,
                machine: true,
            })
            .collect();
        page.block("<div class=\"row\">");
        for ((quantity, name, more), published) in quantities.into_iter().zip(first..) {
            let title = format!("{name} over time for four reductions f, w = {weight}");
            let caption = format!(
                "{name} for w = {weight} (the paper's figure {published}), the four f on one scale, displaced for clarity.{more}"
            );
            page.figure(&[over_time(quantity, result.job.units, &series, &title)?], Layout::Single, &caption);
        }
        page.block("</div></section>");
    }
    page.paragraph(
        "A larger f saves time and costs accuracy: peaks of error stand where the path leaves a trim point. The shaded first \
         0.15 s count for no maximum.",
    );
    Ok(())
}

/// Every run in one line.
fn runs(page: &mut Page, result: &Reproduction) {
    page.heading("The twelve runs");
    let rows: String = result
        .runs
        .iter()
        .map(|run| {
            let outcome = &run.outcome;
            format!(
                "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td class=\"hash\">{}</td></tr>",
                run.weight,
                run.reduction,
                outcome.ticks,
                number(outcome.time_s, 4),
                number(outcome.rms_contour_error, 5),
                escape(&outcome.setpoint_hash)
            )
        })
        .collect();
    page.block(&format!(
        "<div class=\"scroll\"><table class=\"runs\"><caption>Ticks, time, contour error and hash of all setpoints</caption><thead><tr>\
         <th scope=\"col\">w</th><th scope=\"col\">f</th><th scope=\"col\">ticks</th><th scope=\"col\">time, s</th>\
         <th scope=\"col\">error rms, in</th><th scope=\"col\">setpoint hash</th></tr></thead><tbody>{rows}</tbody></table></div>"
    ));
}

#[cfg(test)]
mod tests {
    use super::super::page::tests::{assert_balanced, assert_self_contained};
    use super::*;
    use crate::reproduce::farouki2018::reproduce;

    /// Everything that was published and everything that came out stands in the page, which stands alone and is small.
    #[test]
    fn page_holds_every_figure() {
        let mut result = reproduce(|| ()).unwrap();
        let html = reproduction(&result).unwrap();
        assert_balanced(&html);
        assert_self_contained(&html);
        assert!(html.len() < 4_000_000, "{} bytes", html.len());
        for table in &result.tables {
            for cell in table.measured.iter().chain(table.beside.iter().flat_map(|beside| &beside.1)).flatten() {
                let text = format!("<td>{cell:.0$}</td>", table.decimals);
                assert!(html.contains(&text), "{}: {text}", table.title);
            }
            for cell in table.published.iter().flatten() {
                assert!(html.contains(&format!("<td>{cell}")), "{}: {cell}", table.title);
            }
        }
        assert!(result.runs.iter().all(|run| html.contains(&run.outcome.setpoint_hash)));
        for figure in (5..=13).chain([1, 3]) {
            assert!(html.contains(&format!("paper's figure {figure}")), "figure {figure}");
        }
        result.runs[3].samples.clear();
        assert_eq!(reproduction(&result), Err(ReportError::NoSamples));
    }
}

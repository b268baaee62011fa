//! The report of the feed correction paper: its figures from our own runs, its tables beside what was counted.

use super::ReportError;
use super::canvas::{Anchor, Mark, Picture, Stroke};
use super::chart::{COLUMNS, Strip, TimeChart, Trace};
use super::geometry::Place;
use super::page::{Layout, Page, escape, table};
use super::plane::View;
use super::series::{decimate, number, three_figures};
use super::style::{INK, MAIN, SOFT};
use crate::reproduce::feed_correction::{FEED, Reproduction, Run, TICK};
use crate::spline::Interpolant;

const CURVE: Stroke = Stroke::new(INK, 1.8);
const FLUCTUATION: Stroke = Stroke::new(MAIN, 1.0);
/// The height of a chart of one run.
const HEIGHT: f64 = 230.0;
/// Points of a segment in a picture.
const PARTS: u32 = 24;

/// The report. Errors: runs without feeds; a picture that cannot be drawn.
pub fn feed_correction(result: &Reproduction) -> Result<String, ReportError> {
    if result.runs.is_empty() || result.runs.iter().any(|run| run.feeds.is_empty()) {
        return Err(ReportError::NoSamples);
    }
    let lead = format!(
        "Polynomial splines at a constant feed of {FEED} mm/s, a tick each millisecond: the curves and the fits of the feed correction \
         paper, in f64 as there. The feed of a tick is the arc length between two setpoints over the time. Airfoil: {}.",
        escape(&result.airfoil)
    );
    let mut page = Page::new("The feed correction polynomial", &lead);
    page.facts(&facts(result));
    page.heading("What was published, and what came out here");
    page.block(&rows(result));
    page.heading("The fan");
    page.figure(
        &[path("The 88 segments of the fan", &result.fan)?],
        Layout::Single,
        "As the paper's figure 4(a): a closed C2 cubic spline through 88 points, parametrised by chord length. Dots are its nodes.",
    );
    charts(&mut page, result, "fan")?;
    page.heading("The airfoil");
    page.figure(
        &[path("The 48 segments of the airfoil", &result.section)?],
        Layout::Single,
        "As the paper's figure 7(a): a C3 quintic spline, nearly parametrised by arc length. The paper's section is not published with \
         coordinates; this one is another. It is drawn at a chord of 6 inches.",
    );
    charts(&mut page, result, "airfoil")?;
    page.heading("What the fits cost");
    page.paragraph(
        "Operations are counted by a number that counts what is done with it. A line of the paper's Table 2 is one function of the code; \
         lines in italics are done for each of M - 1 samples.",
    );
    page.block(&terms(result));
    page.block(&totals(result));
    page.heading("How few samples are enough");
    page.paragraph(
        "The seventh order has two numbers left to fit. Two samples settle them; at the nodes of the Gauss rule for the weight that \
         least squares give to them, they settle them as well as hundreds do.",
    );
    page.block(&sparse(result));
    Ok(page.finish())
}

fn facts(result: &Reproduction) -> Vec<(&'static str, String, &'static str)> {
    let of = |method: &str| {
        result.runs.iter().find(|run| run.curve == "fan" && run.method == method).map_or(f64::NAN, Run::largest)
    };
    let times = &result.times;
    vec![
        ("Fan, natural interpolation", three_figures(of("natural")), "%"),
        ("Fan, closed form of the paper", three_figures(of("seventh order, closed form")), "%"),
        ("Fan, two samples", three_figures(of("seventh order, two samples")), "%"),
        ("Time of the closed form over the 14 equations", number(times.centred / times.fourteen, 3), ""),
        ("Time of two samples over the 14 equations", number(times.two_samples / times.fourteen, 4), ""),
    ]
}

/// A chart a run on this curve; a run that departs by rounding only has nothing to show.
fn charts(page: &mut Page, result: &Reproduction, curve: &str) -> Result<(), ReportError> {
    const ROUNDING_PERCENT: f64 = 1e-6;
    for run in result.runs.iter().filter(|run| run.curve == curve) {
        if run.largest() > ROUNDING_PERCENT {
            page.figure(&[chart(run)?], Layout::Single, &caption(run));
        } else {
            page.paragraph(&format!("The feed of the method \u{201c}{}\u{201d} departs by rounding only.", run.method));
        }
    }
    Ok(())
}

fn caption(run: &Run) -> String {
    let [low, high] = run.fluctuation_percent;
    let figure = if run.figure.is_empty() { String::new() } else { format!("As the paper's figure {}. ", run.figure) };
    format!("{figure}The feed departs from {FEED} mm/s by {} to +{} %.", three_figures(low), three_figures(high))
}

fn path(title: &str, spline: &Interpolant<2>) -> Result<Picture, ReportError> {
    let place = |[x, y]: [f64; 2]| Place::new(x, y);
    let steps = (0..=PARTS).map(|k| f64::from(k) / f64::from(PARTS) - 0.5);
    let curve: Vec<Place> =
        spline.segments.iter().flat_map(|segment| steps.clone().map(|v| place(segment.point(v)))).collect();
    let view = View::around(curve.iter().copied(), 1.0);
    Picture::draw(view.size(false), title, |canvas| {
        view.axes(canvas, "mm")?;
        view.line(canvas, &curve, CURVE)?;
        for segment in &spline.segments {
            canvas.dot(view.at(place(segment.point(-0.5))), 2.2, MAIN)?;
        }
        canvas.key(view.key_place(), Anchor::Right, &[(Mark::Line(CURVE), "spline")])
    })
}

/// The departure of the feed over time; every chart has its own scale.
fn chart(run: &Run) -> Result<Picture, ReportError> {
    let duration = run.feeds.len() as f64 * TICK;
    let points =
        run.feeds.iter().zip(1_u32..).map(|(feed, tick)| (f64::from(tick) * TICK, 100.0 * (feed / FEED - 1.0)));
    let trace = Trace { points: decimate(points, (0.0, duration), COLUMNS), stroke: FLUCTUATION };
    let title = format!("{}, {}: the feed's departure", run.curve, run.method);
    TimeChart {
        title,
        quantity: "departure of the feed, %".to_string(),
        strips: vec![Strip { label: run.method.to_string(), traces: vec![trace] }],
        key: vec![(Mark::Line(Stroke::new(SOFT, 1.0)), run.curve)],
        duration,
        settling: 0.0,
        height: HEIGHT,
    }
    .draw()
}

fn rows(result: &Reproduction) -> String {
    let row = |row: &crate::reproduce::Row| {
        ("", vec![row.name.clone(), three_figures(row.published), three_figures(row.measured)])
    };
    table(&["", "published", "here"], 1, false, result.rows.iter().map(row))
}

fn terms(result: &Reproduction) -> String {
    table(
        &["equation", "term", "published * / + -", "here * / + -", "why they differ"],
        2,
        true,
        result.terms.iter().map(|term| {
            let [m, d, a, s] = term.published;
            let here = &term.counted;
            let style = if term.each_sample { "font-style: italic" } else { "" };
            let row = vec![
                term.equation.to_string(),
                term.term.to_string(),
                format!("{m} {d} {a} {s}"),
                format!("{} {} {} {}", here.multiplications, here.divisions, here.additions, here.subtractions),
                term.why.to_string(),
            ];
            (style, row)
        }),
    )
}

fn totals(result: &Reproduction) -> String {
    table(
        &["operations a segment", "M", "published", "here", "why they differ"],
        1,
        true,
        result.totals.iter().map(|total| {
            let published = total.published.map_or("-".to_string(), |published| published.to_string());
            let (divisions, here) = (total.divisions.to_string(), total.counted.sum().to_string());
            ("", vec![total.name.clone(), divisions, published, here, total.why.to_string()])
        }),
    )
}

fn sparse(result: &Reproduction) -> String {
    table(
        &["samples", "at", "Gauss nodes between two", "fluctuation on the fan, %", "operations"],
        0,
        false,
        result.sparse.iter().map(|row| {
            let fluctuation = number(row.fluctuation_percent, 5);
            let cells = [
                row.samples.to_string(),
                row.at.to_string(),
                row.nodes.to_string(),
                fluctuation,
                row.operations.to_string(),
            ];
            ("", cells.to_vec())
        }),
    )
}

//! The report of the paper on toolpath spline approximation: its figures 12 to 17 from our own runs.

use plotters::style::RGBColor;

use super::ReportError;
use super::canvas::{Anchor, Mark, Picture, Stroke};
use super::chart::{COLUMNS, Strip, TimeChart, Trace};
use super::geometry::Place;
use super::page::{Layout, Page, table};
use super::plane::View;
use super::series::{Point, decimate, number, three_figures};
use super::style::{FRAME, GRID, MAIN, OTHER, SOFT, WIDTH};
use crate::reproduce::spline_fit::{Continuity, Moment, Reproduction, Run, Way, in_fillet};

/// A break of the direction, a jump of the curvature, and neither: red, orange and green, as the paper has its markers.
const CORNER: RGBColor = RGBColor(0xb4, 0x1f, 0x24);
const JUMP: RGBColor = OTHER;
const SMOOTH: RGBColor = RGBColor(0x2d, 0x8a, 0x57);

const THIN: Stroke = Stroke::new(FRAME, 1.4);
const FEED: Stroke = Stroke::new(MAIN, 1.3);
const CURVATURE: Stroke = Stroke::new(OTHER, 1.3);

/// The ways whose feed and curvature are shown over time.
const SHOWN: [Way; 4] = [Way::LookAhead, Way::Cubics, Way::Bsplines, Way::Ph];

/// The level that is drawn, in mm.
const LEVEL: f64 = -2.0;

/// The report. Errors: a picture that cannot be drawn.
pub fn spline_fit(result: &Reproduction) -> Result<String, ReportError> {
    let lead = format!(
        "One program of {} lines, a plate milled around at four levels at {} mm/s, run in {} ways within {} mm and the same limits of the \
         machine. The paper's own part and numbers are not in its text, so what is checked is what it found.",
        result.lines,
        number(result.feed, 0),
        result.runs.len(),
        result.tolerance
    );
    let of = |way: Way| result.runs.iter().find(|run| run.way == way).ok_or(ReportError::NoSamples);
    let mut page = Page::new("Lines to curves: what it is worth", &lead);
    page.facts(&facts(of(Way::LookAhead)?, of(Way::Cubics)?, of(Way::Ph)?));
    page.heading("How long each way takes");
    page.figure(
        &[times(result)?],
        Layout::Single,
        "As the paper\u{2019}s figure 17: the time of the whole program, of that with exact stops. The four levels are reached and left at \
         rest or nearly so in every way, as there.",
    );
    page.block(&runs(result));
    page.heading("What the paper found, and what came out here");
    page.block(&claims(result));
    page.heading("How smoothly the curves go on");
    page.figure(
        &[markers(of(Way::Cubics)?)?, markers(of(Way::Ph)?)?],
        Layout::Pair,
        "As the paper\u{2019}s figure 12, for one level: where curves meet, and whether the direction breaks, the curvature jumps, or neither. \
         Where the tool goes down the direction always breaks.",
    );
    page.heading("Where the feed falls");
    page.figure(
        &[coloured(of(Way::Cubics)?, result.feed)?, coloured(of(Way::Ph)?, result.feed)?],
        Layout::Pair,
        "As the paper\u{2019}s figure 13: the feed along the same level.",
    );
    page.heading("Straight, a fillet, straight");
    page.paragraph(
        "The curvature of the published cubics jumps where they leave a straight side. A machine with a limit of jerk has to be slow \
         there, whatever the fillet itself would bear; where the curvature goes on, only the fillet counts.",
    );
    for (quantity, stroke, value, caption) in [
        ("feed, mm/s", FEED, (|moment| moment.feed) as fn(&Moment) -> f64, FEED_CAPTION),
        ("curvature, 1/mm", CURVATURE, |moment| moment.curvature, CURVATURE_CAPTION),
    ] {
        let strips = SHOWN.map(of).into_iter().collect::<Result<Vec<&Run>, _>>()?;
        page.figure(&[over_time(&strips, quantity, stroke, value)?], Layout::Single, caption);
    }
    page.heading("The whole program");
    let strips = [of(Way::Cubics)?, of(Way::Ph)?];
    page.figure(
        &[whole(&strips)?],
        Layout::Single,
        "As the paper\u{2019}s figure 15: the feed over the time of the whole program.",
    );
    Ok(page.finish())
}

const FEED_CAPTION: &str = "As the paper\u{2019}s figures 14 and 15: the feed on the second level, round the fillet of 8 mm. Time counts from \
                            where the tool comes near to it.";
const CURVATURE_CAPTION: &str = "As the paper\u{2019}s figure 16: the curvature of the way over the same time.";

fn facts(lines: &Run, cubics: &Run, ph: &Run) -> Vec<(&'static str, String, &'static str)> {
    vec![
        ("PH of the lines with look-ahead", number(100.0 * ph.time_s / lines.time_s, 1), "% of the time"),
        ("PH of the published cubics", number(100.0 * ph.time_s / cubics.time_s, 1), "% of the time"),
        ("Published cubics at the fillet", three_figures(cubics.fillet_least_feed), "mm/s at least"),
        ("PH at the fillet", three_figures(ph.fillet_least_feed), "mm/s at least"),
    ]
}

/// Bars of the relative times.
fn times(result: &Reproduction) -> Result<Picture, ReportError> {
    const NAMES: f64 = 270.0;
    const ROW: f64 = 34.0;
    const TOP: f64 = 14.0;
    const BAR: f64 = 20.0;
    const NUMBERS: f64 = 140.0;
    let height = TOP + ROW * result.runs.len() as f64 + 10.0;
    let across = (WIDTH - NAMES - NUMBERS) / 100.0;
    Picture::draw((WIDTH, height), "Relative machining time", |canvas| {
        for percent in [0.0, 25.0, 50.0, 75.0, 100.0_f64] {
            let x = NAMES + percent * across;
            canvas.line([(x, TOP), (x, height - 10.0)], Stroke::new(GRID, 1.0))?;
        }
        for (number_of, run) in result.runs.iter().enumerate() {
            let y = TOP + ROW * (number_of as f64 + 0.5);
            let colour = match run.way {
                Way::Bsplines | Way::Ph => MAIN,
                Way::Cubics => OTHER,
                _ => FRAME,
            };
            canvas.text((NAMES - 10.0, y), run.name, Anchor::Right)?;
            let end = NAMES + run.relative_percent * across;
            canvas.rectangle((NAMES, y - 0.5 * BAR), (end, y + 0.5 * BAR), colour)?;
            let text = format!("{} %, {} s", number(run.relative_percent, 1), number(run.time_s, 1));
            canvas.text((end + 8.0, y), &text, Anchor::Left)?;
        }
        Ok(())
    })
}

/// The moments of the level that is drawn.
fn level(run: &Run) -> impl Iterator<Item = &Moment> {
    run.moments.iter().filter(|moment| (moment.at.0[2] - LEVEL).abs() < 1e-6)
}

fn plane(moment: &Moment) -> Place {
    Place::new(moment.at.0[0], moment.at.0[1])
}

fn markers(run: &Run) -> Result<Picture, ReportError> {
    let way: Vec<Place> = level(run).map(plane).collect();
    let view = View::around(way.iter().copied(), 1.0);
    Picture::draw(view.size(false), format!("{}: nodes", run.name), |canvas| {
        view.axes(canvas, "mm")?;
        view.line(canvas, &way, THIN)?;
        // The worst on top.
        for (continuity, colour) in
            [(Continuity::Curvature, SMOOTH), (Continuity::Tangent, JUMP), (Continuity::Corner, CORNER)]
        {
            let nodes = run.nodes.iter().filter(|node| node.continuity == continuity);
            for node in nodes.filter(|node| (node.at.0[2] - LEVEL).abs() < 1e-6) {
                canvas.dot(view.at(Place::new(node.at.0[0], node.at.0[1])), 3.4, colour)?;
            }
        }
        view.name(canvas, run.name)?;
        let key = [(Mark::Dot(CORNER), "corner"), (Mark::Dot(JUMP), "jump"), (Mark::Dot(SMOOTH), "smooth")];
        canvas.key(view.key_place(), Anchor::Right, &key)
    })
}

fn coloured(run: &Run, most: f64) -> Result<Picture, ReportError> {
    let way: Vec<(Place, f64)> = level(run).map(|moment| (plane(moment), moment.feed)).collect();
    let view = View::around(way.iter().map(|step| step.0), 1.0);
    Picture::draw(view.size(true), format!("{}: feed", run.name), |canvas| {
        view.axes(canvas, "mm")?;
        view.coloured_line(canvas, &way, most)?;
        view.name(canvas, run.name)?;
        view.colours(canvas, most, "feed, mm/s")
    })
}

/// A value over the time of the fillet, way by way.
fn over_time(runs: &[&Run], quantity: &str, stroke: Stroke, value: fn(&Moment) -> f64) -> Result<Picture, ReportError> {
    let longest = runs.iter().map(|run| run.fillet_time_s).fold(0.0, f64::max);
    let strips = runs.iter().map(|run| {
        let moments: Vec<&Moment> = run.moments.iter().filter(|moment| in_fillet(moment.at)).collect();
        let start = moments.first().map_or(0.0, |moment| moment.time);
        let points = moments.iter().map(|moment| (moment.time - start, value(moment)));
        let trace = Trace { points: decimate(points, (0.0, longest), COLUMNS), stroke };
        Strip { label: run.name.to_string(), traces: vec![trace] }
    });
    TimeChart {
        title: format!("{quantity} round the fillet"),
        quantity: quantity.to_string(),
        strips: strips.collect(),
        key: Vec::new(),
        duration: longest,
        settling: 0.0,
        height: 560.0,
    }
    .draw()
}

fn whole(runs: &[&Run]) -> Result<Picture, ReportError> {
    let longest = runs.iter().map(|run| run.time_s).fold(0.0, f64::max);
    let strips = runs.iter().map(|run| {
        let points: Vec<Point> = run.moments.iter().map(|moment| (moment.time, moment.feed)).collect();
        let trace = Trace { points: decimate(points, (0.0, longest), COLUMNS), stroke: FEED };
        Strip { label: run.name.to_string(), traces: vec![trace] }
    });
    TimeChart {
        title: "Feed over the whole program".to_string(),
        quantity: "feed, mm/s".to_string(),
        strips: strips.collect(),
        key: vec![(Mark::Line(Stroke::new(SOFT, 1.0)), "rapids too")],
        duration: longest,
        settling: 0.0,
        height: 420.0,
    }
    .draw()
}

fn runs(result: &Reproduction) -> String {
    let head = [
        "",
        "curves",
        "time, s",
        "% of exact stop",
        "corners",
        "curvature jumps",
        "smooth nodes",
        "least feed at the fillet, mm/s",
    ];
    let row = |run: &Run| {
        let cells = vec![
            run.name.to_string(),
            run.strokes.to_string(),
            number(run.time_s, 3),
            number(run.relative_percent, 1),
            run.corners.to_string(),
            run.curvature_jumps.to_string(),
            run.smooth.to_string(),
            number(run.fillet_least_feed, 1),
        ];
        ("", cells)
    };
    table(&head, 1, false, result.runs.iter().map(row))
}

fn claims(result: &Reproduction) -> String {
    let row = |claim: &crate::reproduce::spline_fit::Claim| {
        let verdict = if claim.holds { "" } else { ", not so" };
        let measured = format!("{}{verdict}", number(claim.measured, 3));
        ("", vec![claim.name.to_string(), number(claim.published, 0), measured])
    };
    table(&["ratio of", "published: below", "here"], 1, false, result.rows.iter().map(row))
}

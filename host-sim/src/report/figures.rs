//! The pictures that reports are made of, each from a job, its path and its samples.

use shared::curve::Curve as _;

use super::ReportError;
use super::canvas::{Anchor, Canvas, Mark, Picture, Stroke};
use super::chart::{COLUMNS, Strip, TimeChart, Trace};
use super::geometry::{Detail, Material, Outlines, Place};
use super::plane::View;
use super::series::{Point, decimate, number, round_step, three_figures};
use super::style::{FRAME, GROUND, INK, LEFT, MAIN, OTHER, PAPER, SOFT};
use crate::job::{Job, Part, Units};
use crate::offset::{Offset, Undercut};
use crate::path::Path;
use crate::simulate::Sample;

/// The height of a chart of one strip.
const SINGLE: f64 = 300.0;
/// The height of a chart of several strips.
const STACKED: f64 = 560.0;
/// More rings than this would hide the path.
const MOST_RINGS: usize = 300;
const CONTOUR: Stroke = Stroke::new(INK, 2.0);
const UNTRIMMED: Stroke = Stroke::new(OTHER, 1.7);
const TRIMMED: Stroke = Stroke::new(MAIN, 2.4);
/// Loops of the trimmed offset that are not run.
const OTHERS: Stroke = Stroke::new(MAIN, 0.9);
/// The tool where it comes nearest to what it leaves.
const TOOL: Stroke = Stroke::new(SOFT, 1.0);
const COMMANDED: Stroke = Stroke::new(OTHER, 2.8);
const MEASURED: Stroke = Stroke::new(MAIN, 1.2);

/// A feed in mm/s in the job's units a minute.
pub fn per_minute(units: Units, feed: f64) -> f64 {
    feed / units.mm() * 60.0
}

/// Contour and untrimmed offset, and contour and trimmed offset with its trim points, in the same frame.
pub fn offsets(job: &Job, path: &Path, undercuts: &[Undercut]) -> Result<[Picture; 2], ReportError> {
    let mut outlines = Outlines::new(job, path);
    if let Some(trimmed) = &path.trimmed {
        outlines = outlines.leaving(&job.contour, &trimmed.offset, undercuts);
    }
    let view = View::around(outlines.all(), job.units.mm());
    let untrimmed = Picture::draw(view.size(false), "The contour and its untrimmed offset", |canvas| {
        view.axes_over(canvas, job.units, &outlines)?;
        view.line(canvas, &outlines.untrimmed, UNTRIMMED)?;
        view.line(canvas, &outlines.contour, CONTOUR)?;
        let entries = [(Mark::Line(CONTOUR), "contour C"), (Mark::Line(UNTRIMMED), "untrimmed offset")];
        canvas.key(view.key_place(), Anchor::Right, &entries)
    })?;
    let trimmed = Picture::draw(view.size(false), "The contour and its trimmed offset", |canvas| {
        view.axes_over(canvas, job.units, &outlines)?;
        view.left(canvas, &outlines)?;
        view.trimmed(canvas, &outlines)?;
        let lines = vec![(Mark::Line(CONTOUR), "contour C"), (Mark::Line(TRIMMED), "trimmed offset")];
        canvas.key(view.key_place(), Anchor::Right, &[lines, marks(&outlines, "left")].concat())
    })?;
    Ok([untrimmed, trimmed])
}

/// Contour, untrimmed and trimmed offset, trim points and what the tool leaves, in one picture.
pub fn trimming(part: &Part, offset: &Offset, undercuts: &[Undercut]) -> Result<Picture, ReportError> {
    let outlines = Outlines::of_offset(&part.contour, offset).leaving(&part.contour, offset, undercuts);
    let radius = offset.distance.abs();
    // A tool larger than the contour would leave no room for it in the picture.
    let [low, high] = part.contour.extent();
    let tool = outlines.tool(undercuts).filter(|_| 2.0 * radius < (high - low).norm());
    let box_of = |place: Place| [place - Place::new(radius, radius), place + Place::new(radius, radius)];
    let view = View::around(outlines.all().chain(tool.into_iter().flat_map(box_of)), part.units.mm());
    let title = format!("The trimmed offset of {} at distance {}", part.name(), part.units.length(offset.distance));
    let lines = [(CONTOUR, "contour C"), (UNTRIMMED, "untrimmed offset"), (TRIMMED, "trimmed offset")];
    let mut below = marks(&outlines, "material left");
    below.extend(tool.map(|_| (Mark::Circle(TOOL), "tool")));
    let rows = [lines.map(|(stroke, text)| (Mark::Line(stroke), text)).to_vec(), below];
    Picture::draw(view.size_over_key(rows.len()), title, |canvas| {
        view.axes_over(canvas, part.units, &outlines)?;
        view.left(canvas, &outlines)?;
        view.line(canvas, &outlines.untrimmed, UNTRIMMED)?;
        if let Some(place) = tool {
            canvas.circle(view.at(place), view.length(radius), TOOL)?;
        }
        view.trimmed(canvas, &outlines)?;
        view.key_below(canvas, &rows)
    })
}

/// What there is to be seen beside lines.
fn marks(outlines: &Outlines, left: &'static str) -> Vec<(Mark, &'static str)> {
    let entries = [
        ((1..=MOST_RINGS).contains(&outlines.corners.len()), Mark::Ring(INK, PAPER), "trim point"),
        (!outlines.left.is_empty(), Mark::Area(LEFT), left),
    ];
    entries.into_iter().filter(|entry| entry.0).map(|(_, mark, text)| (mark, text)).collect()
}

/// The path in the colours of the commanded centre feed, from zero to `most` in mm/s.
pub fn feed_along_path(job: &Job, path: &Path, samples: &[Sample], most: f64) -> Result<Picture, ReportError> {
    let outlines = Outlines::new(job, path);
    let view = View::around(outlines.contour.iter().chain(outlines.trimmed.iter().flatten()).copied(), job.units.mm());
    let title = format!("The path coloured by the centre feed, w = {}", path.weight);
    let offset = job.offset != 0.0;
    Picture::draw(view.size(true), title, |canvas| {
        view.axes_over(canvas, job.units, &outlines)?;
        if offset {
            view.line(canvas, &outlines.contour, CONTOUR)?;
        }
        let way: Vec<(Place, f64)> = moving(samples).iter().map(|sample| (sample.setpoint, sample.feed)).collect();
        view.coloured_line(canvas, &way, most)?;
        view.rings(canvas, &outlines)?;
        let unit = job.units.short();
        let largest = number(per_minute(job.units, samples.iter().map(|s| s.feed).fold(0.0, f64::max)), 0);
        let name = format!("centre feed, {unit}/min (largest here {largest})");
        view.name(canvas, &format!("w = {}", path.weight))?;
        view.colours(canvas, per_minute(job.units, most), &name)?;
        let corner = (Mark::Ring(INK, PAPER), if offset { "trim point" } else { "corner" });
        let entries = [(Mark::Line(CONTOUR), "contour C"), corner];
        let shown = match (offset, outlines.corners.is_empty()) {
            (true, false) => &entries[..],
            (true, true) => &entries[..1],
            (false, false) => &entries[1..],
            (false, true) => &[],
        };
        canvas.key(view.key_place(), Anchor::Right, shown)
    })
}

/// Whether a sample is on a detail of the path.
fn within(detail: &Detail, sample: &Sample) -> bool {
    let [from, to] = detail.interval;
    sample.piece == detail.piece && sample.xi >= from && sample.xi <= to
}

/// How many ticks apart the dots of [`spacing`] are: about three dozen over the detail.
pub fn spacing_ticks(detail: &Detail, samples: &[Sample]) -> u64 {
    /// Dots on the detail.
    const DOTS: usize = 36;
    let ticks = samples.iter().filter(|sample| within(detail, sample)).count();
    (ticks.div_ceil(DOTS) as u64).max(1)
}

/// Contact points and centres at equal time steps, every `step` ticks, over a detail of the path.
pub fn spacing(job: &Job, path: &Path, samples: &[Sample], detail: &Detail, step: u64) -> Result<Picture, ReportError> {
    let [contact, centre] = detail.curves(path);
    let view = View::around(contact.iter().chain(&centre).copied(), job.units.mm());
    let weight = format!("w = {}", path.weight);
    let title = format!("Contact points and tool centres at equal time steps, {weight}");
    let piece = path.pieces.get(detail.piece);
    let pairs: Vec<[Point; 2]> = samples
        .iter()
        .filter(|sample| within(detail, sample) && sample.tick % step == 0)
        .filter_map(|s| piece.map(|piece| [piece.segment.point(s.xi), piece.point(s.xi)].map(|place| view.at(place))))
        .collect();
    Picture::draw(view.size(false), title, |canvas| {
        view.axes(canvas, job.units.short())?;
        for pair in &pairs {
            canvas.line(*pair, Stroke::new(FRAME, 0.8))?;
        }
        view.line(canvas, &contact, Stroke::new(INK, 1.4))?;
        view.line(canvas, &centre, Stroke::new(MAIN, 1.4))?;
        for [contact, centre] in &pairs {
            canvas.dot(*contact, 3.0, INK)?;
            canvas.dot(*centre, 3.6, MAIN)?;
        }
        view.name(canvas, &weight)?;
        let entries = [(Mark::Dot(INK), "contact point on C"), (Mark::Dot(MAIN), "tool centre")];
        canvas.key(view.key_place(), Anchor::Right, &entries)
    })
}

/// What a chart over time shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// The centre feed, commanded and measured.
    Feed,
    /// The magnitude of the acceleration.
    Acceleration,
    /// The normal distance from the path.
    ContourError,
    /// The distance of x and y from their setpoints.
    FollowingError,
}

/// One run in a chart.
#[derive(Clone, Copy, Debug)]
pub struct Series<'a> {
    /// Stands before the largest value.
    pub label: &'a str,
    /// All ticks.
    pub samples: &'a [Sample],
    /// Ticks that the largest value leaves out.
    pub settling: u64,
    /// Whether a machine was simulated, so that what is measured differs from what is commanded.
    pub machine: bool,
}

/// A line of a chart: the axis it is about, if it is about one, its stroke, and what it takes from a sample.
type Line = (&'static str, Stroke, Box<dyn Fn(&Sample) -> f64>);

/// A chart of one quantity over time, one strip for each run (two, x and y, of the following error).
pub fn over_time(quantity: Quantity, units: Units, runs: &[Series<'_>], title: &str) -> Result<Picture, ReportError> {
    let duration = runs.iter().filter_map(|run| run.samples.last()).map(seconds).fold(0.0, f64::max);
    let fine = quantity == Quantity::ContourError
        && runs.iter().flat_map(|run| counted(run)).all(|s| s.contour_error < 1e-3 * units.mm());
    let (unit, unit_mm) = match (fine, units) {
        (false, _) => (units.short(), units.mm()),
        (true, Units::Mm) => ("\u{b5}m", 1e-3),
        (true, Units::Inch) => ("\u{b5}in", 25.4e-6),
    };
    let name = match quantity {
        Quantity::Feed => format!("centre feed, {unit}/min"),
        Quantity::Acceleration => format!("acceleration, {unit}/s\u{b2}"),
        Quantity::ContourError => format!("contour error, {unit}"),
        Quantity::FollowingError => format!("setpoint \u{2212} actual, {unit}"),
    };
    let mut strips = Vec::new();
    for run in runs {
        let lines: Vec<Line> = match quantity {
            Quantity::Feed if run.machine => vec![
                ("", COMMANDED, Box::new(move |s| per_minute(units, s.feed))),
                ("", MEASURED, Box::new(move |s| per_minute(units, s.speed))),
            ],
            Quantity::Feed => vec![("", MEASURED, Box::new(move |s| per_minute(units, s.feed)))],
            Quantity::Acceleration => vec![("", MEASURED, Box::new(move |s| s.acceleration / unit_mm))],
            Quantity::ContourError => vec![("", MEASURED, Box::new(move |s| s.contour_error / unit_mm))],
            Quantity::FollowingError => vec![
                ("x", MEASURED, Box::new(move |s| (s.setpoint - s.actual).re / unit_mm)),
                ("y", MEASURED, Box::new(move |s| (s.setpoint - s.actual).im / unit_mm)),
            ],
        };
        let traces = lines.iter().map(|(axis, stroke, value)| {
            let points = moving(run.samples).iter().map(|sample| (seconds(sample), value(sample)));
            let most = counted(run).map(|sample| value(sample).abs()).fold(0.0, f64::max);
            (*axis, most, Trace { points: decimate(points, (0.0, duration), COLUMNS), stroke: *stroke })
        });
        if quantity == Quantity::FollowingError {
            strips.extend(traces.map(|(axis, most, trace)| Strip {
                label: format!("{axis}: largest {} {unit}", three_figures(most)),
                traces: vec![trace],
            }));
        } else {
            let traces: Vec<_> = traces.collect();
            let most = traces.last().map_or(0.0, |trace| trace.1);
            let label = format!("{}largest {}", run.label, three_figures(most));
            strips.push(Strip { label, traces: traces.into_iter().map(|trace| trace.2).collect() });
        }
    }
    let settling = runs.iter().map(|run| run.settling as f64 * f64::from(shared::TICK)).fold(0.0, f64::max);
    let both = quantity == Quantity::Feed && runs.iter().any(|run| run.machine);
    let key = [(Mark::Line(COMMANDED), "commanded"), (Mark::Line(MEASURED), "measured")];
    let height = if strips.len() == 1 { SINGLE } else { STACKED };
    let key = if both { key.to_vec() } else { Vec::new() };
    TimeChart { title: title.to_string(), quantity: name, strips, key, duration, settling, height }.draw()
}

/// The samples of which the largest value is taken.
fn counted<'a>(run: &Series<'a>) -> impl Iterator<Item = &'a Sample> {
    let settling = run.settling;
    run.samples.iter().filter(move |sample| sample.tick > settling)
}

fn seconds(sample: &Sample) -> f64 {
    sample.tick as f64 * f64::from(shared::TICK)
}

/// The samples without the last one, after which nothing is commanded any more.
fn moving(samples: &[Sample]) -> &[Sample] {
    match samples.split_last() {
        Some((last, before)) if last.feed == 0.0 && !before.is_empty() => before,
        _ => samples,
    }
}

/// The largest commanded feed, rounded up so that a scale ends at a round number, in mm/s.
pub fn scale_end(units: Units, samples: impl IntoIterator<Item = f64>) -> f64 {
    let most = samples.into_iter().fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    let step = round_step(per_minute(units, most) / 20.0);
    (per_minute(units, most) / step).ceil() * step * units.mm() / 60.0
}

/// `ticks` in milliseconds, as it stands in captions.
pub fn milliseconds(ticks: u64) -> String {
    number(1e3 * ticks as f64 * f64::from(shared::TICK), 1)
}

impl View {
    /// Axes over the part.
    pub(super) fn axes_over(
        &self,
        canvas: &mut Canvas<'_>,
        units: Units,
        outlines: &Outlines,
    ) -> Result<(), ReportError> {
        match outlines.material {
            Material::Inside => self.area(canvas, &outlines.contour, GROUND)?,
            Material::Outside => {
                self.all(canvas, GROUND)?;
                self.area(canvas, &outlines.contour, PAPER)?;
            }
            Material::Unbounded => (),
        }
        self.axes(canvas, units.short())
    }

    /// What the tool leaves.
    fn left(&self, canvas: &mut Canvas<'_>, outlines: &Outlines) -> Result<(), ReportError> {
        outlines.left.iter().try_for_each(|area| self.area(canvas, area, LEFT))
    }

    /// The trimmed offset with its trim points, the loops that are not run thinner, and the contour.
    fn trimmed(&self, canvas: &mut Canvas<'_>, outlines: &Outlines) -> Result<(), ReportError> {
        for other in &outlines.others {
            self.line(canvas, other, OTHERS)?;
        }
        for piece in &outlines.trimmed {
            self.line(canvas, piece, TRIMMED)?;
        }
        self.line(canvas, &outlines.contour, CONTOUR)?;
        self.rings(canvas, outlines)
    }

    /// A ring at every corner; where there are so many that they would hide the path, none.
    fn rings(&self, canvas: &mut Canvas<'_>, outlines: &Outlines) -> Result<(), ReportError> {
        for &corner in outlines.corners.iter().filter(|_| outlines.corners.len() <= MOST_RINGS) {
            canvas.ring(self.at(corner), 5.5, INK, PAPER)?;
        }
        Ok(())
    }
}

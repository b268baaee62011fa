//! The pictures of a plan: the feed over time, and the path in the plane, both in the colours of what limits them.

use plotters::style::RGBColor;
use shared::complex::Complex;

use super::ReportError;
use super::canvas::{Anchor, Canvas, Mark, Picture, Stroke, key_rows};
use super::chart::COLUMNS;
use super::figures::per_minute;
use super::geometry::{Outlines, Place};
use super::limited::{Cause, Limited, NUMBERED, Slow};
use super::plane::View;
use super::series::{Point, decimate, round_step, ticks};
use super::style::{FRAME, GRID, INK, PAPER, SOFT, WIDTH};
use crate::job::{Job, Units};
use crate::path::Path;
use crate::plan::Plan;
use crate::vector::Vector;

const LEFT: f64 = 66.0;
const RIGHT: f64 = 16.0;
const TOP: f64 = 40.0;
/// Under each row of the chart, for its tick labels.
const FOOT: f64 = 40.0;
/// Under the last row: the name of the time axis.
const NAME: f64 = 24.0;
/// The height of the only row, and that of each of several.
const SINGLE: f64 = 230.0;
const SEVERAL: f64 = 150.0;
/// Slow places in a row of the chart, and rows.
const PLACES: usize = 9;
const MOST_ROWS: usize = 4;
/// The top of the chart over the largest planned feed, where the job asks for so much more.
const HIGHEST: f64 = 1.6;
/// More dots than this would hide the path.
const MOST_DOTS: usize = 300;
const ROW: f64 = 26.0;
/// The job's feed, and the planned one.
const OWN: Stroke = Stroke::new(SOFT, 1.0);
const PLANNED: Stroke = Stroke::new(INK, 1.6);
/// From a slow place to its number.
const LEADER: Stroke = Stroke::new(INK, 0.9);
/// The radius of a number's disc, and of a slow place's dot.
const DISC: f64 = 10.5;
const DOT: f64 = 4.2;

/// The entries of the key: what occurs.
fn key(limited: &Limited, lines: bool) -> Vec<Vec<(Mark, &'static str)>> {
    let mut entries: Vec<(Mark, &str)> =
        limited.occurring().into_iter().map(|cause| (cause.mark(), cause.name())).collect();
    if lines {
        entries.extend([(Mark::Line(OWN), "what the job asks for"), (Mark::Line(PLANNED), "planned")]);
    }
    if !limited.slow.is_empty() {
        entries.push((Mark::Ring(INK, PAPER), "slow place"));
    }
    key_rows(&entries, WIDTH - 30.0)
}

/// The slow places that have a dot.
fn shown(limited: &Limited) -> impl Iterator<Item = &Slow> {
    let are_few = limited.slow.len() <= MOST_DOTS;
    limited.slow.iter().filter(move |slow| are_few || slow.number.is_some())
}

/// A span of time in which one cause limits the speed.
type Span = (f64, f64, Cause);

fn spans(limited: &Limited) -> Vec<Span> {
    let times = &limited.times;
    let mut spans: Vec<Span> = Vec::new();
    for (k, &cause) in limited.causes.iter().enumerate() {
        let to = times.get(k + 1).map_or(times[k], |next| 0.5 * (times[k] + next));
        match spans.last_mut() {
            Some(last) if last.2 == cause => last.1 = to,
            last => {
                let from = last.map_or(0.0, |last| last.1);
                spans.push((from, to, cause));
            }
        }
    }
    spans
}

/// What limits the most of the time between two times. `spans` begin with one that ends behind `from`.
fn foremost(spans: &[Span], from: f64, to: f64) -> Option<Cause> {
    let mut parts: Vec<(Cause, f64)> = Vec::new();
    for &(start, end, cause) in spans.iter().take_while(|span| span.0 < to) {
        let part = end.min(to) - start.max(from);
        match parts.iter_mut().find(|known| known.0 == cause) {
            Some(known) => known.1 += part,
            None => parts.push((cause, part)),
        }
    }
    parts.into_iter().max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))).map(|part| part.0)
}

/// One row of the chart.
struct Row {
    /// From where to where, in s.
    from: f64,
    to: f64,
    top: f64,
    bottom: f64,
    /// Picture units for a second and for a mm/s.
    across: f64,
    up: f64,
}

impl Row {
    fn x(&self, time: f64) -> f64 {
        LEFT + (time - self.from) * self.across
    }

    fn y(&self, speed: f64) -> f64 {
        self.bottom - speed * self.up
    }

    fn points(&self, limited: &Limited, speeds: &[f64]) -> Vec<Point> {
        let first = limited.times.partition_point(|&time| time < self.from).saturating_sub(1);
        let last = (limited.times.partition_point(|&time| time <= self.to) + 1).min(limited.times.len());
        let inner = (first..last).map(|k| (limited.times[k], speeds[k]));
        let inner = inner.filter(|&(time, _)| time > self.from && time < self.to);
        let ends = [self.from, self.to].map(|time| (time, value_at(limited, speeds, time)));
        let all = [ends[0]].into_iter().chain(inner).chain([ends[1]]);
        decimate(all, (self.from, self.to), COLUMNS)
            .into_iter()
            .map(|(time, speed)| (self.x(time), self.y(speed)))
            .collect()
    }

    /// The area under the speeds in the colours of the causes, column by column.
    fn areas(
        &self,
        canvas: &mut Canvas<'_>,
        limited: &Limited,
        speeds: &[f64],
        spans: &[Span],
    ) -> Result<(), ReportError> {
        let columns = (WIDTH - LEFT - RIGHT) as u32;
        let edge = |k: u32| self.from + (self.to - self.from) * f64::from(k) / f64::from(columns);
        let causes: Vec<(u32, Option<Cause>)> = (0..columns)
            .map(|k| {
                let first = spans.partition_point(|span| span.1 <= edge(k));
                (k, foremost(&spans[first..], edge(k), edge(k + 1)))
            })
            .collect();
        let top = |x: f64| self.y(value_at(limited, speeds, self.from + (x - LEFT) / self.across));
        for run in causes.chunk_by(|a, b| a.1 == b.1) {
            let ([(first, Some(cause)), ..], Some((last, _))) = (run, run.last()) else { continue };
            let (left, right) = (self.x(edge(*first)), self.x(edge(last + 1)));
            let steps = 2 * (last + 1 - first);
            let line = (0..=steps).map(|k| left + (right - left) * f64::from(k) / f64::from(steps));
            let around = line.map(|x| (x, top(x))).chain([(right, self.bottom), (left, self.bottom)]);
            let look = cause.look();
            canvas.area(around, look.colour)?;
            if let Some(stroke) = look.hatch {
                canvas.hatch(left, right, self.bottom, top, stroke)?;
            }
        }
        Ok(())
    }
}

/// The parts of a line that are not above `top`.
fn below(line: &[Point], top: f64) -> Vec<Vec<Point>> {
    let mut runs: Vec<Vec<Point>> = Vec::new();
    let mut last: Option<Point> = None;
    for &point in line {
        let is_in = |p: Point| p.1 >= top;
        let crossing = |a: Point, b: Point| (a.0 + (b.0 - a.0) * (top - a.1) / (b.1 - a.1), top);
        match last {
            Some(before) if is_in(before) != is_in(point) => {
                let at = crossing(before, point);
                if is_in(point) {
                    runs.push(vec![at, point]);
                } else if let Some(run) = runs.last_mut() {
                    run.push(at);
                }
            }
            Some(_) if is_in(point) => {
                if let Some(run) = runs.last_mut() {
                    run.push(point);
                }
            }
            None if is_in(point) => runs.push(vec![point]),
            _ => (),
        }
        last = Some(point);
    }
    runs
}

/// The value at a time, between those of the places.
fn value_at(limited: &Limited, values: &[f64], time: f64) -> f64 {
    let after = limited.times.partition_point(|&t| t < time).clamp(1, limited.times.len() - 1);
    let (from, to) = (limited.times[after - 1], limited.times[after]);
    let part = if to > from { ((time - from) / (to - from)).clamp(0.0, 1.0) } else { 1.0 };
    values[after - 1] + (values[after] - values[after - 1]) * part
}

/// The centre's feed over time, over the colours of what limits it.
pub fn feed_over_time(units: Units, plan: &Plan, limited: &Limited) -> Result<Picture, ReportError> {
    let rows = limited.slow.len().div_ceil(PLACES).clamp(1, MOST_ROWS);
    let tall = if rows == 1 { SINGLE } else { SEVERAL };
    let own: Vec<f64> = plan.course.places.iter().map(|place| place.feed).collect();
    let most = own.iter().copied().fold(limited.fastest, f64::max).min(HIGHEST * limited.fastest) * 1.03;
    let across = (WIDTH - LEFT - RIGHT) / limited.time() * rows as f64;
    let row = |number: usize| {
        let top = TOP + number as f64 * (tall + FOOT);
        let [from, to] = [number, number + 1].map(|k| limited.time() * k as f64 / rows as f64);
        Row { from, to, top, bottom: top + tall, across, up: tall / most }
    };
    let key = key(limited, true);
    let bottom = TOP + rows as f64 * (tall + FOOT) + NAME;
    let spans = spans(limited);
    let height = bottom + key.len() as f64 * ROW;
    Picture::draw((WIDTH, height), "The planned feed over time, and what limits it", |canvas| {
        let step = round_step(per_minute(units, 34.0 / tall * most));
        for row in (0..rows).map(row) {
            for (value, label) in ticks(0.0, per_minute(units, most), step) {
                let y = row.y(value * units.mm() / 60.0);
                canvas.line([(LEFT, y), (WIDTH - RIGHT, y)], Stroke::new(GRID, 1.0))?;
                canvas.coloured_text((LEFT - 8.0, y), &label, Anchor::Right, SOFT, false)?;
            }
            row.areas(canvas, limited, &plan.speed, &spans)?;
            for (time, label) in ticks(row.from, row.to, round_step((row.to - row.from) / 8.0)) {
                let x = row.x(time);
                canvas.line([(x, row.bottom), (x, row.bottom + 4.0)], Stroke::new(FRAME, 1.0))?;
                canvas.coloured_text((x, row.bottom + 15.0), &label, Anchor::Middle, SOFT, false)?;
            }
            for run in below(&row.points(limited, &own), row.top) {
                canvas.line(run, OWN)?;
            }
            canvas.line(row.points(limited, &plan.speed), PLANNED)?;
            let (right, frame) = (WIDTH - RIGHT, Stroke::new(FRAME, 1.0));
            canvas.line([(LEFT, row.top), (LEFT, row.bottom), (right, row.bottom)], frame)?;
            let at = |slow: &Slow| (row.x(limited.times[slow.at]), row.y(plan.speed[slow.at]));
            let is_within = |slow: &&Slow| (row.from..row.to).contains(&limited.times[slow.at]);
            let mut marks = Marks::default();
            for slow in shown(limited).filter(is_within) {
                marks.dot(at(slow), limited.causes[slow.at]);
            }
            for (number, slow) in limited.numbered().iter().filter(|(_, slow)| is_within(&slow)) {
                let at = at(slow);
                let above = (1..=6).map(|level| (at.0, at.1 - 1.7 * DISC * f64::from(level)));
                marks.number(*number, at, above.filter(|place| place.1 > row.top - DISC), |_| 0.0);
            }
            marks.draw(canvas)?;
        }
        canvas.text((8.0, 0.5 * TOP), &format!("centre feed, {}/min", units.short()), Anchor::Left)?;
        canvas.text((0.5 * (LEFT + WIDTH - RIGHT), bottom - NAME - 3.0), "time, s", Anchor::Middle)?;
        for (number, row) in key.iter().enumerate() {
            canvas.key((0.5 * WIDTH, bottom + (number as f64 + 0.4) * ROW), Anchor::Middle, row)?;
        }
        Ok(())
    })
}

/// The path in the colours of what limits it.
pub fn path_by_cause(job: &Job, path: &Path, plan: &Plan, limited: &Limited) -> Result<Picture, ReportError> {
    let outlines = Outlines::new(job, path);
    let view = View::around(outlines.contour.iter().chain(&limited.points).copied(), job.units.mm());
    let key = key(limited, false);
    Picture::draw(view.size_over_key(key.len()), "The path in the colours of what limits its feed", |canvas| {
        view.axes_over(canvas, job.units, &outlines)?;
        if job.offset != 0.0 {
            view.line(canvas, &outlines.contour, Stroke::new(INK, 1.2))?;
        }
        let way: Vec<(Place, RGBColor)> =
            limited.points.iter().zip(&limited.causes).map(|(&point, cause)| (point, cause.look().colour)).collect();
        view.line_in_colours(canvas, &way)?;
        let lines = [view.thinned(&limited.points), view.thinned(&outlines.contour)];
        let crowd = |(x, y): Point| {
            let near = |p: &&Point| (p.0 - x).hypot(p.1 - y) < DISC + 4.0;
            let [way, contour] = lines.each_ref().map(|line| line.iter().filter(near).count() as f64);
            way + 0.2 * contour
        };
        let mut marks = Marks::default();
        for slow in shown(limited) {
            marks.dot(view.at(limited.points[slow.at]), limited.causes[slow.at]);
        }
        for (number, slow) in limited.numbered() {
            let at = view.at(limited.points[slow.at]);
            let (sheet_right, sheet_bottom) = view.size(false);
            let is_on_sheet =
                |p: &Point| (DISC..sheet_right - DISC).contains(&p.0) && (DISC..sheet_bottom - DISC).contains(&p.1);
            let around = outward(plan, slow.at);
            marks.number(number, at, around.into_iter().map(|(x, y)| (at.0 + x, at.1 + y)).filter(is_on_sheet), crowd);
        }
        marks.draw(canvas)?;
        view.key_below(canvas, &key)
    })
}

/// What is seen of a direction from above.
fn plane(Vector([x, y, _]): Vector) -> Complex<f64> {
    Complex::new(x, y)
}

/// Where a number may stand from its place, in picture units: the outside of the bend first.
fn outward(plan: &Plan, at: usize) -> Vec<Point> {
    let places = &plan.course.places;
    let (before, after) = (&places[at.saturating_sub(1)], &places[(at + 1).min(places.len() - 1)]);
    let [into, out] = [before, after].map(|place| plane(place.direction));
    // Where a line goes over into a bend nothing turns yet, but the bend has a side.
    let turn = into.cross(out) + 1e-9 * (into.cross(plane(before.bend)) + out.cross(plane(after.bend)));
    let along = if (into + out).norm() > 1e-6 { into + out } else { out };
    // To the right where the way turns left.
    let side = if turn > 0.0 { -along.left() } else { along.left() };
    let angle = (-side.im).atan2(side.re);
    let mut all = Vec::new();
    for far in [20.0, 30.0, 42.0_f64] {
        for part in [0.0, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0, 4.0] {
            let (sin, cos) = (angle + part * std::f64::consts::FRAC_PI_4).sin_cos();
            all.push((far * cos, far * sin));
        }
    }
    all
}

/// Dots and numbers, and what they hide.
#[derive(Default)]
struct Marks {
    dots: Vec<(Point, Cause)>,
    numbers: Vec<(String, Point, Point)>,
}

impl Marks {
    fn dot(&mut self, at: Point, cause: Cause) {
        self.dots.push((at, cause));
    }

    /// Puts a number to the best of some places: on no other number, and then on as little as there is; earlier ones are better.
    fn number(&mut self, number: usize, at: Point, places: impl Iterator<Item = Point>, crowd: impl Fn(Point) -> f64) {
        let hidden = |place: Point| {
            let near = |other: Point, radius: f64| (other.0 - place.0).hypot(other.1 - place.1) < radius;
            let numbers = self.numbers.iter().filter(|other| near(other.2, 2.0 * DISC)).count();
            let dots = self.dots.iter().filter(|other| near(other.0, DISC + DOT)).count();
            1e3 * numbers as f64 + 3.0 * dots as f64 + crowd(place)
        };
        let scored = places.enumerate().map(|(order, place)| (hidden(place) + 0.5 * order as f64, place));
        let best = scored.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(at, |best| best.1);
        self.numbers.push((number.to_string(), at, best));
    }

    fn draw(&self, canvas: &mut Canvas<'_>) -> Result<(), ReportError> {
        for (_, at, place) in &self.numbers {
            canvas.line([*at, *place], LEADER)?;
        }
        for (at, cause) in &self.dots {
            canvas.dot(*at, DOT + 1.4, INK)?;
            canvas.dot(*at, DOT, cause.look().colour)?;
        }
        for (text, _, place) in &self.numbers {
            canvas.dot(*place, DISC, INK)?;
            canvas.dot(*place, DISC - 1.2, PAPER)?;
            canvas.coloured_text(*place, text, Anchor::Middle, INK, true)?;
        }
        Ok(())
    }
}

const _: () = assert!(NUMBERED < 100, "a disc holds two digits");

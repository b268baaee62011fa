//! Values over time: strips that share one time axis and one scale, displaced vertically for clarity.

use super::ReportError;
use super::canvas::{Anchor, Mark, Picture, Stroke};
use super::series::{Point, extent, round_step, ticks};
use super::style::{FRAME, GRID, GROUND, SOFT, WIDTH};

const LEFT: f64 = 66.0;
const RIGHT: f64 = 16.0;
const TOP: f64 = 40.0;
const BOTTOM: f64 = 50.0;
/// Over each strip, for its label.
const HEAD: f64 = 26.0;
/// The least room of a strip, as a part of the tallest one's.
const FLATTEST: f64 = 0.07;
/// Columns that a series is thinned to: one for each pixel on a large screen.
pub const COLUMNS: usize = 900;

/// A line over time.
#[derive(Clone, Debug)]
pub struct Trace {
    /// Time in s and value.
    pub points: Vec<Point>,
    /// How it is drawn.
    pub stroke: Stroke,
}

/// Lines about one zero line.
#[derive(Clone, Debug)]
pub struct Strip {
    /// Stands over it.
    pub label: String,
    /// The lines, the last one on top.
    pub traces: Vec<Trace>,
}

/// A picture of values over time.
#[derive(Clone, Debug)]
pub struct TimeChart<'a> {
    /// What it shows, in words.
    pub title: String,
    /// Name and unit of the values.
    pub quantity: String,
    /// From top to bottom.
    pub strips: Vec<Strip>,
    /// What the lines mean; may be empty.
    pub key: Vec<(Mark, &'a str)>,
    /// The length of the time axis in s.
    pub duration: f64,
    /// The time at the start that does not count, in s.
    pub settling: f64,
    /// The height of the picture.
    pub height: f64,
}

impl TimeChart<'_> {
    /// Draws it.
    pub fn draw(&self) -> Result<Picture, ReportError> {
        let extents: Vec<(f64, f64)> =
            self.strips.iter().map(|strip| extent(strip.traces.iter().flat_map(|trace| &trace.points))).collect();
        let tallest = extents.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
        let tallest = if tallest > 0.0 { tallest } else { 1.0 };
        let rooms: Vec<f64> = extents.iter().map(|(low, high)| (high - low).max(FLATTEST * tallest)).collect();
        let bottom = self.height - BOTTOM;
        let scale = (bottom - TOP - HEAD * rooms.len() as f64) / rooms.iter().sum::<f64>();
        let across = (WIDTH - LEFT - RIGHT) / self.duration.max(f64::MIN_POSITIVE);
        let x = |time: f64| LEFT + time * across;
        Picture::draw((WIDTH, self.height), &self.title, |canvas| {
            if self.settling > 0.0 {
                canvas.rectangle((LEFT, TOP), (x(self.settling), bottom), GROUND)?;
            }
            for (time, label) in ticks(0.0, self.duration, round_step(self.duration / 8.0)) {
                canvas.line([(x(time), TOP), (x(time), bottom)], Stroke::new(GRID, 1.0))?;
                canvas.coloured_text((x(time), bottom + 15.0), &label, Anchor::Middle, SOFT, false)?;
            }
            let step = round_step(34.0 / scale);
            let mut top = TOP;
            for ((strip, (low, high)), room) in self.strips.iter().zip(&extents).zip(&rooms) {
                let floor = top + HEAD + room * scale;
                let y = |value: f64| floor - (value - low) * scale;
                for (value, label) in ticks(*low, *high, step) {
                    let stroke = if value == 0.0 { Stroke::new(FRAME, 1.0) } else { Stroke::new(GRID, 1.0) };
                    canvas.line([(LEFT, y(value)), (WIDTH - RIGHT, y(value))], stroke)?;
                    canvas.coloured_text((LEFT - 8.0, y(value)), &label, Anchor::Right, SOFT, false)?;
                }
                for trace in &strip.traces {
                    canvas.line(trace.points.iter().map(|&(time, value)| (x(time), y(value))), trace.stroke)?;
                }
                canvas.text((LEFT + 8.0, top + 0.5 * HEAD), &strip.label, Anchor::Left)?;
                top = floor;
            }
            canvas.line([(LEFT, TOP), (LEFT, bottom)], Stroke::new(FRAME, 1.0))?;
            canvas.text((8.0, 0.5 * TOP), &self.quantity, Anchor::Left)?;
            canvas.text((0.5 * (LEFT + WIDTH - RIGHT), bottom + 37.0), "time, s", Anchor::Middle)?;
            canvas.key((WIDTH - RIGHT, 0.5 * TOP), Anchor::Right, &self.key)
        })
    }
}

//! Pictures of the plane: the same scale on both axes, places in the job's unit.

use plotters::style::RGBColor;

use super::ReportError;
use super::canvas::{Anchor, Canvas, Mark, Stroke};
use super::geometry::Place;
use super::series::{Point, round_step, ticks};
use super::style::{FRAME, GRID, INK, SOFT, WIDTH, viridis};

const LEFT: f64 = 58.0;
const RIGHT: f64 = 14.0;
/// Above the plot: the key, and the name of the y axis.
const TOP: f64 = 40.0;
/// Under the plot: tick labels and the name of the x axis.
const BOTTOM: f64 = 50.0;
/// Under that: a colour scale.
const COLOURS: f64 = 62.0;
/// Under that, or in its place: a row of a key.
const ROW: f64 = 26.0;
/// The tallest and the flattest plot.
const TALLEST: f64 = 620.0;
const FLATTEST: f64 = 150.0;
/// Shades of a coloured path; neighbours cannot be told apart.
const SHADES: f64 = 64.0;
/// Points nearer to each other than this, in units of the picture, are drawn as one.
const FINE: f64 = 1.0;

/// From mm to places on the sheet.
#[derive(Clone, Copy, Debug)]
pub struct View {
    mm: f64,
    /// Job units at the plot's lower left and upper right.
    low: Point,
    high: Point,
    /// Picture units in a job unit.
    scale: f64,
    plot: Point,
}

impl View {
    /// A view of all `places`, in job units of `mm`.
    pub fn around(places: impl IntoIterator<Item = Place>, mm: f64) -> Self {
        let ends = places.into_iter().fold(None, |ends: Option<(Point, Point)>, place| {
            let (low, high) = ends.unwrap_or(((place.re, place.im), (place.re, place.im)));
            Some(((low.0.min(place.re), low.1.min(place.im)), (high.0.max(place.re), high.1.max(place.im))))
        });
        let (low, high) = ends.unwrap_or(((0.0, 0.0), (mm, mm)));
        let extent = ((high.0 - low.0) / mm, (high.1 - low.1) / mm);
        let margin = 0.04 * extent.0.max(extent.1).max(1e-6);
        let extent = (extent.0 + 2.0 * margin, extent.1 + 2.0 * margin);
        let width = WIDTH - LEFT - RIGHT;
        let height = (width * extent.1 / extent.0).clamp(FLATTEST, TALLEST);
        let scale = (width / extent.0).min(height / extent.1);
        let middle = (0.5 * (low.0 + high.0) / mm, 0.5 * (low.1 + high.1) / mm);
        let reach = (0.5 * width / scale, 0.5 * height / scale);
        Self {
            mm,
            low: (middle.0 - reach.0, middle.1 - reach.1),
            high: (middle.0 + reach.0, middle.1 + reach.1),
            scale,
            plot: (width, height),
        }
    }

    /// The size of the picture, with or without room for a colour scale.
    pub fn size(&self, colours: bool) -> Point {
        (WIDTH, TOP + self.plot.1 + BOTTOM + if colours { COLOURS } else { 0.0 })
    }

    /// The size of the picture with a key of so many rows under the plot.
    pub fn size_over_key(&self, rows: usize) -> Point {
        let (width, height) = self.size(false);
        (width, height + rows as f64 * ROW)
    }

    /// A key under the plot, where one beside the y axis's name would be too wide.
    pub fn key_below(&self, canvas: &mut Canvas<'_>, rows: &[Vec<(Mark, &str)>]) -> Result<(), ReportError> {
        let (middle, top) = (LEFT + 0.5 * self.plot.0, self.size(false).1 + 0.5 * ROW);
        for (number, row) in rows.iter().enumerate() {
            canvas.key((middle, top + number as f64 * ROW), Anchor::Middle, row)?;
        }
        Ok(())
    }

    /// A length in mm as one on the sheet.
    pub fn length(&self, mm: f64) -> f64 {
        mm / self.mm * self.scale
    }

    /// Where a key begins.
    pub fn key_place(&self) -> Point {
        (WIDTH - RIGHT, 0.5 * TOP)
    }

    /// A name over the plot, beside the key.
    pub fn name(&self, canvas: &mut Canvas<'_>, text: &str) -> Result<(), ReportError> {
        canvas.coloured_text((LEFT + 26.0, 0.5 * TOP), text, Anchor::Left, INK, true)
    }

    /// Where `place` is on the sheet.
    pub fn at(&self, place: Place) -> Point {
        self.at_units((place.re / self.mm, place.im / self.mm))
    }

    fn at_units(&self, (x, y): Point) -> Point {
        (LEFT + (x - self.low.0) * self.scale, TOP + (self.high.1 - y) * self.scale)
    }

    /// Grid, frame, tick labels and the axes' names.
    pub fn axes(&self, canvas: &mut Canvas<'_>, unit: &str) -> Result<(), ReportError> {
        let step = round_step(62.0 / self.scale);
        let bottom = TOP + self.plot.1;
        for (x, label) in ticks(self.low.0, self.high.0, step) {
            let at = self.at_units((x, self.low.1)).0;
            canvas.line([(at, TOP), (at, bottom)], Stroke::new(GRID, 1.0))?;
            canvas.coloured_text((at, bottom + 15.0), &label, Anchor::Middle, SOFT, false)?;
        }
        for (y, label) in ticks(self.low.1, self.high.1, step) {
            let at = self.at_units((self.low.0, y)).1;
            canvas.line([(LEFT, at), (WIDTH - RIGHT, at)], Stroke::new(GRID, 1.0))?;
            canvas.coloured_text((LEFT - 8.0, at), &label, Anchor::Right, SOFT, false)?;
        }
        let (right, frame) = (WIDTH - RIGHT, Stroke::new(FRAME, 1.0));
        canvas.line([(LEFT, TOP), (right, TOP), (right, bottom), (LEFT, bottom), (LEFT, TOP)], frame)?;
        canvas.text((LEFT + 0.5 * self.plot.0, bottom + 37.0), &format!("x, {unit}"), Anchor::Middle)?;
        canvas.text((8.0, 0.5 * TOP), &format!("y, {unit}"), Anchor::Left)
    }

    /// A line through `places`, without those that are too near to each other to be seen.
    pub fn line(&self, canvas: &mut Canvas<'_>, places: &[Place], stroke: Stroke) -> Result<(), ReportError> {
        canvas.line(self.thinned(places), stroke)
    }

    /// The area within `places`.
    pub fn area(&self, canvas: &mut Canvas<'_>, places: &[Place], colour: RGBColor) -> Result<(), ReportError> {
        canvas.area(self.thinned(places), colour)
    }

    /// The whole plot.
    pub fn all(&self, canvas: &mut Canvas<'_>, colour: RGBColor) -> Result<(), ReportError> {
        canvas.rectangle((LEFT, TOP), (WIDTH - RIGHT, TOP + self.plot.1), colour)
    }

    /// Places on the sheet, without those that are too near to each other to be seen.
    pub fn thinned(&self, places: &[Place]) -> Vec<Point> {
        let mut kept: Vec<Point> = Vec::new();
        for (number, &place) in places.iter().enumerate() {
            let point = self.at(place);
            if number + 1 == places.len() || kept.last().is_none_or(|&last| distance(last, point) > FINE) {
                kept.push(point);
            }
        }
        kept
    }

    /// A line in the colours of the values along it, with a dark edge that keeps its light end visible on white.
    pub fn coloured_line(&self, canvas: &mut Canvas<'_>, way: &[(Place, f64)], most: f64) -> Result<(), ReportError> {
        let shade = |value: f64| viridis((value / most * SHADES).round() / SHADES);
        let way: Vec<(Place, RGBColor)> = way.iter().map(|&(place, value)| (place, shade(value))).collect();
        self.line_in_colours(canvas, &way)
    }

    /// A line whose every part has the colour of its first place, with a dark edge.
    pub fn line_in_colours(&self, canvas: &mut Canvas<'_>, way: &[(Place, RGBColor)]) -> Result<(), ReportError> {
        let places: Vec<Place> = way.iter().map(|step| step.0).collect();
        canvas.line(self.thinned(&places), Stroke::new(INK, 6.4))?;
        let mut part: Vec<Point> = Vec::new();
        let mut shown = INK;
        for (number, &(place, colour)) in way.iter().enumerate() {
            let point = self.at(place);
            let far = part.last().is_none_or(|&last| distance(last, point) > FINE);
            if !far && number + 1 < way.len() {
                continue;
            }
            if part.is_empty() {
                shown = colour;
            }
            part.push(point);
            if colour != shown || number + 1 == way.len() {
                canvas.line(part.iter().copied(), Stroke::new(shown, 4.8))?;
                part = vec![point];
                shown = colour;
            }
        }
        Ok(())
    }

    /// The colour scale from zero to `most`, in job units a minute, with its `name` under the plot.
    pub fn colours(&self, canvas: &mut Canvas<'_>, most: f64, name: &str) -> Result<(), ReportError> {
        const BAR: f64 = 13.0;
        let (from, width) = (LEFT, self.plot.0);
        let top = TOP + self.plot.1 + BOTTOM + 6.0;
        let edge = |k: f64| from + width * k / SHADES;
        for k in 0..SHADES as u32 {
            let k = f64::from(k);
            // Each a little too wide, so that no seam shows.
            canvas.rectangle(
                (edge(k), top),
                ((edge(k + 1.4)).min(from + width), top + BAR),
                viridis((k + 0.5) / SHADES),
            )?;
        }
        let step = round_step(most / 6.0);
        let marks = ticks(0.0, most, step);
        for (value, label) in &marks {
            let x = from + width * value / most;
            canvas.line([(x, top + BAR), (x, top + BAR + 4.0)], Stroke::new(INK, 1.0))?;
            canvas.coloured_text((x, top + BAR + 15.0), label, Anchor::Middle, SOFT, false)?;
        }
        canvas.text((from + 0.5 * width, top + BAR + 35.0), name, Anchor::Middle)
    }
}

fn distance(a: Point, b: Point) -> f64 {
    (a.0 - b.0).hypot(a.1 - b.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::complex::Complex;

    /// A circle stays a circle: one scale for both axes, also where the picture's height is clamped.
    #[test]
    fn both_axes_have_one_scale() {
        for (width, height) in [(10.0, 10.0), (1000.0, 1.0), (1.0, 1000.0), (0.0, 0.0)] {
            let view = View::around([Complex::new(0.0, 0.0), Complex::new(width, height)], 25.4);
            let origin = view.at(Complex::ZERO);
            let right = view.at(Complex::new(25.4, 0.0));
            let up = view.at(Complex::new(0.0, 25.4));
            assert!((right.0 - origin.0 - (origin.1 - up.1)).abs() < 1e-9 * (1.0 + right.0.abs()));
            let far = view.at(Complex::new(width, height));
            for (x, y) in [origin, far] {
                assert!((LEFT..=WIDTH - RIGHT).contains(&x) && (TOP..=view.size(false).1 - BOTTOM).contains(&y));
            }
        }
    }
}

//! A sheet to draw on: the few marks that the pictures need, over the SVG backend of plotters.
//!
//! The backend rounds to whole numbers; it is given tenths of a unit, so that curves stay smooth and the file short.

use plotters::backend::{DrawingBackend as _, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color as _, FontFamily, FontStyle, IntoFont as _, RGBColor, ShapeStyle, TextStyle};

use super::ReportError;
use super::page::escape;
use super::series::Point;
use super::style::{INK, TEXT};

/// Parts of a unit.
const PARTS: f64 = 10.0;
/// The backend divides the height of text by this.
const BACKEND_TEXT: f64 = 1.24;

/// A line's colour, and its width in units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// The colour.
    pub colour: RGBColor,
    /// The width.
    pub width: f64,
}

impl Stroke {
    /// A line of this colour and width.
    pub const fn new(colour: RGBColor, width: f64) -> Self {
        Self { colour, width }
    }
}

/// Which point of a text stands at its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Anchor {
    /// The middle of its left edge.
    Left,
    /// Its middle.
    Middle,
    /// The middle of its right edge.
    Right,
}

/// A finished picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    size: (u32, u32),
    title: String,
    marks: String,
}

impl Picture {
    /// Draws a picture of this width and height; `title` is what it shows, for those who cannot see it.
    pub fn draw(
        (width, height): Point,
        title: impl Into<String>,
        draw: impl FnOnce(&mut Canvas<'_>) -> Result<(), ReportError>,
    ) -> Result<Self, ReportError> {
        let size = ((width * PARTS).ceil() as u32, (height * PARTS).ceil() as u32);
        let mut text = String::new();
        let mut canvas = Canvas { backend: SVGBackend::with_string(&mut text, size) };
        draw(&mut canvas)?;
        drawn(canvas.backend.present())?;
        drop(canvas);
        // What the backend writes is one element; its own opening tag, which fixes the size in pixels, gives way to ours.
        let marks = text.split_once('>').map_or("", |(_, rest)| rest).trim_end();
        let marks = marks.strip_suffix("</svg>").unwrap_or(marks);
        let marks = marks.replace(" opacity=\"1\"", "").replace(" font-family=\"sans-serif\"", "").replace(" \"", "\"");
        Ok(Self { size, title: title.into(), marks })
    }

    /// As part of an HTML page: as wide as its place.
    pub fn inline(&self) -> String {
        self.element("", "")
    }

    /// As a file of its own, on white.
    pub fn file(&self) -> String {
        let (width, height) = self.size;
        let paper = format!("<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>");
        self.element(" xmlns=\"http://www.w3.org/2000/svg\"", &paper)
    }

    fn element(&self, attributes: &str, first: &str) -> String {
        let (width, height) = self.size;
        let title = escape(&self.title);
        format!(
            "<svg{attributes} viewBox=\"0 0 {width} {height}\" role=\"img\" font-family=\"system-ui, sans-serif\" \
             stroke-linejoin=\"round\" stroke-linecap=\"round\"><title>{title}</title>{first}{}</svg>",
            self.marks
        )
    }
}

/// The sheet while it is drawn on. Places are in units from the upper left.
pub struct Canvas<'a> {
    backend: SVGBackend<'a>,
}

impl Canvas<'_> {
    /// A line through `points`.
    pub fn line(&mut self, points: impl IntoIterator<Item = Point>, stroke: Stroke) -> Result<(), ReportError> {
        let stroke_width = (stroke.width * PARTS).round() as u32;
        let style = ShapeStyle { color: stroke.colour.to_rgba(), filled: false, stroke_width };
        let mut places: Vec<(i32, i32)> = points.into_iter().map(place).collect();
        places.dedup();
        drawn(self.backend.draw_path(places, &style))
    }

    /// The area within `points`.
    pub fn area(&mut self, points: impl IntoIterator<Item = Point>, colour: RGBColor) -> Result<(), ReportError> {
        let mut places: Vec<(i32, i32)> = points.into_iter().map(place).collect();
        places.dedup();
        drawn(self.backend.fill_polygon(places, &colour.to_rgba()))
    }

    /// The rectangle between two corners.
    pub fn rectangle(&mut self, from: Point, to: Point, colour: RGBColor) -> Result<(), ReportError> {
        drawn(self.backend.draw_rect(place(from), place(to), &colour.to_rgba(), true))
    }

    /// Lines that rise to the right, from `left` to `right`, under `top` and over `bottom`. They go on where neighbouring areas meet.
    pub fn hatch(
        &mut self,
        left: f64,
        right: f64,
        bottom: f64,
        top: impl Fn(f64) -> f64,
        stroke: Stroke,
    ) -> Result<(), ReportError> {
        /// Between two lines, along x.
        const SPACING: f64 = 6.0;
        const STEP: f64 = 0.5;
        let steps = ((right - left) / STEP).ceil().max(1.0) as u32;
        let columns: Vec<Point> =
            (0..=steps).map(|k| left + (right - left) * f64::from(k) / f64::from(steps)).map(|x| (x, top(x))).collect();
        let highest = columns.iter().map(|column| column.1).fold(bottom, f64::min);
        let (first, last) = (((left + highest) / SPACING).ceil() as i32, ((right + bottom) / SPACING).floor() as i32);
        for number in first..=last {
            let sum = f64::from(number) * SPACING;
            let is_inside = |&(x, top): &Point| (top..=bottom).contains(&(sum - x));
            for run in columns.chunk_by(|a, b| is_inside(a) == is_inside(b)) {
                if let ([from, .., to], true) = (run, run.first().is_some_and(is_inside)) {
                    self.line([(from.0, sum - from.0), (to.0, sum - to.0)], stroke)?;
                }
            }
        }
        Ok(())
    }

    /// A dot.
    pub fn dot(&mut self, at: Point, radius: f64, colour: RGBColor) -> Result<(), ReportError> {
        drawn(self.backend.draw_circle(place(at), (radius * PARTS).round() as u32, &colour.to_rgba(), true))
    }

    /// A dot with a hole.
    pub fn ring(&mut self, at: Point, radius: f64, colour: RGBColor, hole: RGBColor) -> Result<(), ReportError> {
        self.dot(at, radius, colour)?;
        self.dot(at, radius - 1.7, hole)
    }

    /// A circle.
    pub fn circle(&mut self, at: Point, radius: f64, stroke: Stroke) -> Result<(), ReportError> {
        let stroke_width = (stroke.width * PARTS).round() as u32;
        let style = ShapeStyle { color: stroke.colour.to_rgba(), filled: false, stroke_width };
        drawn(self.backend.draw_circle(place(at), (radius * PARTS).round() as u32, &style, false))
    }

    /// A text in ink.
    pub fn text(&mut self, at: Point, text: &str, anchor: Anchor) -> Result<(), ReportError> {
        self.coloured_text(at, text, anchor, INK, false)
    }

    /// A text in a colour, bold or not.
    pub fn coloured_text(
        &mut self,
        at: Point,
        text: &str,
        anchor: Anchor,
        colour: RGBColor,
        bold: bool,
    ) -> Result<(), ReportError> {
        let horizontal = match anchor {
            Anchor::Left => HPos::Left,
            Anchor::Middle => HPos::Center,
            Anchor::Right => HPos::Right,
        };
        let font = (FontFamily::SansSerif, TEXT * PARTS * BACKEND_TEXT).into_font();
        let font = if bold { font.style(FontStyle::Bold) } else { font };
        let style = TextStyle::from(font).color(&colour).pos(Pos::new(horizontal, VPos::Center));
        drawn(self.backend.draw_text(text, &style, place(at)))
    }

    /// A row of marks with what they mean, from `at` on, or up to `at` where it is anchored right.
    pub fn key(&mut self, at: Point, anchor: Anchor, entries: &[(Mark, &str)]) -> Result<(), ReportError> {
        let all: f64 = entries.iter().map(|(_, text)| key_width(text)).sum::<f64>() - GAP;
        let mut x = match anchor {
            Anchor::Left => at.0,
            Anchor::Middle => at.0 - 0.5 * all,
            Anchor::Right => at.0 - all,
        };
        for (mark, text) in entries {
            match *mark {
                Mark::Line(stroke) => self.line([(x, at.1), (x + SWATCH, at.1)], stroke)?,
                Mark::Dot(colour) => self.dot((x + 0.5 * SWATCH, at.1), 4.5, colour)?,
                Mark::Circle(stroke) => self.circle((x + 0.5 * SWATCH, at.1), 8.0, stroke)?,
                Mark::Area(colour) => {
                    self.rectangle((x + 5.0, at.1 - 6.0), (x + SWATCH - 5.0, at.1 + 6.0), colour)?;
                }
                Mark::Hatched(colour, lines) => {
                    let (left, right) = (x + 5.0, x + SWATCH - 5.0);
                    self.rectangle((left, at.1 - 6.0), (right, at.1 + 6.0), colour)?;
                    self.hatch(left, right, at.1 + 6.0, |_| at.1 - 6.0, lines)?;
                }
                Mark::Ring(colour, hole) => self.ring((x + 0.5 * SWATCH, at.1), 5.5, colour, hole)?,
            }
            self.text((x + SWATCH + 6.0, at.1), text, Anchor::Left)?;
            x += key_width(text);
        }
        Ok(())
    }
}

/// What a key explains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mark {
    /// A line.
    Line(Stroke),
    /// A dot.
    Dot(RGBColor),
    /// A ring and its hole.
    Ring(RGBColor, RGBColor),
    /// A circle.
    Circle(Stroke),
    /// An area.
    Area(RGBColor),
    /// An area and the lines over it.
    Hatched(RGBColor, Stroke),
}

/// The mark of an entry of a key, and the gap behind its text.
const SWATCH: f64 = 26.0;
const GAP: f64 = 18.0;

fn key_width(text: &str) -> f64 {
    SWATCH + 6.0 + text.chars().count() as f64 * 0.6 * TEXT + GAP
}

/// The entries of a key in rows that are no wider than `width`.
pub fn key_rows<'a>(entries: &[(Mark, &'a str)], width: f64) -> Vec<Vec<(Mark, &'a str)>> {
    let mut rows: Vec<Vec<(Mark, &str)>> = Vec::new();
    let mut taken = f64::INFINITY;
    for &(mark, text) in entries {
        let wide = key_width(text);
        if taken + wide - GAP > width {
            rows.push(Vec::new());
            taken = 0.0;
        }
        if let Some(row) = rows.last_mut() {
            row.push((mark, text));
        }
        taken += wide;
    }
    rows
}

fn place((x, y): Point) -> (i32, i32) {
    ((x * PARTS).round() as i32, (y * PARTS).round() as i32)
}

/// The backend's many errors as ours: into a text it cannot fail but by a font.
fn drawn<E>(result: Result<(), E>) -> Result<(), ReportError> {
    result.map_err(|_| ReportError::Drawing)
}

#[cfg(test)]
mod tests {
    use super::super::page::tests::assert_balanced;
    use super::*;

    #[test]
    fn pictures_are_well_formed() {
        let picture = Picture::draw((64.0, 48.0), "a < b & \"c\"", |canvas| {
            canvas.line([(0.0, 0.0), (1.25, 3.0), (64.0, 48.0)], Stroke::new(INK, 1.5))?;
            canvas.ring((5.0, 5.0), 4.0, INK, RGBColor(1, 2, 3))?;
            canvas.text((3.0, 3.0), "x < y & z", Anchor::Middle)
        });
        let picture = picture.unwrap();
        for text in [picture.inline(), picture.file()] {
            assert_balanced(&text);
            assert!(text.contains("points=\"0,0 13,30 640,480\""), "{text}");
            assert!(text.contains("x &lt; y &amp; z") && text.contains("a &lt; b &amp;"));
        }
        assert!(!picture.inline().contains("http"));
    }
}

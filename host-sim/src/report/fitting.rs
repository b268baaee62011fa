//! One picture of a fit: the lines before and the curves after, whole and near where most lines meet. In x and y, in mm.

use plotters::style::RGBColor;

use super::ReportError;
use super::canvas::{Anchor, Canvas, Picture, Stroke};
use super::series::{Point, number};
use super::style::{FRAME, INK, MAIN, OTHER, PAPER, SOFT, WIDTH};
use crate::fit::Curve;
use crate::vector::Vector;

/// What there is to be drawn.
#[derive(Clone, Debug, Default)]
pub struct Fitted {
    /// The points of each chain of lines.
    pub lines: Vec<Vec<Vector>>,
    /// The curves in their place.
    pub curves: Vec<Curve>,
    /// How far they may be apart, in mm.
    pub tolerance: f64,
    /// What the curves are called, of more than one.
    pub name: &'static str,
}

/// Colours of neighbouring curves.
const COLOURS: [RGBColor; 3] = [MAIN, OTHER, RGBColor(0x2f, 0x8f, 0x6b)];
/// Samples of a curve in the view of everything, and in the closer look.
const SAMPLES: [u32; 2] = [60, 400];
/// The lines that the closer look shows at least.
const SHOWN: usize = 60;
/// Above each row of panels, for its names.
const HEAD: f64 = 32.0;
const EDGE: f64 = 6.0;
const BETWEEN: f64 = 14.0;
/// The height of the closer look, and the tallest and the flattest view of everything.
const CLOSE: f64 = 190.0;
const TALLEST: f64 = 340.0;
const FLATTEST: f64 = 90.0;

/// A part of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Window {
    low: Point,
    high: Point,
}

impl Window {
    /// Around some places; none where there are none.
    fn around<'a>(places: impl IntoIterator<Item = &'a Vector>) -> Option<Self> {
        places.into_iter().map(|v| (v.0[0], v.0[1])).fold(None, |found: Option<Self>, p| {
            let Self { low, high } = found.unwrap_or(Self { low: p, high: p });
            let (low, high) = ((low.0.min(p.0), low.1.min(p.1)), (high.0.max(p.0), high.1.max(p.1)));
            Some(Self { low, high })
        })
    }

    fn size(&self) -> Point {
        (self.high.0 - self.low.0, self.high.1 - self.low.1)
    }

    /// Wider about its middle, to the shape of a panel, with a margin.
    fn shaped(&self, panel: Point) -> Self {
        const MARGIN: f64 = 1.12;
        let (width, height) = self.size();
        let scale = (width / panel.0).max(height / panel.1).max(1e-9) * MARGIN;
        let reach = (0.5 * scale * panel.0, 0.5 * scale * panel.1);
        let middle = (0.5 * (self.low.0 + self.high.0), 0.5 * (self.low.1 + self.high.1));
        Self { low: (middle.0 - reach.0, middle.1 - reach.1), high: (middle.0 + reach.0, middle.1 + reach.1) }
    }

    /// The part of a segment inside [Liang & Barsky 1984].
    fn clipped(&self, [from, to]: [Point; 2]) -> Option<[Point; 2]> {
        let along = (to.0 - from.0, to.1 - from.1);
        let (mut first, mut last) = (0.0_f64, 1.0_f64);
        let edges = [
            (-along.0, from.0 - self.low.0),
            (along.0, self.high.0 - from.0),
            (-along.1, from.1 - self.low.1),
            (along.1, self.high.1 - from.1),
        ];
        for (speed, room) in edges {
            if speed == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if speed < 0.0 {
                first = first.max(room / speed);
            } else {
                last = last.min(room / speed);
            }
        }
        let at = |t: f64| (from.0 + along.0 * t, from.1 + along.1 * t);
        (first <= last).then(|| [at(first), at(last)])
    }
}

/// A place on the sheet where a window of the plane is shown.
#[derive(Clone, Copy, Debug)]
struct Panel {
    window: Window,
    corner: Point,
    size: Point,
}

impl Panel {
    fn at(&self, (x, y): Point) -> Point {
        let scale = self.size.0 / self.window.size().0;
        (self.corner.0 + (x - self.window.low.0) * scale, self.corner.1 + (self.window.high.1 - y) * scale)
    }

    fn frame(&self, canvas: &mut Canvas<'_>) -> Result<(), ReportError> {
        let (x, y) = self.corner;
        let (right, bottom) = (x + self.size.0, y + self.size.1);
        canvas.line([(x, y), (right, y), (right, bottom), (x, bottom), (x, y)], Stroke::new(FRAME, 1.0))
    }

    /// What of a line is inside.
    fn line(&self, canvas: &mut Canvas<'_>, places: &[Point], stroke: Stroke) -> Result<(), ReportError> {
        let mut run: Vec<Point> = Vec::new();
        for pair in places.windows(2) {
            let Some([from, to]) = self.window.clipped([pair[0], pair[1]]) else { continue };
            if run.last() != Some(&self.at(from)) {
                if run.len() > 1 {
                    canvas.line(std::mem::take(&mut run), stroke)?;
                }
                run = vec![self.at(from)];
            }
            run.push(self.at(to));
        }
        if run.len() > 1 { canvas.line(run, stroke) } else { Ok(()) }
    }

    fn holds(&self, (x, y): Point) -> bool {
        let Window { low, high } = self.window;
        (low.0..=high.0).contains(&x) && (low.1..=high.1).contains(&y)
    }

    /// A bar of a round length at the lower right.
    fn scale(&self, canvas: &mut Canvas<'_>) -> Result<(), ReportError> {
        let unit = self.size.0 / self.window.size().0;
        let most = 0.3 * self.size.0 / unit;
        let power = 10_f64.powf(most.log10().floor());
        let length = [5.0, 2.0, 1.0].map(|digit| digit * power).into_iter().find(|&length| length <= most);
        let length = length.unwrap_or(power);
        let decimals = (-length.log10().floor()).max(0.0) as usize;
        let (right, y) = (self.corner.0 + self.size.0 - 12.0, self.corner.1 + self.size.1 - 12.0);
        canvas.line([(right - length * unit, y), (right, y)], Stroke::new(INK, 2.0))?;
        let text = format!("{} mm", number(length, decimals));
        canvas.coloured_text((right, y - 14.0), &text, Anchor::Right, SOFT, false)
    }

    fn lines(&self, canvas: &mut Canvas<'_>, fitted: &Fitted, dot: f64) -> Result<(), ReportError> {
        for chain in &fitted.lines {
            let places: Vec<Point> = chain.iter().map(|v| (v.0[0], v.0[1])).collect();
            self.line(canvas, &places, Stroke::new(INK, 1.0))?;
            for &place in places.iter().filter(|&&place| self.holds(place)) {
                canvas.dot(self.at(place), dot, INK)?;
            }
        }
        Ok(())
    }

    fn curves(&self, canvas: &mut Canvas<'_>, fitted: &Fitted, look: Look) -> Result<(), ReportError> {
        for (k, curve) in fitted.curves.iter().enumerate() {
            let stroke = Stroke::new(COLOURS[k % COLOURS.len()], look.width);
            self.line(canvas, &sampled(curve, look.samples), stroke)?;
        }
        let ends = fitted.curves.iter().flat_map(|curve| [curve.at(0.0), curve.at(1.0)]);
        for place in ends.map(|at| (at.point.0[0], at.point.0[1])).filter(|&place| self.holds(place)) {
            canvas.ring(self.at(place), look.ring, INK, PAPER)?;
        }
        Ok(())
    }
}

/// How curves are drawn.
#[derive(Clone, Copy, Debug)]
struct Look {
    samples: u32,
    width: f64,
    /// The radius of the rings at their ends.
    ring: f64,
}

fn sampled(curve: &Curve, samples: u32) -> Vec<Point> {
    let at = |k: u32| {
        let Vector([x, y, _]) = curve.at(f64::from(k) / f64::from(samples)).point;
        (x, y)
    };
    (0..=samples).map(at).collect()
}

/// Where so many lines in a row take the least room.
fn dense(lines: &[Vec<Vector>]) -> Option<Window> {
    let longest = lines.iter().map(Vec::len).max().filter(|&count| count > 1)?;
    let shown = SHOWN.min(longest - 1);
    let windows = lines.iter().flat_map(|chain| chain.windows(shown + 1).filter_map(Window::around));
    let room = |window: &Window| window.size().0.hypot(window.size().1);
    windows.min_by(|a, b| room(a).total_cmp(&room(b)))
}

/// The picture of a fit. Errors: there is nothing to draw.
pub fn fitting(fitted: &Fitted) -> Result<Picture, ReportError> {
    let all = Window::around(fitted.lines.iter().flatten()).ok_or(ReportError::NoSamples)?;
    let close = dense(&fitted.lines).ok_or(ReportError::NoSamples)?;
    let width = 0.5 * (WIDTH - 2.0 * EDGE - BETWEEN);
    let shape = all.size().1 / all.size().0.max(1e-9);
    let height = (width * shape + 16.0).clamp(FLATTEST, TALLEST);
    let rows = [(all, height, HEAD), (close, CLOSE, 2.0 * HEAD + height)];
    let [whole, near] = rows.map(|(window, height, top)| {
        let size = (width, height);
        [EDGE, EDGE + width + BETWEEN].map(|left| Panel { window: window.shaped(size), corner: (left, top), size })
    });
    let bottom = 2.0 * HEAD + height + CLOSE + EDGE;
    // What goes straight up or down is a point here.
    let is_seen = |[from, to]: [Vector; 2]| from.0[..2] != to.0[..2];
    let lines = fitted.lines.iter().flat_map(|chain| chain.windows(2)).filter(|ends| is_seen([ends[0], ends[1]]));
    let is_curve = |curve: &&Curve| !matches!(curve, Curve::Line(line) if !is_seen(line.points));
    let curves = fitted.curves.iter().filter(is_curve);
    let (before, after) = (format!("{} lines", lines.count()), format!("{} {}", curves.count(), fitted.name));
    let title = format!("{before}, and {after} within {} mm of them", fitted.tolerance);
    Picture::draw((WIDTH, bottom), title, |canvas| {
        let name = |canvas: &mut Canvas<'_>, panel: &Panel, text: &str, bold: bool| {
            let at = (panel.corner.0 + 2.0, panel.corner.1 - 0.5 * HEAD);
            canvas.coloured_text(at, text, Anchor::Left, INK, bold)
        };
        name(canvas, &whole[0], &before, true)?;
        name(canvas, &whole[1], &format!("{after}, within {} mm", fitted.tolerance), true)?;
        name(canvas, &near[0], "where most lines meet", false)?;
        name(canvas, &near[1], "the same place", false)?;
        whole[0].lines(canvas, fitted, 1.5)?;
        whole[1].curves(canvas, fitted, Look { samples: SAMPLES[0], width: 3.0, ring: 4.2 })?;
        near[0].lines(canvas, fitted, 2.6)?;
        near[1].curves(canvas, fitted, Look { samples: SAMPLES[1], width: 3.6, ring: 6.0 })?;
        for panel in whole {
            // What the closer look shows.
            let Window { low, high } = near[0].window;
            let corners = [low, (high.0, low.1), high, (low.0, high.1), low];
            panel.line(canvas, &corners, Stroke::new(SOFT, 1.0))?;
        }
        for panel in whole.iter().chain(&near) {
            panel.frame(canvas)?;
            panel.scale(canvas)?;
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::super::page::tests::assert_balanced;
    use super::*;
    use crate::fit::{Kind, fit};

    fn circle() -> Vec<Vector> {
        let on = |k: u32| f64::from(k * k) / 10_000.0 * 6.0;
        (0..=100).map(|k| Vector([10.0 * on(k).cos(), 10.0 * on(k).sin(), 0.0])).collect()
    }

    #[test]
    fn a_picture_says_what_it_shows() {
        let points = circle();
        let curves: Vec<Curve> = fit(&points, Kind::Ph, 0.1).parts.iter().map(|part| part.curve).collect();
        let after = format!("{} PH curves, within 0.1 mm", curves.len());
        let fitted = Fitted { lines: vec![points], curves, tolerance: 0.1, name: "PH curves" };
        let picture = fitting(&fitted).unwrap().file();
        assert_balanced(&picture);
        assert!(picture.contains("100 lines") && picture.contains(&after));
        assert_eq!(fitting(&Fitted::default()), Err(ReportError::NoSamples));
    }

    /// The steps of the circle grow from its start on: there most of them meet.
    #[test]
    fn the_closer_look_is_where_lines_are_short() {
        let found = dense(&[circle()]).unwrap();
        assert!((found.high.0 - 10.0).abs() < 1e-9 && found.low.1.abs() < 1e-9);
    }

    #[test]
    fn what_is_outside_is_cut_off() {
        let window = Window { low: (0.0, 0.0), high: (2.0, 1.0) };
        assert_eq!(window.clipped([(-1.0, 0.5), (3.0, 0.5)]), Some([(0.0, 0.5), (2.0, 0.5)]));
        assert_eq!(window.clipped([(-1.0, 0.0), (1.0, 2.0)]), Some([(0.0, 1.0), (0.0, 1.0)]));
        assert_eq!(window.clipped([(-1.0, 2.0), (3.0, 2.0)]), None);
    }
}

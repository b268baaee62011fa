//! `hodograph fit`: curves in the place of a program's lines.

use std::fs::{self, File};
use std::io::{BufReader, Write};

use clap::{Args, ValueEnum};
use host_sim::compensation::{self, Compensator};
use host_sim::fit::contour::{Chains, only};
use host_sim::fit::program::{Fitter, Step, Summary};
use host_sim::fit::{Curve, Fit, Kind};
use host_sim::input::InputError;
use host_sim::program::item::Nurbs;
use host_sim::program::write::{Dialect, Settings, WriteError, Writer};
use host_sim::program::{self, Action, Feed, Item, Motion};
use host_sim::report::{self, Fitted};
use host_sim::units::Units;
use host_sim::vector::Vector;
use serde::Serialize;

use super::Failure;
use super::output::{create, failed, json, write};
use super::tooling::Tools;

/// What is said of a spline beside which a tool runs.
const SPLINE_BESIDE: &str =
    "the path beside a spline is no curve that a program can say; simulate, plan or stream the program as it is";

/// Lay curves through the lines of a program, under a tolerance that holds both ways
#[derive(Args)]
#[command(
    after_help = "Examples:\n  hodograph fit examples/heart.ngc --tolerance 0.01 --curve ph -o heart.toml\n  hodograph fit part.nc --tolerance 0.01 --curve bspline -o part.mpf --json -"
)]
pub struct FitVerb {
    /// The program: .nc .ngc .gcode .tap (RS-274), .mpf .spf (Sinumerik), .apt .cls (cutter location), or the drawing: .svg .dxf
    input: String,
    /// How far the curves may be from the lines, and the lines from the curves, in mm
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    tolerance: f64,
    /// What is laid through the lines
    #[arg(long, value_enum, default_value_t = Shape::Ph)]
    curve: Shape,
    /// Where the result goes, by the ending: .mpf (Sinumerik), .nc or .ngc (RS-274), .toml (one contour)
    #[arg(short, long, value_name = "FILE")]
    output: Option<String>,
    /// Which of a program's contours is written to .toml, from 0
    #[arg(long, value_name = "NUMBER")]
    contour: Option<usize>,
    /// Draw the lines and the curves, seen along z, as SVG
    #[arg(long, value_name = "FILE.svg")]
    svg: Option<String>,
    #[command(flatten)]
    tools: Tools,
    /// Write the result as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<String>,
}

/// The curves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Shape {
    /// Cubics with common tangents
    Bezier,
    /// Cubic B-splines, continuous in curvature
    Bspline,
    /// PH quintics, continuous in curvature
    Ph,
    /// PH quintics with two continuous derivatives
    PhC2,
    /// Lines and circular arcs, continuous in direction
    Arc,
}

impl Shape {
    /// What many of them are called.
    fn name(self) -> &'static str {
        match self {
            Self::Bezier => "cubics",
            Self::Bspline => "cubics of B-splines",
            Self::Ph | Self::PhC2 => "PH curves",
            Self::Arc => "lines and arcs",
        }
    }
}

/// Adds a line to the chain that it goes on from, or to a new one.
fn draw(lines: &mut Vec<Vec<Vector>>, from: Vector, to: Vector) {
    match lines.last_mut().filter(|chain| chain.last() == Some(&from)) {
        Some(chain) => chain.push(to),
        None => lines.push(vec![from, to]),
    }
}

/// What `--json` writes.
#[derive(Serialize)]
struct Found {
    #[serde(flatten)]
    summary: Summary,
    tolerance: f64,
    units: Units,
}

/// Where steps go.
enum Target {
    Nothing,
    /// And how many events had no place in it.
    Program(Box<Writer<Box<dyn Write>>>, usize),
    Contours(Chains),
}

impl FitVerb {
    /// Fits, and writes what was asked for.
    pub fn run(self) -> Result<(), Failure> {
        let tolerance = self.tolerance;
        if !(tolerance > 0.0 && tolerance.is_finite()) {
            let message = format_args!("the tolerance is {tolerance}; it must be a number above zero");
            return Err(InputError::new("--tolerance", message).into());
        }
        let (target, summary, picture) = self.fit().inspect_err(|_| self.forget())?;
        let found = Found { summary, tolerance, units: Units::Mm };
        if let (Target::Contours(chains), Some(name)) = (&target, &self.output) {
            let chain = only(&chains.chains, self.contour).map_err(|message| InputError::new(&self.input, message))?;
            write(name, chain.to_toml().as_bytes())?;
        }
        if let Some(name) = &self.svg {
            let svg = report::fit_picture(&picture).map_err(|error| InputError::new(&self.input, error))?;
            write(name, svg.as_bytes())?;
        }
        if let Some(name) = &self.json {
            json(name, &found)?;
        }
        if ![&self.json, &self.output, &self.svg].into_iter().any(|name| name.as_deref() == Some("-")) {
            print(&found);
        }
        Ok(())
    }

    fn kind(&self) -> Kind {
        match self.curve {
            Shape::Bezier => Kind::Bezier,
            Shape::Bspline => Kind::Bspline,
            Shape::Ph => Kind::Ph,
            Shape::PhC2 => Kind::PhC2,
            Shape::Arc => Kind::Arcs,
        }
    }

    fn fit(&self) -> Result<(Target, Summary, Fitted), Failure> {
        let mut target = self.target()?;
        let file = File::open(&self.input)
            .map_err(|error| InputError::new(&self.input, format_args!("cannot be read: {error}")))?;
        let bar = super::progress_of(file.metadata().map_or(0, |data| data.len()), "{bytes} of {total_bytes}");
        let input = BufReader::new(bar.wrap_read(file));
        let mut picture = Fitted { tolerance: self.tolerance, name: self.curve.name(), ..Fitted::default() };
        let (is_drawn, curves) = (self.svg.is_some(), &mut picture.curves);
        let mut give = |step: Step<'_>| {
            if let (true, Step::Curves { fit, .. }) = (is_drawn, &step) {
                curves.extend(fit.parts.iter().map(|part| part.curve));
            }
            target.take(&step)
        };
        let mut fitter = Fitter::new(self.kind(), self.tolerance, &mut give);
        let is_contour = self.output.as_deref().is_some_and(|name| ending(name) == "toml");
        if is_contour || program::is_drawing(&self.input) {
            fitter = fitter.with_its_curves();
        }
        let lines = &mut picture.lines;
        let mut take = |item: &Item<'_>| {
            if let (true, Action::Motion(Motion::Line { to })) = (is_drawn, item.action) {
                draw(lines, Vector(item.from), Vector(to));
            }
            fitter.take(item)
        };
        let tooling = self.tools.read()?;
        let mut warnings = Vec::new();
        let mut centre = |step: compensation::Step<'_>| match step {
            compensation::Step::Kept(item) => take(item),
            compensation::Step::Centre(pieces) => pieces.iter().try_for_each(|piece| match piece.item() {
                Some(item) => take(&item),
                None => Err(SPLINE_BESIDE.to_string()),
            }),
            compensation::Step::Warning(warning) => {
                warnings.push(format!("warning: {}: {warning}", self.input));
                Ok(())
            }
        };
        let options = compensation::Options { gouge: tooling.gouge, ..compensation::Options::default() };
        let mut compensator = Compensator::new(&tooling.tools, options, &mut centre);
        let left_out = program::read(&self.input, input, &mut |item| compensator.take(item))?;
        compensator.finish().map_err(|message| InputError::new(&self.input, message))?;
        let summary = fitter.finish().map_err(|message| InputError::new(&self.input, message))?;
        bar.finish_and_clear();
        warnings.extend(left_out.iter().map(|warning| format!("warning: {}: {warning}", self.input)));
        for warning in warnings {
            eprintln!("{warning}");
        }
        if let Target::Program(writer, left) = target {
            let name = self.output.as_deref().unwrap_or_default();
            let mut out = writer.finish().map_err(|error| failed(name, error))?;
            out.flush().map_err(|error| failed(name, error))?;
            drop(out);
            if name != "-" {
                fs::rename(unfinished(name), name).map_err(|error| failed(name, error))?;
            }
            if left > 0 {
                eprintln!(
                    "{name}: {left} events that the language has no words for here (tool length, cutting speed) are not in it; add them by hand"
                );
            }
            target = Target::Nothing;
        }
        Ok((target, summary, picture))
    }

    fn target(&self) -> Result<Target, Failure> {
        let Some(name) = &self.output else { return Ok(Target::Nothing) };
        let dialect = match ending(name) {
            "toml" => return Ok(Target::Contours(Chains::default())),
            "mpf" => Dialect::Sinumerik,
            "nc" | "ngc" => Dialect::Rs274,
            other => {
                let message = format_args!("`{other}` is no ending of a result; .mpf, .nc, .ngc and .toml are");
                return Err(InputError::new(name, message).into());
            }
        };
        if matches!(self.curve, Shape::Ph | Shape::PhC2) {
            let message = "PH quintics have no words in programs; write them to .toml, or take --curve bspline";
            return Err(InputError::new(name, message).into());
        }
        let out = create(&unfinished(name))?;
        let writer = Writer::new(out, dialect, Settings::default()).map_err(|error| failed(name, error))?;
        Ok(Target::Program(Box::new(writer), 0))
    }

    /// Takes back what was begun.
    fn forget(&self) {
        if let Some(name) = self.output.as_deref().filter(|&name| name != "-") {
            // Where nothing was begun there is nothing to take back.
            let _ = fs::remove_file(unfinished(name));
        }
    }
}

impl Target {
    /// Errors are sentences for the place of the program where it happened.
    fn take(&mut self, step: &Step<'_>) -> Result<(), String> {
        match self {
            Self::Nothing => Ok(()),
            Self::Contours(chains) => chains.take(step).map_err(|error| error.to_string()),
            Self::Program(writer, left) => match step {
                Step::Curves { fit, feed, .. } => curves(writer, fit, *feed).map_err(|error| error.to_string()),
                Step::Lines { points, feed, .. } => points
                    .windows(2)
                    .try_for_each(|ends| writer.motion(ends[0].0, *feed, &Motion::Line { to: ends[1].0 }))
                    .map_err(|error| error.to_string()),
                Step::Kept(item) => match item.action {
                    Action::Motion(motion) => {
                        writer.motion(item.from, item.feed, &motion).map_err(|error| error.to_string())
                    }
                    Action::End => Ok(()),
                    action => {
                        let is_written = writer.event(&action).map_err(|error| error.to_string())?;
                        *left += usize::from(!is_written);
                        Ok(())
                    }
                },
            },
        }
    }
}

/// Curve after curve; a B-spline whole, so that its control sees one curve.
fn curves(writer: &mut Writer<Box<dyn Write>>, fit: &Fit, feed: Feed) -> Result<(), WriteError> {
    let mut splines = fit.splines.iter().peekable();
    let mut number = 0;
    while let Some(part) = fit.parts.get(number) {
        if let Some((spans, spline)) = splines.next_if(|(spans, _)| spans.start == number) {
            let points: Vec<[f64; 3]> = spline.points.iter().map(|point| point.0).collect();
            let weights = vec![1.0; points.len()];
            let nurbs = Nurbs { order: 4, points: &points, weights: &weights, knots: &spline.knots };
            writer.motion(points[0], feed, &Motion::Nurbs(nurbs))?;
            number = spans.end;
            continue;
        }
        match part.curve {
            Curve::Line(line) => writer.motion(line.points[0].0, feed, &Motion::Line { to: line.points[1].0 })?,
            Curve::Cubic(cubic) => {
                let [start, rest @ ..] = cubic.points.map(|point| point.0);
                writer.motion(start, feed, &Motion::Bezier { points: &rest })?;
            }
            Curve::Arc(arc) => writer.motion(arc.start.0, feed, &Motion::Arc(arc.motion()))?,
            // No program has them; `target` has refused.
            Curve::Ph(_) => {}
        }
        number += 1;
    }
    Ok(())
}

/// Where a result stands until it is whole: a fault in a long program leaves nothing that looks like one.
fn unfinished(name: &str) -> String {
    if name == "-" { name.to_string() } else { format!("{name}.part") }
}

fn ending(name: &str) -> &str {
    name.rsplit_once('.').map_or("", |(_, ending)| ending)
}

fn print(found: &Found) {
    let Summary { points, lines, segments, other_motions, max_deviation, max_tangent_break, max_curvature_jump } =
        found.summary;
    println!("lines               {lines:>12}    {points} points");
    println!("segments            {segments:>12}    {:.1} lines in each", lines as f64 / segments.max(1) as f64);
    println!("other motions       {other_motions:>12}    as they are");
    println!("deviation           {max_deviation:>12.6} mm at the most, of {}", found.tolerance);
    println!("tangent break       {max_tangent_break:>12.1e} rad where curves go on smoothly");
    println!("curvature jump      {max_curvature_jump:>12.1e} of the larger one there");
}

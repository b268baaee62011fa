//! `hodograph offset`: the trimmed offset of a contour, and what its tool cannot reach.

use std::io::{self, Write};

use clap::Args;
use host_sim::job::Part;
use host_sim::measure::clearance;
use host_sim::offset::{Offset, Undercut, undercuts};
use host_sim::report;
use host_sim::trimming::{Check, Orientation, Trimming};
use host_sim::units::{coordinates, plain};

use super::Failure;
use super::output::{failed, json, write};

/// Trim the offset of a contour: the path of a tool's centre that touches the part and never cuts into it
#[derive(Args)]
#[command(after_help = "Example:\n  hodograph offset examples/pocket.toml --distance -4 --svg pocket.svg --check")]
pub struct OffsetVerb {
    /// The contour, in TOML; it needs no `[feed]`
    contour: String,
    /// The tool's radius in the contour's units: positive right of travel, negative left of it; the contour's own `[offset]`
    /// without it
    #[arg(long, value_name = "D", allow_negative_numbers = true)]
    distance: Option<f64>,
    /// Write the result as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<String>,
    /// Draw contour, untrimmed offset, trimmed offset, trim points and what the tool leaves; `-` is standard output
    #[arg(long, value_name = "FILE.svg")]
    svg: Option<String>,
    /// Measure the result again, independently of how it was found; a path that is nearer than |d| is a failure, status 1
    #[arg(long)]
    check: bool,
}

impl OffsetVerb {
    /// Trims, and writes what was asked for.
    pub fn run(self) -> Result<(), Failure> {
        let part = Part::read(&self.contour)?.with_distance(self.distance);
        let (offset, undercuts, result) = self.find(&part)?;
        if let Some(name) = &self.svg {
            let svg = report::offset_picture(&part, &offset, &undercuts).map_err(|error| failed(name, error))?;
            write(name, svg.as_bytes())?;
        }
        if let Some(name) = &self.json {
            json(name, &result)?;
        }
        if ![&self.json, &self.svg].into_iter().any(|name| name.as_deref() == Some("-")) {
            print(&mut io::stdout().lock(), &result).map_err(|error| failed("standard output", error))?;
        }
        match &result.check {
            Some(check) if !check.holds => Err(Failure::Run(too_near(part.name(), &result, check))),
            _ => Ok(()),
        }
    }

    /// Trims the part and measures, while a bar shows that it goes on.
    fn find(&self, part: &Part) -> Result<(Offset, Vec<Undercut>, Trimming), Failure> {
        let bar = super::spinner(&format!("trimming {} segments", part.contour.segments.len()));
        let offset = part.trim()?;
        bar.set_message("looking for what the tool leaves");
        let undercuts = undercuts(&part.contour, &offset);
        let mut result = Trimming::new(&part.contour, &offset, &undercuts, part.units);
        if self.check {
            bar.set_message("measuring the result");
            result = result.checked(&clearance(&part.contour, &offset));
        }
        bar.finish_and_clear();
        Ok((offset, undercuts, result))
    }
}

fn too_near(name: &str, result: &Trimming, check: &Check) -> String {
    let unit = result.units.short();
    format!(
        "{name}: the check failed: at {} the path is {} {unit} from the contour, nearer than |d| = {} {unit}; this is a \
         fault of hodograph, and the contour is worth a report",
        coordinates(check.at),
        check.smallest_clearance,
        result.distance.abs()
    )
}

/// The result for a person.
fn print(out: &mut impl Write, result: &Trimming) -> io::Result<()> {
    print_loops(out, result)?;
    print_undercuts(out, result)?;
    print_reach(out, result)?;
    match &result.check {
        Some(check) => print_check(out, result, check),
        None => Ok(()),
    }
}

fn print_loops(out: &mut impl Write, result: &Trimming) -> io::Result<()> {
    let unit = result.units.short();
    let count = result.loops.len();
    let noun = if count == 1 { "loop" } else { "loops" };
    writeln!(out, "{count} {noun} at distance {} {unit}", result.distance)?;
    writeln!(
        out,
        "{:>5}  {:21}{:>14}{:>18}{:>8}{:>9}",
        "loop",
        "",
        format!("length, {unit}"),
        format!("area, {unit}2"),
        "pieces",
        "corners"
    )?;
    for (number, found) in result.loops.iter().enumerate() {
        let form = match found.orientation {
            Some(Orientation::Ccw) => "closed, anticlockwise",
            Some(Orientation::Cw) => "closed, clockwise",
            None => "open",
        };
        // Less than a thousandth is rounding; adding zero takes a minus from it.
        let area =
            if found.closed { format!("{:.3}", (found.area * 1e3).round() / 1e3 + 0.0) } else { "-".to_string() };
        write!(
            out,
            "{number:>5}  {form:21}{:>14.4}{area:>18}{:>8}{:>9}",
            found.length,
            found.pieces.len(),
            found.corners()
        )?;
        match found.parent {
            Some(parent) => writeln!(out, "  inside loop {parent}")?,
            None => writeln!(out)?,
        }
    }
    Ok(())
}

/// The thickest dozen of the undercut regions.
fn print_undercuts(out: &mut impl Write, result: &Trimming) -> io::Result<()> {
    const MOST: usize = 12;
    let unit = result.units.short();
    let mut worst: Vec<_> = result.undercuts.iter().collect();
    worst.sort_by(|a, b| b.depth.total_cmp(&a.depth));
    for undercut in worst.iter().take(MOST) {
        writeln!(
            out,
            "material stays between segment {} at {} and segment {} at {}: {} {unit} at {}",
            undercut.from.segment,
            plain(undercut.from.parameter),
            undercut.to.segment,
            plain(undercut.to.parameter),
            plain(undercut.depth),
            coordinates(undercut.deepest)
        )?;
    }
    match worst.get(MOST) {
        Some(next) => {
            let rest = worst.len() - MOST;
            writeln!(out, "and in {rest} more places, {} {unit} at most", plain(next.depth))
        }
        None => Ok(()),
    }
}

fn print_reach(out: &mut impl Write, result: &Trimming) -> io::Result<()> {
    let unit = result.units.short();
    match (result.largest_reaching_tool, result.sharp_corners.as_slice()) {
        (None, _) => writeln!(out, "a tool of any radius reaches everything"),
        (Some(0.0), [corner, rest @ ..]) => {
            let more = match rest.len() {
                0 => String::new(),
                1 => ", and so does one more".to_string(),
                more => format!(", and so do {more} more"),
            };
            writeln!(
                out,
                "no tool reaches everything: the sharp corner at node {}, {}, keeps every radius out{more}",
                corner.node,
                coordinates(corner.at)
            )
        }
        (Some(radius), _) => {
            writeln!(out, "the largest tool that reaches everything has radius {} {unit}", plain(radius))
        }
    }
}

fn print_check(out: &mut impl Write, result: &Trimming, check: &Check) -> io::Result<()> {
    let unit = result.units.short();
    writeln!(
        out,
        "measured at {} points: smallest clearance {} {unit} beside |d| = {} {unit}, at {}; largest undercut {} {unit}",
        check.samples,
        check.smallest_clearance,
        result.distance.abs(),
        coordinates(check.at),
        plain(check.largest_undercut)
    )
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed test says where")]

    use super::*;
    use host_sim::trimming::{OnContour, SharpCorner, UndercutResult};
    use host_sim::units::Units;

    fn text(print: impl Fn(&mut Vec<u8>) -> io::Result<()>) -> String {
        let mut out = Vec::new();
        print(&mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    fn result(depths: &[f64]) -> Trimming {
        let undercut = |&depth: &f64| UndercutResult {
            from: OnContour { segment: 3, parameter: 0.42 },
            to: OnContour { segment: 4, parameter: 0.08 },
            depth,
            deepest: [1.0, 2.0],
        };
        Trimming {
            units: Units::Mm,
            distance: 2.0,
            loops: Vec::new(),
            undercuts: depths.iter().map(undercut).collect(),
            largest_undercut: 0.0,
            largest_reaching_tool: None,
            sharp_corners: Vec::new(),
            check: None,
        }
    }

    #[test]
    fn thickest_dozen_is_named_first() {
        let depths: Vec<f64> = (1..=15).map(f64::from).collect();
        let text = text(|out| print_undercuts(out, &result(&depths)));
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 13);
        let first = "material stays between segment 3 at 0.42 and segment 4 at 0.08: 15 mm at (1, 2)";
        assert_eq!((lines[0], lines[12]), (first, "and in 3 more places, 3 mm at most"));
    }

    /// The sentence of a check that fails; its status is that of a failed run.
    #[test]
    fn failed_check_says_where_and_by_how_much() {
        let at = [1.5, -2.0];
        let check = Check {
            holds: false,
            smallest_clearance: 1.99,
            at,
            largest_removed: 0.0,
            largest_undercut: 0.0,
            samples: 9,
        };
        let said = too_near("part.toml", &result(&[]), &check);
        assert!(
            said.starts_with("part.toml: the check failed: at (1.5, -2) the path is 1.99 mm from the contour"),
            "{said}"
        );
        assert!(said.contains("nearer than |d| = 2 mm") && said.lines().count() == 1);
    }

    #[test]
    fn reach_names_the_corner_that_forbids_it() {
        let mut result = result(&[]);
        assert_eq!(text(|out| print_reach(out, &result)), "a tool of any radius reaches everything\n");
        result.largest_reaching_tool = Some(8.0);
        let said = text(|out| print_reach(out, &result));
        assert_eq!(said, "the largest tool that reaches everything has radius 8 mm\n");
        result.largest_reaching_tool = Some(0.0);
        result.sharp_corners = vec![SharpCorner { node: 3, at: [56.0, 30.0] }];
        let said = text(|out| print_reach(out, &result));
        assert!(said.contains("at node 3, (56, 30), keeps every radius out\n"), "{said}");
    }
}

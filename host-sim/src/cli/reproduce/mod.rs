//! `hodograph reproduce`: a published experiment beside its published figures.

mod farouki2018;
mod feed_correction;
mod spline_fit;

use std::fs;

use clap::{Args, ValueEnum};
use host_sim::input::InputError;
use host_sim::report::{self, ReportError};
use host_sim::reproduce::farouki2018::{REDUCTIONS, WEIGHTS, reproduce as farouki};
use host_sim::reproduce::feed_correction::{Airfoil, STEPS, reproduce as feed_correction};
use host_sim::reproduce::spline_fit as spline;
use serde::Serialize;

use super::Failure;
use super::output::{failed, json, write};

/// Run a published experiment again and lay it beside its published figures
#[derive(Args)]
#[command(
    after_help = "Examples:\n  hodograph reproduce farouki2018 --report farouki2018.html\n  hodograph reproduce \
                        feed-correction --report feed-correction.html\n  hodograph reproduce spline-fit --report spline-fit.html"
)]
pub struct Reproduce {
    /// Which experiment
    #[arg(value_enum)]
    name: Name,
    /// With feed-correction: the coordinates of an airfoil, in Selig's form, in the place of NACA 0012
    #[arg(long, value_name = "FILE.dat")]
    airfoil: Option<String>,
    /// Write the result as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<String>,
    /// Write pictures and tables as one HTML file
    #[arg(long, value_name = "FILE.html")]
    report: Option<String>,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Name {
    /// Farouki & Srinathu: feedrate modulation on a trimmed offset, twelve runs
    Farouki2018,
    /// The feed correction polynomial: a fan and an airfoil under every way to interpolate, and what its fits cost
    FeedCorrection,
    /// Toolpath spline approximation: one program of lines as lines, arcs, and splines of every kind within the same limits
    SplineFit,
}

impl Reproduce {
    /// Runs the experiment, and writes what was asked for.
    pub fn run(self) -> Result<(), Failure> {
        if self.airfoil.is_some() && self.name != Name::FeedCorrection {
            let message = "--airfoil belongs to `reproduce feed-correction`; leave it out";
            return Err(Failure::Input(InputError::new("--airfoil", message)));
        }
        match self.name {
            Name::Farouki2018 => {
                let bar = super::progress_of((WEIGHTS.len() * REDUCTIONS.len()) as u64, "run {pos} of {len}");
                let result = farouki(|| bar.inc(1)).map_err(Failure::Run)?;
                bar.finish_and_clear();
                self.show(&result, report::reproduction, farouki2018::print)
            }
            Name::SplineFit => {
                let bar = super::progress_of(spline::STEPS, "way {pos} of {len}");
                let result = spline::reproduce(|| bar.inc(1)).map_err(Failure::Run)?;
                bar.finish_and_clear();
                self.show(&result, report::spline_fit, spline_fit::print)
            }
            Name::FeedCorrection => {
                let airfoil = self.read_airfoil()?;
                let bar = super::progress_of(STEPS, "step {pos} of {len}");
                let result = feed_correction(&airfoil, || bar.inc(1)).map_err(Failure::Run)?;
                bar.finish_and_clear();
                self.show(&result, report::feed_correction, feed_correction::print)
            }
        }
    }

    /// The airfoil of the file that was named, of which a spline can be made; else the one that is known.
    fn read_airfoil(&self) -> Result<Airfoil, Failure> {
        let Some(file) = &self.airfoil else { return Ok(Airfoil::naca0012()) };
        let faulty = |message: String| Failure::Input(InputError::new(file.clone(), message));
        let text = fs::read_to_string(file).map_err(|error| faulty(format!("it cannot be read: {error}")))?;
        let airfoil = Airfoil::from_text(file, &text).map_err(faulty)?;
        airfoil.spline().map_err(|error| faulty(error.to_string()))?;
        Ok(airfoil)
    }

    fn show<R: Serialize>(
        &self,
        result: &R,
        report: fn(&R) -> Result<String, ReportError>,
        print: fn(&R),
    ) -> Result<(), Failure> {
        if let Some(name) = &self.report {
            let html = report(result).map_err(|error| failed(name, error))?;
            write(name, html.as_bytes())?;
        }
        if let Some(name) = &self.json {
            json(name, result)?;
        }
        if self.json.as_deref() != Some("-") {
            print(result);
            if let Some(name) = self.report.as_deref().filter(|&name| name != "-") {
                println!("\nPictures: {name}");
            }
        }
        Ok(())
    }
}

//! `hodograph machine`: checks a machine's file and shows what a controller will use of it.

use std::io::{self, Write};

use clap::Args;
use host_sim::machine::{self, DriveSummary, Summary};
use host_sim::units::plain;
use shared::machine::{End, HomeSwitch, HostLost};

use super::Failure;
use super::output::{failed, json, write};

/// Check a machine's file, show what the controller will use of it, and write the image that the controller keeps
#[derive(Args)]
#[command(after_help = "Example:\n  hodograph machine examples/machine.toml -o router.image")]
pub struct MachineVerb {
    /// The machine, in TOML
    machine: String,
    /// Write the image that the controller keeps; `-` is standard output
    #[arg(short, long, value_name = "IMAGE")]
    output: Option<String>,
    /// Write what the controller will use as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<String>,
}

impl MachineVerb {
    /// Reads, checks, shows and writes.
    pub fn run(self) -> Result<(), Failure> {
        let settings = machine::read(&self.machine)?;
        let image = machine::to_image(&settings).map_err(|error| failed(&self.machine, error))?;
        let summary = Summary::new(&settings, image.len());
        if let Some(name) = &self.output {
            write(name, &image)?;
        }
        if let Some(name) = &self.json {
            json(name, &summary)?;
        }
        if ![&self.json, &self.output].into_iter().any(|name| name.as_deref() == Some("-")) {
            print(&mut io::stdout().lock(), &summary).map_err(|error| failed("standard output", error))?;
        }
        Ok(())
    }
}

/// The summary for a person.
fn print(out: &mut impl Write, machine: &Summary) -> io::Result<()> {
    let host = match machine.host_lost {
        HostLost::Finish => "finishes what is queued",
        HostLost::Brake => "brakes on the path",
    };
    writeln!(out, "{}: {} axes; {host} when its host vanishes", machine.name, machine.axes.len())?;
    writeln!(
        out,
        "switches count after {} ticks, stops have ended after {}; {} bytes are stored",
        machine.debounce_ticks, machine.release_ticks, machine.image_bytes
    )?;
    for axis in &machine.axes {
        let [low, high] = axis.travel;
        writeln!(
            out,
            "{}: {} to {} mm, {} mm/s, {} mm/s2, {} mm/s3",
            axis.name,
            plain(low),
            plain(high),
            plain(axis.velocity),
            plain(axis.acceleration),
            plain(axis.jerk)
        )?;
        match &axis.drive {
            DriveSummary::Step { steps_per_mm, step_rate, most_step_rate } => writeln!(
                out,
                "   {} steps/mm, {} steps/s of {:.0} that its pulses allow",
                plain(*steps_per_mm),
                plain(*step_rate),
                most_step_rate
            )?,
            DriveSummary::Servo { counts_per_mm, following_error } => writeln!(
                out,
                "   {} counts/mm, a following error of {} mm is a fault",
                plain(*counts_per_mm),
                plain(*following_error)
            )?,
        }
        let switches = if axis.switches.is_empty() { "no switch".to_string() } else { axis.switches.join(", ") };
        writeln!(out, "   {switches}")?;
        match &axis.homing {
            Some(home) => writeln!(
                out,
                "   home is {} mm, by the {} at the {} end, in turn {}; runs {:.2} mm onto the switch, finds it to {:.4} mm",
                plain(home.position),
                if home.switch == HomeSwitch::Limit { "limit switch" } else { "home switch" },
                if home.toward == End::Low { "low" } else { "high" },
                home.order,
                home.overrun,
                home.resolution
            )?,
            None => writeln!(out, "   no homing: its position stays unknown")?,
        }
    }
    Ok(())
}

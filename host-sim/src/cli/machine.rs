//! `hodograph machine`: checks a machine's file, shows what a controller will use of it, and brings it there and back.

use std::io::{self, Write};

use clap::Args;
use host_sim::machine::transfer::{self, TransferError};
use host_sim::machine::{self, DriveSummary, Summary};
use host_sim::session::Session;
use host_sim::transport;
use host_sim::units::plain;
use shared::machine::{End, HomeSwitch, HostLost, MachineSettings};

use super::Failure;
use super::output::{failed, json, write};

/// Check a machine's file, show what the controller will use of it, and bring it to a controller or back
#[derive(Args)]
#[command(after_help = "Examples:
  hodograph machine examples/machine.toml
  hodograph machine examples/machine.toml --port tcp:localhost:4750 --write
  hodograph machine --port tcp:localhost:4750 --read -o router.toml")]
pub struct MachineVerb {
    /// The machine, in TOML
    #[arg(required_unless_present = "read", conflicts_with = "read")]
    machine: Option<String>,
    /// Write the image that the controller keeps, or with --read the machine's file; `-` is standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<String>,
    /// Write what the controller will use as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<String>,
    #[command(flatten)]
    wire: Wire,
}

/// Where a controller is, and what is asked of it.
#[derive(Args)]
struct Wire {
    /// The controller: a serial port, a file that is a line, or `tcp:HOST:PORT`
    #[arg(long, requires = "direction")]
    port: Option<String>,
    /// Bits per second of a serial port
    #[arg(long, default_value_t = 921_600)]
    baud: u32,
    /// Have the controller keep this machine
    #[arg(long, requires = "port", group = "direction")]
    write: bool,
    /// Read the machine that the controller keeps
    #[arg(long, requires = "port", group = "direction")]
    read: bool,
}

impl MachineVerb {
    /// Reads, checks, shows and writes.
    pub fn run(self) -> Result<(), Failure> {
        let settings = match &self.machine {
            Some(name) => machine::read(name)?,
            None => self.wire.read()?,
        };
        let name = self.machine.as_deref().or(self.wire.port.as_deref()).unwrap_or_default();
        let image = machine::to_image(&settings).map_err(|error| failed(name, error))?;
        let summary = Summary::new(&settings, image.len());
        if self.wire.write {
            self.wire.write(&image)?;
        }
        if self.wire.read {
            let text = machine::to_toml(&settings).map_err(|error| failed(name, error))?;
            write(self.output.as_deref().unwrap_or("-"), text.as_bytes())?;
        } else if let Some(name) = &self.output {
            write(name, &image)?;
        }
        if let Some(name) = &self.json {
            json(name, &summary)?;
        }
        let silent = self.wire.read || [&self.json, &self.output].into_iter().any(|name| name.as_deref() == Some("-"));
        if !silent {
            print(&mut io::stdout().lock(), &summary).map_err(|error| failed("standard output", error))?;
            if self.wire.write {
                println!("the controller keeps it");
            }
        }
        Ok(())
    }
}

impl Wire {
    /// Speaks to the controller in a session.
    fn speak<T>(&self, what: impl FnOnce(&mut Session<'_>) -> Result<T, TransferError>) -> Result<T, Failure> {
        let port = self.port.as_deref().unwrap_or_default();
        let mut line = transport::open(port, self.baud)?;
        let outcome =
            Session::open(&mut *line).map_err(TransferError::Stream).and_then(|mut session| what(&mut session));
        outcome.map_err(|error| failed(port, error))
    }

    fn read(&self) -> Result<MachineSettings, Failure> {
        self.speak(transfer::read)
    }

    fn write(&self, image: &[u8]) -> Result<(), Failure> {
        self.speak(|session| transfer::write(session, image))
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

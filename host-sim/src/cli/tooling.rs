//! Options of the tools that programs compensate for.

use clap::{Args, ValueEnum};
use host_sim::compensation::{Gouge, ToolTable};
use host_sim::input::InputError;
use host_sim::strokes::Tooling;
use host_sim::units::Units;

/// What the command line says of tools.
#[derive(Args)]
pub struct Tools {
    /// The tool table of a program with G41 or G42, as LinuxCNC has it: T1 P1 D6.0
    #[arg(long, value_name = "FILE.tbl")]
    tools: Option<String>,
    /// The unit of the tool table
    #[arg(long, value_enum, default_value_t = TableUnits::Mm)]
    tool_units: TableUnits,
    /// What is done where a tool cannot follow its contour
    #[arg(long, value_enum, default_value_t = OnGouge::Trim)]
    gouge: OnGouge,
}

#[derive(Clone, Copy, ValueEnum)]
enum TableUnits {
    Mm,
    Inch,
}

#[derive(Clone, Copy, ValueEnum)]
enum OnGouge {
    /// What it cannot reach is left out, with a warning
    Trim,
    /// The program is refused
    Error,
}

impl Tools {
    /// Reads the table, if there is one. Errors: it cannot be read.
    pub fn read(&self) -> Result<Tooling, InputError> {
        let units = match self.tool_units {
            TableUnits::Mm => Units::Mm,
            TableUnits::Inch => Units::Inch,
        };
        let tools = self.tools.as_deref().map(|name| ToolTable::read(name, units)).transpose()?.unwrap_or_default();
        let gouge = match self.gouge {
            OnGouge::Trim => Gouge::Trim,
            OnGouge::Error => Gouge::Refuse,
        };
        Ok(Tooling { tools, gouge })
    }
}

//! `hodograph reproduce`: a published experiment beside its published figures.

use clap::{Args, ValueEnum};
use host_sim::report;
use host_sim::reproduce::farouki2018::{self, REDUCTIONS, Reproduction, Table, WEIGHTS};

use super::Failure;
use super::output::{failed, json, write};

/// Run a published experiment again and lay it beside its published figures
#[derive(Args)]
#[command(after_help = "Example:\n  hodograph reproduce farouki2018 --report farouki2018.html")]
pub struct Reproduce {
    /// Which experiment
    #[arg(value_enum)]
    name: Name,
    /// Write the result as JSON; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<String>,
    /// Write pictures and tables as one HTML file
    #[arg(long, value_name = "FILE.html")]
    report: Option<String>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Name {
    /// Farouki & Srinathu: feedrate modulation on a trimmed offset, twelve runs
    Farouki2018,
}

impl Reproduce {
    /// Runs the experiment, and writes what was asked for.
    pub fn run(self) -> Result<(), Failure> {
        let Name::Farouki2018 = self.name;
        let bar = super::progress_of((WEIGHTS.len() * REDUCTIONS.len()) as u64, "run {pos} of {len}");
        let result = farouki2018::reproduce(|| bar.inc(1)).map_err(Failure::Run)?;
        bar.finish_and_clear();
        if let Some(name) = &self.report {
            let html = report::reproduction(&result).map_err(|error| failed(name, error))?;
            write(name, html.as_bytes())?;
        }
        if let Some(name) = &self.json {
            json(name, &result)?;
        }
        if self.json.as_deref() != Some("-") {
            print(&result);
            if let Some(name) = self.report.as_deref().filter(|&name| name != "-") {
                println!("\nPictures of all twelve runs: {name}");
            }
        }
        Ok(())
    }
}

fn print(result: &Reproduction) {
    println!("Farouki & Srinathu (2018), twelve runs at 1024 Hz; machine: {}", result.plant);
    for table in &result.tables {
        print_table(table);
    }
}

/// Every cell as: here, published, relative difference.
fn print_table(table: &Table) {
    let decimals = table.decimals;
    println!("\n{}, {} (here | published | difference)", table.title, table.unit);
    print!("{:8}", "");
    for f in REDUCTIONS {
        print!("{:>28}", format!("f = {f}"));
    }
    println!();
    for ((w, measured), published) in WEIGHTS.iter().zip(&table.measured).zip(&table.published) {
        print!("w = {w:<4}");
        for (here, paper) in measured.iter().zip(published) {
            print!("{here:>10.decimals$} |{paper:>8} |{:>+6.1} %", 100.0 * (here / paper - 1.0));
        }
        println!();
    }
    if let Some((name, cells)) = &table.beside {
        println!("{name}:");
        for (w, cells) in WEIGHTS.iter().zip(cells) {
            print!("w = {w:<4}");
            for cell in cells {
                print!("{cell:>10.decimals$}{:18}", "");
            }
            println!();
        }
    }
}

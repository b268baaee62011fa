//! The tables of the twelve runs, as text.

use host_sim::reproduce::farouki2018::{REDUCTIONS, Reproduction, Table, WEIGHTS};

/// Prints them.
pub(super) fn print(result: &Reproduction) {
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

//! `hodograph <verb>`: everything that a person runs on a host.

use std::process::ExitCode;

use clap::Parser as _;

mod cli;

fn main() -> ExitCode {
    leave_with_the_reader();
    match cli::Cli::parse().run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("{failure}");
            failure.code()
        }
    }
}

/// Ends without a word where whoever reads the output has seen enough, as `head` has: `println!` knows no other way than to panic.
fn leave_with_the_reader() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        let is_gone = info
            .payload()
            .downcast_ref::<String>()
            .is_some_and(|text| text.starts_with("failed printing to stdout") && text.contains("Broken pipe"));
        if is_gone {
            // What `head` leaves behind it of a shell's own tools: killed by SIGPIPE.
            std::process::exit(128 + 13);
        }
        usual(info);
    }));
}

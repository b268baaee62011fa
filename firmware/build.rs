//! Hands the linker its scripts: `memory.x` of the top-level directory, the board's own where it differs, cortex-m-rt's and defmt's.

use std::path::Path;

fn main() {
    let manifest = std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    let top = Path::new(&manifest).join("..");
    println!("cargo::rustc-link-search={}", top.display());
    println!("cargo::rerun-if-changed={}", top.join("memory.x").display());
    // Before `link.x`, which takes in the default board's map: that asks for what is said here.
    if std::env::var_os("CARGO_FEATURE_NUCLEO_F446RE").is_some() {
        let map = Path::new(&manifest).join("src/hardware/f446/memory.x");
        println!("cargo::rerun-if-changed={}", map.display());
        println!("cargo::rustc-link-arg-bins=-T{}", map.display());
    }
    for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
}

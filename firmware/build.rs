//! Hands the linker its scripts: `memory.x` of the top-level directory, cortex-m-rt's and defmt's.

use std::path::Path;

fn main() {
    let manifest = std::env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    let top = Path::new(&manifest).join("..");
    println!("cargo::rustc-link-search={}", top.display());
    println!("cargo::rerun-if-changed={}", top.join("memory.x").display());
    for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
        println!("cargo::rustc-link-arg-bins={argument}");
    }
}

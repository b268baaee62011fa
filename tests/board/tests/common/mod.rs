//! What the tests of the target share.

use std::path::{Path, PathBuf};

use board::image::Image;
use board::machine::Mounting;
use shared::fixed::{Fixed, Position};
use shared::loader::Loader;
use shared::machine::MachineSettings;
use shared::piece::{Header, Piece};

/// The top-level directory.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The image, as `cargo xtask build` left it.
#[allow(dead_code, reason = "each file of tests has a copy of this module, and not all need it")]
pub fn image() -> Image {
    built("firmware")
}

/// A machine of two servo axes.
#[allow(dead_code, reason = "each file of tests has a copy of this module, and not all need it")]
pub fn servos() -> Mounting {
    Mounting::new(&machine("mill-servos.toml")).unwrap()
}

/// A machine of three step axes.
#[allow(dead_code, reason = "each file of tests has a copy of this module, and not all need it")]
pub fn steps() -> Mounting {
    Mounting::new(&machine("mill-steps.toml")).unwrap()
}

/// A machine among the examples.
#[allow(dead_code, reason = "each file of tests has a copy of this module, and not all need it")]
pub fn machine(name: &str) -> MachineSettings {
    host_sim::machine::read(root().join("examples").join(name).to_str().unwrap()).unwrap()
}

/// A machine among the examples with normally closed limit switches at both ends of its axes, and the faults of its drives.
#[allow(dead_code, reason = "each file of tests has a copy of this module, and not all need it")]
pub fn machine_with(name: &str) -> Mounting {
    let file = root().join("examples").join(name);
    let text = std::fs::read_to_string(&file).unwrap();
    let all = "enable = {}\nlow_limit = {}\nhigh_limit = {}\ndrive_fault = {}";
    Mounting::new(&host_sim::machine::from_toml(name, &text.replace("enable = {}", all)).unwrap()).unwrap()
}

/// Random numbers in a range, the same every time: a linear congruential generator, Knuth's.
#[allow(dead_code, reason = "each file of tests has a copy of this module, and not all need it")]
pub fn random(range: std::ops::Range<u64>) -> impl Iterator<Item = u64> {
    let mut seed = 20_181_004_u64;
    std::iter::repeat_with(move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        range.start + (((seed >> 33) * (range.end - range.start)) >> 31)
    })
}

/// Where the firmware takes the machine to stand when a job begins: at the path's first point, which the loader reports to the tick.
#[allow(dead_code, reason = "each file of tests has a copy of this module, and not all need it")]
pub fn start_of(header: &Header<f32>, pieces: &[Piece<f32>]) -> Position {
    let mut loader = Loader::new(header, shared::TICK).unwrap();
    loader.load(&pieces[0]).unwrap();
    let [x, y] = loader.start().unwrap();
    [x, y, Fixed(0)]
}

fn built(name: &str) -> Image {
    let target = std::env::var_os("HODOGRAPH_TARGET").map_or_else(|| root().join("target"), PathBuf::from);
    let elf = target.join("thumbv7em-none-eabihf/firmware").join(name);
    assert!(
        elf.is_file(),
        "there is no image yet; `cargo xtask build` makes it, and `cargo xtask test` runs these tests"
    );
    Image::read(&elf).unwrap()
}

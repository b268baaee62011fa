//! Which source each executed instruction came from.
//!
//! The image keeps its line tables, and with them the chain of inlined calls at every address. An instruction belongs to the
//! innermost call of a stage's own source file; helpers that any stage uses (polynomials, complex numbers, fixed point, the standard
//! library) count for the stage that called them. What the optimizer moved or merged belongs to where the line table says it came
//! from: the sum is exact, the border between two stages is good to a few instructions.

use std::collections::BTreeMap;

use addr2line::Loader;

use crate::Error;
use crate::image::Image;

/// The stages of a tick, in the order in which a setpoint passes them.
pub const STAGES: [(&str, &[&str]); 9] = [
    ("executor", &["shared/src/executor.rs", "shared/src/motion.rs", "shared/src/supply.rs"]),
    ("pace", &["shared/src/pace/mod.rs", "shared/src/pace/lattice.rs"]),
    ("interpolator", &["shared/src/interpolator.rs", "shared/src/accumulator.rs"]),
    ("feed law", &["shared/src/feed.rs", "shared/src/profile.rs"]),
    (
        "curve",
        &["shared/src/active.rs", "shared/src/active/ph.rs", "shared/src/active/spline.rs", "shared/src/further.rs"],
    ),
    ("servo", &["shared/src/servo.rs"]),
    ("safety", &["shared/src/safety/mod.rs", "shared/src/safety/table.rs", "shared/src/safety/debounce.rs"]),
    ("control", &["shared/src/control/mod.rs", "shared/src/control/axes.rs"]),
    ("rest", &[]),
];

/// Functions that belong to another stage than their file.
const FUNCTIONS: [(&str, &str, &str); 3] = [
    ("ActivePiece<", "::factor", "feed law"),
    ("ActivePiece<", "::fraction", "feed law"),
    ("ActivePiece<", "::seek", "interpolator"),
];

/// Tells stages by addresses.
pub struct Stages {
    loader: Loader,
}

impl Stages {
    /// The stages of `image`.
    pub fn new(image: &Image) -> Result<Self, Error> {
        let loader = Loader::new(image.path());
        Ok(Self { loader: loader.map_err(|error| Error::new(format!("{}: {error}", image.path().display())))? })
    }

    /// The stage of the instruction at `address`.
    pub fn stage_of(&self, address: u32) -> &'static str {
        let Ok(mut frames) = self.loader.find_frames(u64::from(address)) else { return "rest" };
        // From the innermost call outwards.
        while let Ok(Some(frame)) = frames.next() {
            let name = frame.function.as_ref().and_then(|name| name.demangle().ok()).unwrap_or_default();
            let apart = FUNCTIONS.iter().find(|(of, function, _)| name.contains(of) && name.contains(function));
            if let Some((_, _, stage)) = apart {
                return stage;
            }
            let Some(file) = frame.location.as_ref().and_then(|location| location.file) else { continue };
            let file = file.replace('\\', "/");
            if let Some((stage, _)) = STAGES.iter().find(|(_, files)| files.iter().any(|name| file.ends_with(name))) {
                return stage;
            }
        }
        "rest"
    }

    /// Whether the instruction at `address` belongs to a function that contains one of `names`, itself or in what it was inlined into.
    pub fn is_within(&self, address: u32, names: &[&str]) -> bool {
        let Ok(mut frames) = self.loader.find_frames(u64::from(address)) else { return false };
        while let Ok(Some(frame)) = frames.next() {
            let name = frame.function.as_ref().and_then(|name| name.demangle().ok()).unwrap_or_default();
            if names.iter().any(|part| name.contains(part)) {
                return true;
            }
        }
        false
    }

    /// Instructions per stage and tick, rounded, of the counts of executed instructions over `ticks` ticks.
    pub fn attribute(&self, executed: &BTreeMap<u32, u32>, ticks: u32) -> BTreeMap<&'static str, u32> {
        let mut sums: BTreeMap<&'static str, u32> = STAGES.iter().map(|&(name, _)| (name, 0)).collect();
        for (&address, &count) in executed {
            *sums.entry(self.stage_of(address)).or_default() += count;
        }
        let ticks = ticks.max(1);
        sums.into_iter().map(|(name, sum)| (name, (sum + ticks / 2) / ticks)).collect()
    }
}

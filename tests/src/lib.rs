//! What the acceptance tests share: pieces cut from segments for either scalar, a runner of the kernel, and oracles.
//!
//! [`draft`] says what a planner knows of a piece and cuts it; [`run`] sends pieces through loader and executor, [`stock`] is a queue
//! that a test fills; [`oracle`] integrates equation (21) from the paper's formulas alone, with no line in common with the kernel.
//!
//! For offsets: [`chain`] builds contours by hand and [`contours`] at random, [`simple`] decides whether one crosses itself,
//! [`properties`] holds a trimmed offset against what must be true of it, [`expected`] against closed forms; [`winding`] and
//! [`largest_disc`] serve these.
//!
//! For programs: [`nurbs`] measures B-splines, [`canonical`] reads what LinuxCNC makes of a program.
//!
//! For the link: [`noisy_line`] loses, doubles, reorders, damages and cuts frames; [`link_script`] makes conversations of any bytes, and
//! [`strict_machine`] stands behind the endpoint and trusts nothing that it is handed. The targets of `fuzz/` use both.
//!
//! For programs: [`program_items`] is what the readers promise of any bytes, and [`program_strokes`] what is promised behind them; the targets
//! of `fuzz/` use both.
//!
//! For fits: [`two_sided`] measures curves beside the polylines that they stand for. [`stopwatch`] serves ratios of times.
#![forbid(unsafe_code)]

pub mod bench;
pub mod canonical;
pub mod chain;
pub mod contours;
pub mod draft;
pub mod expected;
pub mod largest_disc;
pub mod link_script;
pub mod noisy_line;
pub mod nurbs;
pub mod oracle;
pub mod program_items;
pub mod program_strokes;
pub mod properties;
pub mod random;
pub mod run;
pub mod simple;
pub mod stock;
pub mod stopwatch;
pub mod strict_machine;
pub mod two_sided;
pub mod winding;

pub use draft::Draft;
pub use host_sim::contour::Contour;
pub use run::{Run, Scalar};

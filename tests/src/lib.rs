//! What the acceptance tests share: pieces cut from segments for either scalar, a runner of the kernel, and an oracle.
//!
//! [`draft`] says what a planner knows of a piece and cuts it; [`run`] sends pieces through loader and executor; [`oracle`]
//! integrates equation (21) from the paper's formulas alone, with no line in common with the kernel.
#![forbid(unsafe_code)]

pub mod draft;
pub mod oracle;
pub mod run;
pub mod stock;

pub use draft::Draft;
pub use run::{Run, Scalar};

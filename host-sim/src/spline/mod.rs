//! Splines through points, and how they are driven at a constant feed.
//!
//! | module | what |
//! | --- | --- |
//! | [`interpolant`] | C2 cubics and C3 quintics through points, open and closed, by chord length or nearly by arc length |
//! | [`methods`] | natural, Taylor, corrected and iterative interpolation of one spline, tick by tick |
//! | [`constrained`] | the earlier fit of the correction polynomial: 14 equations, FC(14) |
//! | [`counted`] | a scalar that counts what is done with it |

pub mod constrained;
pub mod counted;
pub mod interpolant;
pub mod methods;
mod tridiagonal;

pub use interpolant::{Interpolant, Parametrisation, SplineError};

//! Polynomial splines at a constant feed: the feed correction polynomial u(s).
//!
//! A polynomial curve has no polynomial arc length, so the parameter that lies a given way along it has no formula. The feed
//! correction polynomial that Erkorkmaz & Altintas introduced in 2005 comes near it (equations FC(n), restated in the design's section 5):
//! it meets u, du/ds and d2u/ds2 at both ends of a segment exactly, so that velocity and acceleration of the axes are continuous
//! across segments, and fits what is left of its coefficients to the arc length between.
//!
//! | module | what |
//! | --- | --- |
//! | [`segment`] | a quintic (or cubic) in so many dimensions: points, derivatives, arc length, and u_s, u_ss, u_sss |
//! | [`correction`] | u(s) as the tick evaluates it, about the middle of a segment |
//! | [`fit`](mod@fit) | u(s) of the fifth, seventh and ninth order from two samples: what the controller does as a segment arrives |
//! | [`published`] | the fit as it was published, in powers of s and from any number of samples |

pub mod correction;
pub mod fit;
pub mod published;
pub mod segment;

pub use correction::{Correction, CorrectionOrder};
pub use fit::{Fit, fit};
pub use segment::{Ends, PolynomialSegment};

//! How fast a path may be run within a machine's limits.
//!
//! | module | what |
//! | --- | --- |
//! | [`limits`] | what axes and path bear |
//! | [`course`] | the centre's way as a grid: direction, curvature and the job's own feed at each place |
//! | [`bound`](mod@bound) | the least time that velocities and accelerations leave: what no plan can be faster than |
//! | [`demand`] | what a simulated run asks of a machine |

pub mod bound;
pub mod course;
pub mod demand;
pub mod limits;

pub use bound::{Bound, bound};
pub use course::Course;
pub use demand::{Demand, Recorder};
pub use limits::Limits;

//! How fast a path may be run within a machine's limits.
//!
//! | module | what |
//! | --- | --- |
//! | [`limits`] | what axes and path bear |
//! | [`course`] | the centre's way as a grid: direction, curvature and the job's own feed at each place |
//! | [`bound`] | the least time that velocities and accelerations leave: what no plan can be faster than |

pub mod bound;
pub mod course;
pub mod limits;

pub use bound::{Bound, bound};
pub use course::Course;
pub use limits::Limits;

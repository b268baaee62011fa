//! How fast a path may be run within a machine's limits.
//!
//! | module | what |
//! | --- | --- |
//! | [`limits`] | what axes and path bear |
//! | [`course`] | the centre's way as a grid: direction, curvature and the job's own feed at each place |
//! | [`caps`] | the largest speed at each place by itself, and what says so |
//! | [`bound`](mod@bound) | the least time that velocities and accelerations leave: what no plan can be faster than |
//! | `smooth` | lowers a speed profile until no jerk is above its limit |
//! | `grid` | how near to each other the places of a plan stand |
//! | [`law`] | the profiles of pieces that make such speeds |
//! | `draft` | one attempt: such speeds and laws, and where they ask for too much |
//! | [`manner`] | where a path rests, and how it begins and ends |
//! | [`planner`] | all of that for a path: drafts until one keeps its limits |
//! | [`budget`] | a plan that keeps a plant's contour error within a budget |
//! | [`streamed`] | the same for a path of any length, in the same memory |
//! | [`demand`] | what a simulated run asks of a machine |

pub mod bound;
pub mod budget;
pub mod caps;
pub mod course;
pub mod demand;
mod draft;
mod grid;
pub mod law;
pub mod limits;
pub mod manner;
pub mod planner;
mod smooth;
pub mod streamed;

pub use bound::{Bound, bound};
pub use budget::{BudgetError, Budgeted, Response, within_budget};
pub use course::Course;
pub use demand::{Demand, Recorder};
pub use limits::Limits;
pub use manner::{Manner, Rests};
pub use planner::{Plan, PlanError, plan, planned};
pub use streamed::Streamed;

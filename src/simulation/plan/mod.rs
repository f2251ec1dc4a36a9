//! What a scene calls for: its parts, what they take, and what is built of them.

mod demand;
mod effects;
mod estimate;
mod fitted;
mod memory;
mod parts;
mod report;

pub use demand::demand;
pub use parts::{Plan, PlannedModel, flow_solver};
pub use report::PlanReport;

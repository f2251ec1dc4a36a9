//! What a scene calls for: its parts, what they take, and what is built of them.

mod chains;
mod demand;
mod effects;
mod estimate;
mod fitted;
mod forecast;
mod interactions;
mod memory;
mod modes;
mod parts;
mod protocol;
mod report;
mod resolve;
mod scalar;
mod surroundings;

pub use demand::demand;
pub use forecast::Forecast;
pub use parts::{Plan, PlannedModel, flow_solver};
pub use report::PlanReport;

//! The direct way to the flow and the scalar: a mesh that fits the bodies, moved along with them, and a direct solver.

mod flow;
mod history;
mod inclusions;
mod interpolation;
mod plane;

pub use flow::FittedFlow;

pub use inclusions::{FittedInclusions, size as scalar_size};
pub use plane::size as flow_size;

//! The direct way to the flow and the scalar: a mesh that fits the bodies, moved along with them, and a direct solver.

mod flow;
mod inclusions;
mod sampling;

pub use flow::{FittedFlow, size as flow_size};
pub use inclusions::{FittedInclusions, size as scalar_size};

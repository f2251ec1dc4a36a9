//! Studies: how solvers scale, and how far known answers are met.

mod conditioning;
mod scaling;
mod validation;

pub use conditioning::{ConditioningRange, conditioning};
pub use scaling::{Network, ScalingOptions, scaling};
pub use validation::{Case, cases, validation};

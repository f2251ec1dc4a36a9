//! Studies: how solvers scale, how hard their systems are, and how far known answers are met.

mod conditioning;
mod cost;
mod fit;
mod inverses;
mod launcher;
mod scaling;
mod validation;

pub use conditioning::{ConditioningOptions, conditioning};
pub use cost::{CostOptions, cost};
pub use inverses::{InverseOptions, inverses};
pub use scaling::{Network, ScalingOptions, scaling};
pub use validation::{Case, cases, validation};

//! Studies: how solvers scale, and how far known answers are met.

mod conditioning;
mod validation;

pub use conditioning::{ConditioningRange, conditioning};
pub use validation::{Case, cases, validation};

//! Studies: what a method costs and how it scales.

mod conditioning;

pub use conditioning::{ConditioningRange, conditioning};

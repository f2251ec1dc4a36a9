//! The exact law in an island: sweeps, and an interior point.

pub mod bordered;
pub mod exact;
pub mod interior_point;
pub mod pairs;
pub mod sweeps;

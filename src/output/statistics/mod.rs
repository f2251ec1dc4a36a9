//! Tables and charts of what a run measures of places and velocities, over its frames.

pub mod autocorrelation;
pub mod displacements;
pub mod pairs;
pub mod profiles;
pub mod structure_factor;

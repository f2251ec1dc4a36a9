//! Outputs that measure places and velocities over the frames of a run.

pub mod autocorrelation;
mod configurations;
pub mod displacements;
pub mod pairs;
pub mod profiles;
pub mod structure_factor;

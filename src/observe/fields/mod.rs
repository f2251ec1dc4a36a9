//! Velocities, vorticity and dissipation of the flow, at points and in cells.

pub mod cells;
pub mod dissipation;
pub mod faces;
pub mod probe;
pub mod sample;
pub mod vorticity;

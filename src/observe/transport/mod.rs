//! Mean square displacements and velocity autocorrelation of bodies.

pub mod autocorrelation;
pub mod displacements;

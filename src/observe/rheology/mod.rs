//! The stress of a suspension, its parts and what follows from it.

pub mod inertia;
pub mod parts;
pub mod stress;
pub mod viscosity;

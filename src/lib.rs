//! turbid
pub mod error;
#[allow(unsafe_code)]
pub mod petsc;
pub mod parallel;
pub mod geometry;
pub mod grid;
pub mod surface;
pub mod body;
pub mod flow;
pub mod constraint;
pub mod simulation;

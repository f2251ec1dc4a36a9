//! turbid
pub mod body;
pub mod constraint;
pub mod error;
pub mod flow;
pub mod geometry;
pub mod grid;
pub mod parallel;
#[allow(unsafe_code)]
pub mod petsc;
pub mod scene;
pub mod simulation;
pub mod surface;

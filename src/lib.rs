//! turbid
pub mod error;
#[allow(unsafe_code)]
pub mod petsc;
pub mod parallel;
pub mod geometry;
pub mod grid;
pub mod flow;

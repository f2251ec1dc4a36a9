//! Particles in viscous flow, particle by particle, on grids that ignore them.
//!
//! The modules stand in the order of the floors: each imports only from those above it in this list.

// floor 0: the machine
pub mod error;
pub mod parallel;
#[allow(unsafe_code)]
pub mod petsc;
// floor 1: where things are
pub mod geometry;
pub mod grid;
// floor 2: what is on a surface, what a body is
pub mod body;
pub mod surface;
// floor 3: physics; siblings that never import each other
pub mod constraint;
pub mod contact;
pub mod flow;
// floor 4: what to simulate, and the machinery
pub mod scene;
pub mod simulation;
// floor 5: look, never touch
pub mod observe;
pub mod output;
pub mod run;
pub mod study;
// floor 6: words become calls
pub mod cli;

//! What a solve costs, and who is told of its iterations.

use super::work::Stages;
use crate::petsc::Report;

/// Told of each iteration of a linear solver and its relative residual.
pub type ResidualMonitor<'a> = &'a mut dyn FnMut(usize, f64);

/// What a solve cost on this rank, in seconds, and how it converged.
#[derive(Debug, Clone, Copy, Default)]
pub struct Cost {
    /// Matrices and approximate inverses of the box, once per run.
    pub setup: f64,
    /// Jump corrections of the bodies.
    pub assembly: f64,
    /// Bodies of this rank whose jump corrections were assembled: those that moved, and their near neighbours.
    pub assembled: usize,
    /// The Krylov solver, everything included.
    pub krylov: Report,
    /// Parts of it.
    pub stages: Stages,
    /// Unknowns of the grid on all ranks.
    pub grid_unknowns: usize,
    /// Multipliers of bodies on all ranks.
    pub multiplier_unknowns: usize,
    /// Meshes that were made so far; none by methods whose grid ignores bodies.
    pub meshes: usize,
}

//! How a flow with inertia goes on from its last solution.

use crate::system::Level;
use crate::{error::Result, interaction::Wrench, petsc::Vector};

/// What the last solution of a flow with inertia says of the steps to come. Every function is collective.
pub trait Evolution<const D: usize> {
    /// The longest step from it that the flow allows, with forces on all bodies besides those of the setup (none if empty).
    ///
    /// # Errors
    /// PETSc fails.
    fn longest_step(&self, pushes: &[Wrench<D>]) -> Result<f64>;

    /// The solution itself, where it lies on a grid.
    fn on_grid(&self) -> Option<&dyn EvolutionOnGrid<D>>;
}

/// The last solution of a flow with inertia on a grid that ignores bodies. Every function is collective.
pub trait EvolutionOnGrid<const D: usize> {
    /// The solutions from which the next step starts, the last one first.
    fn levels(&self) -> Vec<&Level<D>>;

    /// Cells that the last solution passes in a step; nothing before there is one.
    ///
    /// # Errors
    /// PETSc fails.
    fn courant(&self, step: f64) -> Result<Option<f64>>;

    /// The last flow as far as jump functions extend that outside bodies into them; nothing without them.
    ///
    /// # Errors
    /// PETSc fails.
    fn extended_flow(&self) -> Result<Option<Vector>>;

    /// The force that the last step lost: what rows beside bodies that move do not pass on to their neighbours.
    fn momentum_residual(&self) -> f64;

    /// Thickness of the thinnest layer that the last solution has on a body, in cells, infinite where none is known; nothing without jump functions.
    ///
    /// # Errors
    /// PETSc fails.
    fn thinnest_layer(&self) -> Result<Option<f64>>;
}

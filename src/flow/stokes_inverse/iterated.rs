//! The hypre inverse iterated to a tolerance: as good as exact, and dearer.
//!
//! It shows what the multipliers alone cost: with it the coupled solver iterates as if on them.

use super::{FluidSystem, Stokes, StokesInverse, method::by_multigrid};
use crate::{error::Result, grid::Grid, petsc::Vector};

/// Iterations allowed for one application.
const MOST_ITERATIONS: usize = 200;

/// An inverse exact to a tolerance.
pub struct IteratedInverse<const D: usize> {
    cycle: Box<dyn StokesInverse<D>>,
    tolerance: f64,
}

impl<const D: usize> IteratedInverse<D> {
    /// Sets up the cycle that is iterated until the relative residual is below `tolerance`.
    pub fn new(stokes: &Stokes<D>, grid: &Grid<D>, tolerance: f64) -> Result<IteratedInverse<D>> {
        Ok(IteratedInverse { cycle: by_multigrid(stokes, grid)?, tolerance })
    }
}

impl<const D: usize> StokesInverse<D> for IteratedInverse<D> {
    fn precondition(&mut self, stokes: &Stokes<D>, rows: &Vector, output: &mut Vector) -> Result<()> {
        // rows that are all rounding noise have a mean as large as themselves, which no solution can meet
        let mut projected = rows.copied()?;
        stokes.project(&mut projected)?;
        output.fill(0.0)?;
        FluidSystem { stokes, inverse: Some(self.cycle.as_mut()) }.solve(&projected, output, self.tolerance, MOST_ITERATIONS)?;
        Ok(())
    }

    fn exact(&self) -> bool {
        true
    }
}

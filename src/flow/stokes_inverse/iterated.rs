//! An approximate inverse iterated to a tolerance: as good as exact, and dearer.
//!
//! It shows what the multipliers alone cost: with it the coupled solver iterates as if on them.

use super::{FluidSystem, Stokes, StokesInverse};
use crate::{error::Result, petsc::Vector};

/// Iterations allowed for one application.
const MOST_ITERATIONS: usize = 200;

/// An inverse exact to a tolerance.
pub struct IteratedInverse<const D: usize> {
    approximate: Box<dyn StokesInverse<D>>,
    tolerance: f64,
}

impl<const D: usize> IteratedInverse<D> {
    /// That of an approximate inverse, which is applied until the relative residual is below `tolerance`.
    pub fn new(approximate: Box<dyn StokesInverse<D>>, tolerance: f64) -> IteratedInverse<D> {
        IteratedInverse { approximate, tolerance }
    }
}

impl<const D: usize> StokesInverse<D> for IteratedInverse<D> {
    fn precondition(&mut self, stokes: &Stokes<D>, rows: &Vector, output: &mut Vector) -> Result<()> {
        // rows that are all rounding noise have a mean as large as themselves, which no solution can meet
        let mut projected = rows.copied()?;
        stokes.project(&mut projected)?;
        output.fill(0.0)?;
        FluidSystem { stokes, inverse: Some(self.approximate.as_mut()) }.solve(&projected, output, self.tolerance, MOST_ITERATIONS)?;
        Ok(())
    }

    fn exact(&self) -> bool {
        true
    }
}

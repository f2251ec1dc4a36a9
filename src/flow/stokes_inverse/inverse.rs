//! What an inverse of the Stokes operator does.

use super::Stokes;
use crate::{error::Result, petsc::Vector};

/// An approximate inverse of [`Stokes`]: a fixed linear map from balanced rows to fluid vectors.
///
/// Its output has no mean pressure, and in a fully periodic box no mean velocity.
pub trait StokesInverse<const D: usize> {
    /// `output = K^ rows`, where `rows` are balanced.
    fn precondition(&mut self, stokes: &Stokes<D>, rows: &Vector, output: &mut Vector) -> Result<()>;

    /// Replaces balanced rows by `K^` times them.
    fn replace(&mut self, stokes: &Stokes<D>, fluid: &mut Vector) -> Result<()> {
        let rows = fluid.copied()?;
        self.precondition(stokes, &rows, fluid)
    }

    /// Whether it is the inverse itself, so that no residual of the fluid is left to be seen.
    fn exact(&self) -> bool {
        false
    }
}

//! The fluid without bodies as a linear system.

use super::{Stokes, StokesInverse};
use crate::{
    error::Result,
    petsc::{Krylov, KrylovMethod, KrylovSettings, Report, System, Vector},
};

/// What may help where the flow of a box without bodies is not found.
const REMEDY: &str = "method.inverse = \"transform\", where the box allows it, or a coarser grid may help";

/// The fluid without bodies, as a linear system; `inverse` preconditions it, if there is one.
pub struct FluidSystem<'a, const D: usize> {
    /// The operator.
    pub stokes: &'a Stokes<D>,
    /// Its approximate inverse.
    pub inverse: Option<&'a mut dyn StokesInverse<D>>,
}

impl<const D: usize> System for FluidSystem<'_, D> {
    fn apply(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        self.stokes.multiply(input, output)?;
        self.stokes.balance(output)
    }

    fn precondition(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        match &mut self.inverse {
            Some(inverse) => inverse.precondition(self.stokes, input, output),
            None => output.copy_from(input),
        }
    }
}

impl<const D: usize> FluidSystem<'_, D> {
    /// Solves `K x = rhs` (balanced rows) to a relative residual of `tolerance`, starting from `x`; an exact inverse needs no iteration.
    ///
    /// # Errors
    /// [`Diverged`](crate::error::Error::Diverged) after `most_iterations` iterations.
    pub fn solve(&mut self, rhs: &Vector, x: &mut Vector, tolerance: f64, most_iterations: usize) -> Result<Report> {
        if let Some(inverse) = self.inverse.as_mut().filter(|inverse| inverse.exact()) {
            inverse.precondition(self.stokes, rhs, x)?;
            return Ok(Report::default());
        }
        let settings = KrylovSettings { method: KrylovMethod::Gmres { restart: 200 }, tolerance, most_iterations };
        let krylov = Krylov::new(self.stokes.session(), rhs.local()?.len(), c"fluid_", settings)?;
        let mut krylov = krylov.with_remedy(REMEDY);
        krylov.solve(self, rhs, x, &mut |_, _| {})
    }
}

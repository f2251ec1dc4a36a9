//! Approximate inverses of the Stokes operator.

mod hypre;

pub use hypre::HypreInverse;

use super::Stokes;
use crate::{
    error::Result,
    petsc::{Krylov, KrylovMethod, KrylovSettings, Operator, Report, Vector},
};

/// An approximate inverse of [`Stokes`]: a fixed linear map from balanced rows to fluid vectors.
///
/// Its output has no mean pressure, and in a fully periodic box no mean velocity.
pub trait StokesInverse<const D: usize> {
    /// `output = K^ rows`, where `rows` are balanced.
    fn precondition(&mut self, stokes: &Stokes<D>, rows: &Vector, output: &mut Vector) -> Result<()>;

    /// Seconds spent setting it up.
    fn setup_seconds(&self) -> f64;
}

/// Solves `K x = rhs` (balanced rows) without bodies to a relative residual of `tolerance`, starting from `x`.
///
/// # Errors
/// [`Diverged`](crate::error::Error::Diverged) after 5000 iterations.
pub fn solve_fluid<const D: usize>(
    stokes: &Stokes<D>,
    preconditioner: &mut dyn Operator,
    (rhs, x): (&Vector, &mut Vector),
    tolerance: f64,
) -> Result<Report> {
    let settings = KrylovSettings { method: KrylovMethod::Gmres { restart: 200 }, tolerance, most_iterations: 5000 };
    let mut krylov = Krylov::new(stokes.session(), rhs.local()?.len(), c"fluid_", settings)?;
    krylov.solve(&mut &*stokes, preconditioner, (rhs, x), &mut |_, _| {})
}

/// An inverse together with the operator that it inverts, as a preconditioner.
pub struct Bound<'a, const D: usize> {
    /// The operator.
    pub stokes: &'a Stokes<D>,
    /// Its approximate inverse.
    pub inverse: &'a mut dyn StokesInverse<D>,
}

impl<const D: usize> Operator for Bound<'_, D> {
    fn apply(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        self.inverse.precondition(self.stokes, input, output)
    }
}

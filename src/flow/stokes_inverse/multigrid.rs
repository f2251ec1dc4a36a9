//! One BoomerAMG V-cycle for each shifted Laplacian.

use std::rc::Rc;

use super::{Stokes, projection::FieldInverse};
use crate::{
    error::Result,
    grid::Grid,
    parallel::World,
    petsc::{Amg, AmgSettings, Vector},
};

/// Multigrid cycles of all fields; those with the same Laplacian share one set-up.
pub struct MultigridCycles {
    cycles: Vec<Rc<Amg>>,
    cycle_of: Vec<usize>,
}

impl MultigridCycles {
    /// Sets up one hierarchy for each Laplacian that differs; that of the pressure is the same for all shifts.
    ///
    /// # Errors
    /// PETSc has no memory for it.
    pub fn new<const D: usize>(stokes: &Stokes<D>, grid: &Grid<D>) -> Result<MultigridCycles> {
        let settings = AmgSettings::laplacian(D);
        let (laplacians, cycle_of) = stokes.laplacians()?;
        let singular = grid.domain().fully_periodic() && stokes.shift() == 0.0;
        let cycles = laplacians.iter().enumerate().map(|(index, matrix)| match cycle_of[D] == index {
            true => stokes.pressure_cycle(),
            false => Amg::new(matrix, singular, &settings).map(Rc::new),
        });
        Ok(MultigridCycles { cycles: cycles.collect::<Result<_>>()?, cycle_of: cycle_of.to_vec() })
    }
}

impl FieldInverse for MultigridCycles {
    fn apply(&mut self, _: &World, field: usize, given: &Vector, found: &mut Vector) -> Result<()> {
        self.cycles[self.cycle_of[field]].apply(given, found)
    }
}

//! The coupled system with the fluid eliminated: what is left are multipliers, mean-flow constraint and contacts.
//!
//! With an exact inverse of the fluid, that of the forces that keep given mean velocities included,
//!
//! ```text
//! u = K^-1 C c        J u + E c + T g - N' f = v        and the rows of mean-flow constraint and contacts as they are
//! ```
//!
//! so that the solver's vectors are as short as the multipliers. Forces of the mean-flow constraint are no unknowns: their rows read
//! `unknown = 0`, and they are read back from the fluid.

use super::coupled::{Operator, SystemParts};
use crate::{
    error::Result,
    petsc::{Stage, System, Vector},
    system::work::{SolvedUnknowns, Watch},
};

/// The system without the fluid; vectors hold multipliers and the global unknowns. The second part is the global unknowns of the vector to which
/// it was applied last.
pub struct SchurComplement<'a, const D: usize>(pub SystemParts<'a, D>, Vec<f64>);

impl<'a, const D: usize> SchurComplement<'a, D> {
    /// The system of these parts.
    pub fn new(parts: SystemParts<'a, D>) -> Self {
        SchurComplement(parts, Vec::new())
    }

    /// Puts into `fluid_in` the fluid that `multipliers_in` and global unknowns move; returns the forces of the mean-flow constraint.
    fn move_fluid(&mut self, global_unknowns: &[f64]) -> Result<Vec<f64>> {
        let SystemParts { stokes, inverse, surfaces, work } = &mut self.0;
        let watch = Watch::start(Stage::Bodies);
        work.fluid_in.fill(0.0)?;
        surfaces.spread(1.0, &work.multipliers_in, global_unknowns, &mut work.fluid_in)?;
        watch.stop(&mut work.stages.bodies);
        let watch = Watch::start(Stage::Inverse);
        stokes.balance(&mut work.fluid_in)?;
        inverse.replace(stokes, &mut work.fluid_in)?;
        let still = vec![0.0; surfaces.mean_flow.forces().len()];
        let forces = surfaces.mean_flow.correct_mean_velocities(surfaces.world, &still, &mut work.fluid_in)?;
        watch.stop(&mut work.stages.inverse);
        Ok(forces)
    }
}

impl<const D: usize> System for SchurComplement<'_, D> {
    fn apply(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        let global_unknowns = self.0.work.split(self.0.surfaces.world, input)?;
        let forces = self.move_fluid(&global_unknowns)?;
        let SystemParts { surfaces, work, .. } = &mut self.0;
        let watch = Watch::start(Stage::Bodies);
        let rows = surfaces.rows(&work.fluid_in, &work.multipliers_in, &global_unknowns, &mut work.multipliers_out)?;
        watch.stop(&mut work.stages.bodies);
        work.join(&rows, output)?;
        self.1 = global_unknowns;
        self.1[..forces.len()].copy_from_slice(&forces);
        Ok(())
    }

    fn precondition(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        let SystemParts { surfaces, work, .. } = &mut self.0;
        let rows = work.split(surfaces.world, input)?;
        let watch = Watch::start(Stage::Bodies);
        work.multipliers_out.fill(0.0)?;
        let global_unknowns = surfaces.precondition(&mut work.multipliers_in, &rows, &mut work.multipliers_out)?;
        watch.stop(&mut work.stages.bodies);
        work.join(&global_unknowns, output)
    }
}

impl<const D: usize> Operator for SchurComplement<'_, D> {
    fn unknowns(&mut self, _: &Vector) -> Result<SolvedUnknowns> {
        // the fluid that this vector moves is there already
        let global_unknowns = std::mem::take(&mut self.1);
        let SystemParts { surfaces, work, .. } = &mut self.0;
        surfaces.velocity(&work.fluid_in, &work.multipliers_in, &global_unknowns, &mut work.multipliers_out)?;
        work.unknowns(global_unknowns)
    }
}

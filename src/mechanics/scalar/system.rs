//! The coupled linear system of the scalar and the multipliers, with its block preconditioner.
//!
//! ```text
//! [ h^2 A   -h^2 C ] [ u ]   [ h^2 f (chi + s)     ]
//! [ J        E     ] [ c ] = [ -f e - J (gradient) ]      constants taken out, and in their place: no net flux
//! ```
//!
//! The preconditioner is block triangular: a multigrid cycle for `A`, then each inclusion as if it were alone.

use crate::{
    constraint::ScalarBlocks,
    error::Result,
    petsc::{Amg, Matrix, Session, Stage, System, Vector},
    system::{Stages, work::Watch},
};

/// The coupled system; the solver's vectors hold the scalar, then multipliers.
pub struct ScalarSystem<const D: usize> {
    /// MPI and PETSc.
    pub session: Session,
    /// Minus the Laplacian.
    pub matrix: Matrix,
    /// Its approximate inverse.
    pub inverse: Amg,
    /// Inclusions.
    pub blocks: ScalarBlocks<D>,
    /// Factor `h^2` of the rows of the scalar, which makes them of the size of its values.
    pub scale: f64,
    /// The scalar: unknowns and rows.
    pub field_in: Vector,
    /// See `field_in`.
    pub field_out: Vector,
    /// The multipliers.
    pub multipliers: Vector,
    /// Seconds so far.
    pub stages: Stages,
}

impl<const D: usize> ScalarSystem<D> {
    /// Takes a solver's vector apart into `field_in` and `multipliers`.
    fn split(&mut self, input: &Vector) -> Result<()> {
        let input = input.local()?;
        let mut field = self.field_in.local_mut()?;
        let (of_field, multipliers) = input.split_at(field.len());
        field.copy_from_slice(of_field);
        self.multipliers.local_mut()?.copy_from_slice(multipliers);
        Ok(())
    }
}

impl<const D: usize> System for ScalarSystem<D> {
    fn apply(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        self.split(input)?;
        let watch = Watch::start(Stage::Matrices);
        self.matrix.multiply(&self.field_in, &mut self.field_out)?;
        watch.stop(&mut self.stages.matrices);
        let watch = Watch::start(Stage::Bodies);
        self.blocks.bodies.spread(-1.0, &self.multipliers.local()?, &mut self.field_out)?;
        self.field_out.scale(self.scale)?;
        let mut output = output.local_mut()?;
        let (field, values) = output.split_at_mut(self.field_out.local()?.len());
        field.copy_from_slice(&self.field_out.local()?);
        self.blocks.bodies.interpolate(&self.field_in, values)?;
        self.blocks.add_local(&self.multipliers, 0.0, values)?;
        self.blocks.free_constants(&self.multipliers.local()?, values);
        watch.stop(&mut self.stages.bodies);
        Ok(())
    }

    fn precondition(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        self.split(input)?;
        let watch = Watch::start(Stage::Inverse);
        self.field_in.scale(1.0 / self.scale)?;
        self.inverse.apply(&self.field_in, &mut self.field_out)?;
        watch.stop(&mut self.stages.inverse);
        let watch = Watch::start(Stage::Bodies);
        let mut output = output.local_mut()?;
        let (field, values) = output.split_at_mut(self.field_out.local()?.len());
        field.copy_from_slice(&self.field_out.local()?);
        self.blocks.bodies.interpolate(&self.field_out, values)?;
        self.blocks.alone(&self.multipliers.local()?, values);
        watch.stop(&mut self.stages.bodies);
        Ok(())
    }
}

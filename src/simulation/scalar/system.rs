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
    simulation::work::{Stages, Watch},
};

/// The coupled system; the solver's vectors hold the scalar, then multipliers.
pub struct ScalarSystem<'a, const D: usize> {
    /// Minus the Laplacian.
    pub matrix: &'a Matrix,
    /// Its approximate inverse.
    pub inverse: &'a Amg,
    /// Inclusions.
    pub blocks: &'a mut ScalarBlocks<D>,
    /// Factor `h^2` of the rows of the scalar.
    pub scale: f64,
    /// Work space.
    pub work: &'a mut ScalarWork,
}

/// Vectors that the system needs while it is applied.
pub struct ScalarWork {
    /// The scalar: unknowns and rows.
    pub field_in: Vector,
    /// See `field_in`.
    pub field_out: Vector,
    /// The multipliers.
    pub multipliers: Vector,
    /// Seconds so far.
    pub stages: Stages,
}

impl ScalarWork {
    /// Work space for fields like the given one and so many multipliers.
    pub fn new(session: &Session, field: Vector, multipliers: usize) -> Result<ScalarWork> {
        let multipliers = Vector::new(session, multipliers)?;
        Ok(ScalarWork { field_out: field.like()?, field_in: field, multipliers, stages: Stages::default() })
    }

    /// Takes a solver's vector apart into `field_in` and `multipliers`.
    pub fn split(&mut self, input: &Vector) -> Result<()> {
        let input = input.local()?;
        let mut field = self.field_in.local_mut()?;
        let (of_field, multipliers) = input.split_at(field.len());
        field.copy_from_slice(of_field);
        self.multipliers.local_mut()?.copy_from_slice(multipliers);
        Ok(())
    }
}

impl<const D: usize> ScalarSystem<'_, D> {
    /// `J u + E c` of the scalar in `field_in` and `multipliers`.
    pub fn values(&mut self, out: &mut [f64]) -> Result<()> {
        self.blocks.bodies.interpolate(&self.work.field_in, out)?;
        self.blocks.add_local(&self.work.multipliers, 0.0, out)
    }
}

impl<const D: usize> System for ScalarSystem<'_, D> {
    fn apply(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        self.work.split(input)?;
        let watch = Watch::start(Stage::Matrices);
        self.matrix.multiply(&self.work.field_in, &mut self.work.field_out)?;
        watch.stop(&mut self.work.stages.matrices);
        let watch = Watch::start(Stage::Bodies);
        self.blocks.bodies.spread(-1.0, &self.work.multipliers.local()?, &mut self.work.field_out)?;
        self.work.field_out.scale(self.scale)?;
        let mut output = output.local_mut()?;
        let field = self.work.field_out.local()?.len();
        output[..field].copy_from_slice(&self.work.field_out.local()?);
        self.values(&mut output[field..])?;
        self.blocks.free_constants(&self.work.multipliers.local()?, &mut output[field..]);
        watch.stop(&mut self.work.stages.bodies);
        Ok(())
    }

    fn precondition(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        self.work.split(input)?;
        let watch = Watch::start(Stage::Inverse);
        self.work.field_in.scale(1.0 / self.scale)?;
        self.inverse.apply(&self.work.field_in, &mut self.work.field_out)?;
        watch.stop(&mut self.work.stages.inverse);
        let watch = Watch::start(Stage::Bodies);
        let mut output = output.local_mut()?;
        let field = self.work.field_out.local()?.len();
        output[..field].copy_from_slice(&self.work.field_out.local()?);
        self.blocks.bodies.interpolate(&self.work.field_out, &mut output[field..])?;
        self.blocks.alone(&self.work.multipliers.local()?, &mut output[field..]);
        watch.stop(&mut self.work.stages.bodies);
        Ok(())
    }
}

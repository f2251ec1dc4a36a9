//! The coupled linear system of the scalar and the multipliers, with its block preconditioner.
//!
//! ```text
//! [ h^2 A   -h^2 C ] [ u ]   [ h^2 f (chi + s) ]
//! [ J        E     ] [ c ] = [ -f e            ]      row of the constant mode: a c = 0, no net flux
//! ```
//!
//! The preconditioner is block triangular: a multigrid cycle for `A`, then each inclusion as if it were alone.

use std::{ops::Range, rc::Rc};

use crate::{
    constraint::ScalarBlocks,
    error::Result,
    petsc::{Amg, Matrix, Stage, System, Vector},
    simulation::work::{Stages, Watch},
};

/// An inclusion of this rank.
pub struct Member {
    /// Its multipliers in this rank's part; the first is that of the constant.
    pub range: Range<usize>,
    /// The value on the surface of a lonely inclusion per unit of each multiplier.
    pub values: Rc<Vec<f64>>,
}

/// The coupled system; the solver's vectors hold the scalar, then multipliers.
pub struct ScalarSystem<'a> {
    /// Minus the Laplacian.
    pub matrix: &'a Matrix,
    /// Its approximate inverse.
    pub inverse: &'a Amg,
    /// Inclusions.
    pub blocks: &'a mut ScalarBlocks,
    /// This rank's inclusions.
    pub members: &'a [Member],
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

impl ScalarSystem<'_> {
    /// Values on surfaces tested with all modes, from the scalar in `field_in` and `multipliers`.
    pub fn values(&mut self, source: f64, out: &mut [f64]) -> Result<()> {
        self.blocks.sample(&self.work.field_in, out)?;
        self.blocks.add_local(&self.work.multipliers, source, out)
    }
}

impl System for ScalarSystem<'_> {
    fn apply(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        self.work.split(input)?;
        let watch = Watch::start(Stage::Matrices);
        self.matrix.multiply(&self.work.field_in, &mut self.work.field_out)?;
        watch.stop(&mut self.work.stages.matrices);
        let watch = Watch::start(Stage::Bodies);
        self.blocks.spread(-1.0, &self.work.multipliers.local()?, &mut self.work.field_out)?;
        self.work.field_out.scale(self.scale)?;
        let mut output = output.local_mut()?;
        let field = self.work.field_out.local()?.len();
        output[..field].copy_from_slice(&self.work.field_out.local()?);
        self.values(0.0, &mut output[field..])?;
        let multipliers = self.work.multipliers.local()?;
        for Member { range, values } in self.members {
            output[field + range.start] = values[0] * multipliers[range.start];
        }
        drop(multipliers);
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
        self.blocks.sample(&self.work.field_out, &mut output[field..])?;
        let wanted = self.work.multipliers.local()?;
        for Member { range, values } in self.members {
            output[field + range.start] = 0.0;
            for (multiplier, value) in range.clone().zip(values.iter()) {
                output[field + multiplier] = (wanted[multiplier] - output[field + multiplier]) / value;
            }
        }
        drop(wanted);
        watch.stop(&mut self.work.stages.bodies);
        Ok(())
    }
}

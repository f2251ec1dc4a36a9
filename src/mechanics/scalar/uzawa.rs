//! Uzawa's iteration for the multipliers: `c -= step (u - m(u))`, with an accurate solve of the box for each.
//!
//! It converges for steps below `2 / |J A^{-1} C|`, in a number of iterations that grows with the number of modes on a surface: as `1/h`
//! if the modes follow the grid.

use std::time::Instant;

use super::system::ScalarSystem;
use crate::{
    error::{Error, Result},
    petsc::{Amg, Krylov, KrylovMethod, KrylovSettings, Matrix, Report, Stage, System, Vector},
    system::{Stages, work::Watch},
};

/// Iterations allowed.
const MOST_ITERATIONS: usize = 20_000;

/// Iterations allowed of a solve of the box.
const MOST_BOX_ITERATIONS: usize = 200;

/// Residual of the box over that of the values on surfaces.
const ACCURACY: f64 = 0.1;

/// Power iterations for the norm; their estimate is some per cent too small.
const POWER_ITERATIONS: usize = 12;

/// Step over its bound: the coarsest modes, which bound it, then keep 0.6 of their error in an iteration, and the finest lose nearly as
/// much as they can.
const PART_OF_BOUND: f64 = 0.8;

/// Residual, over the first, from which the iteration counts as diverged.
const DIVERGED: f64 = 1e3;

/// What the iteration was like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uzawa {
    /// The step.
    pub step: f64,
    /// Estimate of the step from which it diverges.
    pub bound: f64,
    /// Iterations of all solves of the box.
    pub box_iterations: usize,
}

/// The box without inclusions.
struct EmptyBox<'a> {
    matrix: &'a Matrix,
    inverse: &'a Amg,
    stages: &'a mut Stages,
}

impl System for EmptyBox<'_> {
    fn apply(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        let watch = Watch::start(Stage::Matrices);
        self.matrix.multiply(input, output)?;
        watch.stop(&mut self.stages.matrices);
        Ok(())
    }

    fn precondition(&mut self, input: &Vector, output: &mut Vector) -> Result<()> {
        let watch = Watch::start(Stage::Inverse);
        self.inverse.apply(input, output)?;
        watch.stop(&mut self.stages.inverse);
        Ok(())
    }
}

impl<const D: usize> ScalarSystem<D> {
    /// Iterates from zero multipliers, with the rows of the source and what is known of the values on surfaces; without a step, it is a
    /// part of the bound.
    ///
    /// # Errors
    /// [`Error::Diverged`] when the step is too large, or the tolerance is not reached.
    pub fn solve_by_uzawa(
        &mut self,
        source: &Vector,
        known: &[f64],
        step: Option<f64>,
        tolerance: f64,
        monitor: &mut dyn FnMut(usize, f64),
    ) -> Result<(Uzawa, Report)> {
        let start = Instant::now();
        let bound = 2.0 / self.norm_of_response(tolerance)?;
        let mut uzawa = Uzawa { step: step.unwrap_or(PART_OF_BOUND * bound), bound, box_iterations: 0 };
        self.multipliers.fill(0.0)?;
        self.field_in.fill(0.0)?;
        let mut krylov = self.krylov(ACCURACY * tolerance)?;
        let (mut values, mut first) = (vec![0.0; known.len()], 0.0);
        for iteration in 0..MOST_ITERATIONS {
            uzawa.box_iterations += self.solve_box(&mut krylov, Some(source))?;
            self.values_without_means(&mut values)?;
            values.iter_mut().zip(known).for_each(|(value, known)| *value -= known);
            let size = self.size(&values);
            first = if iteration == 0 { size } else { first };
            let residual = if first > 0.0 { size / first } else { 0.0 };
            monitor(iteration, residual);
            if residual <= tolerance {
                return Ok((uzawa, Report { iterations: iteration, residual, seconds: start.elapsed().as_secs_f64() }));
            }
            if residual.is_nan() || residual > DIVERGED {
                return Err(too_large(uzawa, iteration));
            }
            let mut c = self.multipliers.local_mut()?;
            c.iter_mut().zip(&values).for_each(|(c, value)| *c -= uzawa.step * value);
        }
        Err(Error::Diverged(format!(
            "method.uzawa_step = {}: {MOST_ITERATIONS} iterations do not reach the tolerance {tolerance:.1e}; a step nearer to {:.3e} \
             takes fewer, method.solver = \"krylov\" far fewer",
            uzawa.step,
            PART_OF_BOUND * bound
        )))
    }

    /// Power iterations for the norm of `J A^{-1} C` without constants.
    fn norm_of_response(&mut self, tolerance: f64) -> Result<f64> {
        let mut krylov = self.krylov(tolerance.max(1e-4))?;
        let first = self.multipliers.range()?.start;
        let mut values: Vec<f64> = (0..self.multipliers.local()?.len()).map(|place| ((first + place) as f64).cos()).collect();
        self.blocks.free_constants(&vec![0.0; values.len()], &mut values);
        let mut norm = self.size(&values).max(f64::MIN_POSITIVE);
        for _ in 0..POWER_ITERATIONS {
            self.multipliers.local_mut()?.iter_mut().zip(&values).for_each(|(c, value)| *c = value / norm);
            self.field_in.fill(0.0)?;
            self.solve_box(&mut krylov, None)?;
            self.values_without_means(&mut values)?;
            norm = self.size(&values);
        }
        Ok(norm)
    }

    fn krylov(&self, tolerance: f64) -> Result<Krylov> {
        let settings = KrylovSettings { method: KrylovMethod::ConjugateGradients, tolerance, most_iterations: MOST_BOX_ITERATIONS };
        Krylov::new(&self.session, self.field_in.local()?.len(), c"uzawa_", settings)
    }

    /// `A u = source + C c`, from the last `u`.
    fn solve_box(&mut self, krylov: &mut Krylov, source: Option<&Vector>) -> Result<usize> {
        let ScalarSystem { matrix, inverse, blocks, field_in, field_out, multipliers, stages, .. } = self;
        match source {
            Some(source) => field_out.copy_from(source)?,
            None => field_out.fill(0.0)?,
        }
        blocks.bodies.spread(1.0, &multipliers.local()?, field_out)?;
        let mut system = EmptyBox { matrix, inverse, stages };
        Ok(krylov.solve(&mut system, field_out, field_in, &mut |_, _| {})?.iterations)
    }

    /// The scalar on surfaces without its means.
    fn values_without_means(&mut self, out: &mut [f64]) -> Result<()> {
        self.blocks.bodies.interpolate(&self.field_in, out)?;
        self.blocks.free_constants(&vec![0.0; out.len()], out);
        Ok(())
    }

    fn size(&self, values: &[f64]) -> f64 {
        let mut square = [values.iter().map(|value| value * value).sum()];
        self.session.world().sum(&mut square);
        square[0].sqrt()
    }
}

fn too_large(Uzawa { step, bound, .. }: Uzawa, iterations: usize) -> Error {
    Error::Diverged(format!(
        "method.uzawa_step = {step}: the iteration diverged after {iterations} steps, as it does above about {bound:.3e}; \
         lower it or set it to \"auto\""
    ))
}

//! The blocks of the linear system that bodies contribute, whatever the method.

use std::rc::Rc;

use nalgebra::{SMatrix, SVector};

use super::{AdjointBlocks, FreeInverse, SharpBlocks};
use crate::{error::Result, petsc::Vector};

/// The blocks of this rank's bodies, which are counted in the order of the layout.
pub enum Blocks<const D: usize> {
    /// Corrected for jumps.
    Sharp(SharpBlocks<D>),
    /// Those of a method that spreads by the adjoint of its sampling.
    Adjoint(AdjointBlocks<D>),
}

impl<const D: usize> Blocks<D> {
    /// `rows += factor * C c`, with this rank's multipliers `c`.
    pub fn spread(&mut self, factor: f64, c: &[f64], rows: &mut Vector) -> Result<()> {
        match self {
            Blocks::Sharp(blocks) => blocks.spread(factor, c, rows),
            Blocks::Adjoint(blocks) => blocks.spread(factor, c, rows),
        }
    }

    /// `out = J u`, this rank's multipliers, for the velocity of a fluid vector (zero on walls).
    pub fn sample(&mut self, fluid: &Vector, out: &mut [f64]) -> Result<()> {
        match self {
            Blocks::Sharp(blocks) => blocks.sample(fluid, out),
            Blocks::Adjoint(blocks) => blocks.sample(fluid, out),
        }
    }

    /// As [`sample`](Self::sample), for a velocity that is that of the moving walls there.
    pub fn sample_with_walls(&mut self, fluid: &Vector, out: &mut [f64]) -> Result<()> {
        match self {
            Blocks::Sharp(blocks) => blocks.sample_with_walls(fluid, out),
            Blocks::Adjoint(blocks) => blocks.sample_with_walls(fluid, out),
        }
    }

    /// `out += E c`.
    pub fn add_local(&mut self, c: &Vector, out: &mut Vector) -> Result<()> {
        match self {
            Blocks::Sharp(blocks) => blocks.add_local(c, out),
            Blocks::Adjoint(blocks) => blocks.add_local(&c.local()?, &mut out.local_mut()?),
        }
    }

    /// What the rows of one of the bodies make of a velocity known at each offset from its centre.
    pub fn coefficients(&self, local: usize, known: impl Fn(&SVector<f64, D>) -> SVector<f64, D>) -> Vec<f64> {
        match self {
            Blocks::Sharp(blocks) => blocks.coefficients(local, known),
            Blocks::Adjoint(blocks) => blocks.coefficients(local, known),
        }
    }

    /// First moment `integral of F_i r_j` of what one of the bodies does to the fluid.
    pub fn first_moment(&self, local: usize, multipliers: &[f64]) -> SMatrix<f64, D, D> {
        match self {
            Blocks::Sharp(blocks) => blocks.first_moment(local, multipliers),
            Blocks::Adjoint(blocks) => blocks.first_moment(local, multipliers),
        }
    }

    /// What this rank's bodies exert on the lower and the upper wall across each axis besides what the rows beside it have.
    pub fn on_walls(&self, multipliers: &[f64]) -> [[SVector<f64, D>; 2]; D] {
        match self {
            Blocks::Sharp(blocks) => blocks.on_walls(multipliers),
            Blocks::Adjoint(_) => [[SVector::zeros(); 2]; D],
        }
    }

    /// Approximate inverse of the diagonal block of one of the bodies in the rows that are not rigid, unless its
    /// rows are those of surface modes.
    pub fn free_inverse(&self, local: usize) -> Option<Rc<FreeInverse>> {
        match self {
            Blocks::Sharp(_) => None,
            Blocks::Adjoint(blocks) => blocks.body(local).free_inverse(),
        }
    }
}

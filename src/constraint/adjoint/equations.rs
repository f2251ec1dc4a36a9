//! How values of the fluid near a body become its equations, and multipliers become forces in their place.

use std::rc::Rc;

use nalgebra::{DMatrix, DVector};

use super::elastic::ElasticInverse;
use crate::{constraint::body::FreeInverse, surface::SurfaceTable};

/// The map from values of the fluid (rows over its nodes) to equations of the body, the rigid ones first.
pub enum Equations<const D: usize> {
    /// Velocities at the points of a surface become coefficients of its modes.
    Surface {
        /// The surface.
        surface: Rc<SurfaceTable<D>>,
        /// Force per volume at a node of a unit multiplier.
        strength: f64,
    },
    /// The first values are the rigid motion, which is taken out of the others.
    Rows(RowEquations),
}

/// Equations that are the values themselves, of which the first read the rigid motion.
pub struct RowEquations {
    /// The other values of each rigid motion; without rows if they do not see it.
    pub motions: DMatrix<f64>,
    /// Number of rigid motions.
    pub rigid: usize,
    /// Forces per volume of a unit multiplier: of a rigid motion, and of another row.
    pub strengths: [f64; 2],
    /// Number of the other rows.
    pub others: usize,
    /// Diagonal of E in the other rows; empty if there is none.
    pub compliance: Vec<f64>,
    /// Approximate inverse of the diagonal block in the other rows.
    pub inverse: Rc<dyn FreeInverse>,
}

/// The inverse of rows and multipliers that are scaled well.
pub struct UnitInverse;

/// The inverse of strains, each scaled by a factor, and stresses likewise.
pub struct ScaledElastic {
    /// Of strains and stresses as they are.
    pub inverse: ElasticInverse,
    /// The factors.
    pub scales: Vec<f64>,
}

impl FreeInverse for UnitInverse {
    fn apply(&self, input: &[f64], output: &mut [f64]) {
        output.copy_from_slice(input);
    }
}

impl FreeInverse for ScaledElastic {
    fn apply(&self, input: &[f64], output: &mut [f64]) {
        let strains: Vec<f64> = input.iter().zip(&self.scales).map(|(row, scale)| row / scale).collect();
        let stresses = self.inverse.apply(&strains).into_iter().zip(&self.scales);
        output.iter_mut().zip(stresses).for_each(|(output, (stress, scale))| *output = stress / scale);
    }
}

impl<const D: usize> Equations<D> {
    /// Number of equations.
    pub fn count(&self) -> usize {
        match self {
            Equations::Surface { surface, .. } => surface.modes.count(),
            Equations::Rows(rows) => rows.rigid + rows.others,
        }
    }

    /// The equations of values.
    pub fn apply(&self, values: Vec<f64>) -> Vec<f64> {
        match self {
            Equations::Surface { surface, .. } => {
                let mut out = vec![0.0; surface.modes.count()];
                surface.project(&values, &mut out);
                out
            }
            Equations::Rows(rows) => rows.without_motion(values),
        }
    }

    /// The adjoint, times the strengths: forces in the place of values.
    pub fn forces(&self, multipliers: &[f64]) -> Vec<f64> {
        match self {
            Equations::Surface { surface, strength } => {
                let columns = surface.projector().as_slice().chunks_exact(multipliers.len());
                columns.map(|column| strength * column.iter().zip(multipliers).map(|(entry, c)| entry * c).sum::<f64>()).collect()
            }
            Equations::Rows(rows) => rows.forces(multipliers),
        }
    }
}

impl RowEquations {
    /// The values with the rigid motion taken out of those that are not it.
    pub fn without_motion(&self, mut values: Vec<f64>) -> Vec<f64> {
        if self.motions.nrows() > 0 {
            let (motion, others) = values.split_at_mut(self.rigid);
            let carried = &self.motions * DVector::from_column_slice(motion);
            others.iter_mut().zip(carried.iter()).for_each(|(value, carried)| *value -= carried);
        }
        values
    }

    fn forces(&self, multipliers: &[f64]) -> Vec<f64> {
        let strength = |row: usize| self.strengths[usize::from(row >= self.rigid)];
        let mut forces: Vec<f64> = multipliers.iter().enumerate().map(|(row, c)| strength(row) * c).collect();
        if self.motions.nrows() > 0 {
            let (rigid, others) = forces.split_at_mut(self.rigid);
            let borne = self.motions.tr_mul(&DVector::from_column_slice(others));
            rigid.iter_mut().zip(borne.iter()).for_each(|(force, borne)| *force -= borne);
        }
        forces
    }
}
